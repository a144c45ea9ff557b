"""Outlines with numpy alone: where they are, and what reaches into them."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.kernels.numpy_truth import any_of
from pioneer3.sim.kernels.robots import Robots

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]

EVERYONE = slice(None)
NOWHERE = 1e8
"""Where hidden robots are placed [m]."""


def place(robots: Robots, which: slice | Int = EVERYONE) -> None:
    """Bring middles and corners of all or some up to date with the poses."""
    (x, y, theta), hidden = robots.state[:3, which], robots.hidden[which]
    if any_of(hidden):
        x, y = np.where(hidden, NOWHERE, x), np.where(hidden, NOWHERE, y)
    # points as complex numbers: to turn one is to multiply
    at, heading = np.empty((2, len(x), 1), dtype=np.complex128)
    at.real[:, 0], at.imag[:, 0] = x, y
    np.cos(theta, out=heading.real[:, 0])
    np.sin(theta, out=heading.imag[:, 0])
    points = robots.points[which] * heading
    points += at
    robots.shapes[which, :2] = points[:, :1].view(np.float64)
    robots.shapes[which, 3:] = points[:, 1:].view(np.float64)


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
