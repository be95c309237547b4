"""The package against closed forms, and against the bits of the library."""

import os
import re
import subprocess
import threading

import motley
import numpy as np
import pytest

GRAVITY = (0, -9.81, 0)


def pendulum():
    scene = motley.Scene()
    ball = scene.add_body(position=(1, 0, 0), mass=2)
    joint = scene.add_joint("ball_socket", scene.ground, ball, local_anchor_b=(-1, 0, 0))
    return scene, ball, joint


def test_a_falling_body_falls_as_bodies_do():
    scene = motley.Scene()
    ball = scene.add_body(position=(0, 0, 0), model="particle")
    solver = motley.Solver(gravity=GRAVITY)
    for _ in range(60):
        solver.step(scene, 1 / 60)
    assert scene.state(ball)["position"][1] == pytest.approx(-9.81 / 2, rel=1e-5)


def test_a_hanging_joint_bears_the_weight():
    scene = motley.Scene()
    ball = scene.add_body(position=(0, -1, 0), mass=2)
    joint = scene.add_joint("ball_socket", scene.ground, ball, local_anchor_b=(0, 1, 0))
    solver = motley.Solver(gravity=GRAVITY)
    for _ in range(60):
        solver.step(scene, 1 / 60)
    assert scene.joint_report(joint)["force"][1] == pytest.approx(2 * 9.81, rel=1e-3)


def test_every_type_of_joint_has_its_name():
    scene, ball, _ = pendulum()
    special = {"manifold": dict(normal=(1, 0, 0), point_count=1, points=[((0, 0, 0), (-1, 0, 0))]),
               "distance": dict(max_length=2), "pulley": dict(max_length=9, point_b=(1, 1, 0), point_a=(0, 1, 0)),
               "swing_limit": dict(max_angle=1), "gear": dict(ratio=2), "twist_drive": dict(lower=-1, upper=1),
               "slide_drive": dict(motor_max_force=1), "euler_drive": dict(angle="y", lower=-1),
               "screw": dict(pitch=0.1), "rack_and_pinion": dict(travel=0.1),
               "hinge": dict(frame_a=dict(position=(1, 0, 0), rotation=(0, 0, 0, 1)), stiffness=3)}
    for kind in motley.joint_types:
        scene.add_joint(kind, scene.ground, ball, **special.get(kind, {}))
    assert scene.joint_count == len(motley.joint_types) + 1


def test_bits_are_those_of_any_instruction_set_and_number_of_threads():
    first, second = pendulum()[0], pendulum()[0]
    one, two = motley.Solver(gravity=GRAVITY, isa="scalar"), motley.Solver(gravity=GRAVITY, threads=2, alone_below=0)
    for _ in range(100):
        one.step(first, 1 / 60)
        two.step(second, 1 / 60)
        assert first.state_hash() == second.state_hash()


@pytest.mark.skipif("MOTLEY_PROGRAM" not in os.environ, reason="MOTLEY_PROGRAM names the program motley")
def test_bits_are_those_of_the_program():
    # `motley run lean`: a row of 100 discs, each of which leans on the next with 50 N, and the first on a wall.
    command = [os.environ["MOTLEY_PROGRAM"], "run", "lean", "--agents", "100", "--seconds", "1"]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    scene = motley.Scene()
    people = scene.add_people([((2 * 0.2) * i, 0) for i in range(100)])
    scene.add_wall([(-0.2, -1), (-0.2, 100)])
    scene.set_forces(people, np.tile([-50, 0, 0], (100, 1)))
    solver = motley.Solver()
    for _ in range(60):
        solver.step(scene, 1 / 60)
    assert f"{scene.state_hash():016x}" == re.search(r"state hash +([0-9a-f]{16})", printed)[1]


def test_a_scene_goes_on_from_bytes_with_the_same_bits():
    scene, _, _ = pendulum()
    solver = motley.Solver(gravity=GRAVITY)
    solver.step(scene, 1 / 60)
    other, copy = motley.Scene.from_bytes(scene.to_bytes()), scene.copy()
    for each in (scene, other, copy):
        solver.step(each, 1 / 60)
    assert scene.state_hash() == other.state_hash() == copy.state_hash()
    with pytest.raises(RuntimeError):
        motley.Scene.from_bytes(scene.to_bytes()[:-5])
    with pytest.raises(RuntimeError):
        motley.Scene.from_bytes(b"")


