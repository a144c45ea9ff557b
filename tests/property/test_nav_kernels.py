"""The kernels of map making agree with what is easier to read."""

from itertools import product
from math import floor

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.jit import plain
from pioneer3.nav.kernels.matching import search, smear
from pioneer3.nav.kernels.normals import normals_of, thinned
from pioneer3.nav.kernels.rays import hit_cells, passed_cells

Float = NDArray[np.float64]
Int = NDArray[np.int64]

SIZE = 12
"""Of the rasters [cells]."""

inside = st.floats(0.05, SIZE - 0.05).map(lambda value: round(value, 2) + 0.003)
point_lists: st.SearchStrategy[Float] = st.lists(
    st.tuples(inside, inside), min_size=1, max_size=8
).map(np.array)


def cells_of(points: Float) -> set[tuple[int, int]]:
    return {(floor(y), floor(x)) for x, y in points.tolist()}


def found(numbers: Int) -> set[tuple[int, int]]:
    return {divmod(number, SIZE) for number in numbers.tolist()}


@given(inside, inside, point_lists)
def test_rays_pass_the_cells_between_their_ends(x: float, y: float, ends: Float) -> None:
    seen, out = np.zeros((SIZE, SIZE), dtype=np.uint8), np.empty(2000, dtype=np.int64)
    origin = np.array([x, y])
    count = plain(passed_cells)(origin, ends, seen, np.zeros(2, dtype=np.int64), 1, out)
    cells, share = found(out[:count]), np.linspace(0, 1, 997)[:, None]
    dense = set().union(*(cells_of(origin + share * (end - origin)) for end in ends))
    assert len(cells) == count
    assert dense <= cells
    for row, column in cells - dense:  # a ray may cut a corner between two samples
        near = [abs(row - r) + abs(column - c) for r, c in dense]
        assert min(near) == 1


@given(point_lists)
def test_echoes_hit_their_own_cells_and_nothing_else_without_walls(points: Float) -> None:
    seen, out = np.zeros((SIZE, SIZE), dtype=np.uint8), np.empty(100, dtype=np.int64)
    nothing = np.zeros((len(points), 3))
    count = plain(hit_cells)(points, nothing, 5.0, seen, np.zeros(2, dtype=np.int64), 1, out)
    assert found(out[:count]) == cells_of(points)


def test_between_two_points_of_a_wall_the_cells_are_hit_too() -> None:
    seen, out = np.zeros((SIZE, SIZE), dtype=np.uint8), np.empty(100, dtype=np.int64)
    points, wall = np.array([[1.5, 4.5], [6.5, 4.5]]), np.tile([0.0, 1.0, 0.0], (2, 1))
    count = hit_cells(points, wall, 6.0, seen, np.zeros(2, dtype=np.int64), 1, out)
    assert found(out[:count]) == {(4, column) for column in range(1, 7)}
    count = hit_cells(points, wall, 4.0, seen, np.array([2, 1]), 2, out)
    assert found(out[:count]) == {(2, 0), (2, 5)}


@settings(deadline=None)
@given(
    st.integers(0, 2**32 - 1), st.integers(1, 6), st.integers(1, 9), st.sampled_from([0.0, 300.0])
)
def test_a_search_by_blocks_finds_the_best_of_all(
    seed: int, half: int, points: int, cost: float
) -> None:
    rng = np.random.default_rng(seed)
    turns, sectors = np.array([-0.2, -0.1, 0.0, 0.1, 0.2]), np.array([0, 0, 0, 1, 1])
    raster = rng.integers(0, 256, (30, 30)).astype(np.uint8)
    pyramid = np.stack([raster] * 3)
    for level, row, column in product((1, 2), range(30), range(30)):
        size = 2**level
        pyramid[level, row, column] = raster[row : row + size, column : column + size].max()
    cells = rng.integers(half, 30 - half, (len(turns), points, 2))
    limits = np.array([float(half), 0.2, cost, -1e17])
    worths = {
        (a, row, column): raster[cells[a, :, 0] + row, cells[a, :, 1] + column].astype(float).sum()
        - cost * ((row / half) ** 2 + (column / half) ** 2 + (turn / 0.2) ** 2)
        for a, turn in enumerate(turns.tolist())
        for row in range(-half, half + 1)
        for column in range(-half, half + 1)
    }
    for parts in (np.zeros_like(sectors), sectors):
        count = int(parts.max()) + 1
        out, best = np.zeros((count, 3), dtype=np.int64), np.empty(count)
        search(pyramid, cells, turns, parts, 0.0, limits, out, best)
        for part in range(count):
            most = max(worth for (a, _, _), worth in worths.items() if parts[a] == part)
            if most >= 0:
                assert abs(best[part] - most) < 1e-6
                assert abs(worths[tuple(out[part].tolist())] - most) < 1e-6
    for least, found in (max(worths.values()) - 1e-6, True), (max(worths.values()) + 1e-6, False):
        limits[3] = least
        out, best = np.zeros((1, 3), dtype=np.int64), np.empty(1)
        search(pyramid, cells, turns, np.zeros_like(sectors), 0.8, limits, out, best)
        assert bool(best[0] >= least) is found


@given(point_lists)
def test_a_smeared_point_raises_the_cells_around_it(points: Float) -> None:
    profile = np.array([[1, 2, 1], [2, 9, 2], [1, 2, 1]], dtype=np.uint8)
    out = np.zeros((SIZE, SIZE), dtype=np.uint8)
    smear(points, np.array([0.0, 0.0, 1.0]), profile, out)
    wanted = np.zeros_like(out)
    for row, column in cells_of(points):
        if 1 <= row < SIZE - 1 and 1 <= column < SIZE - 1:
            part = wanted[row - 1 : row + 2, column - 1 : column + 2]
            np.maximum(part, profile, out=part)
    assert (out == wanted).all()


@given(st.floats(-3, 3), st.floats(0.5, 4.0), st.floats(-0.5, 0.5))
def test_normals_of_a_wall_are_those_of_the_line(turn: float, away: float, slant: float) -> None:
    bearings = np.linspace(-0.4, 0.4, 41)
    ranges = away / np.cos(bearings - slant)
    points = ranges[:, None] * np.stack([np.cos(bearings + turn), np.sin(bearings + turn)], axis=1)
    out = np.empty((41, 3))
    normals_of(points, np.zeros(2), 4, 0.3, 0.03, out)
    normal = -np.cos(turn + slant), -np.sin(turn + slant)
    assert np.abs(out[:, :2] - normal).max() < 1e-6
    assert np.abs(out[:, 2]).max() < 1e-9


@given(point_lists, st.floats(0.01, 3.0))
def test_thinned_points_lie_apart(points: Float, apart: float) -> None:
    kept = np.zeros(len(points), dtype=np.bool_)
    thinned(points, apart, kept)
    assert kept[0]
    left = points[kept]
    assert (np.hypot(*np.diff(left, axis=0).T) >= apart - 1e-9).all()
