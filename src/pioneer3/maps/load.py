"""Reads every kind of map file, and the maps that ship."""

import re
from importlib.resources import as_file, files
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.maps.aria import AriaFile, parse_aria
from pioneer3.maps.image import SIGNATURES
from pioneer3.maps.line_map import LineMap
from pioneer3.maps.map_server import LARGEST_YAML, MapServerFile, parse_map_server
from pioneer3.text import decoded, read_bytes, wrong

PICTURES = (".pgm", ".png", ".ppm", ".pbm", ".bmp", ".jpg", ".jpeg", ".tif", ".tiff", ".gif")
YAMLS = (".yaml", ".yml")
FOREIGN_WORLDS = (".world", ".sdf")
"""Endings of worlds of Stage and Gazebo, which :func:`sim.worldfile.load_world` reads."""
_IMAGE_KEY = re.compile(r"^image\s*:", re.MULTILINE)
_WORLD = re.compile(r"^\s*\[world\]", re.MULTILINE)
_FOREIGN = re.compile(r"^\s*(?:define\s+\w+\s+\w+|\w+\s*\(|include\s+\")|<world\b", re.MULTILINE)
_ARIA = re.compile(r"\A\s*2D-Map")
_SUFFIX = ".map"


def read_map(path: Path) -> LineMap:
    """Read a map: ARIA's `.map`, or map_server's YAML with its picture; named after the file.

    The first line says which of the two it is, or else the end of its name. Worlds, which may
    stand on maps, are read by :func:`pioneer3.sim.worldfile.load_world`.

    Raises:
        ConfigError: The file cannot be read or is not a map; one line that says where and why.
    """
    return read_map_file(path).line_map()


def read_map_file(path: Path) -> AriaFile | MapServerFile:
    """Read a map file with its line numbers; errors are those of :func:`read_map`."""
    raw = read_bytes(path)
    ending = path.suffix.lower()
    if ending in PICTURES and raw.startswith(tuple(SIGNATURES)):
        raise wrong(path, " is a picture; give the YAML file that says its resolution")
    text = decoded(raw)
    start = text[:LARGEST_YAML]
    is_aria = bool(_ARIA.match(start))
    if not is_aria and (ending in YAMLS or (ending != ".map" and _IMAGE_KEY.search(start))):
        if len(raw) > LARGEST_YAML:
            raise wrong(path, " is larger than 64 KB, so not a map_server file")
        return parse_map_server(path, text)
    if ending in FOREIGN_WORLDS:
        advice = "write its walls with `pioneer3 map convert` to a .map first"
        raise wrong(path, f" is a world, where a map is needed; {advice}")
    if not is_aria and _WORLD.search(start):
        raise wrong(path, " is a world; its name must end in .toml")
    return parse_aria(path, text)


def looks_like_map(path: Path) -> bool:
    """Whether a file begins as a map or a world does, and its name says so."""
    begins = {".map": _ARIA, ".toml": _WORLD}
    begins |= dict.fromkeys(YAMLS, _IMAGE_KEY) | dict.fromkeys(FOREIGN_WORLDS, _FOREIGN)
    sign = begins.get(path.suffix.lower())
    if sign is None:
        return False
    try:
        with path.open("rb") as file:
            return bool(sign.search(decoded(file.read(LARGEST_YAML))))
    except (OSError, ConfigError):
        return False


def shipped_maps() -> tuple[str, ...]:
    """Return the names of the maps that ship, sorted."""
    there = files("pioneer3.maps").iterdir()
    return tuple(sorted(m.name.removesuffix(_SUFFIX) for m in there if m.name.endswith(_SUFFIX)))


def shipped_map(name: str) -> LineMap:
    """Return the map that ships under `name`, with or without `.map`.

    Raises:
        ConfigError: There is none; names those that there are.
    """
    stem = name.removesuffix(_SUFFIX)
    if stem not in shipped_maps():
        listed = ", ".join(shipped_maps())
        raise ConfigError(f"map {name!r}: none ships under this name; there is {listed}")
    with as_file(files("pioneer3.maps") / (stem + _SUFFIX)) as path:
        return read_map(path)