def test_a_leaning_row_bears_what_is_behind():
    scene = motley.Scene()
    motley.add_walls(scene, "LINESTRING (0 -5, 0 5)")
    people = scene.add_people([(0.2 + 0.4 * i, 0) for i in range(20)])
    scene.set_forces(people, np.tile([-50, 0, 0], (20, 1)))
    solver = motley.Solver(exact_contacts=True, substeps=1)
    for _ in range(60):
        solver.step(scene, 1 / 60)
    loads = scene.read_loads(people, circumferences=2.0)
    # Each is pushed from behind and by what is in front of it.
    expected = [50 * (2 * (20 - i) - 1) for i in range(20)]
    np.testing.assert_allclose(loads["normal_force"], expected, rtol=1e-3)
    np.testing.assert_allclose(loads["pressure"], loads["normal_force"] / 2)
    wall_force = scene.disc_contacts()
    assert wall_force["normal_force"][wall_force["wall"] != 0].sum() == pytest.approx(1000, rel=1e-3)


def test_contacts_of_the_host_hold():
    scene = motley.Scene()
    ball = scene.add_body(position=(0, 0.5, 0), mass=3)
    solver = motley.Solver(gravity=GRAVITY)
    contacts = np.zeros(1, dtype=motley.contact_dtype)
    contacts["body_a"], contacts["body_b"], contacts["key"] = scene.ground, ball, 7
    contacts["normal"], contacts["arm_b"] = (0, 1, 0), (0, -0.5, 0)
    for _ in range(60):
        contacts["separation"] = scene.state(ball)["position"][1] - 0.5
        assert solver.step(scene, 1 / 60, contacts)["contacts"] == 1
    assert abs(scene.state(ball)["position"][1] - 0.5) < 2e-3
    impulses = scene.contact_impulses()
    assert impulses["normal"][0] / scene.last_step == pytest.approx(3 * 9.81, rel=1e-3)
    assert impulses["friction"].shape == (1, 3) and not impulses["friction"].any()


def queue(count):
    """People who touch, each driven by 200 N into a wall."""
    scene = motley.Scene()
    motley.add_walls(scene, "LINESTRING (0 -5, 0 5)")
    people = scene.add_people([(0.2 + 0.4 * i, 0) for i in range(count)])
    scene.set_forces(people, np.tile([-200, 0, 0], (count, 1)))
    return scene, people


def test_a_report_says_what_a_step_left_and_cost():
    scene, _ = queue(10)
    report = motley.Solver(measures=True).step(scene, 1 / 60)
    assert report["disc_contacts"] == report["contacts"] == 10 and 0 < report["lane_occupancy"] <= 1
    assert report["seconds"] == pytest.approx(sum(report["stages"].values())) and "solve" in report["stages"]
    measures = report["measures"]
    assert measures["residual_max"] >= measures["residual_rms"] > 0
    assert measures["after"]["momentum"] == scene.errors()["momentum"]
    # The direct method leaves nothing, and a tolerance no more than it says.
    report = motley.Solver(method="direct").step(queue(10)[0], 1 / 60)
    assert report["direct_unsolved"] == 0 and report["direct_violation"] < 1e-9
    solver = motley.Solver(method="sequential_impulse", iterations=9999, tolerance=1e-3, measures=True)
    report = solver.step(queue(10)[0], 1 / 60)
    assert report["islands"] == 1 and report["islands_above_tolerance"] == 0 and report["measures"]["residual_max"] <= 1e-3


def test_an_island_has_as_many_sweeps_as_it_wants():
    borne = []
    for wish in (0, 5000):
        scene, people = queue(40)
        scene.set_island_iterations(people[0], wish)
        motley.Solver(method="sequential_impulse", iterations=2, substeps=1).step(scene, 1 / 60)
        contacts = scene.disc_contacts()
        borne.append(contacts["normal_force"][contacts["wall"] != 0].sum())
    assert borne[1] == pytest.approx(40 * 200, rel=1e-3) and borne[0] < 0.9 * borne[1]
    scene, _, joint = pendulum()
    scene.set_iterations(joint, 20)
    assert motley.Solver(gravity=GRAVITY).step(scene, 1 / 60)["iterations"] == 20
    with pytest.raises(motley.InvalidInput, match="set_iterations.at_least"):
        scene.set_iterations(joint, 10001)


