"""Saves maps that robots made, with all that is needed to go on with them another day."""

from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.maps import LineMap, write_aria_map, write_map_server
from pioneer3.sim.relief import FLAT, Relief
from pioneer3.sim.worldfile import write_world
from pioneer3.sim.worldfile.flattened import not_on_map, solids_in_words, split
from pioneer3.text import read_bytes, write_bytes, wrong

if TYPE_CHECKING:
    from pioneer3.nav.mapper import Mapper

FORMATS = (".map", ".yaml", ".toml")
"""ARIA's map; map_server's YAML with a picture; a world on a map."""
LARGEST_SURVEY = 1 << 30
"""[bytes]; a day of driving has 0.1 GB."""


def files_of(path: Path) -> tuple[Path, ...]:
    """Return all files of a map of this name, that of the survey last.

    Raises:
        ConfigError: The ending of the name is none of :data:`FORMATS`.
    """
    ending = path.suffix.lower().replace(".yml", ".yaml")
    if ending not in FORMATS:
        raise ConfigError(f"{path}: the ending tells the format: {', '.join(FORMATS)}")
    beside = {".map": (), ".yaml": (path.with_suffix(".pgm"),), ".toml": (_map_of(path),)}
    return (path, *beside[ending], survey_path(path))


def survey_path(path: Path) -> Path:
    """Return the file of the survey that belongs to a map."""
    return path.with_suffix(".survey.npz")


def free_path(path: Path) -> Path:
    """Return the path of a new map, or one like it: no file of the map is there yet.

    Raises:
        ConfigError: The ending of the name is none of :data:`FORMATS`.
    """
    number, free = 1, path
    while any(file.exists() for file in files_of(free)):
        number += 1
        free = path.with_stem(f"{path.stem}-{number}")
    return free


def copy_map(path: Path, what: str) -> Path:
    """Copy all files of a map under a free name that ends in a word; return it.

    Raises:
        ConfigError: A file cannot be read or written.
    """
    copy = free_path(path.with_stem(f"{path.stem}-{what}"))
    for old, new in zip(files_of(path), files_of(copy), strict=True):
        if old.exists():
            data = read_bytes(old, LARGEST_SURVEY)
            if old == path:  # it may name the file beside it
                for first, second in zip(files_of(path)[1:2], files_of(copy)[1:2], strict=True):
                    data = data.replace(first.name.encode(), second.name.encode())
            write_bytes(new, data)
    return copy


def left_out(line_map: LineMap, path: Path, relief: Relief = FLAT) -> str:
    """Return the parts of a map and its world that a file does not have, in words, or nothing."""
    counts: dict[str, int] = {}
    if path.suffix.lower() != ".toml":
        counts["materials of walls"] = int(np.count_nonzero(line_map.materials))
    if path.suffix.lower() in (".yaml", ".yml"):
        counts["places and areas"] = len(line_map.objects)
    said = [f"{count} {what}" for what, count in counts.items() if count]
    said += not_on_map(relief)
    if path.suffix.lower() != ".toml":
        said += solids_in_words(solid for solid in relief.solids.values() if solid.table != "box")
    return ", ".join(said)


def save_map(line_map: LineMap, path: Path, relief: Relief = FLAT) -> None:
    """Write a map in the format that the ending of its name tells.

    A file that is there stays whole until the new one is. Only a world holds heights,
    materials and physics.

    Raises:
        ConfigError: A file cannot be written, or the ending is none of :data:`FORMATS`.
    """
    files_of(path)
    named = replace(line_map, name=path.stem)
    match path.suffix.lower():
        case ".map":
            write_aria_map(named, path)
        case ".toml":
            base, world = split(named, relief, _map_of(path))
            write_aria_map(base, _map_of(path))
            write_world(world, path)
        case _:
            write_map_server(named, path, *(grid.resolution for grid in named.grids[:1]))


def not_continued(path: Path) -> str:
    """Return the reason that nobody can go on with a map, or nothing."""
    file = survey_path(path)
    return "" if file.exists() else f"to go on with a map, {file.name} has to lie beside it"


def save_survey(mapper: "Mapper", path: Path) -> None:
    """Write the key frames and edges of a map beside it, for another day.

    Raises:
        ConfigError: The file cannot be written.
    """
    data = BytesIO()
    np.savez_compressed(data, **mapper.state)  # type: ignore[arg-type]
    write_bytes(survey_path(path), data.getvalue())


def load_survey(path: Path) -> dict[str, NDArray[Any]]:
    """Return the survey of a map, for :meth:`Mapper.of`.

    Raises:
        ConfigError: There is none, or it cannot be read.
    """
    from pioneer3.nav.mapper import Mapper  # which compiles: a page asks `not_continued` before

    if reason := not_continued(path):
        raise ConfigError(f"{path}: {reason}")
    file = survey_path(path)
    data = read_bytes(file, LARGEST_SURVEY)
    try:
        with np.load(BytesIO(data), allow_pickle=False) as arrays:
            state = {name: arrays[name] for name in arrays.files}
        Mapper.of(state)
    except (BadZipFile, EOFError, KeyError, IndexError, ValueError, TypeError, OSError) as error:
        raise wrong(file, f" is no survey of a map: {error}") from None
    return state


def _map_of(path: Path) -> Path:
    """Return the map that a world stands on."""
    return path.with_suffix(".map")
