"""The maps that come with the package."""

from importlib.resources import as_file, files
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.sim.maps.line_map import LineMap
from pioneer3.sim.maps.read import read_map

_SUFFIX = ".map"


def shipped_maps() -> tuple[str, ...]:
    """Return the names of the maps that ship, sorted."""
    worlds = (files("pioneer3.sim") / "worlds").iterdir()
    return tuple(sorted(w.name.removesuffix(_SUFFIX) for w in worlds if w.name.endswith(_SUFFIX)))


def shipped_map(name: str) -> LineMap:
    """Return the map that ships under `name`, with or without `.map`.

    Raises:
        ConfigError: There is none; names those that there are.
    """
    stem = name.removesuffix(_SUFFIX)
    if stem not in shipped_maps():
        raise ConfigError(f"map {name!r}: none ships under this name; there is {_listed()}")
    with as_file(files("pioneer3.sim") / "worlds" / (stem + _SUFFIX)) as path:
        return read_map(path)


def load_map(name_or_path: str | Path) -> LineMap:
    """Return the shipped map of this name, otherwise the map file at this path.

    A file that exists wins over a shipped map only where the `.map` is written out.

    Raises:
        ConfigError: Neither a shipped name nor a readable map file.
    """
    name = str(name_or_path)
    if name in shipped_maps():
        return shipped_map(name)
    path = Path(name_or_path)
    if _exists(path):
        return read_map(path)
    if name.removesuffix(_SUFFIX) in shipped_maps():
        return shipped_map(name)
    raise ConfigError(f"map {name!r}: no such file, and none ships so; there is {_listed()}")


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:
        # there may be a file, only not for us: reading it says why
        return True


def _listed() -> str:
    return ", ".join(shipped_maps())
