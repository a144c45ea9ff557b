"""The kernel of motions, against a plain oracle."""

from math import cos, hypot, inf, pi, sin

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.jit import fast
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.arcs import ROUNDING, arcs
from tests.combinations import examples

Float = NDArray[np.float64]
FRONT, REAR, HALF, KEEP, PER_SPEED, FAR, SLOW = OUTLINE = 0.3, 0.3, 0.25, 0.04, 0.1, 0.35, 0.15
MOTION = 0.3, 0.6, 1.0, 2.0, 1.0, 0.1


def ramped(now: float, wanted: float, faster: float, slower: float) -> float:
    step = 0.1 * (faster if abs(wanted) > abs(now) and wanted * now >= 0 else slower)
    return float(np.clip(wanted, now - step, now + step))


def oracle(command: tuple[float, float], v: float, w: float, things: Float) -> tuple[float, float]:
    """Return both gaps of one command of a robot at the origin, step by step."""
    x = y = theta = 0.0
    kept, bare, time = FAR, FAR, 0.0
    while True:
        wanted = command if time < 1.0 else (0.0, 0.0)
        v, w = ramped(v, wanted[0], *MOTION[:2]), ramped(w, wanted[1], *MOTION[2:4])
        if time >= 1.0 and abs(v) < 1e-9 and abs(w) < 1e-9:
            return kept, bare
        x += 0.1 * v * cos(theta + 0.05 * w)
        y += 0.1 * v * sin(theta + 0.05 * w)
        theta += 0.1 * w
        time += 0.1
        if abs(v) < 1e-9 and abs(w) < 1e-9:
            continue
        for at_x, at_y, speed_x, speed_y, radius, least in things.tolist():
            dx, dy = at_x + speed_x * time - x, at_y + speed_y * time - y
            ahead, left = cos(theta) * dx + sin(theta) * dy, cos(theta) * dy - sin(theta) * dx
            gap = hypot(max(ahead - FRONT, -REAR - ahead, 0), max(abs(left) - HALF, 0)) - radius
            kept, bare = min(kept, gap - KEEP - PER_SPEED * abs(v)), min(bare, gap - least)


numbers = st.floats(-2.0, 2.0)
thing = st.tuples(
    numbers,
    numbers,
    st.floats(-1, 1) | st.just(0.0),
    st.floats(-1, 1) | st.just(0.0),
    st.floats(0.0, 0.4),
    st.floats(-0.1, 0.04),
)


@settings(deadline=None, max_examples=examples(60))
@given(
    st.tuples(st.floats(-0.3, 0.75), st.floats(-1.5, 1.5)),
    st.floats(-0.3, 0.75),
    st.floats(-1.5, 1.5),
    st.lists(thing, min_size=1, max_size=6),
)
def test_gaps_are_those_of_the_outline_along_the_motion(
    command: tuple[float, float], v: float, w: float, things: list[tuple[float, ...]]
) -> None:
    obstacles, out = np.array(things), np.empty((1, 4))
    side = np.hypot(obstacles[:, 0], obstacles[:, 1]) - obstacles[:, 4]
    side[(obstacles[:, 2:4] != 0.0).any(axis=1)] = -inf
    ascending = np.column_stack([obstacles, side])[side.argsort()]
    values, frame = np.zeros((4, 4), dtype=np.float32), np.array([-2.0, -2.0, 1.0])
    state = np.array([0.0, 0.0, 0.0, v, w])
    fast(arcs, CACHE)(
        np.array([command]),
        state,
        np.array(MOTION),
        np.array(OUTLINE),
        ascending,
        values,
        frame,
        out,
    )
    kept, bare = oracle(command, v, w, obstacles)
    may = kept >= 0.0 or (abs(command[0]) <= SLOW and bare >= -ROUNDING) or command == (0.0, 0.0)
    assume(min(abs(kept), abs(bare + ROUNDING), abs(abs(command[0]) - SLOW)) > 1e-9)
    assert bool(out[0, 0] < inf) is may
    if not may:  # it was followed no further
        assert out[0, 2] < 0.0
        return
    # beyond the farthest gap that is told apart both only say that there is room
    assert out[0, 3] == pytest.approx(bare, abs=0.04 if bare > FAR - 0.04 else 1e-9)
    assert out[0, 2] == pytest.approx(kept, abs=0.12 if bare > FAR - 0.12 else 1e-9)


def test_somebody_who_comes_near_a_robot_that_stands_costs_it_nothing() -> None:
    comes = np.array([[1.0, 0.0, -0.8, 0.0, 0.28, 0.04, -inf]])
    out, values = np.empty((1, 4)), np.zeros((4, 4), dtype=np.float32)
    frame, stands = np.array([-2.0, -2.0, 1.0]), np.zeros(5)
    fast(arcs, CACHE)(
        np.zeros((1, 2)), stands, np.array(MOTION), np.array(OUTLINE), comes, values, frame, out
    )
    assert out[0, 3] == FAR
    assert out[0, 0] < inf
    assert abs(out[0, 1]) <= pi
