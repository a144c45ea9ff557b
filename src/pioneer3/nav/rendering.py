"""Draws the map of a survey: which cells are free, and which are walls."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from pioneer3.arrays import Bool, Float, Int, UInt8
from pioneer3.geometry import Pose2
from pioneer3.jit import fast
from pioneer3.maps import LineMap, MapObject, OccupancyGrid
from pioneer3.maps.grid import raster_outline
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN, solid_walls
from pioneer3.nav.beams import Beams
from pioneer3.nav.frames import Survey
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.rays import hit_cells, passed_cells
from pioneer3.nav.matching import lines_at, rotation
from pioneer3.nav.settings import AS_SHIPPED

WALL_HITS = 2
"""Scans that end in a cell from which on it is a wall: people who walked by were in a cell for a
scan or two."""
WALL_SHARE = 0.2
"""Share of the scans that pass or end in a cell from which on it is a wall: light passes it before
and after people."""
CLEAR_MISSES = 3
"""Scans that pass a cell, and none that ends there, from which on a wall has gone from it."""
SPILL_SHARE = 0.2
"""Share of the hits of a cell nearby below which hits are that cell's: ranges are noisy, and behind
a wall no light passes that would speak against them."""
SPILL_REACH = 0.05
"""Distance to that cell at most [m]."""
DRAWN_RANGE = 30.0
"""Range beyond which echoes are not drawn [m]."""
BRIDGED_GAP = 0.3
"""Distance below which neighbouring points of one wall are joined [m]."""
WALL_THICKNESS = 0.05
"""Distance before their walls up to which rays are taken to pass [m]."""
STRAIGHT_ROUGHNESS = 0.02
"""Distance from a line above which points are drawn where they are [m, RMS]: it is no straight
wall."""
REDRAWN_MOVE = 0.01
"""Change of its pose above which a scan is drawn anew [m]."""
REDRAWN_TURN = 0.002
"""Change of its heading above which a scan is drawn anew [rad]."""
BEAM_GAP = 2
"""Half of the cells between two beams up to which they are free."""
STRIP = 256
"""Rows of cells between two beams that are looked at together."""
NUMBERS = 255
"""Scans after which the numbers in cells, by which each is counted once a scan, begin anew."""
SPARE_GROUND = 5.0
"""Space around the map, for it grows [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Strokes:
    """The drawn part of a key frame, in the robot's frame [m].

    Attributes:
        points: The echoes [m], moved onto the lines through their neighbours, shape (N, 2).
        lines: Normals there, shape (N, 3).
        ends: Of the rays, as far as they are known to be clear [m], shape (M, 2).
    """

    points: Float
    lines: Float
    ends: Float
    origin: Float

    @classmethod
    def of(cls, beams: Beams) -> "_Strokes":
        points = np.ascontiguousarray(beams.points)
        points = points[np.hypot(*(points - beams.origin).T) < DRAWN_RANGE]
        lines = lines_at(points, beams.origin, STRAIGHT_ROUGHNESS)
        points = points - lines[:, 2:] * lines[:, :2]
        ray = points - beams.origin
        length = np.maximum(np.hypot(*ray.T), 1e-9)
        # along the ray, a wall is THICK over the cosine of the incidence
        steep = np.abs((ray * lines[:, :2]).sum(axis=1)) / length
        short = np.where(
            lines[:, :2].any(axis=1), WALL_THICKNESS / np.maximum(steep, 0.02), WALL_THICKNESS
        )
        ends = beams.origin + ray * np.maximum(0.0, 1.0 - short / length)[:, None]
        return cls(points, lines, np.concatenate([ends, beams.free]), beams.origin)


class MapRenderer:
    """Draws a map with cells of side `cell` [m], and again what has changed in it."""

    def __init__(self, cell: float = AS_SHIPPED.mapper.cell) -> None:
        self._cell = cell
        self._corner = np.zeros(2, dtype=np.int64)
        # cells are many: 16 bits last for 65,535 key frames that all see one place
        self._hits, self._misses = (np.zeros((0, 0), dtype=np.uint16) for _ in range(2))
        self._seen = np.zeros((0, 0), dtype=np.uint8)
        self._number = 0
        self._poses: list[Pose2] = []

    def update(self, survey: Survey) -> None:
        """Draw the key frames that are new, and those that have moved, anew."""
        for number, (frame, pose) in enumerate(zip(survey.frames, survey.poses, strict=True)):
            if number < len(self._poses) and _is_near(self._poses[number], pose):
                continue
            strokes = _Strokes.of(frame.beams)
            if number == len(self._poses):
                self._poses.append(pose)
            else:
                self._count(strokes, self._poses[number], drawn=False)
                self._poses[number] = pose
            self._count(strokes, pose, drawn=True)

    @property
    def grid(self) -> OccupancyGrid:
        """The map as cells."""
        states = np.full(self._hits.shape, UNKNOWN, dtype=np.uint8)
        around = 2 * BEAM_GAP
        free = np.pad(self._misses > 0, around)
        for low in range(0, len(states), STRIP):  # closing takes memory
            part = free[low : low + STRIP + 2 * around]
            closed = part | ndimage.binary_closing(part, iterations=BEAM_GAP)
            states[low : low + STRIP][closed[around:-around, around:-around]] = FREE
        del free
        rows, columns = np.nonzero(self._hits >= WALL_HITS)
        hits, misses = self._hits[rows, columns] * 1.0, self._misses[rows, columns]
        wall = hits >= WALL_SHARE * (hits + misses)
        wall &= hits >= SPILL_SHARE * self._most(rows, columns)
        states[rows[wall], columns[wall]] = OCCUPIED
        return self._cropped(states)

    @property
    def clear(self) -> OccupancyGrid:
        """The cells that light passed often, and in which it never ended, as free ones."""
        clear = (self._misses >= CLEAR_MISSES) & (self._hits == 0)
        return self._cropped(np.where(clear, FREE, UNKNOWN).astype(np.uint8))

    def _most(self, rows: Int, columns: Int) -> Float:
        """Return the most hits of a cell within the reach of a spill of each cell, shape (N,)."""
        height, width = self._hits.shape
        most = np.zeros(len(rows), dtype=self._hits.dtype)
        reach = round(SPILL_REACH / self._cell)
        for down, right in product(range(-reach, reach + 1), repeat=2):
            row, column = (
                np.clip(rows + down, 0, height - 1),
                np.clip(columns + right, 0, width - 1),
            )
            np.maximum(most, self._hits[row, column], out=most)
        return most.astype(np.float64)

    def _cropped(self, states: UInt8) -> OccupancyGrid:
        known = states != UNKNOWN
        rows, columns = (np.flatnonzero(known.any(axis=axis)) for axis in (1, 0))
        if not len(rows):
            nothing = np.full((1, 1), UNKNOWN, dtype=np.uint8)
            return OccupancyGrid(states=nothing, resolution=self._cell, origin=Pose2())
        row, column = (self._corner + np.array([rows[0], columns[0]])).tolist()
        return OccupancyGrid(
            states=states[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1],
            resolution=self._cell,
            origin=Pose2(self._cell * column, self._cell * row),
        )

    def _count(self, strokes: _Strokes, pose: Pose2, *, drawn: bool) -> None:
        """Add a scan to the counts of cells, or take it out of them."""
        change = np.add if drawn else np.subtract
        turn = rotation(pose.theta).T
        points, ends, origin = (
            (part @ turn + np.array([pose.x, pose.y])) / self._cell
            for part in (strokes.points, strokes.ends, strokes.origin)
        )
        self._make_room(np.concatenate([points, ends, origin[None]]))
        lines, bridge = strokes.lines.copy(), BRIDGED_GAP / self._cell
        lines[:, :2] = lines[:, :2] @ turn
        self._number = self._number % NUMBERS + 1
        if self._number == 1:
            self._seen[:] = 0
        apart = np.hypot(*np.diff(points, axis=0).T)
        hits = np.empty(len(points) + 2 * ceil(apart[apart <= bridge].sum()), dtype=np.int64)
        count = fast(hit_cells, CACHE)(
            points, lines, bridge, self._seen, self._corner, self._number, hits
        )
        at = hits[:count]
        self._hits.ravel()[at] = change(self._hits.ravel()[at], 1)
        most = int(np.abs(ends - origin).sum()) + 3 * len(ends)
        passed = np.empty(most, dtype=np.int64)
        count = fast(passed_cells, CACHE)(
            origin, ends, self._seen, self._corner, self._number, passed
        )
        at = passed[:count]
        self._misses.ravel()[at] = change(self._misses.ravel()[at], 1)

    def _make_room(self, points: Float) -> None:
        """Add cells where points [cells] lie outside of those that there are."""
        low = np.floor(points.min(axis=0)).astype(np.int64)[::-1]
        high = np.floor(points.max(axis=0)).astype(np.int64)[::-1] + 1
        old, shape = self._corner, np.array(self._hits.shape)
        spare = ceil(SPARE_GROUND / self._cell)
        if shape.all():
            if (low >= old).all() and (high <= old + shape).all():
                return
            low = np.where(low < old, low - spare, old)
            high = np.where(high > old + shape, high + spare, old + shape)
        row, column = (old - low).tolist()
        room = slice(row, row + int(shape[0])), slice(column, column + int(shape[1]))
        self._corner = low

        def larger(counts: NDArray[Any]) -> NDArray[Any]:
            more = np.zeros((high - low).tolist(), dtype=counts.dtype)
            if shape.all():
                more[room] = counts
            return more

        self._hits = larger(self._hits)  # one after the other, as they are large
        self._misses = larger(self._misses)
        self._seen = larger(self._seen)


def render(survey: Survey, cell: float = AS_SHIPPED.mapper.cell) -> OccupancyGrid:
    """Return the map of a survey as cells."""
    renderer = MapRenderer(cell)
    renderer.update(survey)
    return renderer.grid


def trodden(grid: OccupancyGrid, places: Sequence[Pose2], radius: float) -> OccupancyGrid:
    """Return a grid that is not turned with what is unknown around `places` free.

    A robot stood there, though its laser did not see it: it looks ahead. So much is free within the
    `radius` [m] of each place.
    """
    cell, corner = grid.resolution, np.array([grid.origin.x, grid.origin.y])
    if not places:
        return grid
    points = (np.array([(place.x, place.y) for place in places]) - corner) / cell
    reach = ceil(radius / cell) + 1
    height, width = grid.states.shape
    low = np.minimum(0, np.floor(points.min(axis=0)).astype(int) - reach)
    high = np.maximum((width, height), np.floor(points.max(axis=0)).astype(int) + reach + 1)
    (left, right), (below, above) = ((-low[i], high[i] - n) for i, n in ((0, width), (1, height)))
    states = np.pad(grid.states, ((below, above), (left, right)), constant_values=UNKNOWN)
    points -= low
    for x, y in np.unique(np.floor(points).astype(int), axis=0).tolist():
        around = states[y - reach + 1 : y + reach, x - reach + 1 : x + reach]
        around[_disk(reach, radius / cell) & (around == UNKNOWN)] = FREE
    x, y = (corner + cell * low).tolist()
    return OccupancyGrid(states=states, resolution=cell, origin=Pose2(x, y))


@lru_cache
def _disk(reach: int, radius: float) -> Bool:
    off = np.arange(1 - reach, reach)
    disk: Bool = np.hypot(off[:, None], off) <= radius
    return disk


def line_map_of(grid: OccupancyGrid, name: str, objects: Sequence[MapObject] = ()) -> LineMap:
    """Return a map whose walls outline the occupied cells of a grid that is not turned.

    Sides of solid objects are walls, too.
    """
    edges = raster_outline(grid.states == OCCUPIED) * grid.resolution
    solid = solid_walls(objects)
    outlines = edges + np.array([grid.origin.x, grid.origin.y] * 2)
    return LineMap(
        name=name,
        walls=np.concatenate([outlines, solid]),
        homes=tuple(item.pose for item in objects if item.kind == "RobotHome"),
        objects=tuple(objects),
        grids=(grid,),
        lines=solid,
    )


def _is_near(a: Pose2, b: Pose2) -> bool:
    moved = a.inverse() @ b
    return abs(moved.x) + abs(moved.y) < REDRAWN_MOVE and abs(moved.theta) < REDRAWN_TURN