def test_a_person_becomes_a_ball_and_comes_back():
    scene, people = queue(2)
    with pytest.raises(motley.InvalidInput):
        scene.change_body(people[1], "rigid")
    scene.clear_disc(people[1])
    scene.change_body(people[1], "rigid", inertia=2)
    scene.set_mass(people[1], 40, 1)
    scene.set_damping(people[1], 0.1)
    scene.change_body(people[1], "planar", inertia=1.6)
    scene.set_disc(people[1], radius=0.2, friction=0.1)
    assert motley.Solver().step(scene, 1 / 60)["disc_contacts"] == 2


def test_who_is_frozen_is_revived():
    scene = motley.Scene()
    body = scene.add_body(mass=1)
    solver = motley.Solver()
    scene.set_force(body, (3e38, 0, 0))
    for _ in range(3):
        solver.step(scene, 1)
    assert scene.is_contained(body)
    scene.set_force(body, (0, 0, 0))
    scene.revive(body, (1, 2, 3), (4, 0, 0))
    solver.step(scene, 0.5)
    assert scene.state(body)["position"] == pytest.approx((3, 2, 3))


def test_a_weld_gives_as_its_springs_say():
    scene = motley.Scene()
    block = scene.add_body(position=(0, 0, 0), mass=2)
    position, rotation = scene.add_weld(scene.ground, block, linear_hertz=2)
    solver = motley.Solver(gravity=GRAVITY)
    for _ in range(600):
        solver.step(scene, 1 / 60)
    assert scene.state(block)["position"][1] == pytest.approx(-9.81 / (2 * np.pi * 2) ** 2, rel=5e-3)
    assert scene.joint_report(position)["force"][1] == pytest.approx(2 * 9.81, rel=1e-3) and rotation != 0
    assert scene.add_weld(scene.ground, block)[1] == 0
    with pytest.raises(motley.InvalidInput, match="WeldDefinition.linear_hertz"):
        scene.add_weld(scene.ground, block, linear_hertz=-1)


def test_queries_find_who_is_there():
    scene = motley.Scene()
    motley.add_walls(scene, "LINESTRING (5 -5, 5 5)")
    people = scene.add_people([(0, 0), (1, 0), (9, 0)])
    index, walls = motley.CrowdIndex(scene), motley.WallIndex(scene)
    assert len(index) == 3
    assert list(index.within((0, 0), 1.5)) == list(people[:2])
    found, distances = index.nearest((8, 0), 1)
    assert found[0] == people[2] and distances[0] == pytest.approx(1)
    assert walls.is_free((0, 0), (4, 0)) and not walls.is_free((0, 0), (9, 0))


def test_sleepers_wake_and_models_change():
    scene = motley.Scene()
    person = int(scene.add_people([(0, 0)])[0])
    solver = motley.Solver(sleep_speed=0.01, sleep_after=0.1)
    for _ in range(60):
        solver.step(scene, 1 / 60)
    assert scene.is_asleep(person)
    scene.wake(person)
    assert not scene.is_asleep(person)
    scene.remove_body(person)
    assert len(scene) == 0 and not scene.is_alive(person)


def test_another_thread_runs_during_a_step_and_may_not_touch_the_scene():
    scene = motley.Scene()
    places = np.stack(np.meshgrid(np.arange(200), np.arange(200)), -1).reshape(-1, 2) * 0.39
    people = scene.add_people(places)
    solver = motley.Solver()
    refused, running = [], threading.Event()

    def look():
        running.wait()
        while not stop.is_set():
            try:
                scene.read_positions(people)
            except RuntimeError as error:
                refused.append(str(error))

    stop = threading.Event()
    thread = threading.Thread(target=look)
    thread.start()
    running.set()
    for _ in range(20):
        solver.step(scene, 1 / 60)
    stop.set()
    thread.join()
    assert refused and all("in a step" in text for text in refused)
