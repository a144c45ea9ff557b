"""Maps are edited: walls erased, places named."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from pioneer3.cli.main import execute
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import Extent, LineMap, OccupancyGrid, read_map, write_aria_map, write_map_server
from pioneer3.maps.edit import (
    erased,
    find_object,
    renamed,
    with_forbidden,
    with_place,
    with_wall,
    without,
)
from pioneer3.maps.grid import raster_outline
from pioneer3.maps.line_map import FREE, OCCUPIED, MapObject

STATES = np.full((20, 40), FREE, dtype=np.uint8)
STATES[0] = STATES[-1] = OCCUPIED
STATES[8:10, 20:22] = OCCUPIED
GRID = OccupancyGrid(states=STATES, resolution=0.1, origin=Pose2(-1.0, -1.0))
OUTLINE = raster_outline(STATES == OCCUPIED) * 0.1 - 1.0
LINES = np.array([[0.0, 0.5, 1.0, 0.5], [0.2, 0.5, 5.0, 0.5]])
HOME = MapObject(kind="RobotHome", name="Home", pose=Pose2(0.5, 0.1))
MAP = LineMap(
    name="lab",
    walls=np.concatenate([LINES, OUTLINE]),
    objects=(HOME,),
    homes=(HOME.pose,),
    grids=(GRID,),
    lines=LINES,
)
CHAIR = Extent(0.9, -0.3, 1.3, 0.1)


def test_cells_in_the_box_are_free_and_walls_that_cross_it_stay() -> None:
    after = erased(MAP, CHAIR)
    (grid,) = after.grids
    assert (GRID.states == OCCUPIED).sum() - (grid.states == OCCUPIED).sum() == 4
    assert (grid.states[8:10, 20:22] == FREE).all()
    assert len(after.lines) == 2
    assert len(after.walls) == len(MAP.walls) - 4
    assert after.objects == MAP.objects
    both = erased(MAP, Extent(-0.1, -0.3, 1.3, 0.6))
    assert both.lines.tolist() == [LINES[1].tolist()]


def test_an_empty_box_and_a_turned_grid_are_refused() -> None:
    with pytest.raises(ConfigError, match="no wall is inside of x 2 to 3 m"):
        erased(MAP, Extent(2.0, 0.0, 3.0, 0.3))
    turned = replace(MAP, grids=(replace(GRID, origin=Pose2(0.0, 0.0, 1.0)),))
    with pytest.raises(ConfigError, match="turned"):
        erased(turned, CHAIR)


def test_a_goal_is_new_or_moved() -> None:
    once = with_place(MAP, "goal", "Kitchen", (1.0, 2.0))
    both = with_place(once, "dock", "Charger", (2.0, 2.0), 0.5)
    again = with_place(both, "goal", "kitchen", (3.0, 2.0), pi / 2)
    assert [(i.kind, i.name) for i in once.objects] == [("RobotHome", "Home"), ("Goal", "Kitchen")]
    assert [i.pose for i in again.objects][:2] == [HOME.pose, Pose2(3.0, 2.0, pi / 2)]
    assert [i.kind for i in again.objects] == ["RobotHome", "GoalWithHeading", "Dock"]
    assert with_place(MAP, "goal", "Home", (0.0, 0.0)).homes == ()
    assert with_place(MAP, "home", "home", (1.0, 0.0)).homes == (Pose2(1.0, 0.0, 0.0),)
    with pytest.raises(ConfigError, match="needs a name"):
        with_place(MAP, "goal", " ", (0.0, 0.0))


def test_a_wall_is_drawn_and_other_walls_keep_their_materials() -> None:
    glass = replace(MAP, materials=np.array([1] + [0] * (len(MAP.walls) - 1), dtype=np.uint8))
    after = with_wall(glass, (0.0, 1.5), (2.0, 1.5))
    assert after.walls[-1].tolist() == after.lines[-1].tolist() == [0.0, 1.5, 2.0, 1.5]
    assert len(after.lines) == 3
    assert after.materials.tolist() == [*glass.materials.tolist(), 0]
    assert erased(after, CHAIR).materials.tolist()[:3] == [1, 0, 0]
    assert len(erased(after, Extent(-0.1, 1.4, 2.1, 1.6)).lines) == 2
    with pytest.raises(ConfigError, match="two ends"):
        with_wall(MAP, (1.0, 1.0), (1.0, 1.0))


def test_lines_and_areas_are_forbidden() -> None:
    line = with_forbidden(MAP, "line", (0.0, 0.0), (1.0, 0.0))
    area = with_forbidden(line, "area", (2.0, 1.0), (1.0, 0.0), "stairs")
    *_, first, second = area.objects
    assert (first.role, first.forbidden, second.role, second.forbidden) == (
        *("line", True),
        *("area", True),
    )
    assert second.outline == ((2.0, 1.0), (1.0, 1.0), (1.0, 0.0), (2.0, 0.0))
    with pytest.raises(ConfigError, match="opposite corners"):
        with_forbidden(MAP, "area", (0.0, 0.0), (1.0, 0.0))


def test_objects_are_renamed_and_removed() -> None:
    two = with_place(MAP, "goal", "Lab", (1.0, 2.0))
    assert [i.name for i in renamed(two, 1, "Hall").objects] == ["Home", "Hall"]
    assert renamed(two, 1, "LAB").objects[1].name == "LAB"
    with pytest.raises(ConfigError, match="there is a place home already"):
        renamed(two, 1, "home")
    assert without(two, find_object(two, "home")).homes == ()
    with pytest.raises(ConfigError, match="no object has the name Attic; has Home, Lab"):
        find_object(two, "Attic")


def test_a_solid_object_goes_with_its_walls() -> None:
    corners = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    box = MapObject(kind="Sim.BoxObstacle", name="crate", pose=Pose2(), outline=corners, solid=True)
    walls = np.concatenate([LINES, np.array(box.sides)])
    with_box = LineMap(name="lab", walls=walls, objects=(HOME, box))
    after = without(with_box, 1)
    assert after.objects == (HOME,)
    assert after.walls.tolist() == after.lines.tolist() == LINES.tolist()


def test_the_command_edits_as_the_page_does(tmp_path: Path) -> None:
    path = tmp_path / "lab.map"
    write_aria_map(with_place(MAP, "goal", "Old", (1.0, 1.0)), path)
    words = "--wall 0,2,1,2 --dock Charger=1,2,90 --home Home=0.5,0.2 --rename Old=New"
    more = "--forbid-line=-0.5,0,1,0 --forbid-area 2,0,3,1"
    assert execute(["map", "edit", str(path), *words.split(), *more.split()]) == 0
    after = read_map(path)
    assert [0.0, 2.0, 1.0, 2.0] in after.lines.tolist()
    assert [(item.role, item.name) for item in after.objects] == [
        *(("home", "Home"), ("goal", "New"), ("dock", "Charger")),
        *(("line", ""), ("area", "")),
    ]
    assert after.homes == (Pose2(0.5, 0.2),)
    assert execute(["map", "edit", str(path), "--remove", "new"]) == 0
    assert "New" not in [item.name for item in read_map(path).objects]


def test_points_stay_points_in_files(tmp_path: Path) -> None:
    path = tmp_path / "lab.map"
    write_aria_map(MAP, path)
    told = execute(["map", "edit", str(path), "--erase", "0.9,-0.3,1.3,10cm", "--goal", "A=1,2,90"])
    assert told == 0
    after = read_map(path)
    assert (after.grids[0].states == OCCUPIED).sum() == 80
    assert after.lines == pytest.approx(LINES)
    assert [item.name for item in after.objects] == ["Home", "A"]
    assert after.objects[1].pose.theta == pytest.approx(pi / 2)
    assert path.read_text().count("Resolution: 100\n") == 1


def test_a_grid_keeps_what_is_unknown_in_pictures(tmp_path: Path) -> None:
    states = STATES.copy()
    states[12:, 30:] = 0
    grid = replace(GRID, states=states)
    walls = raster_outline(states == OCCUPIED) * 0.1 - 1.0
    only = LineMap(name="lab", walls=walls, grids=(grid,), lines=np.empty((0, 4)))
    path = tmp_path / "lab.yaml"
    write_map_server(only, path, 0.1)
    assert (read_map(path).grids[0].states == states).all()
    assert execute(["map", "edit", str(path), "--erase", "0.9,-0.3,1.3,0.1"]) == 0
    assert (read_map(path).grids[0].states != states).sum() == 4
    assert execute(["map", "edit", str(path), "--wall", "1.03,0.52,2.97,0.52"]) == 0
    after = read_map(path).grids[0].states
    assert (after != states).sum() == 4 + 20
    assert (after[15, 20:40] == OCCUPIED).all()
    assert (after == 0).sum() == (states == 0).sum() - 10


@pytest.mark.parametrize("words", [("--erase", "1,2,3"), ("--goal", "A=1"), ("--goal", "A=1,x")])
def test_wrong_words_are_refused_and_the_file_stays(tmp_path: Path, words: tuple[str, ...]) -> None:
    path = tmp_path / "lab.map"
    write_aria_map(MAP, path)
    before = path.read_bytes()
    assert execute(["map", "edit", str(path), *words]) == 2
    assert path.read_bytes() == before
