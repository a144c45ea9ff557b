"""Ways to a goal: the cheapest one from everywhere, and the one from a place as points."""

from dataclasses import dataclass
from math import ceil, cos, inf, isfinite, sin
from typing import Self

import numpy as np

from pioneer3.arrays import Bool, Float, Float32
from pioneer3.jit import fast
from pioneer3.maps.line_map import MapObject
from pioneer3.nav.costs import CostMap, inside
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.fields import march
from pioneer3.nav.kernels.ways import descend
from pioneer3.nav.raster import Raster, sparse

GET_OUT_WAY = 0.8
"""Way from its start through places where the robot does not fit at most [m]."""
BACKWARDS = 0.2
"""Way against a one-way sector that does not count [m]."""
WAY_STEP = 0.5
"""Distance of the points of a way [cells]."""
MOST_BUCKETS = 10_000
"""Buckets of cells that wait for the cost of their way at most."""


@dataclass(frozen=True, slots=True, eq=False)
class CostToGo:
    """The cost of the cheapest way to a goal at `x`, `y` [m].

    The values are [m in the open], shape (H, W); `inf` where no way leads to the goal.
    """

    raster: Raster
    values: Float32
    x: float
    y: float

    @classmethod
    def of(cls, costs: Float32, raster: Raster, x: float, y: float) -> Self | None:
        """Return the costs to a goal, or `None` if that is outside of the raster."""
        cell = raster.cell_of(x, y)
        return None if cell is None else cls(raster, _cheapest(costs, *cell), x, y)

    def at(self, x: float, y: float) -> float:
        """Return the cost from a place [m]; `inf` without a way."""
        cell = self.raster.cell_of(x, y)
        return float(self.values[cell]) if cell else inf


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """A way to a goal.

    Attributes:
        points: From start to goal [m] in the map's frame, shape (N, 2), N at least 2.
        to_go: Way that is left at each point [m], shape (N,).
    """

    points: Float
    to_go: Float
    cost_to_go: CostToGo

    @property
    def length(self) -> float:
        """[m]."""
        return float(self.to_go[0])

    def rest_from(self, x: float, y: float) -> "Way":
        """Return the rest of the way for a robot at a place [m] on it, or beside it."""
        nearest = int(np.hypot(self.points[:, 0] - x, self.points[:, 1] - y).argmin())
        first = min(nearest, len(self.points) - 2)
        return Way(self.points[first:], self.to_go[first:], self.cost_to_go)


@dataclass(frozen=True, slots=True)
class NoWay:
    """There is no way; `why` is for people.

    Attributes:
        where: The place that closes the way [m], if it is one.
        free: The way that there would be without things that are not on the map, if they close it.
    """

    why: str
    where: tuple[float, float] | None = None
    free: Way | None = None


def plan(costs: CostMap, start: tuple[float, float], goal: tuple[float, float]) -> Way | NoWay:
    """Return the cheapest way for the robot of `costs`, with all that is known besides the map.

    It may `start` where it does not fit, and gets out.
    """
    raster = costs.raster
    if raster.cell_of(*goal) is None:
        return NoWay("the goal is outside of the map")
    if raster.cell_of(*start) is None:
        return NoWay("the robot is outside of the map")
    if not costs.can_turn(*goal):
        return NoWay(_why_not(costs, goal), goal)
    way, shut = _heeding_sectors(costs, start, goal)
    if way is None:
        name = f", {shut.name}" if shut and shut.name else ""
        return NoWay(f"no way leads to the goal but {_TOLD[shut.kind]}{name}" if shut else _NONE)
    beyond = way.length - way.to_go > GET_OUT_WAY
    tight = beyond & ~_fits(costs, way.points)
    if tight.any():
        x, y = way.points[int(tight.argmax())]
        return NoWay("the way is too narrow for this robot", (float(x), float(y)))
    return way


_NONE = "no way leads to the goal"
_TOLD = {
    "OneWaySector": "against a one-way sector",
    "RestrictiveSector": "through a restrictive sector",
}


