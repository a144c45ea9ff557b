"""Finds worlds: shipped ones by name, others by the path of their file."""

from importlib.resources import as_file, files
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.sim.maps.read import is_world
from pioneer3.sim.maps.shipped import shipped_maps
from pioneer3.sim.maps.text import shown
from pioneer3.sim.worldfile.parse import read_world
from pioneer3.sim.worldfile.spec import WorldFile

LONGEST_PATH = 300


def load_world(name_or_path: str | Path) -> WorldFile:
    """Return a world file as it is; a map, shipped or in a file, as a world of its own.

    Raises:
        ConfigError: Neither a shipped name nor a readable file.
    """
    path = Path(name_or_path)
    name = str(name_or_path)
    if name in shipped_worlds():
        return shipped_world(name)
    if is_world(path):
        return read_world(path)
    stem = name.removesuffix(".map")
    if name in shipped_maps() or name == "empty":
        return WorldFile(name=name, map=name)
    if _exists(path):
        return WorldFile(name=path.stem, map=path)
    if stem in shipped_maps():
        return WorldFile(name=stem, map=stem)
    listed = ", ".join((*shipped_maps(), *shipped_worlds(), "empty"))
    said = repr(name) if len(name) <= LONGEST_PATH else shown(name)
    raise ConfigError(f"map {said}: no such file, and none ships so; there is {listed}")


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except PermissionError:
        return True  # there may be a file, only not for us: reading it says why
    except (OSError, ValueError):
        return False


def shipped_worlds() -> tuple[str, ...]:
    """Return the names of the worlds that ship, sorted."""
    there = (files("pioneer3.sim") / "worlds").iterdir()
    return tuple(sorted(Path(w.name).stem for w in there if is_world(Path(w.name))))


def shipped_world(name: str) -> WorldFile:
    """Return the world that ships under `name`, one of :func:`shipped_worlds`."""
    with as_file(files("pioneer3.sim") / "worlds" / f"{name}.toml") as path:
        return read_world(path)
