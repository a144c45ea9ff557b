"""Which bumper segments something touches (protocol.md 4.7)."""

from math import pi

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel

Float = NDArray[np.float64]

REACH = 0.01
"""A bumper is pressed by what is this close to the outline [m]."""
ARC = np.radians(135.0)
"""That all segments of one bumper take together, seen from the robot's pose [rad]."""


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
    starts = np.stack([x[:, 0], y[:, 0]], axis=1)
    ways = np.stack([x[:, 1], y[:, 1]], axis=1) - starts
    first, last = _inside(starts, ways, low, high)
    touches = first <= last
    one, other = (
        (starts + share[:, None] * ways)[touches] @ np.array([1, 1j]) for share in (first, last)
    )
    turned = np.angle(other * one.conj())
    middles, halves = np.angle(one) + turned / 2, abs(turned) / 2
    front = _bits(middles, halves, model.front_bumpers)
    return front, _bits(middles + pi, halves, model.rear_bumpers)


def _inside(starts: Float, ways: Float, low: Float, high: Float) -> tuple[Float, Float]:
    """Return from which share of its way to which each segment is within the box."""
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (low - starts) / ways, (high - starts) / ways
    still = ways == 0
    within = (low <= starts) & (starts <= high)
    enter = np.where(still, np.where(within, 0.0, np.inf), np.minimum(one, other)).max(axis=1)
    leave = np.where(still, np.where(within, 1.0, -np.inf), np.maximum(one, other)).min(axis=1)
    missed = enter > leave
    return np.where(missed, 1.0, enter.clip(0.0)), np.where(missed, 0.0, leave.clip(max=1.0))


def _bits(middles: Float, halves: Float, segments: int) -> int:
    """Return the segments at these bearings, plus and minus `halves` [rad]; bit 1 is the left."""
    if not segments:
        return 0
    middles = (middles + pi) % (2 * pi) - pi
    edges = (ARC / 2 - middles + np.stack([-halves, halves])) / ARC * segments
    first, last = (
        np.floor(edges).astype(int).clip([[0], [-1]], [[segments], [segments - 1]]).tolist()
    )
    bits = 0
    for one, other in zip(first, last, strict=True):
        for number in range(one, other + 1):
            bits |= 2 << number
    return bits
