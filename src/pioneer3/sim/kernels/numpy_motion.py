"""Drives with numpy alone: what `compiled.motion` does robot by robot, for all at once."""

from math import ceil, pi, tau

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.drives import (
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
    TURN_HEAT,
    TURN_NOISE,
    VELOCITY,
    WAY_NOISE,
    Drives,
)
from pioneer3.sim.kernels.numpy_ramps import turn_axes
from pioneer3.sim.kernels.numpy_truth import all_of, any_of, indices_of

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]

HARD = np.array([[HARDEST], [HARDEST_TURN]])
TINY = 1e-300
"""Instead of no turn at all [rad]: not to divide by zero."""
SIDES = np.array([[-0.5], [0.5]])
"""Of the wheel base, where the left and the right wheel are."""
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
    if all_of(velocities):
        wish = _run(drives, dt, 1)
    else:
        fine = ~velocities.all(axis=0)
        wish = np.zeros((8, len(drives)))
        for which, pieces in ((~fine, 1), (fine, max(1, ceil(dt / SUBSTEP - 1e-9)))):
            some = indices_of(which)
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
    held, brake = None, axes[DECELERATION]
    if any_of(flags[HELD : BRAKING + 1]) or not all_of(flags[POWERED]):
        off = flags[POWERED] == 0
        held, hard = off | (flags[HELD] != 0), off | (flags[BRAKING] != 0)
        brake = np.where(hard, HARD, brake)
    blind = not all_of(errors[:WAY_NOISE] == EXACT)
    wish = np.zeros((8, len(drives)))
    for _ in range(pieces):
        ways = turn_axes(axes, held, brake, dt / pieces)
        _follow(wish[3:6], *ways)
        if blind:
            _follow(wish[:3], *(errors[:WAY_NOISE].reshape(2, 2, -1) * ways).sum(axis=1))
        wish[6:] += ways
    if not blind:
        wish[:3] = wish[3:6]
    if any_of(flags[BRAKING]):
        flags[BRAKING] &= axes[VELOCITY].any(axis=0)
    return wish


def _follow(pose: Float, way: Float, turn: Float) -> None:
    """Let poses (3, N) go on along arcs."""
    half = turn / 2 + TINY
    chord = way * (np.sin(half) / half)
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
    wheels[LEFT : RIGHT + 1] += wish[6] + SIDES * (wish[7] * wheels[BASE])


def wrapped(angles: Float) -> Float:
    """Return angles that are at most one turn off, in (-pi, pi] [rad]."""
    if not any_of(abs(angles) >= pi):
        return angles
    return np.where(angles > pi, angles - tau, np.where(angles <= -pi, angles + tau, angles))
