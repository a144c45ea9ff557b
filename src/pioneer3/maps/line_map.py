"""A map: wall segments, named places and occupancy grids, in SI."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pioneer3.arrays import Bool, Float, UInt8
from pioneer3.geometry import Extent, Pose2
from pioneer3.maps.drawing import Layer, MapDrawing, Marker, bounds_of, to_svg
from pioneer3.maps.materials import BLACK, GLASS, REFLECTOR, Codes

States = UInt8
Numbers = NDArray[np.floating[Any]]
Role = Literal["goal", "dock", "home", "place", "line", "area"]

_SPEED = re.compile(r"\d+(\.\d*)?|\.\d+")

UNKNOWN = 0
"""State of a cell that nobody has seen."""
OCCUPIED = 1
"""State of a cell with a wall."""
FREE = 2
"""State of a cell with nothing in it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MapObject:
    """A named place, line or area of a map: ARIA calls it a cairn.

    Attributes:
        kind: ARIA's type name: `Goal`, `RobotHome`, `ForbiddenLine`, `Sim.BoxObstacle`...
        name: Often empty.
        pose: Pose in the map frame; meaningless for lines and areas.
        outline: Points `(x, y)` [m] in the map frame: none for a place, the two ends of a line,
            the four corners of an area in order.
        solid: Its outline is among the walls of the map: a box, a reflector.
        declared: The class of its type in a MapInfo: `GoalType`, `DockType`, `LocationType`...;
            empty for a type that needs none.
        turned_to: A MapInfo says that robots turn to its heading.
    """

    kind: str
    name: str
    pose: Pose2
    outline: tuple[tuple[float, float], ...] = ()
    solid: bool = False
    declared: str = ""
    turned_to: bool = False

    @property
    def role(self) -> Role:
        """Its purpose for people."""
        if self.outline:
            return "line" if len(self.outline) == 2 else "area"
        if self.kind in ("Goal", "GoalWithHeading") or self.declared == "GoalType":
            return "goal"
        if self.kind.startswith("Dock") or self.declared == "DockType":
            return "dock"
        return "home" if self.kind == "RobotHome" else "place"

    @property
    def heads(self) -> bool:
        """Whether the heading of its pose means anything."""
        return self.kind == "GoalWithHeading" or self.turned_to or self.role in ("dock", "home")

    @property
    def forbidden(self) -> bool:
        """Whether robots must not drive over it."""
        return bool(self.outline) and self.kind.startswith("Forbidden")

    @property
    def one_way(self) -> bool:
        """Whether planned ways lead over it only towards the heading of its pose."""
        return self.role == "area" and self.kind == "OneWaySector"

    @property
    def restrictive(self) -> bool:
        """Whether planned ways lead over it only to a goal, or from a start, within it."""
        return self.role == "area" and self.kind == "RestrictiveSector"

    @property
    def speed(self) -> float | None:
        """The highest speed that is wanted within it [m/s]: the name of a `SpeedArea` tells it."""
        if self.kind != "SpeedArea" or len(self.outline) < 3:
            return None
        found = _SPEED.search(self.name)
        return float(found[0]) if found and float(found[0]) > 0 else None

    @property
    def marker(self) -> Marker | None:
        """Its mark on a drawing: a dock, a goal or a home has one."""
        if self.kind.startswith("Dock"):
            return Marker(Layer.DOCK, self.pose, self.name, has_heading=True)
        if self.kind.startswith("Goal"):
            turned = self.kind == "GoalWithHeading"
            return Marker(Layer.GOAL, self.pose, self.name, has_heading=turned)
        if self.kind == "RobotHome":
            return Marker(Layer.HOME, self.pose, self.name, has_heading=True)
        return None

    @property
    def sides(self) -> tuple[tuple[float, float, float, float], ...]:
        """The segments `x0, y0, x1, y1` [m]: of a place none, of a line one, of an area four."""
        corners = self.outline
        after = corners[1:] + (corners[:1] if len(corners) > 2 else ())
        return tuple((*start, *end) for start, end in zip(corners, after, strict=False))

    def covers(self, x: Float, y: Float) -> Bool:
        """Return which of the points (x, y) [m] of the map lie within an area, shape (...)."""
        return which_inside(np.array(self.sides), x, y)


def sides_of(objects: Iterable[MapObject]) -> Float:
    """Return the sides of objects [m], shape (N, 4), in their order."""
    sides = [side for item in objects for side in item.sides]
    return np.array(sides, dtype=np.float64).reshape(-1, 4)