def _heeding_sectors(
    costs: CostMap, start: tuple[float, float], goal: tuple[float, float]
) -> tuple[Way | None, MapObject | None]:
    """Return the cheapest way that crosses no sector as it must not, and the last one closed."""
    barred: list[MapObject] = []
    while True:
        way = _cheapest_way(costs, start, goal)
        against = next((area for area in costs.sectors if _goes_against(area, way)), None)
        if against is None:
            return way, barred[-1] if barred else None
        if against.one_way and against not in barred:
            begins_in = bool(against.covers(*np.array(start)))
            costs = costs.with_barrier(against, at_entry=begins_in)
        else:
            costs = costs.without(against)
        barred.append(against)


def _cheapest_way(
    costs: CostMap, start: tuple[float, float], goal: tuple[float, float]
) -> Way | None:
    """Return the cheapest way, if there is one."""
    cost_to_go = CostToGo.of(costs.costs(), costs.raster, *goal)
    assert cost_to_go is not None
    return way_from(cost_to_go, start) if isfinite(cost_to_go.at(*start)) else None


def _goes_against(area: MapObject, way: Way | None) -> bool:
    """Whether a way crosses a sector as it must not."""
    if way is None:
        return False
    within = area.covers(*way.points.T)
    if area.restrictive:
        return bool(within.any() and not (within[0] or within[-1]))
    both = within[1:] & within[:-1]
    ahead = np.diff(way.points, axis=0) @ (cos(area.pose.theta), sin(area.pose.theta))
    return bool(ahead[both].clip(max=0.0).sum() < -BACKWARDS)


def way_from(cost_to_go: CostToGo, start: tuple[float, float]) -> Way | None:
    """Return the way down from a place, or `None` if it leads nowhere."""
    raster = cost_to_go.raster
    # a metre costs no less than one in the open, and ways down bend less than twice
    points = np.empty((ceil(2 * cost_to_go.at(*start) / (WAY_STEP * raster.cell)) + 100, 2))
    begin, goal = raster.in_cells(np.array([start, (cost_to_go.x, cost_to_go.y)]))
    count = fast(descend, CACHE)(cost_to_go.values, begin, goal, WAY_STEP, points)
    if count < 2:
        return None
    way = points[:count] * raster.cell + (raster.x, raster.y)
    steps = np.hypot(*np.diff(way, axis=0).T)
    to_go = np.append(np.cumsum(steps[::-1])[::-1], 0.0)
    return Way(way, to_go, cost_to_go)


def _cheapest(costs: Float32, row: int, column: int) -> Float32:
    """Return the cost of the cheapest way from each cell to one of them; shapes (H, W).

    Those at the edges have none.
    """
    costs[:, [0, -1]] = costs[[0, -1]] = np.inf
    values, (height, width), low = np.full_like(costs, np.inf), costs.shape, float(costs.min())
    if not (0 < row < height - 1 and 0 < column < width - 1):
        return values
    high = float(costs.max(where=costs < inf, initial=0.0)) or 1.0
    depth = max(min(low, high), high / MOST_BUCKETS)
    first = np.full(int(high / depth) + 3, -1, dtype=np.int32)
    after, goal = sparse((costs.size,), np.int32), row * width + column
    fast(march, CACHE)(costs.ravel(), goal, width, depth, first, after, values.ravel())
    return values


def _fits(costs: CostMap, points: Float) -> Bool:
    """Return whether the robot fits at each of `points` (N, 2) [m], less half a cell."""
    rows, columns, _ = costs.raster.cells_of(points)
    enough = costs.clearance[rows, columns] >= costs.needed - costs.raster.cell / 2
    fits: Bool = enough & ~costs.closed[rows, columns]
    return fits


def _why_not(costs: CostMap, goal: tuple[float, float]) -> str:
    cell = costs.raster.cell_of(*goal)
    assert cell is not None
    area = next((item for item in costs.forbidden if inside(item, costs.raster)[cell]), None)
    if area is not None:
        return f"the goal is in a forbidden area{f', {area.name}' if area.name else ''}"
    if costs.closed[cell]:
        return "nothing is known of the place of the goal"
    room = float(costs.clearance[cell])
    return f"the goal is {room:.2f} m from something, and the robot needs {costs.turning:.2f} m"
