"""Walls in cells: none lost, each found once, cells larger where a map is huge."""

import numpy as np
import pytest

from pioneer3.sim.kernels import build_grid
from pioneer3.sim.kernels import near as near_module
from pioneer3.sim.kernels import walls as walls_module
from pioneer3.sim.kernels.near import NearWalls

SHELF = np.array([[0.0, 0.0, 10.0, 0.0], [0.0, 8.0, 10.0, 8.0], [3.0, 3.0, 3.0, 3.0]])


def test_every_item_names_a_wall_and_every_wall_has_items() -> None:
    grid = build_grid(SHELF)
    columns, rows = grid.shape
    assert len(grid.cell_start) == columns * rows + 1
    assert grid.cell_start[-1] == len(grid.cell_items)
    assert set(grid.cell_items.tolist()) == {0, 1, 2}
    np.testing.assert_array_equal(grid.pieces[:, :4], SHELF[grid.cell_items])


def test_a_slanted_wall_is_in_the_cells_it_crosses_and_no_others() -> None:
    grid = build_grid(np.array([[0.0, 0.0, 20.0, 20.0]]))
    assert len(grid.cell_items) <= 3 * grid.shape[0]


def test_a_wall_has_one_cell_without_a_predecessor() -> None:
    grid = build_grid(SHELF)
    first = grid.pieces[:, 4] == walls_module.NONE
    assert sorted(grid.cell_items[first].tolist()) == [0, 1, 2]


def test_edges_of_the_grid_are_empty() -> None:
    grid = build_grid(SHELF)
    low, high = grid.corner, grid.corner + np.array(grid.shape) * grid.cell
    assert (low < SHELF[:, :2].min(axis=0) - 0.1).all()
    assert (high > SHELF[:, 2:].max(axis=0) + 0.1).all()


def test_a_huge_map_gets_larger_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(walls_module, "MOST_CELLS", 1000)
    grid = build_grid(np.array([[-1e4, 0.0, 1e4, 0.0], [0.0, -1e4, 0.0, 1e4]]))
    assert np.prod(grid.shape) <= 1000
    assert len(grid.cell_items) < 1000


def test_near_lists_hold_each_wall_once_and_drop_far_ones() -> None:
    near = NearWalls(build_grid(SHELF), 1.0)
    points, found = near.of(np.array([5.0, 5.0, 1e6]), np.array([0.5, 7.5, 0.0]))
    assert (points.tolist(), found.tolist()) == ([0, 1], [0, 1])


def test_near_lists_are_forgotten_when_they_grow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(near_module, "MOST_KEPT", 2)
    near = NearWalls(build_grid(SHELF), 2.0)
    for x in (1.5, 3.5, 5.5, 7.5):
        assert 0 in near.of(np.array([x]), np.array([0.5]))[1]
