"""Free space: the cells that a disc can stand on, and places for robots of one size in them."""

from collections.abc import Iterable, Sequence
from math import ceil, floor, sqrt
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel
from pioneer3.sim.maps import Bounds, LineMap
from pioneer3.sim.maps.grid import samples
from pioneer3.sim.maps.line_map import distances
from pioneer3.sim.placement.footprint import hits, inside, which_inside

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]

CELL = 0.1
"""Side of a cell [m]; larger in huge maps."""
MOST_CELLS = 400_000
MARGIN = 1.0
"""Width of the free floor around the map [m]: robots may drive around a map without outer walls."""


class Floor:
    """The cells of a map that a disc can stand on.

    Args:
        walls: Segments [m], shape (W, 4).
        bounds: Of all places to ask for [m].
        radius: Of the disc [m]. It counts as half a cell less, so that no gap is missed by
            rounding, but never so little that it slips through walls.
        solids: Convex polygons that are no floor: the sides of each [m], shape (S, 4).
    """

    def __init__(
        self, walls: Float, bounds: Bounds, radius: float, solids: Sequence[Float] = ()
    ) -> None:
        self._low = np.array([bounds.x_min - MARGIN, bounds.y_min - MARGIN])
        extent = np.array([bounds.x_max + MARGIN, bounds.y_max + MARGIN]) - self._low
        self.cell = max(CELL, sqrt(float(extent.prod()) / MOST_CELLS), float(extent.max()) / 1e5)
        self._shape = (ceil(extent[1] / self.cell) + 1, ceil(extent[0] / self.cell) + 1)
        self._free = self._clear(walls, max(radius - self.cell / 2, 0.8 * self.cell))
        for solid in solids:
            self._block(solid)

    def reached_from(self, starts: list[tuple[float, float]]) -> Bool:
        """Return the cells that can be reached from any of `starts` [m], shape (H, W)."""
        width = self._shape[1]
        free = bytearray(np.pad(self._free, ((1, 1), (0, 1))).astype(np.uint8).tobytes())
        # one blocked column at the right and a blocked row above and below: no cell wraps around
        stride = width + 1
        todo = [(row + 1) * stride + column for row, column in map(self.cell_of, starts)]
        seen = np.zeros(len(free), dtype=np.bool_)
        found = bytearray(len(free))
        while todo:
            at = todo.pop()
            if free[at]:
                free[at] = 0
                found[at] = 1
                todo += (at - 1, at + 1, at - stride, at + stride)
        seen[:] = np.frombuffer(found, dtype=np.uint8)
        return seen.reshape(-1, stride)[1:-1, :-1]

    @property
    def free(self) -> Bool:
        """The cells that the disc can stand on, reachable or not, shape (H, W)."""
        return self._free

    def centres(self, cells: Bool) -> Float:
        """Return the middles of the marked `cells` [m], shape (N, 2)."""
        rows, columns = np.nonzero(cells)
        middles: Float = (np.stack([columns, rows], axis=1) + 0.5) * self.cell + self._low
        return middles

    def is_free(self, x: float, y: float) -> bool:
        """Whether the disc can stand at (`x`, `y`) [m]."""
        return bool(self._free[self.cell_of((x, y))])

    def are_free(self, points: Float) -> Bool:
        """Return whether the disc can stand at each of `points` [m], shape (N, 2)."""
        columns, rows = np.floor((points - self._low) / self.cell).astype(np.int64).T
        height, width = self._shape
        free: Bool = self._free[rows.clip(0, height - 1), columns.clip(0, width - 1)]
        return free

    def cell_of(self, point: tuple[float, float]) -> tuple[int, int]:
        """Return row and column of a point [m], of the nearest cell for those outside."""
        column = floor((point[0] - self._low[0]) / self.cell)
        row = floor((point[1] - self._low[1]) / self.cell)
        return min(max(row, 0), self._shape[0] - 1), min(max(column, 0), self._shape[1] - 1)

    def _block(self, solid: Float) -> None:
        x, y = solid[:, ::2], solid[:, 1::2]
        low = self.cell_of((float(x.min()), float(y.min())))
        high = self.cell_of((float(x.max()), float(y.max())))
        there = np.zeros_like(self._free)
        there[low[0] : high[0] + 1, low[1] : high[1] + 1] = True
        middles = self.centres(there)
        self._free[there] &= ~which_inside(solid, middles[:, 0], middles[:, 1])

    def _clear(self, walls: Float, radius: float) -> Bool:
        """Return the cells whose middle is further than `radius` [m] from all walls."""
        marked = np.zeros(self._shape, dtype=np.bool_)
        columns, rows = (
            np.floor((samples(walls, self.cell / 2) - self._low) / self.cell).astype(np.int64).T
        )
        inside = (columns >= 0) & (columns < self._shape[1]) & (rows >= 0) & (rows < self._shape[0])
        marked[rows[inside], columns[inside]] = True
        reach = floor(radius / self.cell)
        padded = np.pad(marked, reach)
        blocked = marked.copy()
        height, width = self._shape
        for dy in range(-reach, reach + 1):
            for dx in range(-reach, reach + 1):
                if (dx * dx + dy * dy) * self.cell**2 <= radius**2:
                    y, x = reach + dy, reach + dx
                    blocked |= padded[y : y + height, x : x + width]
        return ~blocked


