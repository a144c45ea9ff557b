"""Worlds in TOML: a map with robots, boxes, walls, places and people."""

from pioneer3.sim.worldfile.load import ClientMaps, file_in, load_map, load_world, shipped_worlds
from pioneer3.sim.worldfile.person import Person, outlines_at
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
    "outlines_at",
    "parse_equipment",
    "parse_world",
    "read_world",
    "shipped_worlds",
    "to_toml",
    "write_world",
]
