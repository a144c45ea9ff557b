"""Worlds in TOML: a map, and what stands, drives and walks in it."""

from pioneer3.sim.worldfile.fitting import Fitting, parse_fitting
from pioneer3.sim.worldfile.load import load_world, shipped_worlds
from pioneer3.sim.worldfile.parse import parse_world, read_world
from pioneer3.sim.worldfile.person import Person, outlines_at
from pioneer3.sim.worldfile.spec import Box, Place, RobotSpec, Start, Wall, WorldFile
from pioneer3.sim.worldfile.write import to_toml, write_world

__all__ = [
    "Box",
    "Fitting",
    "Person",
    "Place",
    "RobotSpec",
    "Start",
    "Wall",
    "WorldFile",
    "load_world",
    "outlines_at",
    "parse_fitting",
    "parse_world",
    "read_world",
    "shipped_worlds",
    "to_toml",
    "write_world",
]
