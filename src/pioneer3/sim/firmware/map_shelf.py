"""Which maps a client may ask for by name: those that ship, and those beside the one in use."""

from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.sim.maps import LineMap, shipped_maps
from pioneer3.sim.worldfile import load_map


class MapShelf:
    """Finds maps for clients, who must not read about in this machine's files.

    Args:
        folders: Where else than among the shipped maps they may lie; the working directory by
            default. Folders inside these are not looked into, links out of them not followed.
    """

    def __init__(self, *folders: Path) -> None:
        self._folders = folders or (Path(),)

    def find(self, name: str) -> LineMap:
        """Return the map of this name; a file wins over a shipped map, as it does elsewhere.

        Raises:
            ConfigError: There is none that a client may have, or it cannot be read.
        """
        for folder in self._folders:
            path = _inside(folder, name)
            if path is not None:
                return load_map(path)
        if name.removesuffix(".map") in shipped_maps():
            return load_map(name.removesuffix(".map"))
        raise ConfigError(f"map {name!r}: clients can have the shipped ones and those beside it")


def _inside(folder: Path, name: str) -> Path | None:
    """Return the ordinary file `name` if it lies right in `folder`."""
    try:
        path = (folder / name).resolve()
        return path if path.parent == folder.resolve() and path.is_file() else None
    except (OSError, ValueError, RuntimeError):
        # no name at all, or a loop of links
        return None
