"""One entry for every kind of map file."""

import re
from pathlib import Path

from pioneer3.sim.maps.aria import AriaFile, parse_aria
from pioneer3.sim.maps.line_map import LineMap
from pioneer3.sim.maps.png import SIGNATURE
from pioneer3.sim.maps.server import LARGEST_YAML, ServerFile, parse_server
from pioneer3.sim.maps.text import decoded, read_bytes, wrong

PICTURES = (".pgm", ".png")
YAMLS = (".yaml", ".yml")
_IMAGE_KEY = re.compile(r"^image\s*:", re.MULTILINE)
_WORLD = re.compile(r"^\s*\[world\]", re.MULTILINE)


def is_world(path: Path) -> bool:
    """Whether the name is that of a world of ours."""
    return path.suffix.lower() == ".toml"


def read_map(path: Path) -> LineMap:
    """Read a map: ARIA's `.map`, ROS's map_server YAML with its picture, a TOML world's walls.

    What it is, its first line says, or else the end of its name. The map is named after the
    file, a world as it says. People and what can be moved are no walls: a world's
    :func:`pioneer3.sim.worldfile.load_world` has them.

    Raises:
        ConfigError: The file cannot be read or is no map; one line that says where and why.
    """
    if is_world(path):
        # tomllib and worlds only for those who have one; worlds are built from maps
        from pioneer3.sim.worldfile.parse import read_world  # noqa: PLC0415

        return read_world(path).line_map()
    return read_plan(path).line_map()


def read_plan(path: Path) -> AriaFile | ServerFile:
    """Read a map that is no world, as it stands.

    Raises:
        ConfigError: The file cannot be read or is no map.
    """
    raw = read_bytes(path)
    ending = path.suffix.lower()
    if ending in PICTURES and raw.startswith((SIGNATURE, b"P2", b"P5")):
        raise wrong(path, " is a picture; give the YAML file that says its resolution")
    text = decoded(raw)
    start = text[:LARGEST_YAML]
    is_aria = start.lstrip().startswith("2D-Map")
    if not is_aria and (ending in YAMLS or (ending != ".map" and _IMAGE_KEY.search(start))):
        if len(raw) > LARGEST_YAML:
            raise wrong(path, " is larger than 64 KB, so not a map_server file")
        return parse_server(path, text)
    if not is_aria and _WORLD.search(start):
        raise wrong(path, " is a world; its name must end in .toml")
    return parse_aria(path, text)
