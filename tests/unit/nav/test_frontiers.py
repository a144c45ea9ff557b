"""Where maps end."""

from math import hypot

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.jit import plain
from pioneer3.maps import OccupancyGrid
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN
from pioneer3.nav.frontiers import find_frontiers
from pioneer3.nav.kernels.fields import ways_from

CELL = 0.05


def room(*doors: tuple[float, float]) -> OccupancyGrid:
    """Return a room of 6 x 4 m, with doors in its right wall."""
    states = np.full((80, 120), FREE, dtype=np.uint8)
    states[[0, -1]] = OCCUPIED
    states[:, [0, -1]] = OCCUPIED
    states = np.pad(states, ((20, 20), (20, 60)), constant_values=UNKNOWN)
    for low, high in doors:
        rows = slice(20 + round(low / CELL), 20 + round(high / CELL))
        states[rows, 139:150] = FREE
    return OccupancyGrid(states=states, resolution=CELL, origin=Pose2(-1.0, -1.0))


def test_a_closed_room_has_none() -> None:
    assert find_frontiers(room(), Pose2(3.0, 2.0), 0.3) == ()


def test_a_door_is_one_and_is_looked_through_from_a_place_where_the_robot_fits() -> None:
    (door,) = find_frontiers(room((1.5, 2.5)), Pose2(1.0, 1.0), 0.3)
    assert door.points.mean(axis=0) == pytest.approx([6.35, 2.0], abs=0.15)
    assert door.length == pytest.approx(1.1, abs=0.5)
    assert abs(door.view.theta) < 0.6
    assert 1.0 < door.view.x < 6.4
    assert door.way >= hypot(door.view.x - 1.0, door.view.y - 1.0) - 0.2
    assert door.way < 6.0


def test_the_nearest_comes_first() -> None:
    found = find_frontiers(room((0.5, 1.5), (2.5, 3.5)), Pose2(4.0, 3.0), 0.3)
    assert [frontier.points.mean(axis=0)[1] > 2 for frontier in found] == [True, False]


def test_a_gap_between_beams_is_none() -> None:
    grid = room()
    grid.states[60, 60:64] = UNKNOWN
    assert find_frontiers(grid, Pose2(3.0, 1.0), 0.3) == ()


def test_what_cannot_be_reached_or_seen_is_none() -> None:
    grid = room((1.5, 2.5))
    grid.states[20:100, 60] = OCCUPIED
    assert find_frontiers(grid, Pose2(1.0, 1.0), 0.3) == ()
    assert len(find_frontiers(grid, Pose2(4.0, 2.0), 0.3)) == 1


def test_a_robot_that_is_nowhere_finds_none() -> None:
    assert find_frontiers(room((1.5, 2.5)), Pose2(-0.9, -0.9), 0.3) == ()


def test_ways_are_the_shortest() -> None:
    free: NDArray[np.bool_] = np.zeros((7, 9), dtype=np.bool_)
    free[1:-1, 1:-1] = True
    free[1:5, 4] = False
    size = free.size
    out = np.full(size, np.inf)
    queue, queued = np.empty(size, dtype=np.int64), np.zeros(size, dtype=np.bool_)
    plain(ways_from)(free, 9 + 1, queue, queued, out)
    ways = out.reshape(free.shape)
    assert ways[1, 3] == 2
    assert ways[3, 3] == pytest.approx(2 * 2**0.5)
    assert ways[5, 5] == pytest.approx(2 * 2**0.5 + 4)
    assert np.isinf(ways[0, 0])
