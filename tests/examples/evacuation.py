"""The evacuation of evacuation.cpp from Python, with the same bits, and a plot of who is out when.

    evacuation.py [PEOPLE [PICTURE]]
"""

import sys

import motley
import numpy as np

DT, RADIUS, MASS = 1 / 60, 0.2, 80
DOORS = np.array([[16.0, 6.0], [3.0, 12.0]])  # their middles, m
OUT = np.array([[1.0, 0.0], [0.0, 1.0]])  # the ways out

number = int(sys.argv[1]) if len(sys.argv) > 1 else 240
scene = motley.Scene()
motley.add_walls(scene, "MULTILINESTRING ((16 6.6, 16 12, 3.5 12), (2.5 12, 0 12, 0 0, 16 0, 16 5.4))")
at = np.arange(number)
people = scene.add_people(np.stack([2 + 0.5 * (at % 24), 1 + 0.5 * (at // 24)], 1), radius=RADIUS, mass=MASS)
solver = motley.Solver(threads=2)

place = scene.read_positions(people)[:, :2]
to_door = np.hypot(place[:, None, 0] - DOORS[:, 0], place[:, None, 1] - DOORS[:, 1])
way = np.where(to_door[:, 0] <= to_door[:, 1], 0, 1)  # by the nearest door
middle, out = DOORS[way], OUT[way]
rate, speed = np.float32(MASS / 0.5), np.float32(1.3)
forces = np.zeros((number, 3), np.float32)
inside = [number]
while inside[-1] > 0:
    velocity = scene.read_velocities(people)[:, :2]
    goal = middle + 0.3 * out - place
    goal = goal / np.hypot(goal[:, 0], goal[:, 1])[:, None]
    beyond = ((place - middle) * out).sum(1)
    heading = np.where(beyond[:, None] < 0, goal, out).astype(np.float32)
    forces[:, :2] = rate * (speed * heading - velocity)
    scene.set_forces(people, forces)
    solver.step(scene, DT)
    place = scene.read_positions(people)[:, :2]
    inside.append(int((((place - middle) * out).sum(1) <= 0).sum()))
    if len(inside) > 180 * 60:
        sys.exit("evacuation: somebody is still inside after three minutes")

seconds = (len(inside) - 1) / 60
print(f"all are out after {seconds:.1f} s: {(way == 0).sum() / seconds:.2f} people/s by door 1, "
      f"{(way == 1).sum() / seconds:.2f} by door 2; hash {scene.state_hash():016x}")
if len(sys.argv) > 2:
    import matplotlib.pyplot as plt

    plt.plot(np.arange(len(inside)) / 60, inside)
    plt.xlabel("time (s)")
    plt.ylabel("people inside")
    plt.savefig(sys.argv[2])
