"""Rigid-body constraints for crowds, in coloured SIMD lanes.

A scene has bodies, people, walls and joints; a solver steps it:

    scene = motley.Scene()
    motley.add_walls(scene, "POLYGON ((0 0, 10 0, 10 8, 0 8, 0 0))")
    people = scene.add_people(positions)          # n x 2, m
    solver = motley.Solver(threads=2)
    scene.set_forces(people, forces)              # n x 3, N
    solver.step(scene, 1 / 60)
    loads = scene.read_loads(people)["normal_force"]

Handles are whole numbers, and arrays of them arrays of uint64. Numbers are SI units.
"""

from ._errors import InvalidInput
from ._motley import CrowdIndex, Figure, Scene, Solver, WallIndex, contact_dtype
from .geometry import add_walls, people_inside

joint_types = Scene.joint_types

__all__ = ["CrowdIndex", "Figure", "InvalidInput", "Scene", "Solver", "WallIndex", "add_walls", "contact_dtype", "joint_types",
           "people_inside"]
