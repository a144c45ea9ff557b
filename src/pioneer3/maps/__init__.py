"""Maps of walls: the data class, readers and writers of map files, the maps that ship.

============  ====================================================================================
module        contents
============  ====================================================================================
edit          edits maps: erases and draws walls, names places, forbids lines and areas
occupancy     a map as one grid of occupied, free and unknown cells
write         writes maps: ARIA's `.map`, and YAML with a picture for ROS's map_server
load          reads every kind of map file, and the maps that ship
map_server    reads the maps of ROS's map_server: a YAML file that describes a picture
aria          reads ARIA `.map` files (facts.md 10): headers 2D-Map, 2D-Map-Ex and 2D-Map-Ex2
aria_objects  the `Cairn:` and `MapInfo:` lines of an ARIA map (facts.md 10.2, 10.3)
image         pictures of maps: reads PGM and PNG, writes both, with Pillow
grid          occupancy grids and walls: outlines of occupied cells, and the cells that walls pass
line_map      a map: wall segments, named places and occupancy grids, in SI
drawing       drawings of maps, as SVG
materials     the materials of walls and boxes, as lasers see them
============  ====================================================================================
"""

from pioneer3.geometry import Extent
from pioneer3.maps.line_map import LineMap, MapObject, OccupancyGrid, empty_map
from pioneer3.maps.load import read_map, shipped_map, shipped_maps
from pioneer3.maps.write import write_aria_map, write_map_server

__all__ = [
    "Extent",
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
