"""Checks whether a robot can drive straight to a place of a map."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pioneer3.maps.line_map import LineMap, MapObject, distances
from pioneer3.models import RobotModel
from pioneer3.sim.placement.footprint import inside

Float = NDArray[np.float64]
Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class PathCheck:
    """Objections of a map to a drive.

    Attributes:
        refusal: The reason to refuse it, in a sentence; empty if it is allowed.
        warning: The reason why it may not arrive, in a sentence; empty if nothing is in the way.
    """

    refusal: str = ""
    warning: str = ""


def check_path(line_map: LineMap, model: RobotModel, start: Point, end: Point) -> PathCheck:
    """Return the objections of the map to driving straight from `start` to `end` [m].

    A robot that already stands in a forbidden area may leave it.
    """
    if refusal := next(_refusals(line_map, model, start, end), ""):
        return PathCheck(refusal)
    return PathCheck(warning=next(_warnings(line_map, model, start, end), ""))


def _refusals(line_map: LineMap, model: RobotModel, start: Point, end: Point) -> Iterator[str]:
    forbidden = [(item, np.array(item.sides)) for item in line_map.objects if item.forbidden]
    areas = [(item, sides) for item, sides in forbidden if item.role == "area"]
    for item, sides in areas:
        if inside(sides, *end):
            yield f"This is inside {_called(item)}."
    if len(line_map.walls):
        x_min, y_min, x_max, y_max = line_map.bounds
        if not (x_min <= end[0] <= x_max and y_min <= end[1] <= y_max):
            yield "This is outside the walls of the map."
        nearest = _nearest(line_map, end)
        if nearest < model.width / 2:
            yield f"There is no room: a wall is {nearest:.2f} m away."
    left = [item for item, sides in areas if inside(sides, *start)]
    for item, sides in forbidden:
        if item not in left and crossed(sides, start, end).any():
            yield f"The straight way there crosses {_called(item)}."


def _warnings(line_map: LineMap, model: RobotModel, start: Point, end: Point) -> Iterator[str]:
    if not len(line_map.walls):
        return
    if crossed(line_map.walls, start, end).any():
        yield "Something stands in the straight way there: it may not get through."
    nearest = _nearest(line_map, end)
    if nearest < model.radius:
        yield f"A wall is {nearest:.2f} m from there: it may stop before it."


def crossed(walls: Float, start: Point, end: Point) -> NDArray[np.bool_]:
    """Return the `walls` (W, 4) that the straight way crosses or ends at, shape (W,).

    Walls along the way itself are not among them.
    """
    x0, y0, x1, y1 = walls.T
    (ax, ay), (bx, by) = start, end
    # on opposite sides of a line, the two products of a point with it have opposite signs
    of_way = ((bx - ax) * (y0 - ay) - (by - ay) * (x0 - ax)) * (
        (bx - ax) * (y1 - ay) - (by - ay) * (x1 - ax)
    )
    of_wall = ((x1 - x0) * (ay - y0) - (y1 - y0) * (ax - x0)) * (
        (x1 - x0) * (by - y0) - (y1 - y0) * (bx - x0)
    )
    found: NDArray[np.bool_] = ((of_way < 0) & (of_wall <= 0)) | ((of_way <= 0) & (of_wall < 0))
    return found


def _nearest(line_map: LineMap, point: Point) -> float:
    return float(distances(np.array(point), line_map.walls).min())


def _called(item: MapObject) -> str:
    kind = f"a forbidden {item.role}"
    name = "".join(c if c.isprintable() else "?" for c in item.name[:30])
    return f'{kind}, "{name}"' if name else kind
