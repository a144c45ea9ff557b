"""The map as pages draw it."""

from base64 import b64encode
from typing import Any

from pioneer3.sim.maps import LineMap, MapObject, OccupancyGrid
from pioneer3.sim.maps.image import to_png

MOST_CELLS = 4_000_000
"""Of a grid: a phone keeps four bytes for each."""
SHADE = 85
"""Between the greys of two states of cells: three of them make white."""


def plan(line_map: LineMap | None) -> dict[str, Any]:
    """Say what a map has: walls that outline no cells, cells, and what it names [m, rad]."""
    return {"type": "map", "map": _plan(line_map) if line_map else None}


def _plan(line_map: LineMap) -> dict[str, Any]:
    return {
        "name": line_map.name,
        "walls": line_map.lines.round(3).tolist(),
        "cells": [_cells(grid) for grid in line_map.grids],
        "objects": [_object(item) for item in line_map.objects],
    }


def _cells(grid: OccupancyGrid) -> dict[str, Any]:
    """Return a grey picture of a grid; its first row is the lowest, at the grid's origin."""
    small = grid.coarser(MOST_CELLS)
    origin = small.origin
    return {
        "png": b64encode(to_png(small.states * SHADE)).decode(),
        "side": small.resolution,
        "corner": (origin.x, origin.y, origin.theta),
    }


def _object(item: MapObject) -> dict[str, Any]:
    return {
        "role": item.role,
        "kind": item.kind,
        "name": item.name,
        "x": round(item.pose.x, 3),
        "y": round(item.pose.y, 3),
        "theta": item.pose.theta,
        "heads": item.heads,
        "forbidden": item.forbidden,
        "solid": item.solid,
        "points": [(round(x, 3), round(y, 3)) for x, y in item.outline],
    }
