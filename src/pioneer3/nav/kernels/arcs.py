"""The motions that a robot can begin now, and what each would meet."""

from math import cos, floor, hypot, inf, sin, sqrt

import numpy as np

from pioneer3.arrays import Float, Float32
from pioneer3.jit import inlined, kernel
from pioneer3.nav.kernels.ways import direction

ROUNDING = 1e-6
"""Difference of two gaps that is none [m]."""


@inlined
def towards(now: float, wanted: float, faster: float, slower: float, dt: float) -> float:
    """Return a speed after `dt` [s] on its way to another, by its two accelerations."""
    step = (faster if abs(wanted) > abs(now) and wanted * now >= 0.0 else slower) * dt
    return min(wanted, now + step) if wanted > now else max(wanted, now - step)


@inlined
def gap_to(x: float, y: float, front: float, rear: float, half: float) -> float:
    """Return the distance of a point in the robot's frame from its outline; 0 within [m]."""
    dx = max(x - front, -rear - x, 0.0)
    dy = max(abs(y) - half, 0.0)
    return sqrt(dx * dx + dy * dy)


@kernel
def arcs(
    commands: Float,
    state: Float,
    motion: Float,
    outline: Float,
    obstacles: Float,
    values: Float32,
    frame: Float,
    out: Float,
) -> None:
    """Judge each of `commands`: held for a while, then braked to a stop.

    Args:
        commands: Speed [m/s] and turn rate [rad/s], shape (C, 2).
        state: x, y [m], heading [rad] in the map's frame, speed [m/s], turn rate [rad/s], shape
            (5,).
        motion: Acceleration and deceleration [m/s^2], the same of turns [rad/s^2], how long a
            command is held, and the step of time [s], shape (6,).
        outline: Front, rear, half of the width, distance to be kept [m], and how much more of it
            per speed [s]; gaps beyond the next number are not told apart [m]; the speed of slow
            robots [m/s], shape (7,).
        obstacles: x, y [m] in the map's frame, their velocity [m/s], radius [m], the gap that a
            slow robot keeps to each [m], and the distance of its side from the robot [m], which
            ascends; `-inf` for those that move, shape (N, 7).
        values: Cost to go [m], shape (H, W).
        frame: x, y of the lower left corner and side of a cell [m], shape (3,).
        out: For each command: cost to go at the end, heading off the way there [rad], the least
            gap to an obstacle less the distance to be kept, and less that of slow robots [m];
            shape (C, 4).
            A robot that stands keeps no distance: others may come near it. A motion that comes too
            near to something is followed no further than there: it costs `inf`.
    """
    acceleration, deceleration = motion[0], motion[1]
    turn_acceleration, turn_deceleration = motion[2], motion[3]
    hold, dt = motion[4], motion[5]
    front, rear, half, far = outline[0], outline[1], outline[2], outline[5]
    around = sqrt(max(front, rear) ** 2 + half * half) + far
    for i in range(len(commands)):
        x, y, theta, v, w = state[0], state[1], state[2], state[3], state[4]
        least, slow, time = far, far, 0.0
        is_slow = abs(commands[i, 0]) <= outline[6]
        stands = commands[i, 0] == 0.0 and commands[i, 1] == 0.0
        too_near = False
        while not too_near:
            ends = time >= hold
            wanted_v = 0.0 if ends else commands[i, 0]
            wanted_w = 0.0 if ends else commands[i, 1]
            v = towards(v, wanted_v, acceleration, deceleration, dt)
            w = towards(w, wanted_w, turn_acceleration, turn_deceleration, dt)
            if ends and abs(v) < 1e-9 and abs(w) < 1e-9:
                break
            middle = theta + w * dt / 2.0
            x += v * dt * cos(middle)
            y += v * dt * sin(middle)
            theta += w * dt
            time += dt
            if abs(v) < 1e-9 and abs(w) < 1e-9:
                continue
            c, s = cos(theta), sin(theta)
            keep = outline[3] + outline[4] * abs(v)
            away = around + hypot(x - state[0], y - state[1])
            for j in range(len(obstacles)):
                if obstacles[j, 6] > away:
                    break
                dx = obstacles[j, 0] + obstacles[j, 2] * time - x
                dy = obstacles[j, 1] + obstacles[j, 3] * time - y
                reach = around + obstacles[j, 4]
                if dx * dx + dy * dy > reach * reach:
                    continue
                gap = gap_to(c * dx + s * dy, c * dy - s * dx, front, rear, half) - obstacles[j, 4]
                slow = min(slow, gap - obstacles[j, 5])
                least = min(least, gap - keep)
            too_near = least < 0.0 and not (is_slow and slow >= -ROUNDING) and not stands
        u, t = (x - frame[0]) / frame[2], (y - frame[1]) / frame[2]
        out[i, 0] = inf if too_near else _value(values, u, t)
        to_x, to_y = direction(values, u, t)
        out[i, 1] = 0.0
        if hypot(to_x, to_y) > 0.1:
            cross = cos(theta) * to_y - sin(theta) * to_x
            dot = cos(theta) * to_x + sin(theta) * to_y
            out[i, 1] = abs(np.arctan2(cross, dot))
        out[i, 2] = least
        out[i, 3] = slow


@inlined
def _value(values: Float32, x: float, y: float) -> float:
    """Return the cost at a place [cells] between the middles of cells that have one."""
    height, width = values.shape
    left, low = floor(x - 0.5), floor(y - 0.5)
    u, v = x - 0.5 - left, y - 0.5 - low
    total, weight = 0.0, 0.0
    for corner in range(4):
        right, above = corner % 2, corner // 2
        column, row = left + right, low + above
        if 0 <= column < width and 0 <= row < height and values[row, column] < inf:
            share = (u if right else 1.0 - u) * (v if above else 1.0 - v)
            total += share * values[row, column]
            weight += share
    return total / weight if weight > 0.5 else inf
