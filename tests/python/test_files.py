"""Floor plans of shapely and WKT, trajectories, and the example."""

import pathlib
import subprocess
import sys

import motley
import motley.trajectories
import numpy as np
import pytest

HALL = "POLYGON ((0 0, 10 0, 10 8, 0 8, 0 0), (4 3, 6 3, 6 5, 4 5, 4 3))"


def test_wkt_makes_walls():
    scene = motley.Scene()
    assert len(motley.add_walls(scene, HALL, friction=0.3)) == 2
    assert not motley.WallIndex(scene).is_free((5, 1), (5, 7))


@pytest.mark.parametrize("text", ["POINT (1 2)", "POLYGON ((0 0, 1 1, 1 0, 0 1, 0 0))", "LINE", "", "POLYGON ((0 0, 1"])
def test_what_is_no_floor_plan_is_refused(text):
    scene = motley.Scene()
    with pytest.raises(motley.InvalidInput):
        motley.add_walls(scene, ["LINESTRING (0 0, 1 0)", text])
    assert motley.WallIndex(scene).is_free((0.5, -1), (0.5, 1)), "the wall that was good has not stayed"


def test_shapely_makes_the_same_walls():
    shapely = pytest.importorskip("shapely.wkt")
    from shapely.geometry import GeometryCollection, LineString, Point

    hall = shapely.loads(HALL)
    scene = motley.Scene()
    walls = motley.add_walls(scene, GeometryCollection([hall, LineString([(0, 9), (5, 9)])]))
    assert len(walls) == 3
    people = scene.add_people([(1, 1), (5, 4), (9, 7), (20, 20)])
    assert list(motley.people_inside(motley.CrowdIndex(scene), hall)) == [people[0], people[2]]
    with pytest.raises(TypeError, match="Point"):
        motley.add_walls(scene, Point(1, 2))


def test_trajectories_are_read_as_they_were_written(tmp_path):
    file = tmp_path / "run.txt"
    with motley.trajectories.Writer(file, frame_rate=10) as out:
        out.add([7, 8], [(0, 0), (1, 2)])
        out.add([7], np.array([[0.25, 0, 0]]))
        with pytest.raises(ValueError, match="shape"):
            out.add([7, 8], [(0, 0)])
        with pytest.raises(ValueError, match="finite"):
            out.add([7], [(np.nan, 0)])
    rate, rows = motley.trajectories.read(file)
    assert rate == 10
    assert rows.tolist() == [(7, 0, 0, 0), (8, 0, 1, 2), (7, 1, 0.25, 0)]
    file.write_text("# framerate: 10 fps\n1 2 x 3\n")
    with pytest.raises(ValueError, match="run.txt:2"):
        motley.trajectories.read(file)


def test_the_example_runs(tmp_path):
    pytest.importorskip("matplotlib")
    example = pathlib.Path(__file__).parents[2] / "parallel/python/examples/room.py"
    plot = tmp_path / "room.png"
    run = subprocess.run([sys.executable, example, plot, "60"], check=True, capture_output=True, text=True)
    assert "of 500 are out" in run.stdout
    assert plot.stat().st_size > 10000
