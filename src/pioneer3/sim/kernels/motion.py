# ruff: noqa: PLR0917 (compiled functions take no keywords without a cost)
"""Drives, and what stops them.

A robot may rest against a wall or against another, up to `TOUCH` [m] deep, as its own rectangle has
it. Of a corner that reaches d deep into a side, the other rectangle says up to d times the square
root of 2: it is made smaller along both axes, across the corner. So a robot that moves stops at
`BETWEEN`, and then both of them say that they only touch.
"""

from math import ceil, copysign, cos, isnan, pi, sin, sqrt, tau

import numpy as np

from pioneer3.arrays import Bool, Float, Int32, UInt8
from pioneer3.jit import inlined, kernel
from pioneer3.sim.collision import TOUCH
from pioneer3.sim.kernels.drives import (
    ACCELERATION,
    ANGULAR,
    ARRIVED,
    BASE,
    BOTH_STALLED,
    BRAKING,
    CAPACITY,
    DECELERATION,
    DRIFT_NOISE,
    DRIVE_HEAT,
    DRIVE_POWER,
    ENERGY,
    FINER,
    HARDEST,
    HARDEST_TURN,
    HEAT,
    HEAT_TIME,
    HELD,
    IDLE_POWER,
    LEFT,
    LINEAR,
    NEGLIGIBLE,
    ODOM_THETA,
    ODOM_X,
    ODOM_Y,
    POWERED,
    REMAINING,
    RIGHT,
    STALL_HEAT,
    STALLED,
    SUBSTEP,
    SUPPLY,
    TARGET,
    TOP,
    TOUCHED,
    TURN_HEAT,
    TURN_NOISE,
    V_OF_V,
    V_OF_W,
    VELOCITY,
    W_OF_V,
    W_OF_W,
    WAY_NOISE,
)
from pioneer3.sim.kernels.robots import Others, Walls, cells, neighbours, outline, sort

BETWEEN = TOUCH / 2
"""How deep robots must reach into each other for one that moves to stop [m]; less than `TOUCH` by
the square root of 2 and room for rounding."""

Flags = UInt8
Wheels = tuple[Float, Flags, Float, Float]
"""Arrays of drives: axes, flags, wheels, errors."""

Motion = tuple[float, float, float, float, float, float, float, float]
"""x, y, theta in the robot's frame, the same as the wheels count it, way and turn of the wheels."""


@inlined
def _ramp(
    v: float, goal: float, acceleration: float, brake: float, dt: float
) -> tuple[float, float]:
    """Return the velocity after `dt` on the way to `goal`, and the way.

    Towards zero it brakes, else it accelerates.
    """
    way = 0.0
    if v * goal < 0.0 or abs(goal) < abs(v):
        end = 0.0 if v * goal < 0.0 else goal
        time = min(dt, abs(end - v) / brake) if brake > 0.0 else 0.0
        after = (
            end if time < dt or brake * dt >= abs(end - v) else v + copysign(brake * dt, end - v)
        )
        way, v, dt = (v + after) / 2 * time, after, dt - time
    if dt > 0.0 and v != goal and abs(goal) >= abs(v):
        time = min(dt, abs(goal - v) / acceleration) if acceleration > 0.0 else 0.0
        after = goal if time < dt else v + copysign(acceleration * time, goal - v)
        way, v, dt = way + (v + after) / 2 * time, after, dt - time
    return v, way + v * dt


@kernel
def _run_axis(n: int, axis: int, axes: Float, held: bool, brake: float, dt: float) -> float:
    """Let one axis of a drive run for `dt`; return its way."""
    v: float = axes[VELOCITY, axis, n]
    remaining: float = axes[REMAINING, axis, n]
    top, acceleration = axes[TOP, axis, n], axes[ACCELERATION, axis, n]
    if held or isnan(remaining):
        goal = 0.0 if held else max(-top, min(top, axes[TARGET, axis, n]))
        axes[VELOCITY, axis, n], way = _ramp(v, goal, acceleration, brake, dt)
        return way
    room = max(0.0, abs(remaining) - abs(v) * dt / 2)
    goal = copysign(min(top, sqrt(2 * brake * room)), remaining)
    axes[VELOCITY, axis, n], way = _ramp(v, goal, acceleration, brake, dt)
    if copysign(1.0, remaining) * (remaining - way) > ARRIVED:
        axes[REMAINING, axis, n] = remaining - way
        return way
    axes[TARGET, axis, n] = axes[VELOCITY, axis, n] = 0.0
    axes[REMAINING, axis, n] = np.nan
    return remaining


