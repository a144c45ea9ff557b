"""Does a robot's rectangle stand on a wall? Exact for every wall and pose; the oracle."""

from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2

Float = NDArray[np.float64]

TOUCH = 1e-9
"""How deep a wall must reach into the rectangle to count [m]: a robot may rest against a wall."""


def footprint_hits(pose: Pose2, front: float, rear: float, half_width: float, walls: Float) -> bool:
    """Return whether any wall crosses the rectangle or lies inside it.

    Touching is free: what reaches no deeper than :data:`TOUCH` into the rectangle does not count.
    A segment and a box are apart where one of three axes separates them: the two of the box and
    the one at right angles to the segment. That needs no division, so zero-length and axis-parallel
    walls are no special cases.

    Args:
        pose: The robot in the frame of the walls.
        front: From the pose forward to the front edge [m].
        rear: From the pose back to the rear edge [m], positive.
        half_width: From the pose to either side [m].
        walls: Segments `x0, y0, x1, y1` [m], shape (W, 4).
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
