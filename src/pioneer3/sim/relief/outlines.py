"""Shapes as seen from above: segments `x0, y0, x1, y1` [m], shape (S, 4)."""

from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2

Float = NDArray[np.float64]

NONE: Float = np.empty((0, 4))


def rectangle(pose: Pose2, size: tuple[float, float]) -> Float:
    """Return the sides of a rectangle around `pose` [m], shape (4, 4)."""
    c, s = cos(pose.theta), sin(pose.theta)
    half = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]) * size / 2
    return ring(half @ np.array([(c, s), (-s, c)]) + (pose.x, pose.y))


def ring(corners: Float) -> Float:
    """Return the sides between corners (C, 2) and from the last to the first, shape (C, 4)."""
    return np.concatenate([corners, np.roll(corners, -1, axis=0)], axis=1)


def outer(points: Float) -> Float:
    """Return the corners of the convex hull of `points` (P, 2), counter-clockwise, (C, 2)."""
    ordered = np.unique(points.round(9), axis=0).tolist()
    lower, upper = (_chain(way) for way in (ordered, ordered[::-1]))
    return np.array(lower[:-1] + upper[:-1])


def _chain(points: list[list[float]]) -> list[list[float]]:
    """Return the right-hand side of the hull on the way along sorted points."""
    kept: list[list[float]] = []
    for x, y in points:
        while len(kept) > 1:
            (ax, ay), (bx, by) = kept[-2:]
            if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0:
                break
            kept.pop()
        kept.append([x, y])
    return kept