@inlined
def _wrapped(angle: float) -> float:
    if angle > pi:
        return angle - tau
    return angle + tau if angle <= -pi else angle


@inlined
def _follow(
    x: float, y: float, theta: float, way: float, turn: float
) -> tuple[float, float, float]:
    """Go on along an arc from a pose."""
    half = turn / 2
    chord = way * (sin(half) / half if abs(half) > 1e-6 else 1 - half * half / 6)
    return x + chord * cos(theta + half), y + chord * sin(theta + half), theta + turn


@inlined
def _wants_to_move(n: int, axes: Float, flags: Flags) -> bool:
    moving = axes[VELOCITY, LINEAR, n] != 0.0 or axes[VELOCITY, ANGULAR, n] != 0.0
    wanted = axes[TARGET, LINEAR, n] != 0.0 or axes[TARGET, ANGULAR, n] != 0.0
    left = not (isnan(axes[REMAINING, LINEAR, n]) and isnan(axes[REMAINING, ANGULAR, n]))
    return moving or left or (wanted and flags[POWERED, n] != 0)


@inlined
def _braking(n: int, dt: float, axes: Float, flags: Flags) -> tuple[bool, float, float, int]:
    """Return whether a drive is held, how hard its axes brake, and in how many pieces it runs."""
    off = flags[POWERED, n] == 0
    hard, held = flags[BRAKING, n] != 0 or off, flags[HELD, n] != 0 or off
    brake = HARDEST if hard else axes[DECELERATION, LINEAR, n]
    turn_brake = HARDEST_TURN if hard else axes[DECELERATION, ANGULAR, n]
    fine = not (isnan(axes[REMAINING, LINEAR, n]) and isnan(axes[REMAINING, ANGULAR, n]))
    pieces = max(1, ceil(dt / SUBSTEP - 1e-9)) if fine else 1
    return held, brake, turn_brake, pieces


@inlined
def _end_braking(n: int, axes: Float, flags: Flags) -> None:
    """End the emergency stop of a drive that stands."""
    if flags[BRAKING, n] and axes[VELOCITY, LINEAR, n] == axes[VELOCITY, ANGULAR, n] == 0.0:
        flags[BRAKING, n] = 0


@kernel
def _run_drive(n: int, dt: float, noise: Float, drives: Wheels) -> Motion:
    """Let a drive run; return what that comes to."""
    axes, flags, _, errors = drives
    held, brake, turn_brake, pieces = _braking(n, dt, axes, flags)
    x, y, theta, bx, by, believed, ways, turns = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for _ in range(pieces):
        way = _run_axis(n, LINEAR, axes, held, brake, dt / pieces)
        turn = _run_axis(n, ANGULAR, axes, held, turn_brake, dt / pieces)
        bx, by, believed = _follow(bx, by, believed, way, turn)
        true_way = errors[V_OF_V, n] * way + errors[V_OF_W, n] * turn
        true_turn = errors[W_OF_V, n] * way + errors[W_OF_W, n] * turn
        x, y, theta = _follow(x, y, theta, true_way, true_turn)
        ways, turns = ways + way, turns + turn
    if noise.shape[1] > 0:
        root = sqrt(abs(ways))
        slipped = errors[WAY_NOISE, n] * root * noise[0, n]
        turned = errors[TURN_NOISE, n] * sqrt(abs(turns)) * noise[1, n]
        turned += errors[DRIFT_NOISE, n] * root * noise[2, n]
        x, y, theta = _follow(x, y, theta, slipped, turned)
    _end_braking(n, axes, flags)
    return x, y, theta, bx, by, believed, ways, turns


@kernel
def _overlaps(
    ax: float,
    ay: float,
    bx: float,
    by: float,
    c: float,
    s: float,
    middle: float,
    length: float,
    width: float,
) -> bool:
    """Return whether a segment, relative to the pose, reaches into the rectangle; as the oracle."""
    mx, my, hx, hy = (ax + bx) / 2, (ay + by) / 2, (bx - ax) / 2, (by - ay) / 2
    mx, my = c * mx + s * my - middle, c * my - s * mx
    hx, hy = c * hx + s * hy, c * hy - s * hx
    return (
        abs(mx) <= length + abs(hx)
        and abs(my) <= width + abs(hy)
        and abs(hx * my - hy * mx) <= length * abs(hy) + width * abs(hx)
    )


