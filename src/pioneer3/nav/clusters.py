"""Echoes of a scan that no wall explains, joined to clusters as far apart as two legs."""

from math import atan2, hypot

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import wrap

Float = NDArray[np.float64]
Int = NDArray[np.int64]

JOINED = 0.45
"""Echoes nearer to each other than this are of one thing [m]: the legs of somebody who walks."""
WIDEST = 0.9
"""Larger things are no people [m]."""
COMPANY = 0.15
"""An echo without another one so near is a mistake of the laser, or too little of a thing [m]."""
SHANK, WIDE = 0.04, 0.15
"""Radius of a leg, and how wide parts of a thing are at most that are legs [m]."""
APART = 0.08
"""Echoes farther apart are of two legs [m]."""
STANCE = 0.2
"""From the middle of somebody who stands to the outside of a leg at most [m]."""
AT_EDGE = 0.1
"""So near to the edge of what the laser sees a thing is not seen whole [rad]."""


def middle_of(points: Float, origin: Float) -> tuple[float, float]:
    """Return the middle of the box around points, as far behind them as that of a leg [m]."""
    x, y = ((points.min(axis=0) + points.max(axis=0)) / 2).tolist()
    dx, dy = x - float(origin[0]), y - float(origin[1])
    share = SHANK / max(hypot(dx, dy), SHANK)
    return x + share * dx, y + share * dy


def has_company(points: Float) -> NDArray[np.bool_]:
    """Return which of the points (N, 2) have a neighbour in the scan's order near them."""
    close = np.hypot(*np.diff(points, axis=0).T) < COMPANY
    company = np.zeros(len(points), dtype=np.bool_)
    company[1:] |= close
    company[:-1] |= close
    return company


def is_whole(points: Float, origin: Float, limit: Float, expected: tuple[float, float]) -> bool:
    """Return whether the laser sees all of a thing: no part of it is beyond the edge of its view.

    Args:
        points: Of the thing [m], shape (N, 2).
        origin: Of the laser [m], shape (2,).
        limit: Bearing of the laser [rad] and half of its field of view [rad], shape (2,).
        expected: Where the middle of the thing should be [m].
    """
    bearings = np.arctan2(points[:, 1] - origin[1], points[:, 0] - origin[0])
    off = (bearings - limit[0] + np.pi) % (2 * np.pi) - np.pi
    dx, dy = expected[0] - float(origin[0]), expected[1] - float(origin[1])
    middle = abs(wrap(atan2(dy, dx) - float(limit[0])))
    inside = float(limit[1]) - middle > atan2(STANCE, hypot(dx, dy))
    return inside and bool((np.abs(off) < limit[1] - AT_EDGE / 2).all())


def looks_like_legs(points: Float) -> bool:
    """Return whether all parts of a thing (N, 2) are as narrow as legs."""
    apart = np.hypot(*np.diff(points, axis=0).T) > APART
    parts = np.split(points, np.flatnonzero(apart) + 1)
    return all(hypot(*np.ptp(part, axis=0).tolist()) < WIDE for part in parts)


def clusters(points: Float) -> list[Int]:
    """Return the indices of the points of each thing that is not too large.

    Points lie in the order of their bearings, so that neighbours are beside each other.
    """
    if not len(points):
        return []
    apart = np.hypot(*np.diff(points, axis=0).T) > JOINED
    parts = np.split(np.arange(len(points)), np.flatnonzero(apart) + 1)
    small = []
    for part in parts:
        size = np.ptp(points[part], axis=0)
        if hypot(size[0], size[1]) < WIDEST:
            small.append(part)
    return small
