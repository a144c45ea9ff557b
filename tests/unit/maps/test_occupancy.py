"""Maps as one grid."""

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN, LineMap, OccupancyGrid
from pioneer3.maps.occupancy import occupancy_of


def test_walls_become_occupied_cells() -> None:
    line_map = LineMap(name="wall", walls=np.array([[0.0, 0.0, 1.0, 0.0]]))
    grid = occupancy_of(line_map)
    rows, columns = np.nonzero(grid.states == OCCUPIED)
    x = grid.origin.x + (columns + 0.5) * grid.resolution
    assert set(rows) == {1}
    assert (x.min(), x.max()) == pytest.approx((0.025, 1.025))
    assert UNKNOWN not in grid.states


def test_a_map_that_is_one_grid_stays_as_it_is() -> None:
    states = np.array([[FREE, OCCUPIED], [UNKNOWN, FREE]], dtype=np.uint8)
    grid = OccupancyGrid(states=states, resolution=0.1, origin=Pose2(1.0, 2.0, 0.5))
    walls = np.array([[1.0, 2.0, 1.2, 2.0]])
    assert occupancy_of(LineMap(name="grid", walls=walls, grids=(grid,))) is grid


def test_a_grid_with_lines_knows_what_it_knew() -> None:
    states = np.array([[FREE, FREE], [UNKNOWN, FREE]], dtype=np.uint8)
    grid = OccupancyGrid(states=states, resolution=1.0, origin=Pose2())
    lines = np.array([[0.0, 0.0, 2.0, 0.0], [0.0, 2.0, 2.0, 2.0]])
    found = occupancy_of(LineMap(name="both", walls=lines, grids=(grid,), lines=lines), 0.5)

    def state(x: float, y: float) -> int:
        column, row = (x - found.origin.x) / 0.5, (y - found.origin.y) / 0.5
        return int(found.states[int(row), int(column)])

    assert [state(1.2, 0.7), state(0.2, 1.2), state(1.2, 0.2)] == [FREE, UNKNOWN, OCCUPIED]


def test_large_maps_get_larger_cells() -> None:
    line_map = LineMap(name="long", walls=np.array([[0.0, 0.0, 100.0, 100.0]]))
    grid = occupancy_of(line_map, most=10_000)
    assert grid.states.size <= 10_000
    assert (grid.states == OCCUPIED).any()
