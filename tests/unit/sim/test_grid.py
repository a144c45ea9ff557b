"""The walls near a point, and only about those."""

import numpy as np
import pytest

from pioneer3.sim import grid as grid_module
from pioneer3.sim.grid import CACHED, WallGrid, distances

SHELF = np.array([[0.0, 0.0, 10.0, 0.0], [0.0, 8.0, 10.0, 8.0], [3.0, 3.0, 3.0, 3.0]])


def test_far_walls_are_left_out() -> None:
    assert WallGrid(SHELF).near(5.0, 0.5, 1.0).tolist() == [SHELF[0].tolist()]


def test_a_wall_comes_once_however_many_cells_it_crosses() -> None:
    assert WallGrid(SHELF, cell=0.1).near(5.0, 4.0, 20.0).tolist() == SHELF.tolist()


def test_far_outside_the_map_there_is_nothing_near() -> None:
    assert WallGrid(SHELF).near(-1e6, 1e6, 5.0).shape == (0, 4)


def test_a_map_without_walls_answers_too() -> None:
    empty = WallGrid(np.empty((0, 4)))
    assert empty.near(0.0, 0.0, 5.0).shape == (0, 4)
    assert empty.cast(np.zeros((2, 2)), np.zeros(2), 5.0).tolist() == [5.0, 5.0]


def test_the_same_question_gives_the_same_read_only_array() -> None:
    grid = WallGrid(SHELF)
    near = grid.near(5.1, 0.5, 1.0)
    assert grid.near(5.2, 0.6, 1.0) is near
    assert not near.flags.writeable


def test_old_answers_are_dropped() -> None:
    grid = WallGrid(SHELF)
    first = grid.near(0.5, 0.5, 1.0)
    for x in range(1, CACHED + 1):
        grid.near(x + 0.5, 0.5, 1.0)
    assert grid.near(0.5, 0.5, 1.0) is not first


def test_rays_from_far_outside_reach_the_map() -> None:
    grid = WallGrid(SHELF)
    ranges = grid.cast(np.array([[5.0, -50_000.0]]), np.array([np.pi / 2]), 1e6)
    np.testing.assert_allclose(ranges, [50_000.0])


def test_a_huge_map_gets_larger_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grid_module, "MOST_CELLS", 1000)
    grid = WallGrid(np.array([[-1e5, 0.0, 1e5, 0.0]] * 2))
    assert grid.cell == 400.0
    assert len(grid.near(0.0, 0.0, 1.0)) == 2


def test_distances_are_to_the_nearest_point_of_each_wall() -> None:
    at = np.array([-3.0, 4.0])
    np.testing.assert_allclose(distances(at, SHELF), [5.0, 5.0, np.hypot(6, 1)])
