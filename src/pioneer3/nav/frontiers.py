"""Where a map ends: places from which a robot sees what is unknown."""

from dataclasses import dataclass
from math import atan2, ceil, inf

import numpy as np
from scipy import ndimage

from pioneer3.arrays import Bool, Float, Int, UInt8
from pioneer3.geometry import Pose2
from pioneer3.jit import fast
from pioneer3.maps import OccupancyGrid
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.fields import ways_from

SHORTEST_FRONTIER = 0.4
"""Length below which a frontier is a gap between beams [m]."""
WALL_DEPTH = 0.15
"""Distance to a wall within which the unknown is the wall itself [m]: few beams graze along it."""
VIEW_DISTANCE = 2.0
"""Distance from which a frontier is looked at [m]."""
VIEWS_APART = 0.1
"""Distance between two places to look from [m]."""
FRONTIER_WORTH = 1.0
"""Way that a metre more of frontier is worth [m]."""
FRONTIER_LENGTH = 6.0
"""Length above which a frontier is worth no more [m]."""
IGNORED_RADIUS = 0.5
"""Radius around a place in which nothing is looked for [m]."""
NOWHERE: Float = np.empty((0, 2))
BEGIN_RADIUS = 0.5
"""Distance within which a robot begins that is nearer to walls than it can turn [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frontier:
    """An edge between what is free and what is unknown.

    Attributes:
        points: The middles of its cells [m], shape (N, 2).
        view: Where the robot looks at it from, and its heading there [m, rad].
        end: The part of it that the robot looks at [m], shape (2,).
        way: To that place [m].
    """

    points: Float
    length: float
    view: Pose2
    end: Float
    way: float

    @property
    def cost(self) -> float:
        """The way, less what a long frontier is worth [m]."""
        return self.way - FRONTIER_WORTH * min(self.length, FRONTIER_LENGTH)


def find_frontiers(
    grid: OccupancyGrid,
    robot_in_map: Pose2,
    radius: float,
    passes: float | None = None,
    without: Float = NOWHERE,
) -> tuple[Frontier, ...]:
    """Return the frontiers that a robot can get to see, the most worth while first.

    Args:
        grid: What is known; not turned.
        robot_in_map: Where the robot is.
        radius: Of its turning circle [m]: it looks at frontiers from where it can turn.
        passes: It gets through where walls are farther than this from its middle [m]; if not
            given, where it can turn.
        without: Places where nothing is looked for [m], shape (N, 2).
    """
    states = np.pad(grid.states, 1, constant_values=UNKNOWN)
    corner = np.array([grid.origin.x, grid.origin.y]) - grid.resolution
    cell = grid.resolution
    clear = ndimage.distance_transform_edt(states != OCCUPIED)
    unknown = (states == UNKNOWN) & (clear > WALL_DEPTH / cell)
    edge = (states == FREE) & ndimage.binary_dilation(unknown)
    _leave_out(edge, (without - corner) / cell, IGNORED_RADIUS / cell)
    labels, count = ndimage.label(edge, structure=np.ones((3, 3)))
    at = (np.array([robot_in_map.x, robot_in_map.y]) - corner) / cell
    passable = (states == FREE) & (clear > (radius if passes is None else passes) / cell)
    ways = _ways(passable, at, (radius + BEGIN_RADIUS) / cell)
    if not count or ways is None:
        return ()
    off, nearest = ndimage.distance_transform_edt(~edge, return_indices=True)
    every = max(1, round(VIEWS_APART / cell))
    views = np.isfinite(ways) & (clear > radius / cell) & (off <= VIEW_DISTANCE / cell)
    near = np.argwhere(views[::every, ::every]) * every
    rows, columns = near.T
    ends = nearest[:, rows, columns].T
    owner = labels[ends[:, 0], ends[:, 1]]
    cost = ways[rows, columns] + off[rows, columns]
    found = []
    for label, cells in enumerate(ndimage.find_objects(labels), start=1):
        member = np.argwhere(labels[cells] == label) + np.array([cells[0].start, cells[1].start])
        length = _extent(member) * cell
        if length < SHORTEST_FRONTIER:
            continue
        mine = np.flatnonzero(owner == label)
        chosen = _first_in_sight(states, near[mine], ends[mine], cost[mine])
        if chosen is None:
            continue
        at, end = near[mine[chosen]], ends[mine[chosen]]
        place = corner + (at[::-1] + 0.5) * cell
        heading = atan2(float(end[0] - at[0]), float(end[1] - at[1]))
        found.append(
            Frontier(
                points=corner + (member[:, ::-1] + 0.5) * cell,
                length=length,
                view=Pose2(float(place[0]), float(place[1]), heading),
                end=corner + (end[::-1] + 0.5) * cell,
                way=float(ways[at[0], at[1]]) * cell,
            )
        )
    return tuple(sorted(found, key=lambda frontier: frontier.cost))


def _leave_out(edge: Bool, places: Float, radius: float) -> None:
    """Take the cells around places [cells] out of an edge."""
    cells = np.argwhere(edge)
    for x, y in places.tolist():
        near = np.hypot(cells[:, 1] + 0.5 - x, cells[:, 0] + 0.5 - y) < radius
        edge[cells[near, 0], cells[near, 1]] = False


def _ways(passable: Bool, at: Float, begin: float) -> Float | None:
    """Return the ways from a place to all cells that a robot gets to, `None` if it is at none.

    It can be at cells that are `passable` (H, W), at none of the edges. The nearest of these may be
    farther than the place by `begin` [cells].
    """
    cells = np.argwhere(passable)
    if not len(cells):
        return None
    away = np.hypot(cells[:, 1] + 0.5 - at[0], cells[:, 0] + 0.5 - at[1])
    nearest = int(away.argmin())
    if away[nearest] > begin:
        return None
    size, width = passable.size, passable.shape[1]
    start = int(cells[nearest, 0]) * width + int(cells[nearest, 1])
    out = np.full(size, inf)
    queue, queued = np.empty(size, dtype=np.int64), np.zeros(size, dtype=np.bool_)
    fast(ways_from, CACHE)(passable, start, queue, queued, out)
    return out.reshape(passable.shape)


def _extent(cells: Int) -> float:
    """Return the diagonal of the box around cells [cells]."""
    sides = cells.max(axis=0) - cells.min(axis=0) + 1
    return float(np.hypot(*sides))


def _first_in_sight(states: UInt8, places: Int, ends: Int, cost: Float) -> int | None:
    """Return the number of the cheapest place that sees its end, if there is one."""
    for number in np.argsort(cost)[:200].tolist():
        steps = ceil(2 * float(np.abs(ends[number] - places[number]).max())) + 1
        share = np.linspace(0.0, 1.0, steps)[:, None]
        line = np.rint(places[number] + share * (ends[number] - places[number])).astype(np.int64)
        if not (states[line[:, 0], line[:, 1]] == OCCUPIED).any():
            return int(number)
    return None
