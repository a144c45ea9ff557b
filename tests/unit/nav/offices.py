"""Small maps to navigate on."""

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject
from pioneer3.models import load_model
from pioneer3.nav.costs import CostMap

Float = NDArray[np.float64]
AT = load_model("p3at-sh")
NO_OBSTACLES = np.empty((0, 5))
"""Nothing around a robot."""


def box(x0: float, y0: float, x1: float, y1: float) -> list[list[float]]:
    """Return the four sides of a box."""
    return [[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]]


def room(*walls: list[float], objects: tuple[MapObject, ...] = ()) -> LineMap:
    """Return a room of 10 x 6 m with more walls."""
    sides = np.array([*box(0, 0, 10, 6), *walls], dtype=np.float64)
    return LineMap(name="room", walls=sides, objects=objects)


def two_rooms(door: float, *, objects: tuple[MapObject, ...] = ()) -> LineMap:
    """Return two rooms with a door of some width [m] at (5, 3)."""
    low, high = 3 - door / 2, 3 + door / 2
    return room([5, 0, 5, low], [5, high, 5, 6], objects=objects)


def costs(line_map: LineMap) -> CostMap:
    """Return its costs for a P3-AT."""
    return CostMap.of(line_map, AT)


def area(kind: str, *corners: tuple[float, float], name: str = "") -> MapObject:
    """Return an area of a map."""
    return MapObject(kind=kind, name=name, pose=Pose2(), outline=corners)
