"""Edits maps: erases walls, names places."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps.grid import raster_outline
from pioneer3.maps.line_map import (
    FREE,
    OCCUPIED,
    Bounds,
    LineMap,
    MapObject,
    OccupancyGrid,
    solid_walls,
)

Float = NDArray[np.float64]


def erased(line_map: LineMap, box: Bounds) -> LineMap:
    """Return a map without what stands in a box [m]: walls that lie in it whole, and cells.

    Solid objects, forbidden lines and places stay.

    Raises:
        ConfigError: Nothing stands there, or a grid of the map is turned.
    """
    if any(grid.origin.theta for grid in line_map.grids):
        raise ConfigError(f"{line_map.name}: its grid is turned: nothing can be erased")
    grids = tuple(_without(grid, box) for grid in line_map.grids)
    solid = solid_walls(line_map.objects)
    sides = {tuple(side) for side in solid.tolist()}
    lines = [
        line
        for line in line_map.lines.tolist()
        if tuple(line) in sides or not (_holds(box, *line[:2]) and _holds(box, *line[2:]))
    ]
    same = all(a is b for a, b in zip(grids, line_map.grids, strict=True))
    if same and len(lines) == len(line_map.lines):
        raise ConfigError(f"{line_map.name}: no wall is inside of {_words(box)}")
    kept = np.array(lines, dtype=np.float64).reshape(-1, 4)
    walls = np.concatenate([kept, *map(_outline, grids)])
    return LineMap(
        name=line_map.name,
        walls=walls,
        homes=line_map.homes,
        objects=line_map.objects,
        grids=grids,
        lines=kept,
    )


def with_goal(line_map: LineMap, name: str, x: float, y: float, heading: float | None) -> LineMap:
    """Return a map with a goal [m, rad], in the place of any object of that name."""
    kind = "Goal" if heading is None else "GoalWithHeading"
    goal = MapObject(kind=kind, name=name, pose=Pose2(x, y, heading or 0.0))
    others = tuple(i for i in line_map.objects if i.name.casefold() != name.casefold() or i.outline)
    homes = tuple(item.pose for item in others if item.kind == "RobotHome")
    return replace(line_map, objects=(*others, goal), homes=homes)


def _without(grid: OccupancyGrid, box: Bounds) -> OccupancyGrid:
    height, width = grid.states.shape
    columns = grid.origin.x + (np.arange(width) + 0.5) * grid.resolution
    rows = grid.origin.y + (np.arange(height) + 0.5) * grid.resolution
    inside = np.outer(
        (rows >= box.y_min) & (rows <= box.y_max), (columns >= box.x_min) & (columns <= box.x_max)
    )
    inside &= grid.states == OCCUPIED
    if not inside.any():
        return grid
    states = grid.states.copy()
    states[inside] = FREE
    return replace(grid, states=states)


def _outline(grid: OccupancyGrid) -> Float:
    corner = np.array([grid.origin.x, grid.origin.y] * 2)
    edges: Float = raster_outline(grid.states == OCCUPIED) * grid.resolution + corner
    return edges


def _holds(box: Bounds, x: float, y: float) -> bool:
    return box.x_min <= x <= box.x_max and box.y_min <= y <= box.y_max


def _words(box: Bounds) -> str:
    return f"x {box.x_min:g} to {box.x_max:g} m, y {box.y_min:g} to {box.y_max:g} m"
