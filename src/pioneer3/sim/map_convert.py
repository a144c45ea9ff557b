"""Reads, checks and converts maps and worlds by their names, for `pioneer3 map`."""

from collections import Counter
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from pioneer3.errors import ConfigError
from pioneer3.maps import LineMap, write_aria_map, write_map_server
from pioneer3.maps.drawing import MapDrawing, to_svg
from pioneer3.models import load_model
from pioneer3.names import printable
from pioneer3.sim.map_check import MapProblem, Severity, check_world
from pioneer3.sim.worldfile import WorldFile, load_world, write_world
from pioneer3.sim.worldfile.drawing import draw, to_picture
from pioneer3.sim.worldfile.flattened import solids_in_words
from pioneer3.text import write_bytes

FORMATS = (".map", ".yaml", ".toml", ".svg", ".png")


@dataclass(frozen=True, slots=True, kw_only=True)
class MapInfo:
    """A map or world, with the size of its walls along x and y, and all their lengths [m].

    `counts` are the numbers of objects of each kind, with robots, boxes and people.
    """

    name: str
    drawing: MapDrawing
    size: tuple[float, float]
    walls: int
    wall_length: float
    counts: dict[str, int]


@dataclass(frozen=True, slots=True)
class Converted:
    """The files that a conversion has written, and the contents that the new format cannot hold."""

    files: tuple[Path, ...]
    left_out: tuple[str, ...] = ()


def look(name_or_path: str) -> MapInfo:
    """Read a shipped map, a map file or a world; ConfigError if it cannot be read."""
    world = load_world(name_or_path)
    line_map = world.line_map()
    bounds, walls = line_map.bounds, line_map.walls
    lengths = np.hypot(walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1])
    return MapInfo(
        name=world.name,
        drawing=draw(world, line_map),
        size=(bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min),
        walls=len(walls),
        wall_length=float(lengths.sum()),
        counts=_counts(world, line_map),
    )


def _counts(world: WorldFile, line_map: LineMap) -> dict[str, int]:
    counts = Counter(item.kind for item in line_map.objects)
    found = {"robot": len(world.robots), "movable box": len(world.movable)}
    found |= {"person": len(world.people), **Counter(solid.table for solid in world.solids)}
    return dict(counts) | {kind: count for kind, count in found.items() if count}


def check(name_or_path: str, robot: str) -> tuple[tuple[MapProblem, ...], int]:
    """Return the problems of a map, and the exit code: 0 none, 1 warnings, 2 errors.

    Raises:
        ConfigError: There is no such robot model.
    """
    findings = check_world(name_or_path, load_model(robot))
    if any(finding.level is Severity.ERROR for finding in findings):
        return findings, 2
    return findings, 1 if findings else 0


def convert(source: str, target: Path, *, resolution: float, force: bool) -> Converted:
    """Write a map or world in the format that the ending of `target` names.

    `target` ends in `.map`, `.yaml`, `.toml`, `.svg` or `.png`. `resolution` is the side of a pixel
    of a map_server picture [m]; `force` writes over files that are there.

    Raises:
        ConfigError: The source cannot be read, the ending is unknown, or the target is there.
    """
    ending = target.suffix.lower().replace(".yml", ".yaml")
    if ending not in FORMATS:
        raise ConfigError(f"{_shown(target)}: {_unknown(ending)}")
    world = load_world(source)
    line_map = world.line_map()
    written: tuple[Path, ...] = (target,)
    if ending == ".yaml":
        written = (target, target.with_suffix(".pgm"))
    elif ending == ".toml" and isinstance(world.map, LineMap):
        written = (target, target.with_suffix(".map"))
    _make_room(source, world, written, force=force)
    match ending:
        case ".map":
            # a box of an ARIA map may be moved: MobileSim lets people drag it
            boxes = tuple(replace(box, movable=False) for box in world.boxes)
            write_aria_map(replace(world, boxes=boxes).line_map(), target)
        case ".yaml":
            write_map_server(line_map, target, resolution)
        case ".toml":
            if isinstance(world.map, LineMap):
                write_aria_map(world.map, written[-1])
                world = replace(world, map=written[-1])
            write_world(world, target)
        case ".svg":
            write_bytes(target, to_svg(draw(world, line_map)).encode())
        case ".png":
            write_bytes(target, to_picture(draw(world, line_map)))
    return Converted(written, _left_out(world, line_map, ending))


def _make_room(source: str, world: WorldFile, targets: tuple[Path, ...], *, force: bool) -> None:
    """Refuse to write over the source, and without `force` over any file."""
    read = {Path(source), world.map} if isinstance(world.map, Path) else {Path(source)}
    for target in targets:
        try:
            there = target.exists()
            same = there and any(item.exists() and target.samefile(item) for item in read)
        except (OSError, ValueError):
            continue  # writing says why
        if same:
            raise ConfigError(f"{_shown(target)}: is the source; choose another name")
        if there and not force:
            raise ConfigError(f"{_shown(target)}: is there already; --force writes over it")


def _left_out(world: WorldFile, line_map: LineMap, ending: str) -> tuple[str, ...]:
    """Return the contents that a format cannot hold, in words."""
    counts = {"robots": len(world.robots), "people": len(world.people)}
    counts["materials of walls"] = int(np.count_nonzero(line_map.materials))
    heights = [wall.height for wall in world.walls] + [box.height for box in world.boxes]
    counts["heights of walls and boxes"] = len(heights) - heights.count(None)
    if ending == ".yaml":
        counts |= {"movable boxes": len(world.movable), "objects": len(line_map.objects)}
    if ending not in {".map", ".yaml"}:
        return ()
    said = tuple(f"{count} {name}" for name, count in counts.items() if count)
    return said + tuple(solids_in_words(world.solids))


def _unknown(ending: str) -> str:
    close = get_close_matches(ending, FORMATS, n=1)
    hint = f"did you mean {close[0]}?" if close else f"expected {', '.join(FORMATS)}"
    return f"unknown format {ending!a}, {hint}"


def _shown(path: Path) -> str:
    return printable(str(path))
