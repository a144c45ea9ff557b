"""The gaps between a robot and the things around it."""

from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel

Float = NDArray[np.float64]


def gaps_at(at: Pose2, model: RobotModel, obstacles: Float) -> Float:
    """Return the gap between a robot and each obstacle [m], less than 0 within one, shape (N,).

    Args:
        at: Where the robot is [m, rad].
        model: Its outline.
        obstacles: x, y [m], velocity [m/s] and radius [m] in the same frame, shape (N, 5).
    """
    c, s = cos(at.theta), sin(at.theta)
    dx, dy = obstacles[:, 0] - at.x, obstacles[:, 1] - at.y
    x, y = c * dx + s * dy, c * dy - s * dx
    off_x = np.maximum(np.maximum(x - model.length_front, -model.length_rear - x), 0.0)
    off_y = np.maximum(np.abs(y) - model.width / 2, 0.0)
    gaps: Float = np.hypot(off_x, off_y) - obstacles[:, 4]
    return gaps
