"""Robots as seen from poses, with numpy alone: frames, the outlines of others in them, sizes."""

from math import ceil

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.collision import TOUCH as DEEP
from pioneer3.sim.kernels.robots import Robots

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Int32 = NDArray[np.int32]


def frames_of(x: Float, y: Float, theta: Float) -> Float:
    """Return x, y, cosine and sine of poses, shape (4, ...)."""
    return np.array([x, y, np.cos(theta), np.sin(theta)])


def seen_from(frames: Float, which: Int, points: Float) -> Float:
    """Return points x, y, x, y..., shape (2 K, P, ...), as seen from the frames `which` (P,)."""
    x, y, c, s = frames.take(which, axis=1)
    dx, dy = points[::2] - x, points[1::2] - y
    seen = np.empty((len(points), *dx.shape[1:]))
    np.add(c * dx, s * dy, out=seen[::2])
    np.subtract(c * dy, s * dx, out=seen[1::2])
    return seen


def outlines_from(robots: Robots, frames: Float, beside: Int, others: Int) -> Float:
    """Return the corners of `others` (P,) as seen from the frames `beside` (P,), (2 C, P) [m]."""
    return seen_from(frames, beside, robots.shapes.take(others, axis=0).T[3:])


def sides(corners: Float) -> Float:
    """Return the sides of outlines given by C corners, (2 C, P) to ax, ay, bx, by, (4, C P)."""
    ends = np.empty((4, len(corners) // 2, corners.shape[1]))
    ends[2], ends[3] = corners[::2], corners[1::2]
    ends[:2, 1:], ends[:2, 0] = ends[2:, :-1], ends[2:, -1]
    return ends.reshape(4, -1)


def joined(whose: Int, ends: Float, robots: Robots, beside: Int, others: Int) -> tuple[Int, Float]:
    """Return whose walls and where (4, P), together with the sides of the `others` beside them."""
    if len(others) == 0:
        return whose, ends
    outlines = sides(robots.shapes.T[3:]).reshape(4, -1, len(robots)).take(others, axis=2)
    whose = np.concatenate([whose, *[beside] * outlines.shape[1]])
    return whose, np.concatenate([ends, outlines.reshape(4, -1)], axis=1)


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
