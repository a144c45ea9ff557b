"""Echoes of a scan that no wall explains, joined to clusters as far apart as two legs."""

from math import atan2, hypot

import numpy as np

from pioneer3.arrays import Bool, Float, Int
from pioneer3.geometry import wrap

JOIN_DISTANCE = 0.45
"""Distance below which two echoes are of one thing, and echoes of the thing that should be there
[m]: the legs of somebody who walks."""
WIDEST_PERSON = 0.9
"""Size above which things are no people [m]."""
COMPANY = 0.15
"""Distance to the next echo at most [m]: one without it is a mistake of the laser, or too little of
a thing."""
SHANK_RADIUS = 0.04
"""Radius of a leg [m]."""
SHANK_WIDTH = 0.15
"""Width of the parts of a thing that are legs at most [m]."""
LEGS_APART = 0.08
"""Distance above which two echoes are of two legs [m]."""
STANCE = 0.2
"""Distance from the middle of somebody who stands to the outside of a leg at most [m]."""
FIELD_EDGE = 0.1
"""Angle to the edge of the laser's field within which a thing is not seen whole [rad]."""


def middle_of(points: Float, origin: Float) -> tuple[float, float]:
    """Return the middle of the box around points, as far behind them as that of a leg [m]."""
    x, y = ((points.min(axis=0) + points.max(axis=0)) / 2).tolist()
    dx, dy = x - float(origin[0]), y - float(origin[1])
    share = SHANK_RADIUS / max(hypot(dx, dy), SHANK_RADIUS)
    return x + share * dx, y + share * dy


def has_company(points: Float) -> Bool:
    """Return which of the points (N, 2) have a neighbour in the scan's order near them."""
    close = np.hypot(*np.diff(points, axis=0).T) < COMPANY
    company = np.zeros(len(points), dtype=np.bool_)
    company[1:] |= close
    company[:-1] |= close
    return company


def is_whole(points: Float, origin: Float, limit: Float, expected: tuple[float, float]) -> bool:
    """Return whether the laser sees all of a thing: no part of it is beyond the edge of its view.

    The thing has `points` (N, 2), its middle should be at `expected`; `limit` (2,) is the bearing
    of the laser and half of its field of view [rad].
    """
    bearings = np.arctan2(points[:, 1] - origin[1], points[:, 0] - origin[0])
    off = (bearings - limit[0] + np.pi) % (2 * np.pi) - np.pi
    dx, dy = expected[0] - float(origin[0]), expected[1] - float(origin[1])
    middle = abs(wrap(atan2(dy, dx) - float(limit[0])))
    inside = float(limit[1]) - middle > atan2(STANCE, hypot(dx, dy))
    return inside and bool((np.abs(off) < limit[1] - FIELD_EDGE / 2).all())


def looks_like_legs(points: Float) -> bool:
    """Return whether all parts of a thing (N, 2) are as narrow as legs."""
    apart = np.hypot(*np.diff(points, axis=0).T) > LEGS_APART
    parts = np.split(points, np.flatnonzero(apart) + 1)
    return all(hypot(*np.ptp(part, axis=0).tolist()) < SHANK_WIDTH for part in parts)


def clusters(points: Float) -> list[Int]:
    """Return the indices of the points of each thing that is not too large.

    Points lie in the order of their bearings, so that neighbours are beside each other.
    """
    if not len(points):
        return []
    apart = np.hypot(*np.diff(points, axis=0).T) > JOIN_DISTANCE
    parts = np.split(np.arange(len(points)), np.flatnonzero(apart) + 1)
    return [part for part in parts if hypot(*np.ptp(points[part], axis=0)) < WIDEST_PERSON]
