"""Ranges along rays, derived by hand; both implementations."""

from collections.abc import Callable
from math import inf, pi, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.sim.kernels import Kernels, RobotArrays, build_grid
from pioneer3.sim.raycast import cast_reference
from tests.rays import cast_rays

Float = NDArray[np.float64]
Caster = Callable[[Float, Float, Float, float], Float]

SQUARE = np.array([[-1, -1, 1, -1], [1, -1, 1, 1], [1, 1, -1, 1], [-1, 1, -1, -1]], dtype=float)


def by_kernels(origin: Float, angles: Float, walls: Float, limit: float) -> Float:
    return cast_from(np.tile(origin, (len(angles), 1)), angles, walls, limit)


def cast_from(origins: Float, angles: Float, walls: Float, limit: float) -> Float:
    nobody = np.full(len(angles), -1, dtype=np.int32)
    robots = RobotArrays(*np.empty((3, 0)))
    kernels = Kernels()
    kernels.place(robots)
    grid = build_grid(walls)
    return cast_rays(kernels, grid, robots, origins, angles, owner=nobody, limit=limit)


def one(caster: Caster, angle: float, *walls: tuple[float, ...], limit: float = 9.0) -> float:
    table = np.array(walls, dtype=float).reshape(-1, 4)
    return float(caster(np.zeros(2), np.array([angle]), table, limit)[0])


casters = pytest.mark.parametrize("caster", [cast_reference, by_kernels])


@casters
def test_the_middle_of_a_square_sees_its_sides_and_corners(caster: Caster) -> None:
    angles = np.arange(8) * pi / 4
    expected = [1, sqrt(2)] * 4
    np.testing.assert_allclose(caster(np.zeros(2), angles, SQUARE, 9.0), expected, atol=1e-9)


@casters
def test_no_walls_no_hit(caster: Caster) -> None:
    assert one(caster, 0.3) == 9.0
    assert one(caster, 0.3, limit=inf) == inf


@casters
def test_no_rays_no_ranges(caster: Caster) -> None:
    assert caster(np.zeros(2), np.empty(0), SQUARE, 9.0).shape == (0,)


@casters
def test_a_wall_behind_or_beyond_the_limit_is_not_hit(caster: Caster) -> None:
    assert one(caster, 0.0, (-2, -1, -2, 1)) == 9.0
    assert one(caster, 0.0, (10, -1, 10, 1)) == 9.0
    assert one(caster, 0.0, (9, -1, 9, 1)) == 9.0


@casters
@pytest.mark.parametrize("angle", [0.0, pi / 2, pi, -pi / 2, 0.7, -2.1])
def test_a_wall_along_a_ray_is_hit_at_its_nearer_end(caster: Caster, angle: float) -> None:
    c, s = float(np.cos(angle)), float(np.sin(angle))
    assert one(caster, angle, (5 * c, 5 * s, 3 * c, 3 * s)) == pytest.approx(3.0)
    assert one(caster, angle, (-5 * c, -5 * s, -3 * c, -3 * s)) == 9.0
    assert one(caster, angle, (-5 * c, -5 * s, 3 * c, 3 * s)) == 0.0


@casters
def test_the_end_of_a_wall_is_part_of_it(caster: Caster) -> None:
    assert one(caster, 0.0, (2, 0, 2, 1)) == pytest.approx(2.0)
    assert one(caster, 0.0, (2, 1e-6, 2, 1)) == 9.0


@casters
def test_a_wall_of_no_length_is_a_point(caster: Caster) -> None:
    assert one(caster, 0.0, (2, 0, 2, 0)) == pytest.approx(2.0)
    assert one(caster, 0.1, (2, 0, 2, 0)) == 9.0
    assert one(caster, 0.1, (0, 0, 0, 0)) == 0.0


@casters
def test_an_origin_on_a_wall_sees_it_at_no_distance(caster: Caster) -> None:
    for angle in (0.0, 0.5, pi / 2, pi):
        assert one(caster, angle, (-1, 0, 1, 0)) == 0.0


@casters
def test_a_ray_does_not_slip_through_a_corner(caster: Caster) -> None:
    for angle in np.linspace(-3, 3, 61):
        c, s = 3 * float(np.cos(angle)), 3 * float(np.sin(angle))
        found = one(caster, float(angle), (c, s, c - s, s + c), (c, s, c + s, s - c))
        assert found == pytest.approx(3.0)


def test_each_ray_has_its_own_origin() -> None:
    origins = np.array([[0.0, 0.0], [0.5, 0.0], [-3.0, 0.0]])
    ranges = cast_from(origins, np.zeros(3), SQUARE, 9.0)
    np.testing.assert_allclose(ranges, [1.0, 0.5, 2.0])
