"""Free space: the cells where a disc fits, and the places for robots of one size among them."""

from collections.abc import Iterable, Sequence
from math import ceil, floor, sqrt
from typing import NamedTuple, Self

import numpy as np

from pioneer3.arrays import Bool, Float
from pioneer3.geometry import Pose2
from pioneer3.maps import Extent, LineMap
from pioneer3.maps.grid import samples
from pioneer3.maps.line_map import distances, which_inside
from pioneer3.models import RobotModel
from pioneer3.sim.collision import hits, inside

CELL = 0.1
"""Side of a cell [m]; larger in huge maps."""
MOST_CELLS = 400_000
MARGIN = 1.0
"""Width of the free space around the map [m]: robots may drive around a map without outer walls."""


class FreeGrid:
    """The cells of a map where a disc fits.

    Half a cell is subtracted from its radius [m], so that no gap is missed by rounding, but so much
    remains that the disc does not pass through walls. `solids` are convex polygons that are not
    free: the sides of each [m], shape (S, 4).

    Attributes:
        free: The cells where the disc fits, reachable or not, shape (H, W).
    """

    def __init__(
        self, walls: Float, bounds: Extent, radius: float, solids: Sequence[Float] = ()
    ) -> None:
        self._low = np.array([bounds.x_min - MARGIN, bounds.y_min - MARGIN])
        extent = np.array([bounds.x_max + MARGIN, bounds.y_max + MARGIN]) - self._low
        self.cell = max(CELL, sqrt(float(extent.prod()) / MOST_CELLS), float(extent.max()) / 1e5)
        self._shape = (ceil(extent[1] / self.cell) + 1, ceil(extent[0] / self.cell) + 1)
        self.free = self._clear(walls, max(radius - self.cell / 2, 0.8 * self.cell))
        for solid in solids:
            self._block(solid)

    def reached_from(self, starts: list[tuple[float, float]]) -> Bool:
        """Return the cells that can be reached from any of `starts` [m], shape (H, W)."""
        width = self._shape[1]
        free = bytearray(np.pad(self.free, ((1, 1), (0, 1))).astype(np.uint8).tobytes())
        # one blocked column at the right and a blocked row above and below: no cell wraps around
        stride = width + 1
        todo = [(row + 1) * stride + column for row, column in map(self.cell_of, starts)]
        found = bytearray(len(free))
        while todo:
            at = todo.pop()
            if free[at]:
                free[at] = 0
                found[at] = 1
                todo += (at - 1, at + 1, at - stride, at + stride)
        return np.frombuffer(found, dtype=np.bool_).reshape(-1, stride)[1:-1, :-1]

    def centres(self, cells: Bool) -> Float:
        """Return the middles of the marked `cells` [m], shape (N, 2)."""
        rows, columns = np.nonzero(cells)
        middles: Float = (np.stack([columns, rows], axis=1) + 0.5) * self.cell + self._low
        return middles

    def is_free(self, x: float, y: float) -> bool:
        """Whether the disc fits at (`x`, `y`) [m]."""
        return bool(self.free[self.cell_of((x, y))])

    def are_free(self, points: Float) -> Bool:
        """Return whether the disc fits at each of `points` [m], shape (N, 2)."""
        columns, rows = np.floor((points - self._low) / self.cell).astype(np.int64).T
        height, width = self._shape
        free: Bool = self.free[rows.clip(0, height - 1), columns.clip(0, width - 1)]
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
        there = np.zeros_like(self.free)
        there[low[0] : high[0] + 1, low[1] : high[1] + 1] = True
        middles = self.centres(there)
        self.free[there] &= ~which_inside(solid, middles[:, 0], middles[:, 1])

    def _clear(self, walls: Float, radius: float) -> Bool:
        """Return the cells whose middle is further than `radius` [m] from all walls."""
        marked = np.zeros(self._shape, dtype=np.bool_)
        points = samples(walls, self.cell / 2) - self._low
        columns, rows = np.floor(points / self.cell).astype(np.int64).T
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
    """The space that a robot needs to turn [m]."""

    x: float
    y: float
    radius: float


class Obstructions(NamedTuple):
    """Walls and solid obstacles, where robots cannot stand.

    Barriers are walls and sides: segments [m], shape (S, 4); solids are convex polygons: the sides
    of each, likewise.
    """

    barriers: Float
    solids: Sequence[Float]

    @classmethod
    def of(cls, line_map: LineMap, obstacles: Sequence[Float] = ()) -> Self:
        """Return the walls and boxes of a map, together with solid `obstacles`."""
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