class Circle(NamedTuple):
    """The floor that a robot needs [m]."""

    x: float
    y: float
    radius: float


class Ground(NamedTuple):
    """What robots cannot stand on.

    Attributes:
        barriers: Walls and sides: segments [m], shape (S, 4).
        solids: Convex polygons: the sides of each [m], shape (S, 4).
    """

    barriers: Float
    solids: Sequence[Float]

    @classmethod
    def of(cls, line_map: LineMap, obstacles: Sequence[Float] = ()) -> Self:
        """Return the walls and boxes of a map, and `obstacles` that are solid."""
        boxes = [np.array(o.sides) for o in line_map.objects if o.solid and len(o.sides) > 2]
        return cls(np.concatenate([line_map.walls, *obstacles]), [*obstacles, *boxes])

    def blocks(self, model: RobotModel, pose: Pose2) -> bool:
        """Whether `model` cannot stand at `pose`."""
        if hits(model, pose, self.barriers):
            return True
        return any(inside(solid, pose.x, pose.y) for solid in self.solids)

    def clears(self, x: float, y: float, radius: float) -> bool:
        """Whether a circle [m] touches nothing."""
        if any(inside(solid, x, y) for solid in self.solids):
            return False
        away = distances(np.array([x, y]), self.barriers)
        return float(away.min(initial=np.inf)) >= radius


class Room:
    """Places for robots that need a circle of one radius.

    Attributes:
        centres: Of the places [m], shape (N, 2).
        cell: Their distance [m].
        open: Which ones are left, shape (N,).
    """

    def __init__(self, floor: Floor, cells: Bool) -> None:
        self.centres = floor.centres(cells)
        self.cell = floor.cell
        self.open = np.ones(len(self.centres), dtype=np.bool_)
        self._floor = floor
        self._ways: dict[tuple[float, float], Bool] = {}

    def close(self, circles: Iterable[Circle]) -> None:
        """Close the places whose centres lie in one of `circles`."""
        for x, y, radius in circles:
            self.open &= np.hypot(self.centres[:, 0] - x, self.centres[:, 1] - y) >= radius

    def leads_on(self, heading: float, distance: float) -> Bool:
        """Return from which places the robot gets `distance` [m] on at `heading`, shape (N,)."""
        if (heading, distance) not in self._ways:
            way = np.ones(len(self.centres), dtype=np.bool_)
            along = np.array([np.cos(heading), np.sin(heading)])
            for gone in np.append(np.arange(self.cell, distance, self.cell), distance):
                way &= self._floor.are_free(self.centres + gone * along)
            self._ways[heading, distance] = way
        return self._ways[heading, distance]

    def nearest_first(self, x: float, y: float, among: Bool | None = None) -> list[int]:
        """Return the open places, those `among` which to look, the nearest to (x, y) [m] first."""
        there = np.flatnonzero(self.open if among is None else self.open & among)
        away = np.hypot(self.centres[there, 0] - x, self.centres[there, 1] - y)
        order: list[int] = there[np.argsort(away, kind="stable")].tolist()
        return order


def room_around(line_map: LineMap, ground: Ground, radius: float, origin: Pose2) -> Room:
    """Return the places in reach of `origin`, or of the free place nearest to it.

    Args:
        line_map: For its bounds.
        ground: All that stands there.
        radius: Of the circle that a robot needs [m].
        origin: From where.
    """
    b = line_map.bounds
    x, y = origin.x, origin.y
    bounds = Bounds(min(b.x_min, x), min(b.y_min, y), max(b.x_max, x), max(b.y_max, y))
    floor = Floor(ground.barriers, bounds, radius, ground.solids)
    free = floor.centres(floor.free)
    if not len(free):
        return Room(floor, floor.free)
    nearest = np.hypot(free[:, 0] - x, free[:, 1] - y).argmin()
    return Room(floor, floor.reached_from([(free[nearest, 0], free[nearest, 1])]))


def room_inside(line_map: LineMap, ground: Ground, radius: float) -> Room:
    """Return the places that robots are meant for: within the walls, in reach of a home.

    Where the map has no homes, other places say what is in reach; without any, what the walls
    enclose is, unless that is little. Arguments as for :func:`room_around`.
    """
    bounds = line_map.bounds
    floor = Floor(ground.barriers, bounds, radius, ground.solids)
    within = np.zeros_like(floor.free)
    low, high = floor.cell_of(bounds[:2]), floor.cell_of(bounds[2:])
    within[low[0] : high[0] + 1, low[1] : high[1] + 1] = True
    within &= floor.free
    homes = [(home.x, home.y) for home in line_map.starts]
    places = [(item.pose.x, item.pose.y) for item in line_map.objects if not item.outline]
    meant = floor.reached_from(homes or places) & within
    if meant.any():
        return Room(floor, meant)
    outside = floor.reached_from([(bounds.x_min - MARGIN, bounds.y_min - MARGIN)])
    enclosed = within & ~outside
    return Room(floor, enclosed if 2 * enclosed.sum() > within.sum() else within)


def room_on_a_plane(ground: Ground, radius: float, origin: Pose2, far: float) -> Room:
    """Return the places up to `far` [m] from `origin` where there are no walls."""
    x, y = origin.x, origin.y
    bounds = Bounds(x - far, y - far, x + far, y + far)
    floor = Floor(ground.barriers, bounds, radius, ground.solids)
    return Room(floor, floor.free)
