"""Which bumper segments something touches (arcos.md 4.7)."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel

Float = NDArray[np.float64]

REACH = 0.01
"""A bumper is pressed by what is this close to the outline [m]."""
ARC = np.radians(135.0)
"""That all segments of one bumper take together, seen from the robot's pose [rad]."""
SAMPLES = np.linspace(0.0, 1.0, 9)
"""Places along what touches that are looked at."""


def pressed_segments(model: RobotModel, pose: Pose2, ends: Float) -> tuple[int, int]:
    """Return the pressed segments in front and behind, as bits from bit 1 on.

    Args:
        model: Has sizes and numbers of segments.
        pose: Of the robot, in the frame of `ends`.
        ends: Walls and outlines around, x0, y0, x1, y1 [m], shape (P, 4).
    """
    inverse = pose.inverse()
    c, s = np.cos(inverse.theta), np.sin(inverse.theta)
    x, y = ends[:, ::2], ends[:, 1::2]
    x, y = inverse.x + c * x - s * y, inverse.y + s * x + c * y
    low = np.array([-model.length_rear - REACH, -model.width / 2 - REACH])
    high = np.array([model.length_front + REACH, model.width / 2 + REACH])
    starts, ways = (
        np.stack([x[:, 0], y[:, 0]], 1),
        np.stack([x[:, 1] - x[:, 0], y[:, 1] - y[:, 0]], 1),
    )
    first, last = _inside(starts, ways, low, high)
    touches = first <= last
    shares = first[touches, None] + (last - first)[touches, None] * SAMPLES
    points = starts[touches, None] + shares[..., None] * ways[touches, None]
    bearings = np.arctan2(points[..., 1], points[..., 0]).ravel()
    front = _bits(bearings, model.front_bumpers)
    return front, _bits(np.angle(-np.exp(1j * bearings)), model.rear_bumpers)


def _inside(starts: Float, ways: Float, low: Float, high: Float) -> tuple[Float, Float]:
    """Return from which share of its way to which each segment is within the box."""
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (low - starts) / ways, (high - starts) / ways
    still = ways == 0
    within = (low <= starts) & (starts <= high)
    enter = np.where(still, np.where(within, 0.0, np.inf), np.minimum(one, other))
    leave = np.where(still, np.where(within, 1.0, -np.inf), np.maximum(one, other))
    return np.maximum(enter.max(axis=1), 0.0), np.minimum(leave.min(axis=1), 1.0)


def _bits(bearings: Float, segments: int) -> int:
    """Return the segments at these bearings [rad]: from left to right, bit 1 first."""
    if not segments or not len(bearings):
        return 0
    numbers = np.floor((ARC / 2 - bearings) / ARC * segments).astype(int)
    hit = np.unique(numbers[(numbers >= 0) & (numbers < segments)])
    return sum(2 << int(number) for number in hit)
