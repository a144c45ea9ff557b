"""Finds maps and worlds: shipped ones by name, others by the path of their file."""

from importlib.resources import as_file, files
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.maps import LineMap, shipped_maps
from pioneer3.maps.load import FOREIGN_WORLDS, looks_like_map
from pioneer3.sim.worldfile.spec import WorldFile
from pioneer3.sim.worldfile.toml import is_world, read_world
from pioneer3.text import read_bytes, shown

LONGEST_PATH = 300


def load_map(name_or_path: str | Path) -> LineMap:
    """Return the walls and places of a shipped map, a map file or a world, or ConfigError."""
    return load_world(name_or_path).line_map()


def load_world(name_or_path: str | Path) -> WorldFile:
    """Return a world, or the world that is made of a map only; either shipped or in a file.

    A file wins over a shipped map only where the `.map` is written out.

    Raises:
        ConfigError: Neither a shipped name nor a readable file.
    """
    path = Path(name_or_path)
    name = str(name_or_path)
    if name in shipped_worlds():
        return shipped_world(name)
    if is_world(path):
        return read_world(path)
    if path.suffix.lower() in FOREIGN_WORLDS:
        return read_foreign(path)
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


def read_foreign(path: Path) -> WorldFile:
    """Read a world of Gazebo, which is XML or ends in `.sdf`, or else of Stage."""
    from pioneer3.sim.worldfile.gazebo import read_gazebo
    from pioneer3.sim.worldfile.gazebo_text import LARGEST_SDF
    from pioneer3.sim.worldfile.stage import read_stage

    start = read_bytes(path, LARGEST_SDF, "world")[:1000].lstrip(b"\xef\xbb\xbf \t\r\n")
    is_sdf = start.startswith(b"<") or path.suffix.lower() == ".sdf"
    return read_gazebo(path) if is_sdf else read_stage(path)


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except PermissionError:
        return True  # the file may be there: reading it tells why it cannot be read
    except (OSError, ValueError):
        return False


def shipped_worlds() -> tuple[str, ...]:
    """Return the names of the worlds that ship, sorted."""
    there = (files("pioneer3.sim") / "worlds").iterdir()
    return tuple(sorted(Path(w.name).stem for w in there if is_world(Path(w.name))))


def maps_in(folder: Path) -> tuple[Path, ...]:
    """Return the maps and worlds in a folder, by the beginnings of its files, sorted.

    Raises:
        ConfigError: It is no folder that can be read.
    """
    try:
        files_in = sorted(path for path in folder.iterdir() if path.is_file())
    except OSError as error:
        raise ConfigError(f"{shown(str(folder))}: {error.strerror or error}") from None
    return tuple(path for path in files_in if looks_like_map(path))


def shipped_world(name: str) -> WorldFile:
    """Return the world of :func:`shipped_worlds` with this name."""
    with as_file(files("pioneer3.sim") / "worlds" / f"{name}.toml") as path:
        return read_world(path)


class ClientMaps:
    """The maps that a client may ask for by name: those that ship, and those in some folders.

    That is by default the working directory. Folders inside these are not searched, and links out
    of them not followed, so that clients cannot read this machine's other files.
    """

    def __init__(self, *folders: Path) -> None:
        self._folders = folders or (Path(),)

    def find(self, name: str) -> WorldFile:
        """Return the world or map of this name; a file wins over a shipped map.

        Raises:
            ConfigError: A client may have no such map, or it cannot be read.
        """
        for folder in self._folders:
            path = file_in(folder, name)
            if path is not None:
                return load_world(path)
        if name.removesuffix(".map") in shipped_maps():
            return load_world(name.removesuffix(".map"))
        raise ConfigError(f"map {name!r}: clients can have the shipped ones and those beside it")


def file_in(folder: Path, name: str) -> Path | None:
    """Return the ordinary file `name`, whoever told the name, if it lies right in `folder`."""
    try:
        path = (folder / name).resolve()
        return path if path.parent == folder.resolve() and path.is_file() else None
    except (OSError, ValueError, RuntimeError):
        # not a name, or a loop of links
        return None
