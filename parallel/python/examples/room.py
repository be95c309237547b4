"""500 people press out of a room through a door; the pressure that each bears at the end, as a plot."""

import sys

import matplotlib.pyplot as plt
import motley
import numpy as np

scene = motley.Scene()
motley.add_walls(scene, "LINESTRING (15 5.6, 15 12, 0 12, 0 0, 15 0, 15 4.4)")  # a door of 1.2 m in the middle of the right side
places = np.stack(np.meshgrid(np.arange(25), np.arange(20)), -1).reshape(-1, 2) * 0.5 + [2, 1]
people = scene.add_people(places, radius=0.2, mass=80, friction=0.2)
solver = motley.Solver(threads=2)
around = np.full(len(people), 2 * np.pi * 0.2)  # circumferences, m
for step in range(300 if len(sys.argv) < 3 else int(sys.argv[2])):
    place, velocity = scene.read_positions(people), scene.read_velocities(people)
    goal = np.where(place[:, :1] < 15, [[15.3, 5, 0]], [[30, 5, 0]]) - place
    walk = 1.3 * goal / np.linalg.norm(goal, axis=1, keepdims=True)
    scene.set_forces(people, 80 * (walk - velocity) / 0.5)
    solver.step(scene, 1 / 60)
pressure = scene.read_loads(people, around)["pressure"]  # N/m
place = scene.read_positions(people)
plt.scatter(place[:, 0], place[:, 1], c=pressure, s=30, cmap="viridis")
plt.colorbar(label="pressure (N per metre of circumference)")
plt.gca().set_aspect("equal")
plt.savefig(sys.argv[1] if len(sys.argv) > 1 else "room.png")
print(f"{(place[:, 0] > 15).sum()} of {len(people)} are out; the most pressed bears {pressure.max():.0f} N/m")
