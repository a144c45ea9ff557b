"""The room between a robot's outline and walls, along the motion that a command leads to."""

from math import cos, hypot, inf, sin

from pioneer3.arrays import Float
from pioneer3.jit import inlined, kernel
from pioneer3.nav.kernels.arcs import gap_to, towards

HALVINGS = 30
"""Steps of the search for the deepest point of a wall within the outline."""


@inlined
def depth_at(x: float, y: float, front: float, rear: float, half: float) -> float:
    """Return how deep a point of the robot's frame is within its outline; less than 0 outside."""
    return min(front - x, x + rear, half - abs(y))


@inlined
def off_segment(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Return the distance of a point from a segment, which may be a point as well [m]."""
    ux, uy = bx - ax, by - ay
    length = ux * ux + uy * uy
    share = 0.0
    if length > 0.0:
        share = min(1.0, max(0.0, ((x - ax) * ux + (y - ay) * uy) / length))
    return hypot(x - ax - share * ux, y - ay - share * uy)


@kernel
def room_beside(
    ax: float, ay: float, bx: float, by: float, front: float, rear: float, half: float
) -> float:
    """Return the gap between an outline and a segment of its frame [m].

    Where they overlap it is less than 0: as deep as the segment's deepest point.
    """
    low, high = 0.0, 1.0  # the part within the outline, by clipping
    for side in range(4):
        if side == 0:
            begin, end = front - ax, front - bx
        elif side == 1:
            begin, end = ax + rear, bx + rear
        elif side == 2:
            begin, end = half - ay, half - by
        else:
            begin, end = ay + half, by + half
        if begin < 0.0 and end < 0.0:
            low, high = 1.0, 0.0
        elif begin < 0.0:
            low = max(low, begin / (begin - end))
        elif end < 0.0:
            high = min(high, begin / (begin - end))
    if low <= high:
        for _ in range(HALVINGS):  # the depth rises to one point, and falls again
            one, other = low + (high - low) / 3.0, high - (high - low) / 3.0
            first = depth_at(ax + one * (bx - ax), ay + one * (by - ay), front, rear, half)
            second = depth_at(ax + other * (bx - ax), ay + other * (by - ay), front, rear, half)
            if first < second:
                low = one
            else:
                high = other
        share = (low + high) / 2.0
        return -depth_at(ax + share * (bx - ax), ay + share * (by - ay), front, rear, half)
    gap = min(gap_to(ax, ay, front, rear, half), gap_to(bx, by, front, rear, half))
    for corner in range(4):
        x = front if corner % 2 else -rear
        y = half if corner // 2 else -half
        gap = min(gap, off_segment(x, y, ax, ay, bx, by))
    return gap


@kernel
def room_along(
    commands: Float,
    before: Float,
    motion: Float,
    outline: Float,
    walls: Float,
    kept: Float,
    out: Float,
) -> None:
    """Write the least room of each command, less what is kept, until the robot stands [m].

    The robot obeys at once, or after a delay in which it obeys the command before: both count.

    Args:
        commands: Speed [m/s] and turn rate [rad/s], shape (C, 2).
        before: Measured speed and turn rate, and the command before [m/s, rad/s], shape (4,).
        motion: Acceleration and deceleration [m/s^2], the same of turns [rad/s^2], the longest
            delay, how long a command is held, and the step of time [s], shape (7,).
        outline: Front, rear, half of the width, the most that is kept, and the room less than which
            a command is followed no further [m], shape (5,).
        walls: Segments or points in the robot's frame, and their distances from its middle [m],
            which ascend, shape (S, 5).
        kept: From each of them [m], shape (S,).
        out: For each command; `inf` where all walls are farther than is kept, shape (C,).
    """
    front, rear, half = outline[0], outline[1], outline[2]
    around = hypot(max(front, rear), half) + outline[3]
    dt = motion[6]
    for i in range(len(commands)):
        least = inf
        for late in range(2):
            x, y, theta, v, w, time = 0.0, 0.0, 0.0, before[0], before[1], 0.0
            delay = motion[4] if late else 0.0
            while least >= outline[4]:
                wanted_v, wanted_w = commands[i, 0], commands[i, 1]
                if time < delay:
                    wanted_v, wanted_w = before[2], before[3]
                elif time >= delay + motion[5]:
                    wanted_v, wanted_w = 0.0, 0.0
                    if abs(v) < 1e-9 and abs(w) < 1e-9:
                        break
                mean_v, mean_w = v / 2.0, w / 2.0
                v = towards(v, wanted_v, motion[0], motion[1], dt)
                w = towards(w, wanted_w, motion[2], motion[3], dt)
                mean_v, mean_w = mean_v + v / 2.0, mean_w + w / 2.0
                middle = theta + mean_w * dt / 2.0
                x += mean_v * dt * cos(middle)
                y += mean_v * dt * sin(middle)
                theta += mean_w * dt
                time += dt
                c, s, away = cos(theta), sin(theta), around + hypot(x, y)
                for j in range(len(walls)):
                    if walls[j, 4] > away:
                        break
                    ax, ay = walls[j, 0] - x, walls[j, 1] - y
                    bx, by = walls[j, 2] - x, walls[j, 3] - y
                    if off_segment(0.0, 0.0, ax, ay, bx, by) > around:
                        continue
                    room = room_beside(
                        c * ax + s * ay,
                        c * ay - s * ax,
                        c * bx + s * by,
                        c * by - s * bx,
                        front,
                        rear,
                        half,
                    )
                    least = min(least, room - kept[j])
        out[i] = least


@kernel
def rooms(walls: Float, outline: Float, out: Float) -> None:
    """Write the gap between an outline and each wall of its frame, and its distance [m], (S, 2)."""
    for j in range(len(walls)):
        ax, ay, bx, by = walls[j, 0], walls[j, 1], walls[j, 2], walls[j, 3]
        out[j, 0] = room_beside(ax, ay, bx, by, outline[0], outline[1], outline[2])
        out[j, 1] = off_segment(0.0, 0.0, ax, ay, bx, by)
