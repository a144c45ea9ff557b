"""Speeds that ramp up and down, with numpy alone: both axes of all drives at once."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.drives import ACCELERATION, ARRIVED, REMAINING, TARGET, TOP, VELOCITY
from pioneer3.sim.kernels.numpy_truth import all_of, any_of

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Pair = tuple[Float, Float]

AT_ONCE = 1e300
"""Instead of no acceleration at all, which takes no time [1/s^2]."""


def turn_axes(axes: Float, held: Bool | None, brake: Float, dt: float) -> Float:
    """Let both axes of all drives run for `dt`; return their ways, shape (2, N).

    Of those `held` (N,) both axes stop.
    """
    v, remaining, top = axes[VELOCITY], axes[REMAINING], axes[TOP]
    goal = np.minimum(np.maximum(axes[TARGET], -top), top)
    covers = ~np.isnan(remaining)
    if held is not None:
        goal[:, held], covers[:, held] = 0.0, False
    if any_of(covers):
        room = np.maximum(abs(remaining) - abs(v) * (dt / 2), 0.0)
        speed = np.copysign(np.minimum(top, np.sqrt(2 * brake * room)), remaining)
        goal = np.where(covers, speed, goal)
    axes[VELOCITY], ways = _ramp(v, goal, axes[ACCELERATION], brake, dt)
    if any_of(covers):
        left = remaining - ways
        there = covers & (np.copysign(1.0, remaining) * left <= ARRIVED)
        ways = np.where(there, remaining, ways)
        axes[REMAINING] = np.where(there, np.nan, np.where(covers, left, remaining))
        axes[TARGET][there] = axes[VELOCITY][there] = 0.0
    return ways


def _ramp(v: Float, goal: Float, acceleration: Float, brake: Float, dt: float) -> Pair:
    """Approach `goal`, towards zero with `brake`, away from it with `acceleration`.

    Returns:
        The velocities after `dt`, and the ways.
    """
    if all_of(goal == v):
        return v, v * dt
    slower = np.minimum(np.maximum(goal, np.minimum(v, 0.0)), np.maximum(v, 0.0))
    slows = slower != v
    first, rate = np.where(slows, slower, goal), np.where(slows, brake, acceleration)
    end, time = _towards(v, first, rate, dt)
    way, left = (v + end) / 2 * time, dt - time
    if any_of(left * (goal - end)):
        v = end
        end, time = _towards(v, goal, acceleration, left)
        way, left = way + (v + end) / 2 * time, left - time
    return end, way + end * left


def _towards(v: Float, goal: Float, rate: Float, dt: Float | float) -> Pair:
    """Return the velocity after `dt` on the way to `goal`, and the time until it is there."""
    if not all_of(rate):
        rate = np.where(rate > 0, rate, AT_ONCE)
    most = rate * dt
    after = np.minimum(np.maximum(goal, v - most), v + most)
    return after, np.minimum(abs(goal - v) / rate, dt)
