"""Outlines with numpy alone: where they are, and what reaches into them."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.robots import Robots

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]

EVERYONE = slice(None)
NOWHERE = 1e8
"""Where hidden robots are placed [m]."""

AHEAD = np.array([1, -1, -1, 1])
LEFT = np.array([1, 1, -1, -1])
"""Signs of the corners, counter-clockwise from the front left."""


def place(robots: Robots, which: slice | Int = EVERYONE) -> None:
    """Bring middles, radii and corners of all or some up to date with the poses."""
    x, y, theta, front, rear, half, cut, hidden = robots.state[:, which]
    if hidden.any():
        x, y = np.where(hidden, NOWHERE, x), np.where(hidden, NOWHERE, y)
    c, s = np.cos(theta), np.sin(theta)
    shapes, middle = robots.shapes, (front - rear) / 2
    shapes[which, 0], shapes[which, 1] = x + c * middle, y + s * middle
    shapes[which, 2] = np.hypot((front + rear) / 2, half)
    ahead, left = np.stack([front, -rear, -rear, front]), np.multiply.outer(LEFT, half)
    if shapes.shape[1] > 11:
        # a cut corner is two: counter-clockwise the side that is walked along comes first
        ahead, left = ahead.repeat(2, axis=0), left.repeat(2, axis=0)
        for k in range(8):
            quarter = k // 2
            if (k + quarter) % 2 == 0:
                left[k] -= LEFT[quarter] * cut
            else:
                ahead[k] -= AHEAD[quarter] * cut
    shapes[which, 3::2] = (x + c * ahead - s * left).T
    shapes[which, 4::2] = (y + s * ahead + c * left).T


def reach_into(ends: Float, middle: Float, length: Float, width: Float) -> Bool:
    """Return whether segments reach into rectangles, as the oracle `footprint_hits`.

    Args:
        ends: ax, ay, bx, by, seen from the pose of the rectangle beside each [m], shape (4, P).
        middle: From the pose to the middle of the rectangle [m], shape (P,).
        length: Half of it [m], shape (P,).
        width: Half of it [m], shape (P,).
    """
    ax, ay, bx, by = ends
    mx, my, hx, hy = (ax + bx) / 2 - middle, (ay + by) / 2, (bx - ax) / 2, (by - ay) / 2
    meets: Bool = (
        (abs(mx) <= length + abs(hx))
        & (abs(my) <= width + abs(hy))
        & (abs(hx * my - hy * mx) <= length * abs(hy) + width * abs(hx))
    )
    return meets
