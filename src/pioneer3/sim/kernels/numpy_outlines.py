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

AHEAD = np.array([1, -1, -1, 1])
LEFT = np.array([1, 1, -1, -1])
"""Signs of the corners, counter-clockwise from the front left."""


def place(robots: Robots, which: slice | Int = EVERYONE) -> None:
    """Bring middles, radii and corners of all or some up to date with the poses."""
    x, y, theta, front, rear, half, _, hidden = robots.state[:, which]
    if any_of(hidden):
        x, y = np.where(hidden, NOWHERE, x), np.where(hidden, NOWHERE, y)
    # points as complex numbers: to turn one is to multiply
    at, heading = np.empty((2, len(x), 1), dtype=np.complex128)
    at.real[:, 0], at.imag[:, 0] = x, y
    np.cos(theta, out=heading.real[:, 0])
    np.sin(theta, out=heading.imag[:, 0])
    corners = np.empty((len(x), (robots.shapes.shape[1] - 3) // 2), dtype=np.complex128)
    _corners(corners.real.T, corners.imag.T, robots.state[3:7, which])
    corners *= heading
    corners += at
    at += heading * ((front - rear) / 2)[:, None]
    shapes = robots.shapes
    shapes[which, :2] = at.view(np.float64)
    shapes[which, 2] = np.hypot((front + rear) / 2, half)
    shapes[which, 3:] = corners.view(np.float64)


def _corners(ahead: Float, left: Float, sizes: Float) -> None:
    """Fill in corners (4 or 8, N) [m], given front, rear, half width and cut, shape (4, N)."""
    front, rear, half, cut = sizes
    k = len(ahead) // 4
    ahead[:k] = ahead[3 * k :] = front
    ahead[k : 3 * k] = -rear
    left[: 2 * k], left[2 * k :] = half, -half
    if k == 2:
        # a cut corner is two: counter-clockwise the side that is walked along comes first
        left[::4] -= LEFT[::2, None] * cut
        left[3::4] -= LEFT[1::2, None] * cut
        ahead[1::4] -= AHEAD[::2, None] * cut
        ahead[2::4] -= AHEAD[1::2, None] * cut


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