def solid_walls(objects: Iterable[MapObject]) -> Float:
    """Return the walls that solid objects stand for [m], shape (W, 4), in their order."""
    return sides_of(item for item in objects if item.solid)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OccupancyGrid:
    """Occupied, free and unknown cells; compares by identity.

    Attributes:
        states: `UNKNOWN`, `OCCUPIED` or `FREE`, shape (H, W); row 0 is the lowest.
        resolution: Side of a cell [m].
        origin: The lower left corner of the grid, and how it is turned, in the map frame.
    """

    states: States
    resolution: float
    origin: Pose2

    def states_at(self, x: Numbers, y: Numbers) -> States:
        """Return the states of the cells at places [m], of one shape; unknown outside the grid."""
        dx, dy = x - self.origin.x, y - self.origin.y
        c, s = np.cos(self.origin.theta), np.sin(self.origin.theta)
        column = np.floor((c * dx + s * dy) / self.resolution).astype(np.int64)
        row = np.floor((c * dy - s * dx) / self.resolution).astype(np.int64)
        height, width = self.states.shape
        within = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        found = np.full(within.shape, UNKNOWN, dtype=np.uint8)
        found[within] = self.states[row[within], column[within]]
        return found

    def coarser(self, most: int) -> "OccupancyGrid":
        """Return the grid with at most `most` cells, by joining squares of cells.

        A square with an occupied cell is occupied; any other with a free cell is free.
        """
        height, width = self.states.shape
        share = 1
        while -(-height // share) * -(-width // share) > most:
            share += 1
        if share == 1:
            return self
        padded = np.pad(self.states, ((0, -height % share), (0, -width % share)))
        rows, columns = (size // share for size in padded.shape)
        blocks = padded.reshape(rows, share, columns, share)
        states = np.full((rows, columns), UNKNOWN, dtype=np.uint8)
        for state in (FREE, OCCUPIED):
            states[(blocks == state).any(axis=(1, 3))] = state
        return OccupancyGrid(states=states, resolution=self.resolution * share, origin=self.origin)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LineMap:
    """Walls and places; compares by identity.

    Attributes:
        walls: Segments `x0, y0, x1, y1` [m], shape (W, 4), float64; a read-only copy is kept. The
            sides of solid objects are among them.
        homes: Poses a robot may start at, in file order.
        objects: Every cairn in file order, the homes and obstacles among them.
        grids: Occupancy grids; some of the walls outline their occupied cells.
        lines: The walls that outline no grid [m], shape (L, 4); without grids all walls.
        materials: Codes of the walls' materials, shape (W,); if not given, all are plain.
        file: The file that it was read from, or saved to; `None` if it ships, or has none.
    """

    name: str
    walls: Float
    homes: tuple[Pose2, ...] = ()
    objects: tuple[MapObject, ...] = ()
    grids: tuple[OccupancyGrid, ...] = ()
    lines: Float = field(default_factory=lambda: np.empty((0, 4)))
    materials: Codes = field(default_factory=lambda: np.empty(0, dtype=np.uint8))
    file: Path | None = None

    def __post_init__(self) -> None:
        """Keep read-only copies of the segments."""
        object.__setattr__(self, "walls", _frozen(self.walls))
        object.__setattr__(self, "lines", _frozen(self.lines) if self.grids else self.walls)
        if len(self.materials) != len(self.walls):
            plain = np.zeros(len(self.walls), dtype=np.uint8)
            object.__setattr__(self, "materials", plain)

    @property
    def starts(self) -> tuple[Pose2, ...]:
        """Poses at the start: the homes; without any the first dock, as in MobileSim."""
        docks = [item.pose for item in self.objects if item.role == "dock"]
        return self.homes or tuple(docks[:1])

    @property
    def bounds(self) -> Extent:
        """The smallest box around the walls [m]; all zeros where there are none."""
        if not self.walls.size:
            return Extent(0.0, 0.0, 0.0, 0.0)
        x, y = self.walls[:, ::2], self.walls[:, 1::2]
        return Extent(float(x.min()), float(y.min()), float(x.max()), float(y.max()))

    @property
    def drawing(self) -> MapDrawing:
        """The drawing of its walls and places."""
        lines = {
            Layer.WALL: self.walls,
            Layer.FORBIDDEN: sides_of(o for o in self.objects if o.kind.startswith("Forbidden")),
            Layer.BOX: sides_of(o for o in self.objects if o.solid),
            Layer.BLACK: self.walls[self.materials == BLACK],
            Layer.GLASS: self.walls[self.materials == GLASS],
            Layer.REFLECTOR: self.walls[self.materials == REFLECTOR],
        }
        markers = tuple(marker for item in self.objects if (marker := item.marker) is not None)
        bounds = bounds_of(lines.values(), markers)
        return MapDrawing(name=self.name, bounds=bounds, lines=lines, markers=markers)

    def _repr_html_(self) -> str:
        """Return the map as a notebook shows it."""
        return to_svg(self.drawing, on_page=False)


def _frozen(segments: Float) -> Float:
    if not segments.flags.writeable and segments.base is None and segments.shape[1:] == (4,):
        return segments
    copy = np.array(segments, dtype=np.float64).reshape(-1, 4)
    copy.setflags(write=False)
    return copy


def empty_map() -> LineMap:
    """Return a plane without walls, for `--nomap`."""
    return LineMap(name="empty", walls=np.empty((0, 4)))


def distances(point: Float, walls: Float) -> Float:
    """Return the distance [m] of `point` (2,) to each of `walls` (W, 4), shape (W,)."""
    start, extent = walls[:, :2] - point, walls[:, 2:] - walls[:, :2]
    squared = (extent**2).sum(axis=1)
    share = -(start * extent).sum(axis=1) / np.where(squared > 0, squared, 1.0)
    nearest: Float = start + np.clip(share, 0.0, 1.0)[:, None] * extent
    return np.hypot(nearest[:, 0], nearest[:, 1])


def which_inside(polygon: Float, x: Float, y: Float) -> Bool:
    """Return which of the points (x, y) [m], shape (...), lie in a convex polygon.

    It is given by its sides in order [m], shape (S, 4).
    """
    left = right = np.ones(np.broadcast_shapes(x.shape, y.shape), dtype=np.bool_)
    for x0, y0, x1, y1 in polygon.tolist():
        side = (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)
        left, right = left & (side > 0), right & (side < 0)
    return left | right
