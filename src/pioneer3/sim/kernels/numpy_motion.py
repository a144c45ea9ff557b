"""Drives with numpy alone: what `compiled.motion` does robot by robot, for all at once."""

from math import ceil, pi, tau

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.drives import (
    ACCELERATION,
    ARRIVED,
    BASE,
    BRAKING,
    CAPACITY,
    DECELERATION,
    DRIFT_NOISE,
    DRIVE_HEAT,
    DRIVE_POWER,
    ENERGY,
    HARDEST,
    HARDEST_TURN,
    HEAT,
    HEAT_TIME,
    HELD,
    IDLE_POWER,
    LEFT,
    ODOM_THETA,
    ODOM_X,
    POWERED,
    REMAINING,
    RIGHT,
    STALL_HEAT,
    STALLED,
    SUBSTEP,
    SUPPLY,
    TARGET,
    TOP,
    TURN_HEAT,
    TURN_NOISE,
    VELOCITY,
    WAY_NOISE,
    Drives,
)

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]

HARD = np.array([[HARDEST], [HARDEST_TURN]])
EXACT = np.array([[1.0], [0.0], [0.0], [1.0]])
"""What wheels see that see everything: the first rows of `Drives.errors`."""


def live(drives: Drives, dt: float) -> None:
    """Use energy, and warm up or cool down."""
    v, w = abs(drives.axes[VELOCITY])
    wheels = drives.wheels
    energy, heat = wheels[ENERGY], wheels[HEAT]
    energy += (wheels[SUPPLY] - IDLE_POWER - DRIVE_POWER * v) * dt
    np.minimum(np.maximum(energy, 0.0, out=energy), CAPACITY, out=energy)
    warm = DRIVE_HEAT * v + TURN_HEAT * w + STALL_HEAT * drives.flags[STALLED]
    heat += (warm - heat) * (dt / HEAT_TIME)


def wants_to_move(drives: Drives) -> Bool:
    """Return which drives turn, or are about to, shape (N,)."""
    axes = drives.axes
    turns = (axes[TARGET] != 0) & (drives.flags[POWERED] != 0)
    turns |= axes[VELOCITY] != 0
    turns |= ~np.isnan(axes[REMAINING])
    moves: Bool = turns[0] | turns[1]
    return moves


def wishes(drives: Drives, dt: float, noise: Float | None) -> Float:
    """Let all drives run.

    Returns:
        Motion x, y, theta in each robot's frame, what the wheels believe it is, way and turn of
        the wheels, shape (8, N).
    """
    velocities = np.isnan(drives.axes[REMAINING])
    if velocities.all():
        wish = _run(drives, dt, 1)
    else:
        fine = ~velocities.all(axis=0)
        wish = np.zeros((8, len(drives)))
        for which, pieces in ((~fine, 1), (fine, max(1, ceil(dt / SUBSTEP - 1e-9)))):
            some = np.flatnonzero(which)
            part = drives.only(some)
            wish[:, some] = _run(part, dt, pieces)
            drives.axes[:, :, some], drives.flags[:, some] = part.axes, part.flags
    if noise is not None:
        way, turn = abs(wish[6:]) ** 0.5
        errors = drives.errors
        turned = errors[TURN_NOISE] * turn * noise[1] + errors[DRIFT_NOISE] * way * noise[2]
        _follow(wish[:3], errors[WAY_NOISE] * way * noise[0], turned)
    return wish


def _run(drives: Drives, dt: float, pieces: int) -> Float:
    """Do the same in so many pieces, without noise."""
    axes, flags, errors = drives.axes, drives.flags, drives.errors
    off = flags[POWERED] == 0
    held, hard = off | (flags[HELD] != 0), off | (flags[BRAKING] != 0)
    brake = np.where(hard, HARD, axes[DECELERATION])
    blind = not (errors[:WAY_NOISE] == EXACT).all()
    wish = np.zeros((8, len(drives)))
    for _ in range(pieces):
        ways = _turn_axes(axes, held, brake, dt / pieces)
        _follow(wish[3:6], *ways)
        if blind:
            _follow(wish[:3], *(errors[:WAY_NOISE].reshape(2, 2, -1) * ways).sum(axis=1))
        wish[6:] += ways
    if not blind:
        wish[:3] = wish[3:6]
    if flags[BRAKING].any():
        flags[BRAKING] &= axes[VELOCITY].any(axis=0)
    return wish


def _turn_axes(axes: Float, held: Bool, brake: Float, dt: float) -> Float:
    """Let both axes of all drives run for `dt`; return their ways, shape (2, N)."""
    v, remaining, top = axes[VELOCITY], axes[REMAINING], axes[TOP]
    goal = np.minimum(np.maximum(axes[TARGET], -top), top)
    covers = ~np.isnan(remaining)
    if held.any():
        goal[:, held], covers[:, held] = 0.0, False
    if covers.any():
        room = np.maximum(abs(remaining) - abs(v) * (dt / 2), 0.0)
        speed = np.copysign(np.minimum(top, np.sqrt(2 * brake * room)), remaining)
        goal = np.where(covers, speed, goal)
    if (goal == v).all():
        ways = v * dt
    else:
        axes[VELOCITY], ways = _ramp(v, goal, axes[ACCELERATION], brake, dt)
    if covers.any():
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
    if slows.any():
        first = np.where(turns_round, 0.0, np.where(slows, goal, v))
        middle, time = _towards(v, first, brake, dt)
        left = dt - time
    end: Float = middle
    time_up: Float | float = 0.0
    if not (middle == goal).all():
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


def _follow(pose: Float, way: Float, turn: Float) -> None:
    """Let poses (3, N) go on along arcs."""
    half = turn / 2
    chord = way * np.divide(np.sin(half), half, out=np.ones_like(half), where=half != 0)
    x, y, theta = pose
    half += theta
    x += chord * np.cos(half)
    y += chord * np.sin(half)
    theta += turn


def reached(poses: Float, wish: Float) -> Float:
    """Return poses (3, N) after motions (3, N), each in its robot's frame."""
    theta, (ahead, left, _) = poses[2], wish
    c, s = np.cos(theta), np.sin(theta)
    there: Float = poses + wish
    np.add(poses[0], c * ahead - s * left, out=there[0])
    np.add(poses[1], s * ahead + c * left, out=there[1])
    return there


def roll(drives: Drives, wish: Float) -> None:
    """Let the wheels believe in their motion."""
    wheels = drives.wheels
    odometry = wheels[ODOM_X : ODOM_THETA + 1]
    odometry[:] = reached(odometry, wish[3:6])
    odometry[2] = wrapped(odometry[2])
    turn = wish[7] * wheels[BASE] / 2
    wheels[LEFT] += wish[6] - turn
    wheels[RIGHT] += wish[6] + turn


def wrapped(angles: Float) -> Float:
    """Return angles that are at most one turn off, in (-pi, pi] [rad]."""
    inside: Float = np.where(
        angles > pi, angles - tau, np.where(angles <= -pi, angles + tau, angles)
    )
    return inside
