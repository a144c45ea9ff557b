"""Several robots on one map: who comes near to whom, and places to let others pass."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.costs import CostMap
from pioneer3.nav.planner import CostToGo

PASSING_ROOM = 0.2
"""Room between two robots that pass each other [m]."""
OTHERS_WAY = 5.0
"""Length of the ways of others that counts [m]."""
OWN_WAY = 3.0
"""Length of the own way that is looked at [m]."""
SPARE_ROOM = 0.03
"""Room that is needed besides that to turn, where a robot waits [m]."""
POINT_STRIDE = 4
"""Points of a way of which one counts."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Traveller:
    """A robot among others, and its pose in the map's frame [m, rad].

    Attributes:
        corner: From its middle to its farthest corner [m].
        way: The rest of its way [m] in the map's frame, shape (N, 2); empty where it stays.
        since: When it set out [s]; of two robots the one that set out first goes first.
    """

    name: str
    robot_in_map: Pose2
    corner: float
    way: Float
    since: float

    @property
    def body(self) -> Float:
        """Points around it [m], shape (K, 2)."""
        angles = np.linspace(0.0, 2 * np.pi, 16, endpoint=False)
        ring = 0.8 * self.corner * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        around: Float = ring + np.array([self.robot_in_map.x, self.robot_in_map.y])
        return around

    def ahead(self, length: float = inf) -> Float:
        """Return where it is and will be on the next stretch of its way [m], shape (M, 2)."""
        here = np.array([[self.robot_in_map.x, self.robot_in_map.y]])
        way = _stretch(self.way, length)
        return np.concatenate([here, way[::POINT_STRIDE], way[-1:]])


def without_robots(beams: Beams, robot_in_map: Pose2, others: Iterable[Traveller]) -> Beams:
    """Return a scan without the echoes of other robots: nobody has to remember where they were.

    The robot's pose is that at the scan's last reading.
    """
    keep = np.ones(len(beams.points), dtype=np.bool_)
    for other in others:
        there = robot_in_map.inverse() @ other.robot_in_map
        away = np.hypot(beams.points[:, 0] - there.x, beams.points[:, 1] - there.y)
        keep &= away > other.corner + PASSING_ROOM
    return beams if keep.all() else replace(beams, points=beams.points[keep])


def meeting(mine: Traveller, other: Traveller) -> float | None:
    """Return how far one may drive on its way before it comes too near to another [m].

    0 where it is in the way of the other already; `None` if they do not meet soon.
    """
    apart = mine.corner + other.corner + PASSING_ROOM
    here = mine.robot_in_map
    way = np.concatenate([[(here.x, here.y)], _stretch(mine.way, OWN_WAY)])
    theirs = other.ahead(OTHERS_WAY)
    away = np.hypot(way[:, None, 0] - theirs[None, :, 0], way[:, None, 1] - theirs[None, :, 1]).min(
        axis=1
    )
    close = away < apart
    if not close.any():
        return None
    steps = np.hypot(*np.diff(way, axis=0).T)
    return float(steps[: int(close.argmax())].sum())


def passing_place(costs: CostMap, mine: Traveller, others: Sequence[Traveller]) -> CostToGo | None:
    """Return the way to the nearest place where a robot is in the way of none of the others.

    It can turn there, and wait. The `costs` are those of the map with all that is seen.
    """
    costs = costs.with_obstacles(np.concatenate([other.body for other in others]))
    raster, prices, here = costs.raster, costs.costs(), mine.robot_in_map
    from_robot = CostToGo.of(prices, raster, here.x, here.y)
    if from_robot is None:
        return None
    free = np.isfinite(from_robot.values) & (costs.clearance >= costs.turning + SPARE_ROOM)
    rows, columns = np.nonzero(free)
    places = raster.middles_of(rows, columns)
    cost = from_robot.values[rows, columns].astype(np.float64)
    for other in others:
        apart = mine.corner + other.corner + PASSING_ROOM
        for point in other.ahead():
            cost[np.hypot(*(places - point).T) < apart] = inf
    if not np.isfinite(cost).any():
        return None
    to_go = CostToGo.of(prices, raster, *places[int(cost.argmin())].tolist())
    return to_go if to_go is not None and isfinite(to_go.at(here.x, here.y)) else None


def _stretch(way: Float, length: float) -> Float:
    """Return the first points of a way, up to a length [m]."""
    if len(way) < 2:
        return way
    steps = np.hypot(*np.diff(way, axis=0).T)
    count = int(np.searchsorted(np.cumsum(steps), length)) + 1
    part: Float = way[:count]
    return part
