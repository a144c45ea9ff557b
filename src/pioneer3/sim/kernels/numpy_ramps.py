"""Speeds that ramp up and down, with numpy alone: both axes of all drives at once."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.drives import ACCELERATION, ARRIVED, REMAINING, TARGET, TOP, VELOCITY
from pioneer3.sim.kernels.numpy_truth import all_of, any_of

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]


def turn_axes(axes: Float, held: Bool, brake: Float, dt: float) -> Float:
    """Let both axes of all drives run for `dt`; return their ways, shape (2, N)."""
    v, remaining, top = axes[VELOCITY], axes[REMAINING], axes[TOP]
    goal = np.minimum(np.maximum(axes[TARGET], -top), top)
    covers = ~np.isnan(remaining)
    if any_of(held):
        goal[:, held], covers[:, held] = 0.0, False
    if any_of(covers):
        room = np.maximum(abs(remaining) - abs(v) * (dt / 2), 0.0)
        speed = np.copysign(np.minimum(top, np.sqrt(2 * brake * room)), remaining)
        goal = np.where(covers, speed, goal)
    if all_of(goal == v):
        ways = v * dt
    else:
        axes[VELOCITY], ways = _ramp(v, goal, axes[ACCELERATION], brake, dt)
    if any_of(covers):
        left = remaining - ways
        there = covers & (np.copysign(1.0, remaining) * left <= ARRIVED)
        ways = np.where(there, remaining, ways)
        axes[REMAINING] = np.where(there, np.nan, np.where(covers, left, remaining))
        axes[TARGET][there] = axes[VELOCITY][there] = 0.0
    return np.asarray(ways)


def _ramp(
    v: Float, goal: Float, acceleration: Float, brake: Float, dt: Float | float
) -> tuple[Float, Float]:
    """Approach `goal`, towards zero with `brake`, away from it with `acceleration`."""
    turns_round = v * goal < 0
    slows = turns_round | (abs(goal) < abs(v))
    middle, left = v, dt
    time: Float | float = 0.0
    if any_of(slows):
        first = np.where(turns_round, 0.0, np.where(slows, goal, v))
        middle, time = _towards(v, first, brake, dt)
        left = dt - time
    end: Float = middle
    time_up: Float | float = 0.0
    if not all_of(middle == goal):
        rises = (abs(goal) >= abs(middle)) & (left > 0)
        end, time_up = _towards(middle, np.where(rises, goal, middle), acceleration, left)
    way = (v + middle) / 2 * time + (middle + end) / 2 * time_up + end * (left - time_up)
    return end, way


def _towards(v: Float, goal: Float, rate: Float, dt: Float | float) -> tuple[Float, Float]:
    """Return the velocity after `dt` on the way to `goal`, and the time until it is there."""
    gap, most = goal - v, rate * dt
    size = abs(gap)
    done = (size <= most) | (rate == 0)
    # what has no rate takes no time
    time = np.divide(size, rate, out=np.zeros_like(size), where=rate > 0)
    return np.where(done, goal, v + np.copysign(most, gap)), np.where(done, time, dt)
