"""Scanned points become a watertight outline with joined edges."""

import numpy as np
import pytest

from pioneer3.maps.grid import outline


def test_no_points_no_walls() -> None:
    assert outline(np.empty((0, 2)), 0.02).shape == (0, 4)


def test_one_point_is_a_square_around_it() -> None:
    walls = outline(np.array([[1.0, 2.0]]), 0.5)
    expected = [
        [0.75, 1.75, 1.25, 1.75],
        [0.75, 2.25, 1.25, 2.25],
        [0.75, 1.75, 0.75, 2.25],
        [1.25, 1.75, 1.25, 2.25],
    ]
    np.testing.assert_allclose(walls, expected)


def test_a_row_of_points_has_four_walls_whatever_its_length() -> None:
    points = np.stack([np.arange(50) * 0.02, np.zeros(50)], axis=1)
    walls = outline(points[::-1], 0.02)
    assert len(walls) == 4
    assert np.hypot(*(walls[:, 2:] - walls[:, :2]).T).max() == pytest.approx(1.0)


def test_a_hole_has_its_own_walls() -> None:
    ring = [(x, y) for x in range(3) for y in range(3) if (x, y) != (1, 1)]
    assert len(outline(np.array(ring, dtype=float), 1.0)) == 8


def test_cells_that_touch_at_a_corner_leave_no_gap_there() -> None:
    walls = outline(np.array([[0.0, 0.0], [1.0, 1.0]]), 1.0)
    corner = np.array([0.5, 0.5])
    crossing = (walls[:, :2] < corner + 1e-9).all(axis=1) & (walls[:, 2:] > corner - 1e-9).all(
        axis=1
    )
    # the lower edge of one cell goes on as the upper edge of the other: two crossing walls
    assert crossing.sum() == 2
    assert len(walls) == 6


def test_repeated_points_count_once() -> None:
    assert len(outline(np.zeros((9, 2)), 0.02)) == 4


def test_points_100_km_apart_need_no_huge_grid() -> None:
    assert len(outline(np.array([[-1e5, -1e5], [1e5, 1e5]]), 0.001)) == 8
