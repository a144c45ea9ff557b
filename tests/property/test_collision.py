"""The footprint test agrees with a clip in exact fractions."""

from fractions import Fraction
from math import cos, sin

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from pioneer3.geometry import Pose2
from pioneer3.sim.collision import footprint_hits
from tests.combinations import examples

COORDINATES = st.one_of(st.integers(-8, 8).map(lambda n: n / 4), st.floats(-2, 2))
SIZES = st.integers(1, 8).map(lambda n: n / 8)
SEGMENTS = st.tuples(*[COORDINATES] * 4)
SHAPES = st.tuples(SIZES, SIZES, SIZES)


def clipped(wall: tuple[float, ...], shape: tuple[float, float, float], grown: Fraction) -> bool:
    """Liang-Barsky in fractions: does `wall` meet the closed rectangle, grown all around?"""
    x0, y0, x1, y1 = map(Fraction, wall)
    front, rear, half_width = map(Fraction, shape)
    enter, leave = Fraction(0), Fraction(1)
    for start, extent, low, high in (
        (x0, x1 - x0, -rear - grown, front + grown),
        (y0, y1 - y0, -half_width - grown, half_width + grown),
    ):
        if extent == 0:
            if not low <= start <= high:
                return False
            continue
        one, other = sorted(((low - start) / extent, (high - start) / extent))
        enter, leave = max(enter, one), min(leave, other)
    return enter <= leave


@given(SEGMENTS, SHAPES)
@settings(max_examples=examples(200))
def test_a_robot_at_the_origin_agrees_with_exact_clipping(
    wall: tuple[float, ...], shape: tuple[float, float, float]
) -> None:
    found = footprint_hits(Pose2(), *shape, np.array([wall]))
    deep = clipped(wall, shape, Fraction(-2, 10**9))
    close = clipped(wall, shape, Fraction(-1, 2 * 10**9))
    assert deep <= found <= close


@given(SEGMENTS, SHAPES, st.floats(-50, 50), st.floats(-50, 50), st.floats(-7, 7))
@settings(max_examples=examples(200))
def test_moving_robot_and_wall_together_changes_nothing(
    wall: tuple[float, ...], shape: tuple[float, float, float], x: float, y: float, theta: float
) -> None:
    assume(clipped(wall, shape, Fraction(-1, 10**6)) == clipped(wall, shape, Fraction(1, 10**6)))
    c, s = cos(theta), sin(theta)
    x0, y0, x1, y1 = wall
    moved = np.array(
        [[x + c * x0 - s * y0, y + s * x0 + c * y0, x + c * x1 - s * y1, y + s * x1 + c * y1]]
    )
    found = footprint_hits(Pose2(x, y, theta), *shape, moved)
    assert found == clipped(wall, shape, Fraction(0))


@given(st.lists(SEGMENTS, max_size=6), SHAPES)
def test_many_walls_hit_if_one_does(
    walls: list[tuple[float, ...]], shape: tuple[float, float, float]
) -> None:
    table = np.array(walls, dtype=float).reshape(-1, 4)
    single = [footprint_hits(Pose2(), *shape, wall[None]) for wall in table]
    assert footprint_hits(Pose2(), *shape, table) == any(single)
