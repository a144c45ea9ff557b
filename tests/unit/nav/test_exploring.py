"""Which edge of a map a robot goes to next."""

from math import hypot

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import OccupancyGrid
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN
from pioneer3.models import load_model
from pioneer3.nav.costs import CostMap
from pioneer3.nav.exploring import Exploration, Outlook
from pioneer3.nav.frontiers import find_frontiers
from pioneer3.nav.rendering import line_map_of, trodden
from pioneer3.nav.settings import AS_SHIPPED
from tests.unit.nav.test_frontiers import CELL, room

LEFT, RIGHT = (0.6, 1.7), (2.4, 3.5)
"""Doors of a room [m]."""
MODEL = load_model("p3dx-sh")
PATIENCE = AS_SHIPPED.mapper.patience


def look(exploration: Exploration, grid: OccupancyGrid, at: Pose2, now: float = 0.0) -> Outlook:
    return exploration.choose(grid, CostMap.of(line_map_of(grid, "room"), MODEL), at, now)


def test_it_goes_to_the_nearest_edge_and_stays_with_it() -> None:
    exploration, grid = Exploration(), room(LEFT, RIGHT)
    first = look(exploration, grid, Pose2(3.0, 3.0))
    assert first.left == 2
    assert first.target is not None
    assert first.target.frontier.points[:, 1].mean() > 2.0
    again = look(exploration, grid, Pose2(4.0, 1.5), 1.0)
    assert again.target is not None
    assert again.target.frontier.points[:, 1].mean() > 2.0
    assert hypot(*again.target.way.points[0] - (4.0, 1.5)) < 0.1


def test_an_edge_that_stays_as_it_was_is_left_for_the_next_one() -> None:
    exploration, grid, seen = Exploration(), room(LEFT, RIGHT), list[float]()
    while (target := look(exploration, grid, Pose2(4.0, 3.0)).target) is not None:
        seen.append(float(target.frontier.end[1]))
        exploration.give_up("")
    assert seen[0] > 2.0
    assert seen[-1] < 2.0
    assert len(seen) < 10
    assert exploration.unreachable == ()


def test_where_it_could_not_get_is_tried_again_at_the_end_and_then_told() -> None:
    exploration, grid, tried = Exploration(), room(RIGHT), 0
    while look(exploration, grid, Pose2(3.0, 3.0)).target is not None:
        exploration.give_up("somebody stands there")
        tried += 1
    one, *others = exploration.unreachable
    assert tried == 2 * (1 + len(others))
    assert one.why == "somebody stands there"
    assert one.frontier.end == pytest.approx([6.35, 3.0], abs=0.7)


def test_an_edge_is_given_up_where_nothing_new_comes_to_light() -> None:
    exploration, grid = Exploration(), room(LEFT, RIGHT)
    look(exploration, grid, Pose2(3.0, 3.0), 0.0)
    look(exploration, grid, Pose2(3.0, 3.0), PATIENCE - 1.0)
    assert exploration.given_up == []
    look(exploration, grid, Pose2(3.0, 3.0), PATIENCE + 1.0)
    assert [each.why for each in exploration.given_up] == ["the robot did not get there"]


def test_hands_that_drive_elsewhere_do_not_count_as_failure() -> None:
    exploration, grid = Exploration(), room(LEFT, RIGHT)
    look(exploration, grid, Pose2(3.0, 3.0), 0.0)
    exploration.wait(PATIENCE)
    look(exploration, grid, Pose2(3.0, 3.0), PATIENCE + 1.0)
    assert exploration.given_up == []


def test_rooms_behind_doors_in_which_it_cannot_turn_are_edges_too() -> None:
    grid = room()
    grid.states[20:100, 60:63] = OCCUPIED
    grid.states[50:66, 60:63] = FREE  # a door of 0.8 m
    grid.states[60:80, 139:150] = FREE
    robot = Pose2(1.0, 1.9)
    assert find_frontiers(grid, robot, 0.45) == ()
    assert len(find_frontiers(grid, robot, 0.45, passes=0.3)) == 1


def test_ground_under_the_robot_is_free_though_its_laser_does_not_see_it() -> None:
    states = np.full((4, 4), OCCUPIED, dtype=np.uint8)
    grid = OccupancyGrid(states=states, resolution=CELL, origin=Pose2(1.0, 1.0))
    after = trodden(grid, [Pose2(0.5, 1.1)], 0.3)
    assert (after.states == OCCUPIED).sum() == 16
    area = (after.states == FREE).sum() * CELL**2
    assert area == pytest.approx(np.pi * 0.3**2, rel=0.1)
    rows, columns = np.nonzero(after.states == FREE)
    assert after.origin.x + CELL * (columns.mean() + 0.5) == pytest.approx(0.5, abs=CELL)
    assert after.origin.y + CELL * (rows.mean() + 0.5) == pytest.approx(1.1, abs=CELL)
    rows, columns = np.nonzero(after.states == OCCUPIED)
    assert after.origin.x + CELL * (columns.mean() + 0.5) == pytest.approx(1.1)
    assert (after.states == UNKNOWN).any()
