"""The cost of driving over each place of a map, for one robot."""

from dataclasses import dataclass, replace
from itertools import product
from math import cos, inf, sin
from typing import Self

import numpy as np

from pioneer3.arrays import Bool, Float, Float32
from pioneer3.jit import fast
from pioneer3.maps import Extent, LineMap
from pioneer3.maps.line_map import FREE, UNKNOWN, MapObject
from pioneer3.models import RobotModel
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.fields import nearest_wall
from pioneer3.nav.particles import points_by
from pioneer3.nav.raster import Raster
from pioneer3.nav.settings import AS_SHIPPED, PlannerSettings

COST_CELL = 0.05
"""Side of a cell [m]."""
FINE_COSTS = 4_000_000
"""Cells above which they are made twice as large: 100 by 100 m; each plan works on them."""
SQUEEZE_COST = 60.0
"""Cost of a metre where the robot does not fit [m in the open]: it may get out of there."""
PEOPLE_COST = 3.0
"""Cost of a metre on the lines on which people come, besides that of the open [m in the open]: as
much as that of a place along a wall, as in a corridor that is left to them."""
PEOPLE_FADE = 0.1
"""Distance over which this cost falls to nothing where they pass beside the robot [m]."""
PASSING_DISTANCE = 0.25 + 0.15
"""Distance from the middle of somebody who passes to the robot's side [m]."""
BARRIER = 2.0
"""Thickness of the edge of a one-way sector that is closed [cells]."""
LEAST_CLEARANCE = 0.08
"""Clearance below which no place is worth leaving from [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CostMap:
    """Costs for the centre of one robot.

    Attributes:
        clearance: Distance to the nearest wall, forbidden line or obstacle [m], up to `reach`,
            shape (H, W).
        closed: Where the robot must not be, whatever its clearance: in forbidden areas, outside of
            all that is known, shape (H, W).
        sectors: Areas that they may cross one way, or may enter for a goal in them alone.
        busy: Share of `PEOPLE_COST` that each place costs, as people come there, shape (H, W), or
            `None`.
        speeds: Highest speed that is wanted [m/s], `inf` where any is, shape (H, W).
        needed: The clearance that the robot needs to pass [m].
        turning: The clearance that it needs to turn to any heading [m].
        top_speed: Of the robot [m/s].
    """

    raster: Raster
    clearance: Float32
    closed: Bool
    forbidden: tuple[MapObject, ...]
    sectors: tuple[MapObject, ...]
    speeds: Float32
    needed: float
    turning: float
    top_speed: float
    settings: PlannerSettings
    busy: Float32 | None = None

    @classmethod
    def of(
        cls,
        line_map: LineMap,
        model: RobotModel,
        settings: PlannerSettings = AS_SHIPPED.planner,
        cell: float = COST_CELL,
    ) -> Self:
        """Return the costs of a map for a robot.

        A robot is as wide as it is: it turns towards its way before a narrow place.
        """
        raster = Raster.around(_extent(line_map), cell, 2 * cell, FINE_COSTS)
        needed = settings.margin + min(model.width / 2, model.length_front, model.length_rear)
        reach = max(needed, model.corner) + settings.comfort
        clearance = np.full(raster.shape, reach, dtype=np.float32)
        lines = [side for item in line_map.objects if item.forbidden for side in item.sides]
        walls = np.concatenate([line_map.walls, np.array(lines).reshape(-1, 4)])
        fast(nearest_wall, CACHE)(walls, (*raster.edges, reach), 0.0, clearance)
        closed = _unknown(line_map, raster)
        closed[:, [0, -1]] = closed[[0, -1]] = True
        speeds = np.broadcast_to(np.float32(np.inf), raster.shape)  # takes no memory
        for item in line_map.objects:
            if len(item.outline) > 2 and (item.forbidden or item.solid):
                closed |= inside(item, raster)
            if item.speed is not None:
                within = inside(item, raster)
                speeds = np.where(within, np.minimum(speeds, np.float32(item.speed)), speeds)
        return cls(
            raster=raster,
            clearance=clearance,
            closed=closed,
            forbidden=tuple(o for o in line_map.objects if o.forbidden and len(o.outline) > 2),
            sectors=tuple(o for o in line_map.objects if o.one_way or o.restrictive),
            speeds=speeds,
            needed=needed,
            turning=model.corner + settings.turning_margin,
            top_speed=model.max_speed,
            settings=settings,
        )

    def with_barrier(self, area: MapObject, *, at_entry: bool) -> Self:
        """Return the costs with a one-way sector that nobody enters, or leaves, the wrong way."""
        rows, columns = np.nonzero(inside(area, self.raster))
        if not len(rows):
            return self
        ahead = columns * cos(area.pose.theta) + rows * sin(area.pose.theta)
        edge = ahead <= ahead.min() + BARRIER if at_entry else ahead >= ahead.max() - BARRIER
        closed = self.closed.copy()
        closed[rows[edge], columns[edge]] = True
        return replace(self, closed=closed)

    def without(self, area: MapObject) -> Self:
        """Return the costs with a sector that is closed."""
        sectors = tuple(each for each in self.sectors if each is not area)
        return replace(self, closed=self.closed | inside(area, self.raster), sectors=sectors)

    def with_obstacles(self, points: Float) -> Self:
        """Return the costs with obstacles that are not on the map, at `points` (N, 2) [m]."""
        if not len(points):
            return self
        clearance = self.clearance.copy()
        # its largest value is the reach: all cells that an obstacle may lower
        frame = *self.raster.edges, float(clearance.max())
        fast(nearest_wall, CACHE)(np.tile(points, 2), frame, 0.0, clearance)
        return replace(self, clearance=clearance)

    def with_lines(self, lines: Float) -> Self:
        """Return the costs with lines on which people come, (L, 4) [m]: best left to them."""
        if not len(lines):
            return self
        apart = np.float32(self.needed - self.settings.margin + PASSING_DISTANCE)
        away = np.full(self.raster.shape, apart, dtype=np.float32)
        fast(nearest_wall, CACHE)(lines, (*self.raster.edges, float(apart)), 0.0, away)
        return replace(self, busy=np.clip((apart - away) / np.float32(PEOPLE_FADE), 0, 1))

    def speed_at(self, x: float, y: float) -> float:
        """Return the highest speed that is wanted at a place [m/s]; `inf` where any is."""
        cell = self.raster.cell_of(x, y)
        return float(self.speeds[cell]) if cell else inf

    def costs(self) -> Float32:
        """Return the cost of crossing each cell from side to side [m in the open], shape (H, W)."""
        costs = np.empty(self.raster.shape, dtype=np.float32)
        for rows in self.raster.strips:
            clearance = self.clearance[rows]
            room = (clearance - np.float32(self.needed)) / np.float32(self.settings.comfort)
            tight = np.clip(1 - room, 0, 1)
            factors = 1 + np.float32(self.settings.narrow_cost) * tight * tight
            factors *= np.maximum(1, np.float32(self.top_speed) / self.speeds[rows])
            if self.busy is not None:
                factors += np.float32(PEOPLE_COST) * self.busy[rows]
            factors[room < 0] = SQUEEZE_COST
            factors[self.closed[rows] | (clearance < LEAST_CLEARANCE)] = np.inf
            costs[rows] = factors * np.float32(self.raster.cell)
        return costs

    def clearance_at(self, points: Float) -> Float32:
        """Return the clearance at each of `points` (N, 2) [m] of the map, shape (N,)."""
        rows, columns, _ = self.raster.cells_of(points)
        there: Float32 = self.clearance[rows, columns]
        return there

    def can_turn(self, x: float, y: float) -> bool:
        """Whether the robot can turn to any heading at a place [m]."""
        cell = self.raster.cell_of(x, y)
        if cell is None or self.closed[cell]:
            return False
        return bool(self.clearance[cell] >= self.turning)


def inside(item: MapObject, raster: Raster) -> Bool:
    """Return the cells whose middles lie within an area, shape (H, W)."""
    out = np.zeros(raster.shape, dtype=np.bool_)
    corners = np.array(item.outline)
    middle_x, middle_y = corners.mean(axis=0).tolist()
    rows, columns = raster.window(middle_x, middle_y, np.ptp(corners, axis=0).max() / 2)
    out[rows, columns] = item.covers(*raster.middles(rows, columns))
    return out


def _extent(line_map: LineMap) -> Extent:
    """Return the box around the walls and the known parts of grids that know what is free."""
    parts = [line_map.walls.reshape(-1, 2)]
    for grid in line_map.grids:
        rows, columns = np.nonzero(grid.states == FREE)
        if len(rows):
            sides = (columns.min(), columns.max() + 1), (rows.min(), rows.max() + 1)
            corners = grid.resolution * np.array(list(product(*sides)))
            parts.append(points_by(grid.origin, corners))
    corners = np.concatenate(parts)
    if not len(corners):
        return line_map.bounds
    return Extent(*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist())


def _unknown(line_map: LineMap, raster: Raster) -> Bool:
    """Return the cells of which no grid knows that they are free, shape (H, W).

    A map that draws walls alone, or grids without free cells, knows nothing of that.
    """
    grids = [grid for grid in line_map.grids if (grid.states == FREE).any()]
    unknown = np.full(raster.shape, bool(grids))
    for strip in raster.strips:
        x, y = raster.middles(strip, slice(None))
        for grid in grids:
            unknown[strip] &= grid.states_at(x, y) == UNKNOWN
    return unknown