@kernel
def _collides(
    n: int,
    px: float,
    py: float,
    theta: float,
    moved_by: float,
    touch: float,
    state: Float,
    walls: Walls,
    others: Others,
    found: Int32,
) -> bool:
    """Return whether robot `n` would stand on something at a pose.

    The others may have moved by up to `moved_by` [m] since they were sorted into the table; they
    count from a depth of `touch` [m] on, walls of `TOUCH`.
    """
    frame, starts, pieces = walls
    shapes, columns, rows = others[1], int(frame[4]), int(frame[5])
    if state[7, n] != 0.0:
        return False
    c, s, corners = cos(theta), sin(theta), shapes.shape[1]
    front, rear, half = state[3, n], state[4, n], state[5, n]
    middle, length, width = (front - rear) / 2, (front + rear) / 2 - TOUCH, half - TOUCH
    longest = max(front, rear)
    hit, reach = False, sqrt(longest * longest + half * half)
    west, east = cells(px - reach, px + reach, frame[0], frame[3])
    south, north = cells(py - reach, py + reach, frame[1], frame[3])
    west, east = max(west, 0), min(east, columns - 1)
    for row in range(max(south, 0), min(north, rows - 1) + 1 if west <= east else 0):
        for k in range(starts[row * columns + west], starts[row * columns + east + 1]):
            ax, ay = pieces[k, 0] - px, pieces[k, 1] - py
            bx, by = pieces[k, 2] - px, pieces[k, 3] - py
            hit |= _overlaps(ax, ay, bx, by, c, s, middle, length, width)
    near = 0 if hit or len(shapes) < 2 else neighbours(px, py, reach + moved_by, n, others, found)
    length, width = (front + rear) / 2 - touch, half - touch
    for i in range(near):
        k = found[i]
        ax, ay = shapes[k, corners - 2] - px, shapes[k, corners - 1] - py
        for j in range(3, corners, 2):
            bx, by = shapes[k, j] - px, shapes[k, j + 1] - py
            hit |= _overlaps(ax, ay, bx, by, c, s, middle, length, width)
            ax, ay = bx, by
    return hit


@kernel
def blocked(
    first: int, last: int, poses: Float, state: Float, walls: Walls, others: Others, out: Bool
) -> None:
    """Fill `out` from `first` to `last` with whether robots would stand on something."""
    found = np.empty(len(others[1]) + 1, np.int32)
    for n in range(first, last):
        x, y, theta = poses[0, n], poses[1, n], poses[2, n]
        out[n] = _collides(n, x, y, theta, 0.0, TOUCH, state, walls, others, found)


@kernel
def _free_share(
    n: int,
    motion: Motion,
    moved_by: float,
    state: Float,
    walls: Walls,
    others: Others,
    found: Int32,
) -> float:
    """Return how much of its motion robot `n` can make, in steps of 1 / FINER^2."""
    x, y, c, s = state[0, n], state[1, n], cos(state[2, n]), sin(state[2, n])
    free, part = 0.0, 1.0
    if max(abs(motion[0]), abs(motion[1]), abs(motion[2])) <= NEGLIGIBLE:
        return free
    for _ in range(2):
        part /= FINER
        begin = free
        for k in range(1, FINER):
            share = begin + part * k
            dx, dy, theta = share * motion[0], share * motion[1], state[2, n] + share * motion[2]
            px, py = x + c * dx - s * dy, y + s * dx + c * dy
            if _collides(n, px, py, theta, moved_by, BETWEEN, state, walls, others, found):
                break
            free = share
    return free


