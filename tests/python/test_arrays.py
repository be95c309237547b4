"""Arrays of every kind: what fits is used as it lies, what does not is converted or refused by name, and nothing crashes."""

import motley
import numpy as np
import pytest


def crowd(count=4):
    scene = motley.Scene()
    return scene, scene.add_people([(float(i), 0) for i in range(count)])


def refusal(call, *arguments, **named):
    with pytest.raises(motley.InvalidInput) as caught:
        call(*arguments, **named)
    return caught.value


def test_forces_come_from_any_layout_with_the_same_bits():
    expected = None
    wide = np.arange(24, dtype=np.float32).reshape(4, 6)
    wide[:, 2] = 0
    for forces in (wide[:, :3], np.ascontiguousarray(wide[:, :3]), np.asfortranarray(wide[:, :3]), wide[:, :3].tolist(),
                   wide[:, :3].astype(np.float64), wide[:, :3].astype(int), wide[:, :3].astype(">f4"),
                   wide[::-1, :3][::-1], wide[:, 2::-1][:, ::-1]):
        scene, people = crowd()
        scene.set_forces(people, forces)
        motley.Solver().step(scene, 1 / 60)
        expected = expected or scene.state_hash()
        assert scene.state_hash() == expected
    assert expected != crowd()[0].state_hash()


def test_an_array_that_is_thrown_away_early_has_been_read():
    scene, people = crowd()
    forces = np.full((4, 3), [80, 0, 0], dtype=np.float32)
    scene.set_forces(people, forces)
    forces[:] = np.nan
    del forces
    motley.Solver().step(scene, 1 / 60)
    np.testing.assert_allclose(scene.read_velocities(people)[:, 0], 1 / 60, rtol=1e-5)


def test_reads_write_into_the_caller_s_memory():
    scene, people = crowd()
    table = np.zeros((4, 5))
    assert scene.read_positions(people, out=table[:, 1:4]) is not None
    np.testing.assert_array_equal(table[:, 1], [0, 1, 2, 3])
    assert not table[:, 0].any() and not table[:, 4].any()


@pytest.mark.parametrize("out", [np.zeros((4, 2)), np.zeros((3, 3)), np.zeros((4, 3), np.float32), np.zeros((4, 3))[::-1],
                                 np.zeros((4, 3)).T, np.zeros(12), np.broadcast_to(np.zeros(3), (4, 3)), [[0, 0, 0]] * 4,
                                 np.zeros((4, 6))[:, ::2], np.zeros((4, 3), ">f8"), "text"])
def test_an_array_that_cannot_be_written_is_refused(out):
    scene, people = crowd()
    before = None if isinstance(out, (str, list)) else out.copy()
    assert refusal(scene.read_positions, people, out=out).field == "out"
    if before is not None:
        np.testing.assert_array_equal(out, before)


def test_a_read_only_array_may_be_read_and_not_written():
    scene, people = crowd()
    fixed = np.zeros((4, 3), dtype=np.float32)
    fixed.flags.writeable = False
    scene.set_forces(people, fixed)
    place = np.zeros((4, 3))
    place.flags.writeable = False
    assert "read-only" in refusal(scene.read_positions, people, out=place).value


@pytest.mark.parametrize("forces", [np.zeros((3, 3)), np.zeros((4, 2)), np.zeros(12), np.zeros((4, 3), complex), "text", None,
                                    [["a", "b", "c"]] * 4, np.zeros((4, 3), object), [[1, 2, 3], [4, 5]]])
def test_wrong_shapes_and_types_are_named(forces):
    scene, people = crowd()
    before = scene.state_hash()
    assert refusal(scene.set_forces, people, forces).field == "forces"
    assert scene.state_hash() == before


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_values_that_are_not_finite_are_refused_and_change_nothing(bad):
    scene, people = crowd()
    before = scene.to_bytes()
    forces = np.zeros((4, 3))
    forces[2, 1] = bad
    refusal(scene.set_forces, people, forces)
    refusal(scene.add_people, [(0, bad)])
    refusal(scene.add_body, mass=bad)
    refusal(scene.add_wall, [(0, 0), (bad, 1)])
    refusal(motley.Solver().step, scene, bad)
    assert scene.to_bytes() == before


def test_people_are_added_all_or_none():
    scene, _ = crowd()
    before = scene.state_hash()
    assert "radius" in refusal(scene.add_people, [(0, 5), (1, 5)], radius=[0.2, -1]).field
    assert len(scene) == 4 and scene.state_hash() == before


@pytest.mark.parametrize("handles", [[1.5], [[1]], "text", [10**30], [-1], None])
def test_handles_are_whole_numbers(handles):
    scene, _ = crowd()
    with pytest.raises((motley.InvalidInput, TypeError, OverflowError)):
        scene.read_positions(handles)


def test_handles_of_nobody_are_refused():
    scene, people = crowd()
    scene.remove_body(int(people[1]))
    refusal(scene.read_positions, people)
    refusal(scene.state, int(people[1]))
    refusal(scene.remove_body, scene.ground)


def test_errors_name_field_value_and_range():
    error = refusal(motley.Scene().add_body, mass=-1)
    assert (error.field, error.value, error.expected) == ("BodyDefinition.mass", "-1", "1e-10 to 1e10 (kg)")
    assert isinstance(error, ValueError)
    assert refusal(motley.Scene().add_body, model="cube").expected == "'particle', 'planar', 'rigid'"
    assert refusal(motley.Scene().add_body, position=(1, 2)).field == "BodyDefinition.position"
    assert refusal(motley.Scene().add_body, mass="heavy").field == "BodyDefinition.mass"
    assert refusal(motley.Solver, substeps=0).field == "SolverSettings.substeps"
    assert refusal(motley.Solver, substeps=2.5).field == "SolverSettings.substeps"
    assert refusal(motley.Solver, method="magic").field == "SolverSettings.method"
    assert refusal(motley.Solver, isa="mmx").field == "isa"
    with pytest.raises(TypeError, match="'weight'"):
        motley.Scene().add_body(weight=3)
    with pytest.raises(TypeError, match="'speed'"):
        motley.Solver(speed=3)
    scene = motley.Scene()
    body = scene.add_body()
    assert refusal(scene.add_joint, "glue", scene.ground, body).field == "type"
    assert "max_angle" in refusal(scene.add_joint, "swing_limit", scene.ground, body, max_angle=-1).field
    with pytest.raises(TypeError, match="'length'"):
        scene.add_joint("hinge", scene.ground, body, length=3)


def test_contacts_of_another_type_are_refused():
    scene, people = crowd()
    solver = motley.Solver()
    for contacts in (np.zeros(3), [1, 2], np.zeros((2, 2), motley.contact_dtype), np.zeros(4, motley.contact_dtype)[::2]):
        assert refusal(solver.step, scene, 1 / 60, contacts).field == "contacts"
    bad = np.zeros(1, motley.contact_dtype)
    bad["body_a"], bad["body_b"] = people[0], people[1]
    before = scene.to_bytes()
    assert "normal" in str(refusal(solver.step, scene, 1 / 60, bad))
    assert scene.to_bytes() == before


def test_settings_stay_if_one_is_refused():
    solver = motley.Solver(substeps=3)
    solver.change(iterations=2)
    refusal(solver.change, iterations=5, substeps=-1)
    assert solver.settings["substeps"] == 3 and solver.settings["iterations"] == 2
    assert solver.settings["method"] == "soft_step" and solver.settings["gravity"] == (0, 0, 0)
