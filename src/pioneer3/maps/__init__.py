"""Maps of walls: the data class, readers and writers of map files, the maps that ship."""

from pioneer3.maps.line_map import Bounds, LineMap, MapObject, OccupancyGrid, empty_map
from pioneer3.maps.load import read_map, shipped_map, shipped_maps
from pioneer3.maps.write import write_aria_map, write_map_server

__all__ = [
    "Bounds",
    "LineMap",
    "MapObject",
    "OccupancyGrid",
    "empty_map",
    "read_map",
    "shipped_map",
    "shipped_maps",
    "write_aria_map",
    "write_map_server",
]
