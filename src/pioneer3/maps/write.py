"""Writes maps: ARIA's `.map`, and YAML with a picture for ROS's map_server."""

from collections.abc import Iterator
from dataclasses import replace
from math import cos, degrees, sin
from pathlib import Path

import numpy as np

from pioneer3.arrays import Float, Int
from pioneer3.errors import ConfigError
from pioneer3.geometry import Extent
from pioneer3.maps.aria_objects import STANDARD_LINES, STANDARD_SOLIDS
from pioneer3.maps.grid import EDGE, MOST_CELLS, shape_of, touched
from pioneer3.maps.image import to_pgm
from pioneer3.maps.line_map import FREE as FREE_CELL
from pioneer3.maps.line_map import OCCUPIED as OCCUPIED_CELL
from pioneer3.maps.line_map import LineMap, MapObject, OccupancyGrid, solid_walls
from pioneer3.text import write_bytes
from pioneer3.units import MM

RESOLUTION = 0.05
"""Default side of a pixel [m], as usual with ROS's own map saver."""
OCCUPIED = 0
"""Shade of a wall, of map_saver."""
UNKNOWN = 205
"""Shade of the unknown, of map_saver."""
FREE = 254
"""Shade of free ground, of map_saver."""
KNOWN = frozenset(
    {"Goal", "GoalWithHeading", "Dock", "RobotHome", "ForbiddenLine", "ForbiddenArea"}
)
"""Types that need no MapInfo."""
POINTS = ("LocationType", "GoalType", "DockType")
"""Classes of types that are places."""


def write_aria_map(line_map: LineMap, path: Path) -> None:
    """Write an ARIA map; coordinates are rounded to whole millimetres, as ARIA reads them.

    The occupied cells of grids become scanned points, as long as no grid is turned and all have
    cells of one size; else their outlines become LINES. Reading it back gives walls within half a
    millimetre, and the same objects.

    Raises:
        ConfigError: The file cannot be written.
    """
    write_bytes(path, aria_text(line_map).encode())


def aria_text(line_map: LineMap) -> str:
    """Return the text that :func:`write_aria_map` writes."""
    return "".join(f"{line}\n" for line in _aria_lines(line_map))


def _aria_lines(line_map: LineMap) -> Iterator[str]:
    resolution = _resolution_mm(line_map)
    walls = line_map.walls if resolution is None else line_map.lines
    solid = {tuple(side) for side in solid_walls(line_map.objects).tolist()}
    drawn = np.array([tuple(wall) not in solid for wall in walls.tolist()], dtype=np.bool_)
    walls_mm = np.rint(walls[drawn] / MM).astype(np.int64)
    points_mm = np.empty((0, 2), dtype=np.int64) if resolution is None else _points_mm(line_map)
    yield "2D-Map"
    if len(points_mm):
        yield f"MinPos: {points_mm[:, 0].min()} {points_mm[:, 1].min()}"
        yield f"MaxPos: {points_mm[:, 0].max()} {points_mm[:, 1].max()}"
        yield f"NumPoints: {len(points_mm)}"
        yield f"Resolution: {resolution}"
    if len(walls_mm):
        x_mm, y_mm = walls_mm[:, ::2], walls_mm[:, 1::2]
        yield f"LineMinPos: {x_mm.min()} {y_mm.min()}"
        yield f"LineMaxPos: {x_mm.max()} {y_mm.max()}"
    yield f"NumLines: {len(walls_mm)}"
    yield from dict.fromkeys(filter(None, map(_info, line_map.objects)))
    yield from map(_cairn, line_map.objects)
    yield "LINES"
    for row in walls_mm.tolist():
        yield " ".join(map(str, row))
    # ARIA reads on until it has found this heading
    yield "DATA"
    for x, y in points_mm.tolist():
        yield f"{x} {y}"


def _resolution_mm(line_map: LineMap) -> int | None:
    """Return the side of the cells of all grids [mm], if their points can be written."""
    sides = {grid.resolution for grid in line_map.grids}
    if len(sides) != 1 or any(grid.origin.theta for grid in line_map.grids):
        return None
    side = sides.pop() / MM
    return round(side) if side >= 1 and abs(side - round(side)) < EDGE else None


def _points_mm(line_map: LineMap) -> Int:
    """Return the middles of the occupied cells [mm], shape (N, 2)."""
    parts: list[Float] = [np.empty((0, 2))]
    for grid in line_map.grids:
        rows, columns = np.nonzero(grid.states == OCCUPIED_CELL)
        middles = (np.stack([columns, rows], axis=1) + 0.5) * grid.resolution
        parts.append(middles + np.array([grid.origin.x, grid.origin.y]))
    return np.rint(np.concatenate(parts) / MM).astype(np.int64)


