"""Draws the map of a survey: which cells are free, and which are walls."""

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.jit import fast
from pioneer3.maps import Bounds, LineMap, OccupancyGrid
from pioneer3.maps.grid import raster_outline
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN
from pioneer3.nav.beams import Beams
from pioneer3.nav.frames import KeyFrame, Survey
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.rays import hit_cells, passed_cells
from pioneer3.nav.matching import lines_at, rotation
from pioneer3.nav.raster import Raster

Float = NDArray[np.float64]
Int = NDArray[np.int64]
Counts = NDArray[np.int32]

CELL = 0.05
"""[m]."""
HITS, SHARE = 2, 0.3
"""A cell is a wall where so many scans end, and this share of those that pass or end there: people
who walked by were in a cell for a scan or two, and light passes it before and after."""
CLEAR = 8.0
"""Where nothing echoes, the way is taken to be clear this far [m]: farther off, glass and dark
walls send too little light back."""
FAR = 30.0
"""Echoes from farther away are not drawn [m]."""
BRIDGE = 0.3
"""Neighbouring points of one wall are joined if they are nearer than this [m]."""
THICK = 0.05
"""Rays are not taken to pass nearer than this before their walls [m]."""
MOVED, MOVED_TURN = 0.01, 0.002
"""A scan is drawn anew where its pose has changed more than this [m, rad]."""
SPARE = 5.0
"""Space around the map, for it grows [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Strokes:
    """What is drawn of a key frame, in the robot's frame.

    Attributes:
        points: The echoes [m], moved onto the lines through their neighbours, shape (N, 2).
        lines: Normals there, shape (N, 3).
        ends: Of the rays, as far as they are known to be clear [m], shape (M, 2).
        origin: Of the rays [m].
    """

    points: Float
    lines: Float
    ends: Float
    origin: Float

    @classmethod
    def of(cls, beams: Beams) -> "_Strokes":
        points = np.ascontiguousarray(beams.points)
        points = points[np.hypot(*(points - beams.origin).T) < FAR]
        lines = lines_at(points, beams.origin)
        points = points - lines[:, 2:] * lines[:, :2]
        ray = points - beams.origin
        length = np.maximum(np.hypot(*ray.T), 1e-9)
        # along the ray, a wall is THICK over the cosine of the incidence
        steep = np.abs((ray * lines[:, :2]).sum(axis=1)) / length
        short = np.where(lines[:, :2].any(axis=1), THICK / np.maximum(steep, 0.02), THICK)
        ends = beams.origin + ray * np.maximum(0.0, 1.0 - short / length)[:, None]
        clear = beams.clear - beams.origin
        away = np.maximum(np.hypot(*clear.T), 1e-9)
        clear = beams.origin + clear * np.minimum(1.0, CLEAR / away)[:, None]
        return cls(points, lines, np.concatenate([ends, clear]), beams.origin)


class Renderer:
    """Draws a map, and again what has changed in it.

    Args:
        cell: Side of a cell [m].
    """

    def __init__(self, cell: float = CELL) -> None:
        self._raster = Raster(x=0.0, y=0.0, cell=cell, height=0, width=0)
        self._hits, self._misses = (np.zeros((0, 0), dtype=np.int32) for _ in range(2))
        self._seen = np.zeros((0, 0), dtype=np.int32)
        self._number = 0
        self._frames: list[KeyFrame] = []
        self._strokes: list[_Strokes] = []
        self._drawn: list[tuple[Int, Int] | None] = []
        self._poses: list[Pose2] = []

    def update(self, survey: Survey) -> None:
        """Draw the key frames that are new, and those that have moved, anew."""
        for number, (frame, pose) in enumerate(zip(survey.frames, survey.poses, strict=True)):
            if number == len(self._frames):
                self._frames.append(frame)
                self._strokes.append(_Strokes.of(frame.beams))
                self._poses.append(pose)
                self._drawn.append(None)
            elif _is_near(self._poses[number], pose):
                continue
            self._erase(number)
            self._poses[number] = pose
            self._draw(number)

    @property
    def grid(self) -> OccupancyGrid:
        """The map as cells."""
        hits, total = self._hits, self._hits + self._misses
        states = np.full(hits.shape, UNKNOWN, dtype=np.uint8)
        states[self._misses > 0] = FREE
        states[(hits >= HITS) & (hits >= SHARE * total)] = OCCUPIED
        known = np.argwhere(states != UNKNOWN)
        if not len(known):
            nothing = np.full((1, 1), UNKNOWN, dtype=np.uint8)
            return OccupancyGrid(states=nothing, resolution=self._raster.cell, origin=Pose2())
        low, high = known.min(axis=0), known.max(axis=0) + 1
        cell, raster = self._raster.cell, self._raster
        return OccupancyGrid(
            states=states[low[0] : high[0], low[1] : high[1]],
            resolution=cell,
            origin=Pose2(raster.x + cell * int(low[1]), raster.y + cell * int(low[0])),
        )

    def _draw(self, number: int) -> None:
        strokes, pose = self._strokes[number], self._poses[number]
        turn, at = rotation(pose.theta).T, (pose.x, pose.y)
        points, ends = strokes.points @ turn + at, strokes.ends @ turn + at
        origin = strokes.origin @ turn + at
        self._make_room(np.concatenate([points, ends, origin[None]]))
        raster, lines = self._raster, strokes.lines.copy()
        lines[:, :2] = lines[:, :2] @ turn
        self._number += 1
        apart = np.hypot(*np.diff(points, axis=0).T) if len(points) > 1 else np.empty(0)
        most = len(points) + 2 * ceil(float(apart[apart < BRIDGE].sum()) / raster.cell)
        hits = np.empty(most, dtype=np.int64)
        count = fast(hit_cells, CACHE)(
            raster.in_cells(points), lines, BRIDGE / raster.cell, self._seen, self._number, hits
        )
        hits = hits[:count].copy()
        away = np.abs(raster.in_cells(ends) - raster.in_cells(origin)).sum(axis=1)
        passed = np.empty(int(away.sum()) + 3 * len(ends), dtype=np.int64)
        count = fast(passed_cells, CACHE)(
            raster.in_cells(origin), raster.in_cells(ends), self._seen, self._number, passed
        )
        passed = passed[:count].copy()
        self._hits.ravel()[hits] += 1
        self._misses.ravel()[passed] += 1
        self._drawn[number] = hits, passed

    def _erase(self, number: int) -> None:
        drawn = self._drawn[number]
        if drawn is not None:
            self._hits.ravel()[drawn[0]] -= 1
            self._misses.ravel()[drawn[1]] -= 1
            self._drawn[number] = None

    def _make_room(self, points: Float) -> None:
        """Make the raster larger where points lie outside of it."""
        low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
        old, cell = self._raster, self._raster.cell
        if old.height:
            right, top = old.x + old.width * cell, old.y + old.height * cell
            inside = old.x <= low[0] and old.y <= low[1] and high[0] < right and high[1] < top
            if inside:
                return
            low = min(old.x + SPARE, low[0]), min(old.y + SPARE, low[1])
            high = max(right - SPARE, high[0]), max(top - SPARE, high[1])
        self._raster = new = Raster.around(Bounds(*low, *high), cell, SPARE)
        row, column = round((old.y - new.y) / cell), round((old.x - new.x) / cell)
        room = slice(row, row + old.height), slice(column, column + old.width)
        for name in ("_hits", "_misses", "_seen"):
            larger = np.zeros(new.shape, dtype=np.int32)
            if old.height:
                larger[room] = getattr(self, name)
            setattr(self, name, larger)
        for number, drawn in enumerate(self._drawn):
            if drawn is not None:
                hits, passed = (
                    (cells // old.width + row) * new.width + cells % old.width + column
                    for cells in drawn
                )
                self._drawn[number] = hits, passed


def render(survey: Survey, cell: float = CELL) -> OccupancyGrid:
    """Return the map of a survey as cells."""
    renderer = Renderer(cell)
    renderer.update(survey)
    return renderer.grid


def line_map_of(grid: OccupancyGrid, name: str) -> LineMap:
    """Return a map whose walls outline the occupied cells of a grid that is not turned."""
    edges = raster_outline(grid.states == OCCUPIED) * grid.resolution
    walls = edges + np.array([grid.origin.x, grid.origin.y] * 2)
    return LineMap(name=name, walls=walls, grids=(grid,))


def _is_near(a: Pose2, b: Pose2) -> bool:
    moved = a.inverse() @ b
    return abs(moved.x) + abs(moved.y) < MOVED and abs(moved.theta) < MOVED_TURN
