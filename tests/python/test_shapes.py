"""Capsules, joints of six degrees of freedom, break limits and assemblies, against statics."""

import math

import motley
import numpy as np
import pytest

GRAVITY = (0, 0, -9.81)


def step(scene, seconds):
    solver = motley.Solver(gravity=GRAVITY)
    for _ in range(round(60 * seconds)):
        solver.step(scene, 1 / 60)


def test_a_floor_bears_a_sphere_and_a_slope_with_too_little_friction_lets_it_slide():
    scene = motley.Scene()
    scene.add_half_space(friction=0.2)
    ball = scene.add_body(position=(0, 0, 0.5), mass=3, inertia=0.3)
    shape = scene.add_capsule(ball, (0, 0, 0), (0, 0, 0), radius=0.5, friction=0.2)
    step(scene, 1)
    contacts = scene.shape_contacts()
    assert contacts["b"] == [ball] and contacts["a"] == [scene.ground]
    assert contacts["normal_force"][0] == pytest.approx(3 * 9.81, rel=1e-3)
    assert contacts["normal"][0] == pytest.approx((0, 0, 1), abs=1e-6)
    scene.remove_shape(shape)
    step(scene, 0.1)
    assert len(scene.shape_contacts()["b"]) == 0

    # Steeper than friction: a capsule across the slope slides with g (sin - mu cos).
    slope, mu = math.radians(40), 0.2
    scene = motley.Scene()
    scene.add_half_space(normal=(math.sin(slope), 0, math.cos(slope)), friction=mu)
    box = [scene.add_body(position=(0.5 * math.sin(slope), y, 0.5 * math.cos(slope)), mass=1, inertia=1e6) for y in (-1, 1)]
    for each in box:
        scene.add_capsule(each, (0, -0.2, 0), (0, 0.2, 0), radius=0.5, friction=mu)
    step(scene, 1)
    speed = np.linalg.norm(scene.read_velocities(box), axis=1)
    assert speed == pytest.approx(9.81 * (math.sin(slope) - mu * math.cos(slope)), rel=0.01)


def test_a_joint_of_six_degrees_of_freedom_locks_limits_and_frees():
    scene = motley.Scene()
    lift = scene.add_body(position=(0, 0, 0), mass=2)
    joints = scene.add_six_dof(scene.ground, lift, position=["locked", "locked", (-0.25, 0.5)], rotation=["locked"] * 3)
    assert len(joints) == scene.joint_count >= 2
    step(scene, 2)
    assert scene.state(lift)["position"] == pytest.approx((0, 0, -0.25), abs=1e-3)
    free = scene.add_body(position=(5, 0, 0), mass=2)
    scene.add_six_dof(scene.ground, free, position=["free"] * 3,
                      rotation=["locked", "locked", dict(lower=-math.inf, upper=math.inf, motor_speed=1, motor_max_force=100)])
    step(scene, 0.5)
    assert scene.state(free)["position"][2] == pytest.approx(-9.81 * 0.125, rel=1e-3)
    assert scene.state(free)["angular_velocity"] == pytest.approx((0, 0, 1), abs=1e-3)
    for wrong in (dict(position="free"), dict(position=["free"] * 2), dict(rotation=[(1, 0), "free", "free"]),
                  dict(rotations="yaw"), dict(position=[dict(lower=math.nan)] * 3), dict(rotation=["loose", "free", "free"])):
        with pytest.raises(motley.InvalidInput):
            scene.add_six_dof(scene.ground, free, **wrong)
    with pytest.raises(TypeError):
        scene.add_six_dof(scene.ground, free, swing=1)


def test_a_joint_that_bears_more_than_its_limit_is_listed_until_it_is_removed():
    scene = motley.Scene()
    weight = scene.add_body(position=(0, 0, -1), mass=10)
    joint = scene.add_joint("ball_socket", scene.ground, weight, local_anchor_b=(0, 0, 1))
    scene.set_break_limit(joint, force=120)
    step(scene, 0.5)
    assert len(scene.break_events()["joint"]) == 0
    scene.set_break_limit(joint, force=80)
    step(scene, 1 / 60)
    events = scene.break_events()
    assert list(events["joint"]) == [joint]
    assert events["force"][0] == pytest.approx(98.1, rel=1e-2)
    scene.remove_joint(joint)
    step(scene, 1 / 60)
    assert len(scene.break_events()["joint"]) == 0
    with pytest.raises(motley.InvalidInput):
        scene.set_break_limit(joint, force=80)


def test_copies_of_a_figure_hang_as_one_does():
    figure = motley.Figure()
    post = figure.add_body(motion="static")
    arm = figure.add_body(position=(0, 0, -1), mass=2)
    figure.add_joint("ball_socket", post, arm, local_anchor_b=(0, 0, 1))
    figure.add_capsule(arm, (0, 0, 0), (0, 0, 1), radius=0.1)
    assert len(figure) == 2
    with pytest.raises(motley.InvalidInput):
        figure.add_joint("pulley", post, arm, max_length=9)
    scene = motley.Scene()
    places = [(3 * i, 0, 5) for i in range(20)]
    bodies = scene.add_assembly(figure, places, linear_velocities=np.zeros((20, 3)))
    assert bodies.shape == (20, 2) and len(scene) == 40 and scene.joint_count == 20
    step(scene, 1)
    assert scene.read_positions(bodies[:, 1]) == pytest.approx(np.array(places) + (0, 0, -1), abs=1e-3)
    before = len(scene)
    for wrong in (dict(orientations=np.zeros((20, 4))), dict(orientations=np.ones((19, 4))), dict(linear_velocities=[1, 2, 3])):
        with pytest.raises(motley.InvalidInput):
            scene.add_assembly(figure, places, **wrong)
    assert len(scene) == before
