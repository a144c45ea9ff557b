"""Distances to walls."""

import mmap
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.maps import Extent
from pioneer3.maps.line_map import distances
from pioneer3.nav.raster import DistanceField, cells_where, sparse

coordinate = st.floats(-2.0, 2.0).map(lambda value: round(value, 3))
Float = NDArray[np.float64]

walls_of: st.SearchStrategy[Float] = st.lists(
    st.tuples(coordinate, coordinate, coordinate, coordinate), min_size=1, max_size=6
).map(np.array)
BOUNDS = Extent(-2.0, -2.0, 2.0, 2.0)


@given(walls_of)
def test_it_is_exact_in_the_middles_of_cells(walls: Float) -> None:
    field = DistanceField.of(walls, BOUNDS, 0.25, 0.8)
    for row, column in np.ndindex(field.raster.shape):
        middle = np.array(field.raster.middle_of(row, column))
        wanted = min(0.8, float(distances(middle, walls).min()))
        assert field.reach + field.distances[row, column] == pytest.approx(wanted, abs=1e-6)


def test_memory_is_taken_where_a_system_knows_no_huge_pages(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(mmap, "MADV_NOHUGEPAGE", 9999)
    assert not sparse((3, 4), np.float32).any()


@given(st.integers(0, 6), st.integers(0, 6), st.randoms(use_true_random=False))
def test_cells_are_found_as_numpy_finds_them(height: int, width: int, random: Random) -> None:
    cells = [[random.random() < 0.3 for _ in range(width)] for _ in range(height)]
    marks = np.array(cells, dtype=np.bool_).reshape(height, width)
    for part in (marks, marks[1:, :2]):
        assert np.array_equal(cells_where(part), np.nonzero(part))
