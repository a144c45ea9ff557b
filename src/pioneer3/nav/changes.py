"""Draws maps that were continued, the last day over those before, and finds what has changed."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy import ndimage

from pioneer3.arrays import Bool, Float, UInt8
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject, OccupancyGrid
from pioneer3.maps.line_map import FREE, OCCUPIED, UNKNOWN
from pioneer3.nav.frames import Survey
from pioneer3.nav.rendering import SPILL_REACH, MapRenderer, line_map_of, trodden
from pioneer3.nav.settings import AS_SHIPPED

JOINED_REACH = 0.3
"""Distance below which changed cells are one change [m]."""
LEAST_CHANGE = 0.01
"""Area below which a change is not worth a word [m^2]: a leg of a chair."""
TOLD_CHANGES = 8
"""Changes of a map that are told at most, the largest ones."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MapChange:
    """A wall, or part of it, that has come or gone: its middle, and the area of its cells.

    The middles of these are `cells` [m], shape (N, 2).
    """

    x: float
    y: float
    area: float
    gone: bool
    cells: Float = field(compare=False, repr=False)

    def __str__(self) -> str:
        """Return the change in words."""
        how = "gone" if self.gone else "new"
        return f"{how}: {self.area:.2f} m² of walls near ({self.x:.1f}, {self.y:.1f})"


def days_of(survey: Survey) -> Iterator[Survey]:
    """Yield the key frames of each day on which a map was made or continued, without edges.

    A map is continued by a key frame to which no way leads from the one before.
    """
    frames, poses = survey.frames, survey.poses
    linked = {
        edge.second for edge in survey.edges if not edge.loop and edge.second == edge.first + 1
    }
    begins = [number for number in range(1, len(frames)) if number not in linked]
    for begin, end in zip([0, *begins], [*begins, len(frames)], strict=True):
        yield Survey(frames[begin:end], poses[begin:end], ())


class DaysRenderer:
    """Draws a survey, the days over those before: :class:`MapRenderer` draws each of them.

    A wall goes where light passed often enough on a later day, and no wall was seen beside.
    """

    def __init__(self, cell: float = AS_SHIPPED.mapper.cell) -> None:
        self._cell = cell
        self._days = [MapRenderer(cell)]

    def update(self, survey: Survey) -> OccupancyGrid:
        """Return the map as cells; only what is new, and what has moved, is drawn anew."""
        for number, day in enumerate(days_of(survey)):
            if number == len(self._days):
                self._days.append(MapRenderer(self._cell))
            self._days[number].update(day)
        first, *later = self._days
        grid = first.grid
        for renderer in later:
            grid = _over(grid, renderer)
        return grid


def render_days(survey: Survey, cell: float = AS_SHIPPED.mapper.cell) -> OccupancyGrid:
    """Return the map of a survey as cells, those of later days over those of earlier ones."""
    return DaysRenderer(cell).update(survey)


def drawn(
    survey: Survey,
    room: float,
    cell: float = AS_SHIPPED.mapper.cell,
    *,
    name: str = "map",
    objects: Sequence[MapObject] = (),
) -> LineMap:
    """Return the map of a survey; within `room` [m] of the robot's places it is free."""
    return line_map_of(trodden(render_days(survey, cell), survey.poses, room), name, objects)


def changes(before: OccupancyGrid, after: OccupancyGrid) -> list[MapChange]:
    """Return the walls that differ between two maps with the same cells, the largest first."""
    old, new, corner = _aligned(before, after)
    cell = after.resolution
    found = list[MapChange]()
    for gone, was, now in ((True, old, new), (False, new, old)):
        # walls that have moved by the errors of poses have not changed
        mask = (was == OCCUPIED) & (now == FREE) & ~_near(now == OCCUPIED, cell)
        joined = ndimage.binary_dilation(mask, iterations=round(JOINED_REACH / cell / 2))
        labels, _ = ndimage.label(joined)
        for number, (rows, columns) in enumerate(ndimage.find_objects(labels), 1):
            here = np.argwhere(mask[rows, columns] & (labels[rows, columns] == number))
            area = len(here) * cell**2
            if area < LEAST_CHANGE:
                continue
            cells = (corner + (here + (rows.start, columns.start) + 0.5) * cell)[:, ::-1]
            x, y = cells.mean(axis=0).tolist()
            found.append(MapChange(x=x, y=y, area=area, gone=gone, cells=cells))
    return sorted(found, key=lambda each: -each.area)


def in_words(found: Sequence[MapChange]) -> tuple[str, ...]:
    """Return a line for each change; of many, the largest are told and the others counted."""
    lines = tuple(map(str, found[:TOLD_CHANGES]))
    left = len(found) - len(lines)
    return (*lines, f"and {left} smaller {'change' if left == 1 else 'changes'}") if left else lines


def _over(grid: OccupancyGrid, renderer: MapRenderer) -> OccupancyGrid:
    """Return a grid with the one of a later day over it."""
    later = renderer.grid
    old, new, (y, x) = _aligned(grid, later)
    whole = OccupancyGrid(states=old, resolution=grid.resolution, origin=Pose2(x, y))
    _, clear, _ = _aligned(whole, renderer.clear)
    states = np.where(new == UNKNOWN, old, new)
    stays = (old == OCCUPIED) & (new != OCCUPIED)
    stays &= (clear != FREE) | _near(new == OCCUPIED, later.resolution)
    states[stays] = OCCUPIED
    return OccupancyGrid(states=states, resolution=grid.resolution, origin=Pose2(x, y))


def _near(walls: Bool, cell: float) -> Bool:
    near: Bool = ndimage.binary_dilation(walls, iterations=round(SPILL_REACH / cell))
    return near


def _aligned(a: OccupancyGrid, b: OccupancyGrid) -> tuple[UInt8, UInt8, np.ndarray]:
    """Return the states of two grids over the same cells, and their lower left corner, y and x."""
    cell = a.resolution
    corners = [np.round(np.array([g.origin.y, g.origin.x]) / cell).astype(int) for g in (a, b)]
    low = np.minimum(*corners)
    high = np.maximum(*(c + g.states.shape for c, g in zip(corners, (a, b), strict=True)))
    both = []
    for corner, grid in zip(corners, (a, b), strict=True):
        states = np.full(high - low, UNKNOWN, dtype=np.uint8)
        row, column = corner - low
        height, width = grid.states.shape
        states[row : row + height, column : column + width] = grid.states
        both.append(states)
    return both[0], both[1], low * cell
