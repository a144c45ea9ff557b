"""Who may meet whom, with numpy alone: frames, rectangles in them, and what is around."""

from math import ceil

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.collision import TOUCH as DEEP
from pioneer3.sim.kernels.near import near_robots
from pioneer3.sim.kernels.numpy_outlines import reach_into
from pioneer3.sim.kernels.numpy_rays import sides
from pioneer3.sim.kernels.robots import Robots

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]

ROOM_OF_OTHERS = 3.0
"""How far from a robot others that move are looked for [m]."""


def room_of_others(robots: Robots, who: Int, poses: Float) -> Float:
    """Return the distance to the nearest other [m], up to `ROOM_OF_OTHERS`, of poses (3, F)."""
    room = np.full(len(who), ROOM_OF_OTHERS)
    beside, others = near_robots(robots, poses[0], poses[1], ROOM_OF_OTHERS, who)
    if len(others):
        dx, dy = robots.shapes.T[:2].take(others, axis=1) - poses[:2].take(beside, axis=1)
        np.minimum.at(room, beside, np.hypot(dx, dy) - robots.shapes[others, 2])
    return room


def may_meet(robots: Robots, who: Int | Int32, frames: Float, ways: Float) -> tuple[Bool, Bool]:
    """Tell who may meet another, where no point of robot `n` is more than `ways[n]` from its place.

    Returns:
        Whether it may meet another, and whether, there itself, it surely does not, both (F,).
    """
    meets = np.zeros(len(who), dtype=np.bool_)
    if len(who) == 0:
        return meets, ~meets
    reach = largest(robots, who) + 2 * float(ways.max(initial=0.0))
    beside, others = near_robots(robots, frames[0], frames[1], reach, who)
    solid = robots.hidden[who[beside]] == 0
    beside, others = beside[solid], others[solid]
    hit = np.zeros_like(meets)
    if len(others):
        seen = sides(outlines_from(robots, frames, beside, others))
        ends = seen.reshape(4, -1, len(others))
        middle, length, width = boxes_of(robots, who).take(beside, axis=1)
        for found, spread in ((meets, ways[others] + ways[who[beside]]), (hit, ways[others])):
            into = reach_into(ends, middle, length + spread, width + spread).any(axis=0)
            found[beside[into]] = True
    return meets, ~hit


def hit_after(around: tuple[Int, Float], boxes: Float, motions: Float, shares: Float) -> Bool:
    """Return whether robots would stand on what is around after shares (F, K) of their motions."""
    whose, ends = around
    hits = np.zeros(shares.shape, dtype=np.bool_)
    moved = motions[:, :, None] * shares
    seen = seen_from(frames_of(*moved), whose, ends[:, :, None])
    middle, length, width = boxes.take(whose, axis=1)[:, :, None]
    segment, share = np.nonzero(reach_into(seen, middle, length, width))
    hits[whose[segment], share] = True
    return hits


def boxes_of(robots: Robots, who: Int | Int32) -> Float:
    """Return from pose to middle, half the length, half the width of robots [m], shape (3, F)."""
    front, rear, half = robots.state[3:6].take(who, axis=1)
    return np.stack([(front - rear) / 2, (front + rear) / 2 - DEEP, half - DEEP])


def largest(robots: Robots, who: Int | Int32) -> float:
    """Return the largest distance of a corner from its robot's pose [m]."""
    front, rear, half = robots.state[3:6].take(who, axis=1)
    return float(np.hypot(np.maximum(front, rear), half).max(initial=0.0))


def rounded(reach: float) -> float:
    """Return a reach that is little more, so that few lists of near walls do [m]."""
    return ceil(4 * reach) / 4


def frames_of(x: Float, y: Float, theta: Float) -> Float:
    """Return x, y, cosine and sine of poses, shape (4, ...)."""
    return np.array([x, y, np.cos(theta), np.sin(theta)])


def outlines_from(robots: Robots, frames: Float, beside: Int, others: Int) -> Float:
    """Return the corners of `others` (P,) as seen from the frames `beside` (P,), (2 C, P) [m]."""
    return seen_from(frames, beside, robots.shapes.take(others, axis=0).T[3:])


def joined(whose: Int, ends: Float, robots: Robots, beside: Int, others: Int) -> tuple[Int, Float]:
    """Return whose walls and where (4, P), together with the sides of the `others` beside them."""
    if len(others) == 0:
        return whose, ends
    outlines = sides(robots.shapes.T[3:]).reshape(4, -1, len(robots)).take(others, axis=2)
    whose = np.concatenate([whose, *[beside] * outlines.shape[1]])
    return whose, np.concatenate([ends, outlines.reshape(4, -1)], axis=1)


def seen_from(frames: Float, which: Int, points: Float) -> Float:
    """Return points x, y, x, y..., shape (2 K, P, ...), as seen from the frames `which` (P,)."""
    x, y, c, s = frames.take(which, axis=1)
    dx, dy = points[::2] - x, points[1::2] - y
    seen = np.empty((len(points), *dx.shape[1:]))
    np.add(c * dx, s * dy, out=seen[::2])
    np.subtract(c * dy, s * dx, out=seen[1::2])
    return seen
