"""The floor that is left for robots of one size: around a place, or anywhere inside a map."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel
from pioneer3.sim.maps import Bounds, LineMap
from pioneer3.sim.maps.distance import distances
from pioneer3.sim.population.footprint import hits, inside
from pioneer3.sim.worldfile.reach import MARGIN, Floor

Float = NDArray[np.float64]
Bool = NDArray[np.bool_]


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
