"""Finds legs in the scan of a laser: narrow round clusters that stand free.

The beams of a scan are cut into clusters where the range jumps (adaptive breakpoints: Borges and
Aldon, 2004); a cluster is a leg by its width, its roundness, and its surroundings (Arras, Mozos and
Burgard, 2007). How people are made from legs is in docs/explanation/follow.md.
"""

from collections.abc import Iterator
from math import cos, hypot, inf, isfinite, pi, sin
from typing import NamedTuple

from pioneer3.state import Scan

LEGS_RANGE = 4.0
"""Range beyond which legs are not looked for [m]."""
NOISE = 0.04
"""Difference of the ranges of one cluster that is noise at most [m]."""
SLOPE = 1.5
"""Difference of the ranges of one cluster besides noise at most, by the distance from beam to beam:
surfaces are seen as flat as 34 degrees."""
BLANKS = 3
"""So many beams without a valid reading do not end a cluster: dark cloth sends little back."""
NARROWEST = 0.05
"""Width of a leg at least [m]."""
WIDEST_LEG = 0.25
"""Width of a leg at most [m]."""
WIDEST_BOTH = 0.6
"""Two legs that are not apart, as of a person in a skirt, are narrower than this [m]."""
ROUND = 0.08
"""The middle of a leg is nearer than its edges by this share of its width, or more."""
ROUND_BEAMS = 5
"""With fewer beams nothing is known of the roundness."""
FREE_BESIDE = 0.1
"""Distance by which things beside a leg are farther away than its edge [m]."""
DEEPEST = 0.1
"""Largest radius of one leg [m]."""
DEPTH = pi / 4
"""The points of a circle that a laser sees lie so much before its middle, on the average [radii]"""


class Leg(NamedTuple):
    """A cluster that may be a leg, or both legs of a person, and its width across the beams [m].

    Attributes:
        x: Of its middle, in odometry's frame [m].
        free: Whether all beside it is farther away; otherwise only a part of it may be seen.
    """

    x: float
    y: float
    width: float
    free: bool

    @property
    def both(self) -> bool:
        """Whether it is too wide for one leg."""
        return self.width > WIDEST_LEG


def find_legs(scan: Scan) -> list[Leg]:
    """Return all clusters that may be legs, from right to left."""
    angles, ranges = scan.angles, scan.ranges
    if len(angles) < 2:
        return []
    step = (angles[-1] - angles[0]) / (len(angles) - 1)
    sensor = scan.sensor_in_odom
    legs = []
    for first, last in _clusters(ranges, step):
        nearest = min(ranges[first], ranges[last])
        # the edges lie half a beam further out, on the average
        width = (angles[last] - angles[first] + step) * nearest
        if first == last or not NARROWEST <= width <= WIDEST_BOTH:
            continue
        free = _free(ranges, first, last)
        if width > WIDEST_LEG and not free:
            continue
        valid = [k for k in range(first, last + 1) if isfinite(ranges[k])]
        if (
            width <= WIDEST_LEG
            and len(valid) >= ROUND_BEAMS
            and not _is_round(ranges, valid, width)
        ):
            continue
        away = sum(ranges[k] for k in valid) / len(valid) + DEPTH * min(width / 2, DEEPEST)
        bearing = sensor.theta + sum(angles[k] for k in valid) / len(valid)
        x, y = sensor.x + away * cos(bearing), sensor.y + away * sin(bearing)
        legs.append(Leg(x, y, width, free))
    return legs


def _clusters(ranges: tuple[float, ...], step: float) -> Iterator[tuple[int, int]]:
    """Yield the first and the last beam of each cluster within reach."""
    slope, first, last, before = SLOPE * step, -1, -1, 0.0
    for k, metres in enumerate(ranges):
        if 0.0 < metres <= LEGS_RANGE:
            if first >= 0 and k - last <= BLANKS + 1:
                # a jump is seen from its nearer side
                near = min(before, metres)
                if abs(metres - before) <= NOISE + slope * (k - last) * near:
                    last, before = k, metres
                    continue
            if first >= 0:
                yield first, last
            first = last = k
            before = metres
        elif first >= 0 and metres == metres:  # noqa: PLR0124  NaN is no valid reading
            yield first, last
            first = -1
    if first >= 0:
        yield first, last


def _free(ranges: tuple[float, ...], first: int, last: int) -> bool:
    """Return whether what is beside a cluster is farther away; nothing is known past the ends."""
    if first == 0 or last == len(ranges) - 1:
        return False
    return _beside(ranges, first, -1) and _beside(ranges, last, 1)


def _beside(ranges: tuple[float, ...], edge: int, way: int) -> bool:
    end = edge + way * (BLANKS + 1)
    for k in range(edge + way, end, way):
        if not 0 <= k < len(ranges):
            break
        if ranges[k] == ranges[k]:
            return ranges[k] > ranges[edge] + FREE_BESIDE
    return True


def _is_round(ranges: tuple[float, ...], valid: list[int], width: float) -> bool:
    third = max(1, len(valid) // 4)
    edges = [ranges[k] for k in (*valid[:third], *valid[-third:])]
    middle = valid[third:-third]
    depth = sum(edges) / len(edges) - sum(ranges[k] for k in middle) / len(middle)
    return depth >= ROUND * width


def gap_to(leg: Leg, x: float, y: float) -> float:
    """Return the distance from the middle of a leg to a point [m]."""
    return hypot(leg.x - x, leg.y - y)


def range_towards(scan: Scan, bearing: float) -> float:
    """Return the reading of the beam nearest to a bearing in the laser's frame [m].

    `inf` also where there is no valid reading; 0 beside the field of view.
    """
    angles = scan.angles
    step = (angles[-1] - angles[0]) / max(1, len(angles) - 1)
    beam = round((bearing - angles[0]) / step) if step else -1
    if not 0 <= beam < len(angles):
        return 0.0
    metres = scan.ranges[beam]
    return metres if isfinite(metres) else inf
