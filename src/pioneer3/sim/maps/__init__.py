"""Maps of walls: the data class, readers and writers of map files, the maps that ship."""

from pioneer3.sim.maps.line_map import Bounds, LineMap, MapObject, empty_map
from pioneer3.sim.maps.read import read_map
from pioneer3.sim.maps.shipped import load_map, shipped_map, shipped_maps
from pioneer3.sim.maps.write import write_aria_map, write_map_server

__all__ = [
    "Bounds",
    "LineMap",
    "MapObject",
    "empty_map",
    "load_map",
    "read_map",
    "shipped_map",
    "shipped_maps",
    "write_aria_map",
    "write_map_server",
]
