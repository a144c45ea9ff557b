"""The maps that ship: found by name, and fit to drive in."""

from pathlib import Path

import numpy as np
import pytest

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import shipped_map, shipped_maps
from pioneer3.maps.line_map import distances
from pioneer3.sim.collision import footprint_hits
from pioneer3.sim.raycast import cast_reference
from pioneer3.sim.worldfile import load_map


def test_an_office_ships() -> None:
    assert "office" in shipped_maps()
    office = shipped_map("office")
    assert office.name == "office"
    assert office.bounds == pytest.approx((0.0, 0.0, 20.0, 14.0))


def test_a_robot_has_room_where_it_starts() -> None:
    office = shipped_map("office")
    home = office.homes[0]
    at = np.array([home.x, home.y])
    assert distances(at, office.walls).min() >= 1.5
    # straight ahead over the robot's width, from its nose
    for side in (-0.25, 0.0, 0.25):
        eye = np.array([home.x + 0.32, home.y + side])
        assert cast_reference(eye, np.array([home.theta]), office.walls, 9.0)[0] >= 2.0


def test_every_place_in_the_office_is_free() -> None:
    office = shipped_map("office")
    kinds = {item.kind for item in office.objects}
    assert {"RobotHome", "Goal", "Dock"} <= kinds
    for item in office.objects:
        assert not footprint_hits(item.pose, 0.4, 0.4, 0.35, office.walls), item.name


def test_every_room_of_the_office_can_be_reached() -> None:
    office = shipped_map("office")
    step = 0.25
    seen, todo = set(), [(round(office.homes[0].x / step), round(office.homes[0].y / step))]
    while todo:
        column, row = todo.pop()
        at = Pose2(column * step, row * step)
        if (column, row) in seen or footprint_hits(at, 0.35, 0.35, 0.35, office.walls):
            continue
        seen.add((column, row))
        todo += [(column + 1, row), (column - 1, row), (column, row + 1), (column, row - 1)]
    for item in office.objects:
        assert (round(item.pose.x / step), round(item.pose.y / step)) in seen, item.name


def test_names_and_paths_both_load(tmp_path: Path) -> None:
    path = tmp_path / "mine.map"
    path.write_text("2D-Map\nLINES\n0 0 1 1\n")
    assert load_map("office").name == load_map("office.map").name == "office"
    assert load_map(path).name == load_map(str(path)).name == "mine"


@pytest.mark.parametrize("name", ["offise", "", "no/such.map", "a\0b", "line\nbreak", "x" * 5000])
def test_an_unknown_name_is_a_one_line_error(name: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load_map(name)
    assert str(caught.value).isprintable()


def test_an_unknown_name_lists_what_ships() -> None:
    with pytest.raises(ConfigError, match="office"):
        load_map("offise")
    with pytest.raises(ConfigError, match="office"):
        shipped_map("offise")
