"""Distances to walls."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.maps import Extent
from pioneer3.maps.line_map import distances
from pioneer3.nav.raster import DistanceField

coordinate = st.floats(-2.0, 2.0).map(lambda value: round(value, 3))
Float = NDArray[np.float64]

points_of: st.SearchStrategy[Float] = st.lists(st.tuples(coordinate, coordinate), min_size=1).map(
    np.array
)
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
        assert field.distances[row, column] == pytest.approx(wanted, abs=1e-6)


@given(walls_of, points_of)
def test_between_them_it_errs_by_less_than_a_cell(walls: Float, points: Float) -> None:
    field = DistanceField.of(walls, BOUNDS, 0.05, 0.5)
    wanted = [min(0.5, float(distances(point, walls).min())) for point in points]
    assert field.at(points) == pytest.approx(np.array(wanted), abs=0.05 / 2**0.5 + 1e-6)


def test_it_ends_at_its_reach() -> None:
    field = DistanceField.of(np.array([[0.0, 0.0, 1.0, 0.0]]), Extent(0, 0, 1, 0), 0.05, 0.5)
    assert field.at(np.array([[0.5, 3.0], [0.5, 100.0]])).tolist() == [0.5, 0.5]
    assert field.at(np.array([[0.5, 0.25]])) == pytest.approx(0.25, abs=1e-6)
