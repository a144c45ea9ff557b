"""A robot's rectangle: what it collides with, and the bumper segments that something presses.

The collision is exact for every wall and pose; it is the reference of the kernels. Bumpers are as
in protocol.md 4.7.
"""

from math import cos, hypot, pi, sin

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.maps.line_map import which_inside
from pioneer3.models import RobotModel

TOUCH = 1e-9
"""How deep a wall must reach into the rectangle to count [m]: a robot may rest against a wall."""
REACH = 0.01
"""A bumper is pressed by what is this close to the outline [m]."""
ARC = np.radians(135.0)
"""That all segments of one bumper take together, seen from the robot's pose [rad]."""


def footprint_hits(pose: Pose2, front: float, rear: float, half_width: float, walls: Float) -> bool:
    """Return whether any wall crosses the rectangle or lies inside it.

    Touching is free: what reaches no deeper than :data:`TOUCH` into the rectangle does not count.
    A segment and a box are apart where one of three axes separates them: the two of the box and
    the one at right angles to the segment. That needs no division, so zero-length and axis-parallel
    walls are no special cases.

    Pose and walls are in one frame; walls are segments `x0, y0, x1, y1` [m], shape (W, 4). `front`,
    `rear` and `half_width` lead from the pose to the edges, and are positive [m].
    """
    c, s = cos(pose.theta), sin(pose.theta)
    x0, y0 = walls[:, 0] - pose.x, walls[:, 1] - pose.y
    x1, y1 = walls[:, 2] - pose.x, walls[:, 3] - pose.y
    # middle and half extent of each wall, seen from the middle of the rectangle along its sides
    mx, my = (x0 + x1) / 2, (y0 + y1) / 2
    hx, hy = (x1 - x0) / 2, (y1 - y0) / 2
    mx, my = c * mx + s * my - (front - rear) / 2, c * my - s * mx
    hx, hy = c * hx + s * hy, c * hy - s * hx
    length, width = (front + rear) / 2 - TOUCH, half_width - TOUCH
    ax, ay = abs(hx), abs(hy)
    meets = (
        (abs(mx) <= length + ax)
        & (abs(my) <= width + ay)
        & (abs(hx * my - hy * mx) <= length * ay + width * ax)
    )
    return bool(meets.any())


def pressed_segments(model: RobotModel, pose: Pose2, ends: Float) -> tuple[int, int]:
    """Return the pressed segments in front and behind, as bits from bit 1 on.

    `ends` are walls and outlines around, x0, y0, x1, y1 [m], shape (P, 4), in the frame of `pose`.
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


def turning_circle(model: RobotModel) -> float:
    """Return the radius of the circle that `model` sweeps when it turns on the spot [m]."""
    return max(model.radius, model.corner)


def outline(model: RobotModel, pose: Pose2) -> Float:
    """Return the four sides of `model` at `pose` [m], shape (4, 4)."""
    c, s, half = cos(pose.theta), sin(pose.theta), model.width / 2
    front, rear = model.length_front, -model.length_rear
    corners = [
        (pose.x + c * x - s * y, pose.y + s * x + c * y)
        for x, y in ((front, half), (rear, half), (rear, -half), (front, -half))
    ]
    return np.array([(*a, *b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)])


def overlap(model: RobotModel, pose: Pose2, other: RobotModel, there: Pose2) -> bool:
    """Whether two robots stand in each other."""
    apart = hypot(there.x - pose.x, there.y - pose.y)
    if apart > turning_circle(model) + turning_circle(other):
        return False
    return hits(model, pose, _lines(other, there)) or hits(other, there, _lines(model, pose))


def stands_in(model: RobotModel, pose: Pose2, polygon: Float) -> bool:
    """Whether `model` at `pose` reaches into a convex polygon, or is all inside it.

    `polygon` has its sides in order [m], shape (S, 4).
    """
    return inside(polygon, pose.x, pose.y) or hits(model, pose, polygon)


def inside(polygon: Float, x: float, y: float) -> bool:
    """Whether (x, y) [m] lies in a convex polygon, given by its sides in order, shape (S, 4)."""
    return bool(which_inside(polygon, np.array(x), np.array(y)))


def _lines(model: RobotModel, pose: Pose2) -> Float:
    """Return the outline and the middle line: two robots in one pose have no side in the other."""
    tail, nose = pose @ Pose2(-model.length_rear), pose @ Pose2(model.length_front)
    return np.concatenate([outline(model, pose), [[tail.x, tail.y, nose.x, nose.y]]])


def hits(model: RobotModel, pose: Pose2, segments: Float) -> bool:
    """Whether `model` at `pose` stands on any of `segments` [m], shape (S, 4)."""
    return footprint_hits(pose, model.length_front, model.length_rear, model.width / 2, segments)
