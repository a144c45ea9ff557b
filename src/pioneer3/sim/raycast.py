"""Range to the nearest wall along each ray. Arrays in, arrays out.

Seen from a ray, a point lies so far `along` it and so far `across` it, to its left. A ray meets a
wall whose ends lie across it on opposite sides, or touch it. Two walls that share a corner see it
with the same numbers, so no ray slips between them.
"""

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
Int = NDArray[np.int64]

TOUCH = 1e-9
"""A wall's end this close to a ray is on it [m]."""

PAIRS = 1 << 15
"""Pairs of ray and wall worked on at a time: the arrays then fit a processor's cache."""


def cast_reference(origin: Float, angles: Float, walls: Float, limit: float) -> Float:
    """Plain numpy; slow but obvious. The oracle of the kernels.

    Args:
        origin: Where all rays start [m], shape (2,).
        angles: Ray directions [rad], shape (B,).
        walls: Segments `x0, y0, x1, y1` [m], shape (W, 4).
        limit: Longest range [m]; a ray that hits nothing returns this.

    Returns:
        Ranges [m], shape (B,), each in [0, limit]. A wall along a ray is hit at its nearer end, a
        wall that the origin lies on at 0.
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
    shortest: Float = np.where(hit, ranges, limit).min(axis=1, initial=limit).clip(min=0.0)
    return shortest


def directions(angles: Float) -> Float:
    """Return the unit vector of each of `angles` [rad], (B,) to (B, 2)."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def meetings(origins: Float, headings: Float, walls: Float) -> tuple[Int, Float]:
    """Return which rays meet a wall ahead of them, and how far away.

    Only the few walls that cross a ray's line, before or behind it, are measured along it.

    Args:
        origins: Where rays start [m], shape (..., 2).
        headings: Their unit vectors, shape (..., 2).
        walls: Segments [m], shape (..., 4). The three broadcast against each other.

    Returns:
        Of each meeting the index along the first axis and the range [m] >= 0, both of shape (M,).
    """
    dx, dy = headings[..., 0], headings[..., 1]
    x0, y0 = walls[..., 0] - origins[..., 0], walls[..., 1] - origins[..., 1]
    x1, y1 = walls[..., 2] - origins[..., 0], walls[..., 3] - origins[..., 1]
    across0, across1 = dx * y0 - dy * x0, dx * y1 - dy * x1
    # not both ends strictly left nor both strictly right
    meets = (np.minimum(across0, across1) <= TOUCH) & (np.maximum(across0, across1) >= -TOUCH)
    where = np.nonzero(meets)
    dx, dy, x0, y0, x1, y1 = (
        np.broadcast_to(v, meets.shape)[where] for v in (dx, dy, x0, y0, x1, y1)
    )
    along0, along1 = dx * x0 + dy * y0, dx * x1 + dy * y1
    found = _meeting(along0, along1, across0[where], across1[where])
    ahead = found >= -TOUCH
    return where[0][ahead], found[ahead].clip(min=0.0)


def _meeting(along0: Float, along1: Float, across0: Float, across1: Float) -> Float:
    """Return how far along its ray each wall, given by its ends, meets the ray's line."""
    across0 = np.where(abs(across0) <= TOUCH, 0.0, across0)
    across1 = np.where(abs(across1) <= TOUCH, 0.0, across1)
    lies_along = (across0 == 0) & (across1 == 0)
    share = across0 / np.where(lies_along, 1.0, across0 - across1)
    nearer = np.where(along0 * along1 <= 0, 0.0, np.minimum(along0, along1))
    return np.where(lies_along, nearer, along0 + (along1 - along0) * share)