@kernel
def _apply(n: int, share: float, motion: Motion, drives: Wheels, state: Float) -> None:
    """Move a robot by a share of its motion, in the world and in its odometry."""
    wheels = drives[2]
    c, s = cos(state[2, n]), sin(state[2, n])
    x, y = share * motion[0], share * motion[1]
    state[0, n] += c * x - s * y
    state[1, n] += s * x + c * y
    state[2, n] = _wrapped(state[2, n] + share * motion[2])
    c, s = cos(wheels[ODOM_THETA, n]), sin(wheels[ODOM_THETA, n])
    x, y, turn = share * motion[3], share * motion[4], share * motion[7] * wheels[BASE, n] / 2
    wheels[ODOM_X, n] += c * x - s * y
    wheels[ODOM_Y, n] += s * x + c * y
    wheels[ODOM_THETA, n] = _wrapped(wheels[ODOM_THETA, n] + share * motion[5])
    wheels[LEFT, n] += share * motion[6] - turn
    wheels[RIGHT, n] += share * motion[6] + turn


@inlined
def _use_energy(n: int, dt: float, drives: Wheels) -> None:
    """Use energy, and warm up or cool down."""
    axes, flags, wheels, _ = drives
    v, w = abs(axes[VELOCITY, LINEAR, n]), abs(axes[VELOCITY, ANGULAR, n])
    power = wheels[SUPPLY, n] - IDLE_POWER - DRIVE_POWER * v
    wheels[ENERGY, n] = min(max(wheels[ENERGY, n] + power * dt, 0.0), CAPACITY)
    warm = DRIVE_HEAT * v + TURN_HEAT * w + STALL_HEAT * (flags[STALLED, n] != 0)
    wheels[HEAT, n] += (warm - wheels[HEAT, n]) * (dt / HEAT_TIME)


@kernel
def step(
    dt: float, noise: Float, drives: Wheels, state: Float, walls: Walls, others: Others
) -> None:
    """Let every drive run for `dt`, robot by robot, as far as nothing is in the way."""
    axes, flags, _, _ = drives
    found = np.empty(len(others[1]) + 1, np.int32)
    moved, moved_by = False, 0.0
    for n in range(axes.shape[2]):
        _use_energy(n, dt, drives)
        if not _wants_to_move(n, axes, flags):
            flags[STALLED, n] = 0
            continue
        motion = _run_drive(n, dt, noise, drives)
        x, y, c, s = state[0, n], state[1, n], cos(state[2, n]), sin(state[2, n])
        px, py = x + c * motion[0] - s * motion[1], y + s * motion[0] + c * motion[1]
        share = 1.0
        theta = state[2, n] + motion[2]
        if _collides(n, px, py, theta, moved_by, BETWEEN, state, walls, others, found):
            share = _free_share(n, motion, moved_by, state, walls, others, found)
            axes[VELOCITY, LINEAR, n] = axes[VELOCITY, ANGULAR, n] = 0.0
        flags[TOUCHED, n] = share < 1.0
        flags[STALLED, n] = BOTH_STALLED * (share < 1.0)
        if share > 0.0:
            _apply(n, share, motion, drives, state)
            outline(n, state, others[1])
            way = sqrt(motion[0] * motion[0] + motion[1] * motion[1])
            moved_by = max(moved_by, way + abs(motion[2]) * others[1][n, 2])
            moved = True
    if moved:
        sort(others)


@kernel
def ramp(dt: float, drives: Wheels) -> None:
    """Let the velocities that every drive wants follow their ramps for `dt`; nothing moves."""
    axes, flags, _, _ = drives
    for n in range(axes.shape[2]):
        _use_energy(n, dt, drives)
        if not _wants_to_move(n, axes, flags):
            continue
        held, brake, turn_brake, pieces = _braking(n, dt, axes, flags)
        for _ in range(pieces):
            _run_axis(n, LINEAR, axes, held, brake, dt / pieces)
            _run_axis(n, ANGULAR, axes, held, turn_brake, dt / pieces)
        _end_braking(n, axes, flags)


@kernel
def count(left: Float, right: Float, drives: Wheels) -> None:
    """Count the ways that the left and the right wheels have rolled, both (N,), as odometry."""
    wheels = drives[2]
    for n in range(wheels.shape[1]):
        way, turn = (left[n] + right[n]) / 2, (right[n] - left[n]) / wheels[BASE, n]
        x, y, theta = wheels[ODOM_X, n], wheels[ODOM_Y, n], wheels[ODOM_THETA, n]
        x, y, theta = _follow(x, y, theta, way, turn)
        wheels[ODOM_X, n], wheels[ODOM_Y, n], wheels[ODOM_THETA, n] = x, y, _wrapped(theta)
        wheels[LEFT, n] += left[n]
        wheels[RIGHT, n] += right[n]
