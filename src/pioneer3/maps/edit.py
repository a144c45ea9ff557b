"""Edits maps: erases and draws walls, names places, forbids lines and areas."""

from dataclasses import replace
from math import hypot
from typing import Literal

import numpy as np

from pioneer3.errors import ConfigError
from pioneer3.geometry import Extent, Pose2
from pioneer3.maps.grid import walls_of
from pioneer3.maps.line_map import (
    FREE,
    OCCUPIED,
    LineMap,
    MapObject,
    OccupancyGrid,
    solid_walls,
)

Point = tuple[float, float]
NewRole = Literal["goal", "dock", "home"]
"""The roles of places that can be added."""
SHORTEST = 0.01
"""Walls and forbidden lines are at least so long [m]."""


def erased(line_map: LineMap, box: Extent) -> LineMap:
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
        inside = f"x {box.x_min:g} to {box.x_max:g} m, y {box.y_min:g} to {box.y_max:g} m"
        raise ConfigError(f"{line_map.name}: no wall is inside of {inside}")
    kept = np.array(lines, dtype=np.float64).reshape(-1, 4)
    walls = np.concatenate([kept, *map(walls_of, grids)])
    materials = dict(zip(map(tuple, line_map.walls.tolist()), line_map.materials, strict=True))
    return replace(
        line_map,
        walls=walls,
        grids=grids,
        lines=kept,
        materials=np.array([materials.get(tuple(w), 0) for w in walls.tolist()], dtype=np.uint8),
    )


def with_wall(line_map: LineMap, start: Point, end: Point) -> LineMap:
    """Return a map with one wall more, between two points [m].

    Raises:
        ConfigError: They are the same point.
    """
    wall = np.array([[*_apart(line_map, start, end)]])
    return replace(
        line_map,
        walls=np.concatenate([line_map.walls, wall]),
        lines=np.concatenate([line_map.lines, wall]),
        materials=np.append(line_map.materials, np.uint8(0)),
    )


def with_place(
    line_map: LineMap, role: NewRole, name: str, at: Point, heading: float | None = None
) -> LineMap:
    """Return a map with a place [m, rad], instead of any of that name.

    Docks and homes without a heading head along x.

    Raises:
        ConfigError: The name is empty.
    """
    kinds = {"goal": "Goal" if heading is None else "GoalWithHeading"}
    kinds |= {"dock": "Dock", "home": "RobotHome"}
    named = _name(line_map, name)
    place = MapObject(kind=kinds[role], name=named, pose=Pose2(*at, heading or 0.0))
    objects = [item for item in line_map.objects if item.outline or not _is_named(item, named)]
    same = (n for n, i in enumerate(line_map.objects) if not i.outline and _is_named(i, named))
    objects.insert(next(same, len(objects)), place)
    return _with_objects(line_map, objects)


def with_forbidden(
    line_map: LineMap, shape: Literal["line", "area"], start: Point, end: Point, name: str = ""
) -> LineMap:
    """Return a map with a line that robots do not cross, or an area that they do not enter.

    `start` and `end` are the line's, or opposite corners of the area [m].

    Raises:
        ConfigError: It is too small.
    """
    x0, y0, x1, y1 = _apart(line_map, start, end)
    outline: tuple[Point, ...] = ((x0, y0), (x1, y1))
    if shape == "area":
        if min(abs(x1 - x0), abs(y1 - y0)) < SHORTEST:
            raise ConfigError(f"{line_map.name}: an area has two opposite corners")
        outline = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    kind = "ForbiddenLine" if shape == "line" else "ForbiddenArea"
    forbidden = MapObject(kind=kind, name=name.strip(), pose=Pose2(), outline=outline)
    return _with_objects(line_map, [*line_map.objects, forbidden])


def renamed(line_map: LineMap, number: int, name: str) -> LineMap:
    """Return a map whose object of this number, counted from 0, has another name.

    Raises:
        ConfigError: The name is empty, or a place has it already.
    """
    item, named = line_map.objects[number], _name(line_map, name)
    others = (other for other in line_map.objects if other is not item and not other.outline)
    if not item.outline and any(_is_named(other, named) for other in others):
        raise ConfigError(f"{line_map.name}: there is a place {named} already")
    objects = [replace(i, name=named) if i is item else i for i in line_map.objects]
    return _with_objects(line_map, objects)


def without(line_map: LineMap, number: int) -> LineMap:
    """Return a map without the object of this number, counted from 0, and without its walls."""
    item = line_map.objects[number]
    sides = set(item.sides) if item.solid else set()
    stays = np.array([tuple(wall) not in sides for wall in line_map.walls.tolist()], dtype=np.bool_)
    lines = [line for line in line_map.lines.tolist() if tuple(line) not in sides]
    kept = replace(
        line_map,
        walls=line_map.walls[stays],
        lines=np.array(lines, dtype=np.float64).reshape(-1, 4),
        materials=line_map.materials[stays],
    )
    return _with_objects(kept, [other for other in line_map.objects if other is not item])


def find_object(line_map: LineMap, name: str) -> int:
    """Return the number of the object of a name, in upper or lower case, counted from 0.

    Raises:
        ConfigError: There is none, or more than one; names those that there are.
    """
    found = [n for n, item in enumerate(line_map.objects) if _is_named(item, name.strip())]
    if len(found) == 1:
        return found[0]
    if found:
        raise ConfigError(f"{line_map.name}: {len(found)} objects have the name {name.strip()}")
    names = ", ".join(sorted({item.name for item in line_map.objects if item.name})) or "none"
    raise ConfigError(f"{line_map.name}: no object has the name {name.strip()}; has {names}")


def _with_objects(line_map: LineMap, objects: list[MapObject]) -> LineMap:
    homes = tuple(item.pose for item in objects if item.kind == "RobotHome")
    return replace(line_map, objects=tuple(objects), homes=homes)


def _is_named(item: MapObject, name: str) -> bool:
    return item.name.casefold() == name.casefold()


def _name(line_map: LineMap, name: str) -> str:
    if not name.strip():
        raise ConfigError(f"{line_map.name}: a place needs a name")
    return name.strip()


def _apart(line_map: LineMap, start: Point, end: Point) -> tuple[float, float, float, float]:
    if hypot(end[0] - start[0], end[1] - start[1]) < SHORTEST:
        raise ConfigError(f"{line_map.name}: a line has two ends that are apart")
    return *start, *end


def _without(grid: OccupancyGrid, box: Extent) -> OccupancyGrid:
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


def _holds(box: Extent, x: float, y: float) -> bool:
    return box.x_min <= x <= box.x_max and box.y_min <= y <= box.y_max
