"""Range to the nearest wall along each ray. Arrays in, arrays out.

Seen from a ray, a point lies so far `along` it and so far `across` it, to its left. A ray meets a
wall whose ends lie across it on opposite sides, or touch it. Two walls that share a corner see it
with the same numbers, so no ray slips between them.
"""

import numpy as np

from pioneer3.arrays import Float

TOUCH = 1e-9
"""A wall's end this close to a ray is on it [m]."""


def cast_reference(origin: Float, angles: Float, walls: Float, limit: float) -> Float:
    """Return ranges of rays at `angles` (B,) [rad], in plain numpy: the oracle of the kernels.

    Rays start at `origin` (2,), walls are segments x0, y0, x1, y1 (W, 4) [m]. A ray that hits
    nothing reads `limit`; a wall along a ray is hit at its nearer end, one that the origin lies on
    at 0.
    """
    shortest: Float = ranges_reference(origin, angles, walls, limit).min(axis=1, initial=limit)
    return shortest


def ranges_reference(origin: Float, angles: Float, walls: Float, limit: float) -> Float:
    """Return the range [m] along each ray to each wall as if it were alone, shape (B, W).

    Arguments are those of :func:`cast_reference`; a wall that a ray misses is at `limit`.
    """
    dx, dy = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x0, y0, x1, y1 = (walls - np.tile(origin, 2)).T
    along0, along1 = dx * x0 + dy * y0, dx * x1 + dy * y1
    across0, across1 = dx * y0 - dy * x0, dx * y1 - dy * x1
    across0 = np.where(abs(across0) <= TOUCH, 0.0, across0)
    across1 = np.where(abs(across1) <= TOUCH, 0.0, across1)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = along0 + (along1 - along0) * (across0 / (across0 - across1))
    # along the ray: between its ends a wall holds the origin, or the nearer end counts
    nearer = np.where(along0 * along1 <= 0, 0.0, np.minimum(along0, along1))
    ranges = np.where((across0 == 0) & (across1 == 0), nearer, crossing)
    hit = (np.sign(across0) * np.sign(across1) <= 0) & (ranges >= -TOUCH)
    alone: Float = np.where(hit, ranges, limit).clip(min=0.0, max=limit)
    return alone
