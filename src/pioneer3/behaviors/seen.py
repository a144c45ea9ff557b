"""A point that a range sensor saw."""

from typing import NamedTuple


class Seen(NamedTuple):
    """Where it is in odometry's frame [m], and when it was seen [s]."""

    x: float
    y: float
    stamp: float
