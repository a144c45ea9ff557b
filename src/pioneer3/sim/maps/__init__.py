"""Maps of walls: the data class, the reader of ARIA `.map` files and the maps that ship."""

from pioneer3.sim.maps.aria import read_map
from pioneer3.sim.maps.line_map import Bounds, LineMap, MapObject, empty_map
from pioneer3.sim.maps.shipped import load_map, shipped_map, shipped_maps

__all__ = [
    "Bounds",
    "LineMap",
    "MapObject",
    "empty_map",
    "load_map",
    "read_map",
    "shipped_map",
    "shipped_maps",
]
