"""The map as pages draw it."""

from base64 import b64encode
from typing import Any

from pioneer3.sim.maps import LineMap, MapObject
from pioneer3.sim.maps.cells import Cells
from pioneer3.sim.maps.png import to_png

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
        "cells": [_cells(cells) for cells in line_map.cells],
        "objects": [_object(item) for item in line_map.objects],
    }


def _cells(cells: Cells) -> dict[str, Any]:
    """Return a grey picture of cells; its first row is the lowest, in :attr:`Cells.corner`."""
    small = cells.coarser(MOST_CELLS)
    corner = small.corner
    return {
        "png": b64encode(to_png(small.states * SHADE)).decode(),
        "side": small.side,
        "corner": (corner.x, corner.y, corner.theta),
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
