"""Walls in cells: none lost, each found once, cells larger where a map is huge."""

import numpy as np
import pytest

from pioneer3.sim.kernels import build_grid
from pioneer3.sim.kernels import walls as walls_module

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


def test_the_clearance_of_a_point_is_the_way_to_its_nearest_wall_or_the_reach() -> None:
    points = np.array([[5.0, 0.5], [3.0, 3.5], [5.0, 5.0], [1e6, 0.0], [-3.0, 4.0]])
    clearance = build_grid(SHELF).clearance(points, 2.0)
    assert clearance.tolist() == [0.5, 0.5, 2.0, 2.0, 2.0]


def test_clearances_agree_with_a_look_at_every_wall() -> None:
    random = np.random.default_rng(1)
    walls, points = random.uniform(-5, 5, (40, 4)), random.uniform(-6, 6, (200, 2))
    found = build_grid(walls).clearance(points, 3.0)
    start, extent = walls[:, :2], walls[:, 2:] - walls[:, :2]
    along = ((points[:, None] - start) * extent).sum(axis=2) / (extent**2).sum(axis=1)
    feet = start + along.clip(0, 1)[:, :, None] * extent
    plain = np.linalg.norm(points[:, None] - feet, axis=2).min(axis=1)
    np.testing.assert_allclose(found, plain.clip(max=3.0), atol=1e-9)