class FreePlaces:
    """Places for robots that need a circle of one radius: centres (N, 2), a cell apart [m].

    Those that are still free are `open` (N,).
    """

    def __init__(self, grid: FreeGrid, cells: Bool) -> None:
        self.centres = grid.centres(cells)
        self.cell = grid.cell
        self.open = np.ones(len(self.centres), dtype=np.bool_)
        self._grid = grid
        self._ways: dict[tuple[float, float], Bool] = {}

    def close(self, circles: Iterable[Circle]) -> None:
        """Close the places whose centres lie in one of `circles`."""
        for x, y, radius in circles:
            self.open &= np.hypot(self.centres[:, 0] - x, self.centres[:, 1] - y) >= radius

    def has_way_ahead(self, heading: float, distance: float) -> Bool:
        """Return the places with a free way of `distance` [m] at `heading`, shape (N,)."""
        if (heading, distance) not in self._ways:
            way = np.ones(len(self.centres), dtype=np.bool_)
            along = np.array([np.cos(heading), np.sin(heading)])
            for gone in np.append(np.arange(self.cell, distance, self.cell), distance):
                way &= self._grid.are_free(self.centres + gone * along)
            self._ways[heading, distance] = way
        return self._ways[heading, distance]

    def nearest_first(self, x: float, y: float, among: Bool | None = None) -> list[int]:
        """Return the indices of the open places `among` these, the nearest to (x, y) [m] first."""
        there = np.flatnonzero(self.open if among is None else self.open & among)
        away = np.hypot(self.centres[there, 0] - x, self.centres[there, 1] - y)
        order: list[int] = there[np.argsort(away, kind="stable")].tolist()
        return order


def places_around(
    line_map: LineMap, obstructions: Obstructions, radius: float, origin: Pose2
) -> FreePlaces:
    """Return the places in reach of `origin`, or of the free place nearest to it.

    `radius` is that of the circle that a robot needs [m].
    """
    b = line_map.bounds
    x, y = origin.x, origin.y
    bounds = Extent(min(b.x_min, x), min(b.y_min, y), max(b.x_max, x), max(b.y_max, y))
    grid = FreeGrid(obstructions.barriers, bounds, radius, obstructions.solids)
    free = grid.centres(grid.free)
    if not len(free):
        return FreePlaces(grid, grid.free)
    nearest = np.hypot(free[:, 0] - x, free[:, 1] - y).argmin()
    return FreePlaces(grid, grid.reached_from([(free[nearest, 0], free[nearest, 1])]))


def places_inside(line_map: LineMap, obstructions: Obstructions, radius: float) -> FreePlaces:
    """Return the places within the walls that can be reached from a home.

    On a map without homes, from other places; without any, the places that walls enclose, unless
    these are few. Arguments as for :func:`places_around`.
    """
    bounds = line_map.bounds
    grid = FreeGrid(obstructions.barriers, bounds, radius, obstructions.solids)
    within = np.zeros_like(grid.free)
    low, high = grid.cell_of(bounds[:2]), grid.cell_of(bounds[2:])
    within[low[0] : high[0] + 1, low[1] : high[1] + 1] = True
    within &= grid.free
    homes = [(home.x, home.y) for home in line_map.starts]
    places = [(item.pose.x, item.pose.y) for item in line_map.objects if not item.outline]
    meant = grid.reached_from(homes or places) & within
    if meant.any():
        return FreePlaces(grid, meant)
    outside = grid.reached_from([(bounds.x_min - MARGIN, bounds.y_min - MARGIN)])
    enclosed = within & ~outside
    return FreePlaces(grid, enclosed if 2 * enclosed.sum() > within.sum() else within)


def places_on_plane(
    obstructions: Obstructions, radius: float, origin: Pose2, far: float
) -> FreePlaces:
    """Return the places up to `far` [m] from `origin` on a map without walls."""
    x, y = origin.x, origin.y
    bounds = Extent(x - far, y - far, x + far, y + far)
    grid = FreeGrid(obstructions.barriers, bounds, radius, obstructions.solids)
    return FreePlaces(grid, grid.free)