def _info(item: MapObject) -> str:
    """Return the MapInfo line that an object's type needs, or an empty text."""
    name = _quoted(f"Name={item.kind}")
    if len(item.outline) == 2:
        if item.kind in STANDARD_LINES:
            return ""
        return f"MapInfo: BoundaryType {name}" + (" Sim.LaserReflect=2" if item.solid else "")
    if item.outline:
        if item.kind in KNOWN | STANDARD_SOLIDS:
            return ""
        return f"MapInfo: SectorType {name}" + (" Sim.Obstacle=yes" if item.solid else "")
    if item.kind in KNOWN:
        return ""
    declared = item.declared if item.declared in POINTS else POINTS[0]
    return f"MapInfo: {declared} {name}" + (" Heading=Required" if item.turned_to else "")


def _cairn(item: MapObject) -> str:
    pose = item.pose
    x_mm, y_mm = round(pose.x / MM), round(pose.y / MM)
    theta_deg = round(degrees(pose.theta), 9)
    fields = f"{_quoted(item.kind)} {x_mm} {y_mm} {theta_deg:.9g}"
    corners = " ".join(str(round(number / MM)) for number in _corners(item))
    name = item.name.replace('"', "'")
    printable = "".join(c if c.isprintable() else " " for c in name)
    return f'Cairn: {fields} "" ICON "{printable}" {corners}'.rstrip()


def _corners(item: MapObject) -> Iterator[float]:
    """Yield the four numbers of a line or, turned back, of an area [m]; of a place none."""
    is_line = len(item.outline) == 2
    turned = 0.0 if is_line else -item.pose.theta
    c, s = cos(turned), sin(turned)
    # the ends of a line; of an area the first corner and the opposite one
    for x, y in item.outline if is_line else item.outline[:3:2]:
        yield c * x - s * y
        yield s * x + c * y


def _quoted(word: str) -> str:
    word = "".join(c if c.isprintable() else " " for c in word.replace('"', "'"))
    return word if word and " " not in word else f'"{word}"'


def write_map_server(line_map: LineMap, path: Path, resolution: float = RESOLUTION) -> Path:
    """Write a YAML file, and beside it a PGM picture of the walls; return the picture's path.

    Walls become black pixels, all else is free: which side of a wall is unknown, lines don't
    say. Objects are lost, map_server has none. Reading it back gives outlines that lie within
    a pixel's diagonal of the walls. A map that is one grid of this `resolution`, the side of a
    pixel [m], with free cells, is written as it is, with its lines on it.

    Raises:
        ConfigError: The picture would be too large, or a file cannot be written.
    """
    import yaml

    image = path.with_suffix(".pgm")
    grid = _only_grid(line_map, resolution)
    bounds = _bounds_of(grid) if grid else framed(line_map.bounds, resolution)
    height, width = shape_of(bounds, resolution)
    if height * width > MOST_CELLS:
        raise ConfigError(
            f"{path}: resolution: {resolution:g} m makes {width} x {height} pixels, more than "
            f"{MOST_CELLS / 1e6:.0f} million; take larger ones"
        )
    if grid:
        shades = np.full(grid.states.shape, UNKNOWN, dtype=np.uint8)
        shades[grid.states == FREE_CELL] = FREE
        shades[grid.states == OCCUPIED_CELL] = OCCUPIED
    else:
        occupied = touched(line_map.walls, bounds, resolution)
        shades = np.where(occupied, OCCUPIED, FREE).astype(np.uint8)
    write_bytes(image, to_pgm(shades[::-1]))
    text = yaml.safe_dump(
        {
            "image": image.name,
            "resolution": resolution,
            "origin": [bounds.x_min, bounds.y_min, 0.0],
            "negate": 0,
            "occupied_thresh": 0.65,
            "free_thresh": 0.196,
        },
        sort_keys=False,
        default_flow_style=None,
        allow_unicode=True,
    )
    write_bytes(path, text.encode())
    return image


def _only_grid(line_map: LineMap, resolution: float) -> OccupancyGrid | None:
    """Return the grid of a map that is one, with the lines that lie on it.

    `None` where free and unknown cells cannot stay as they are.
    """
    if len(line_map.grids) != 1:
        return None
    (grid,) = line_map.grids
    as_it_is = grid.resolution == resolution and not grid.origin.theta
    if not as_it_is or not (grid.states == FREE_CELL).any():
        return None
    bounds, ends = _bounds_of(grid), line_map.lines.reshape(-1, 2)
    if (ends < bounds[:2]).any() or (ends > bounds[2:]).any():
        return None
    states = grid.states.copy()
    states[touched(line_map.lines, bounds, resolution)] = OCCUPIED_CELL
    return replace(grid, states=states)


def _bounds_of(grid: OccupancyGrid) -> Extent:
    height, width = grid.states.shape
    x, y, cell = grid.origin.x, grid.origin.y, grid.resolution
    return Extent(x, y, x + width * cell, y + height * cell)


def framed(bounds: Extent, cell: float) -> Extent:
    """Return `bounds` with a free cell all around, grown to whole cells."""
    low_x, low_y = (np.floor(low / cell + EDGE) - 1 for low in bounds[:2])
    high_x, high_y = (np.floor(high / cell + EDGE) + 2 for high in bounds[2:])
    return Extent(*(float(round(edge * cell, 9)) for edge in (low_x, low_y, high_x, high_y)))
