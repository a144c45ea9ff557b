"""The footprint of a robot: its rectangle, and the circle it needs to turn."""

from math import cos, hypot, sin

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel
from pioneer3.sim.collision import footprint_hits

Float = NDArray[np.float64]


def turning_circle(model: RobotModel) -> float:
    """Return the radius of the circle that `model` sweeps when it turns on the spot [m]."""
    longest = max(model.length_front, model.length_rear)
    return max(model.radius, hypot(longest, model.width / 2))


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


def which_inside(polygon: Float, x: Float, y: Float) -> NDArray[np.bool_]:
    """Return which of the points (x, y) [m], shape (...), lie in a convex polygon."""
    x0, y0, x1, y1 = polygon.T
    sides = (x1 - x0) * (y[..., None] - y0) - (y1 - y0) * (x[..., None] - x0)
    found: NDArray[np.bool_] = (sides > 0).all(axis=-1) | (sides < 0).all(axis=-1)
    return found


def _lines(model: RobotModel, pose: Pose2) -> Float:
    """Return the outline and the middle line: two robots in one pose have no side in the other."""
    tail, nose = pose @ Pose2(-model.length_rear), pose @ Pose2(model.length_front)
    return np.concatenate([outline(model, pose), [[tail.x, tail.y, nose.x, nose.y]]])


def hits(model: RobotModel, pose: Pose2, segments: Float) -> bool:
    """Whether `model` at `pose` stands on any of `segments` [m], shape (S, 4)."""
    return footprint_hits(pose, model.length_front, model.length_rear, model.width / 2, segments)
