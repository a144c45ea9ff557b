"""Worlds: a map with robots, boxes, walls, places and people; in TOML, or of other simulators.

============  ===================================================================================
module        contents
============  ===================================================================================
arguments     options of a command line about robots and starts, which override a world file
flattened     worlds without their third dimension: in words, and as a map with a world file
drawing       drawings of worlds: what is on them besides the map, and PNG
load          finds maps and worlds: shipped ones by name, others by the path of their file
gazebo        reads worlds of Gazebo: boxes, columns, cuts of meshes, and robots
collada       triangles of COLLADA files, the usual meshes of Gazebo
gazebo_frames the poses of SDF: of links, frames, joints and models in their model or world
gazebo_text   the XML of such worlds, and the files that they name
stage         reads worlds of Stage: walls, boxes, and robots with their lasers
stage_text    the text of such worlds: tokens, includes and macros become entities
stand_ins     models and lasers for the robots of another simulator, by their names or sizes
toml          reads and writes world files: TOML with a table for each object of a world
solid_checks  refuses solids of a world file that cannot be there, with file, line and key
spec          the contents of a world file: map, robots, solids, places and people; frozen, in SI
person        people who walk: their position is a function of time alone
============  ===================================================================================
"""

from pioneer3.sim.worldfile.load import (
    ClientMaps,
    file_in,
    load_map,
    load_world,
    maps_in,
    shipped_worlds,
)
from pioneer3.sim.worldfile.person import Person
from pioneer3.sim.worldfile.spec import (
    Box,
    Place,
    RobotSpec,
    Start,
    Wall,
    WorldFile,
)
from pioneer3.sim.worldfile.toml import (
    parse_equipment,
    parse_world,
    read_world,
    to_toml,
    write_world,
)

__all__ = [
    "Box",
    "ClientMaps",
    "Person",
    "Place",
    "RobotSpec",
    "Start",
    "Wall",
    "WorldFile",
    "file_in",
    "load_map",
    "load_world",
    "maps_in",
    "parse_equipment",
    "parse_world",
    "read_world",
    "shipped_worlds",
    "to_toml",
    "write_world",
]
