"""The fast ways to cast rays agree with the plain one, and nearby walls are never lost."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.sim.grid import WallGrid, distances
from pioneer3.sim.raycast import cast, cast_reference

Float = NDArray[np.float64]

# whole and half numbers make corners, walls along rays and origins on walls likely
COORDINATES = st.one_of(
    st.integers(-4, 4).map(float), st.integers(-8, 8).map(lambda n: n / 2), st.floats(-30, 30)
)
ANGLES = st.one_of(st.integers(-8, 8).map(lambda n: n * np.pi / 4), st.floats(-7, 7))
POINTS = st.lists(st.tuples(COORDINATES, COORDINATES), min_size=1, max_size=8)
WALLS = st.lists(st.tuples(*[COORDINATES] * 4), max_size=12).map(
    lambda rows: np.array(rows, dtype=float).reshape(-1, 4)
)
LIMITS = st.sampled_from([0.5, 3.0, 40.0, float("inf")])


def expected(origins: Float, angles: Float, walls: Float, limit: float) -> Float:
    rays = zip(origins, angles, strict=True)
    return np.array([cast_reference(o, np.array([a]), walls, limit)[0] for o, a in rays])


@given(st.lists(st.tuples(COORDINATES, COORDINATES, ANGLES), max_size=8), WALLS, LIMITS)
@settings(max_examples=200, deadline=None)
def test_cast_agrees_with_the_reference(
    rays: list[tuple[float, float, float]], walls: Float, limit: float
) -> None:
    table = np.array(rays, dtype=float).reshape(-1, 3)
    origins, angles = table[:, :2], table[:, 2]
    plain = expected(origins, angles, walls, limit)
    np.testing.assert_allclose(cast(origins, angles, walls, limit), plain, rtol=0, atol=1e-9)
    grid = WallGrid(walls, cell=0.7)
    np.testing.assert_allclose(grid.cast(origins, angles, limit), plain, rtol=0, atol=1e-9)


@given(st.tuples(COORDINATES, COORDINATES), st.lists(ANGLES, max_size=8), WALLS, LIMITS)
@settings(deadline=None)
def test_one_origin_for_all_agrees_with_the_reference(
    origin: tuple[float, float], angles: list[float], walls: Float, limit: float
) -> None:
    turns = np.array(angles, dtype=float)
    origins = np.tile(np.array(origin), (len(angles), 1))
    plain = cast_reference(np.array(origin), turns, walls, limit)
    np.testing.assert_allclose(cast(origins, turns, walls, limit), plain, rtol=0, atol=1e-9)


@given(POINTS, WALLS, st.floats(0, 40), st.sampled_from([0.3, 1.0, 7.0]))
@settings(max_examples=200, deadline=None)
def test_no_wall_within_the_radius_is_lost(
    points: list[tuple[float, float]], walls: Float, radius: float, cell: float
) -> None:
    grid = WallGrid(walls, cell)
    for x, y in points:
        wanted = walls[distances(np.array([x, y]), walls) <= radius]
        near = {tuple(wall) for wall in grid.near(x, y, radius).tolist()}
        assert {tuple(wall) for wall in wanted.tolist()} <= near


@given(POINTS, WALLS, st.sampled_from([0.3, 5.0]))
@settings(deadline=None)
def test_walls_near_are_enough_for_short_rays(
    points: list[tuple[float, float]], walls: Float, limit: float
) -> None:
    grid, angles = WallGrid(walls), np.linspace(-3, 3, 7)
    for x, y in points:
        origins = np.tile(np.array([x, y]), (7, 1))
        near = cast(origins, angles, grid.near(x, y, limit), limit)
        np.testing.assert_array_equal(near, cast(origins, angles, walls, limit))
