"""Checks a map or world file: returns all that is wrong with it, not only the first error."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from enum import StrEnum
from math import atan2, degrees, radians, tan
from pathlib import Path

import numpy as np
from numpy.random import default_rng

from pioneer3.errors import ConfigError
from pioneer3.geometry import Extent, Pose2
from pioneer3.maps.aria import (
    DEFAULT_RESOLUTION_MM,
    AriaEntry,
    AriaFile,
    Section,
    parse_aria,
    resolution_mm,
)
from pioneer3.maps.line_map import LineMap, MapObject, distances
from pioneer3.maps.load import read_map_file
from pioneer3.maps.map_server import KEYS, MapServerFile
from pioneer3.models import RobotModel, load_model
from pioneer3.names import printable
from pioneer3.sim.collision import footprint_hits
from pioneer3.sim.free_space import FreeGrid
from pioneer3.sim.physics.elements import check_hull, shown_name
from pioneer3.sim.placer import SpawnedRobot, spawn_robots
from pioneer3.sim.relief import Mesh, Ramp
from pioneer3.sim.worldfile import RobotSpec, WorldFile, load_world
from pioneer3.text import decoded, read_bytes

MOST = 10
"""Findings of one kind that are listed; the rest is counted."""
_COUNTS = {"LINES": "NumLines", "DATA": "NumPoints"}
_BOXES = {"LINES": ("LineMinPos", "LineMaxPos"), "DATA": ("MinPos", "MaxPos")}
ROUNDING_MM = 1.0
STEEPEST_DEG = 14.0
"""Steepest ramp that a P3-DX climbs with physics; a PeopleBot climbs 12, a P3-AT 20."""
MOST_ERRORS = 1000
GOALS = ("Goal", "GoalWithHeading")
ROUTES = ("RouteInfo", "TaskInfo", "SchedTaskInfo", "SchedInfo")
"""Entries that tell routes and what robots do on them."""
FORBIDDEN = ("ForbiddenLine", "ForbiddenArea")


class Severity(StrEnum):
    """The severity of a finding."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True, kw_only=True)
class MapProblem:
    """A problem of a map, which cannot be used if it has an error.

    The line is that in the file, from 1; `None` for problems of no single line.
    """

    level: Severity
    text: str
    line: int | None = None


def warning(text: str, line: int | None = None) -> MapProblem:
    """Return a warning."""
    return MapProblem(level=Severity.WARNING, text=text, line=line)


def some(findings: Iterable[MapProblem], kind: str) -> Iterator[MapProblem]:
    """Yield the first :data:`MOST` of `findings`, and the number of others of this `kind`."""
    found: Sequence[MapProblem] = tuple(findings)
    yield from found[:MOST]
    if len(found) > MOST:
        yield MapProblem(level=found[0].level, text=f"and {len(found) - MOST} more {kind}")


def check_world(name_or_path: str | Path, model: RobotModel) -> tuple[MapProblem, ...]:
    """Return all problems of a map or world, errors first, then by line.

    The robot must fit at homes and goals.
    """
    found = _findings(name_or_path, model)
    return tuple(sorted(found, key=lambda r: (r.level is not Severity.ERROR, r.line or 0)))


def _findings(name_or_path: str | Path, model: RobotModel) -> Iterator[MapProblem]:
    path = Path(name_or_path)
    try:
        world = load_world(name_or_path)
        if isinstance(world.map, Path) and world.map == path:
            yield from _plan(path, model)
        else:
            yield from _world(world, model)
    except ConfigError as error:
        yield as_finding(path, error)


def _plan(path: Path, model: RobotModel) -> Iterator[MapProblem]:
    """Yield the problems of a file that holds only a map."""
    try:
        file: AriaFile | MapServerFile = read_map_file(path)
    except ConfigError as error:
        findings = tuple(check_aria(path, decoded(read_bytes(path)))) if _is_aria(path) else ()
        yield from findings or (as_finding(path, error),)
        return
    lines: dict[int, int] = {}
    if isinstance(file, AriaFile):
        yield from check_aria(path, decoded(read_bytes(path)))
        lines = {at: place.line.number for at, place in enumerate(file.places)}
    else:
        yield from _unknown_keys(file)
    yield from check_places(file.line_map(), model, lines)


def _is_aria(path: Path) -> bool:
    return read_bytes(path)[:1000].lstrip(b"\xef\xbb\xbf \r\n\t").startswith(b"2D-Map")


def _unknown_keys(file: MapServerFile) -> Iterator[MapProblem]:
    for key, field in file.fields.items():
        if key not in KEYS:
            close = get_close_matches(key, KEYS, n=1)
            hint = f", did you mean {close[0]}?" if close else ""
            yield warning(f"{printable(key)}: unknown key, skipped{hint}", field.line.number)


def _world(world: WorldFile, model: RobotModel) -> Iterator[MapProblem]:
    line_map = world.line_map()
    own = any(isinstance(robot.start, Pose2) for robot in world.robots)
    yield from check_places(line_map, model, starts=own)
    yield from _steep(world)
    yield from _hulls(world, line_map)
    sound: dict[int, RobotSpec] = {}
    for index, robot in enumerate(world.robots):
        try:
            load_model(robot.model)
        except ConfigError as error:
            yield MapProblem(level=Severity.ERROR, text=f"robot[{index}].model: {error}")
            continue
        sound[index] = robot
        if robot.start == "home" and not line_map.starts:
            yield warning(f"robot[{index}].start: there is no home and no dock")
    try:
        cleared = replace(world, robots=tuple(sound.values()))
        spawned = spawn_robots(cleared, line_map, default_rng(world.seed))
    except ConfigError as error:
        yield MapProblem(level=Severity.ERROR, text=str(error))
        return
    for (index, robot), each in zip(sound.items(), spawned, strict=True):
        yield from _robot(f"robot[{index}]", robot, each, line_map)


def _steep(world: WorldFile) -> Iterator[MapProblem]:
    """Yield the ramps that no robot climbs."""
    ramps = [solid for solid in world.solids if isinstance(solid, Ramp)]
    for index, ramp in enumerate(ramps):
        slope = degrees(atan2(ramp.height, ramp.size[0]))
        if slope > STEEPEST_DEG:
            long_enough = ramp.height / tan(radians(STEEPEST_DEG))
            yield warning(
                f"ramp[{index}]: rises {slope:.0f} degrees, a P3-DX climbs {STEEPEST_DEG:.0f}: "
                f"make it {long_enough:.2f} m long, or lower"
            )


def _hulls(world: WorldFile, line_map: LineMap) -> Iterator[MapProblem]:
    """Yield the meshes that physics refuse, where MuJoCo is installed."""
    for name, solid in world.relief(line_map).solids.items():
        if isinstance(solid, Mesh):
            try:
                check_hull(name, solid.hull, "")
            except ConfigError as error:
                problem = str(error).partition(f"{shown_name(name)}: ")[2]
                yield warning(f"{shown_name(name)}, with physics: {problem}")
            except ImportError:
                return


def _robot(
    place: str, robot: RobotSpec, each: SpawnedRobot, line_map: LineMap
) -> Iterator[MapProblem]:
    """Yield the problems of a robot and its start."""
    asked = robot.start
    if isinstance(asked, Pose2):
        problem = room(asked, line_map, each.model) if len(line_map.walls) else ""
        if problem:
            yield warning(f"{place}.start {problem}")
        elif each.pose != asked:
            yield warning(f"{place}.start: another robot stands there, it begins beside it")
        elif each.in_the_way:
            yield warning(f"{place}.start: a movable box or a person stands there")
    if robot.equipment.table_ir in {"old", "new"} and not each.model.table_irs:
        yield warning(f"{place}.equipment.table_ir: {each.model.name} has no table sensors")


def check_aria(path: Path, text: str) -> Iterator[MapProblem]:
    """Yield the problems in the text of an ARIA map, line by line."""
    errors: list[ConfigError] = []

    def note(error: ConfigError) -> None:
        if len(errors) < MOST_ERRORS:
            errors.append(error)

    try:
        file = parse_aria(path, text, note)
    except ConfigError as error:
        yield as_finding(path, error)
        return
    yield from some((as_finding(path, error) for error in errors), "errors")
    yield from _header(file)
    for section in file.sections:
        if section.kind == "LINES":
            yield from some(_without_length(section), "lines without length")
            yield from some(_doubles(section), "doubled lines")


def as_finding(path: Path, error: ConfigError) -> MapProblem:
    """Return an error about the file at `path` as a finding, with its line as a number."""
    text = str(error).removeprefix(f"{path}:").strip()
    number, _, rest = text.partition(":")
    line = int(number) if number.isdecimal() else None
    return MapProblem(level=Severity.ERROR, text=rest.strip() if line else text, line=line)


def _header(file: AriaFile) -> Iterator[MapProblem]:
    """Yield the entries of the header that disagree with the rest, or count for nothing here."""
    routes = next((entry for entry in file.entries if entry.key in ROUTES), None)
    if routes:
        yield warning("routes and tasks are kept, and not driven: see patrol", routes.line.number)
    for entry in file.entries:
        if entry.key.endswith("Resolution"):
            yield from _no_resolution(file, entry)
        for section in file.sections:
            if entry.key == section.source + _COUNTS[section.kind]:
                there = len(section.rows)
                if entry.value.strip() != str(there):
                    said = f"{entry.key} says {entry.value[:20]!a}, there are {there}"
                    yield warning(said, entry.line.number)
            elif entry.key in [section.source + key for key in _BOXES[section.kind]]:
                corner = _corner(section, is_low="Min" in entry.key)
                if corner and not _agrees(entry.value, corner):
                    x, y = corner
                    said = f"{entry.key} says {entry.value[:30]!a}, it is {x:g} {y:g}"
                    yield warning(said, entry.line.number)


def _no_resolution(file: AriaFile, entry: AriaEntry) -> Iterator[MapProblem]:
    """Yield a resolution of 0 or less, if there are cells that it is for."""
    try:
        told = resolution_mm(entry)
    except ConfigError:  # an error of the whole map, which is told besides
        return
    cells = any(section.kind == "DATA" and len(section.rows) for section in file.sections)
    if told is None and cells:
        usual = f"{DEFAULT_RESOLUTION_MM:g} mm count"
        yield warning(f"{entry.key} says {entry.value[:20]!a}: {usual}", entry.line.number)


def _corner(section: Section, *, is_low: bool) -> tuple[float, float] | None:
    """Return the lowest or highest x and y of a section [mm]."""
    points = section.rows.reshape(-1, 2)
    if not len(points):
        return None
    x, y = (points.min(axis=0) if is_low else points.max(axis=0)).tolist()
    return x, y


def _agrees(value: str, corner: tuple[float, float]) -> bool:
    try:
        numbers = [float(word) for word in value.split()]
    except ValueError:
        return False
    return len(numbers) == 2 and all(
        abs(said - true) <= ROUNDING_MM for said, true in zip(numbers, corner, strict=True)
    )


def _rows(section: Section) -> Iterator[tuple[tuple[float, ...], int]]:
    """Yield each row with its line."""
    yield from zip(map(tuple, section.rows.tolist()), section.at.tolist(), strict=True)


def _without_length(section: Section) -> Iterator[MapProblem]:
    for row, line in _rows(section):
        if row[:2] == row[2:]:
            yield warning(f"a line without length at {row[0]:g} {row[1]:g}", line)


def _doubles(section: Section) -> Iterator[MapProblem]:
    seen: dict[tuple[float, ...], int] = {}
    for row, line in _rows(section):
        key = min(row, row[2:] + row[:2])
        if key in seen:
            yield warning(f"the same line as on line {seen[key]}", line)
        seen.setdefault(key, line)


def check_places(
    line_map: LineMap,
    model: RobotModel,
    lines: dict[int, int] | None = None,
    *,
    starts: bool = False,
) -> Iterator[MapProblem]:
    """Yield the homes where the robot does not fit, and the goals that it cannot reach.

    `lines` has the line of the file of each object, by its index in the map, as far as known.
    With `starts` there are robots that need no home.
    """
    known = lines or {}
    placed = [(item, known.get(at)) for at, item in enumerate(line_map.objects)]
    if not len(line_map.walls):
        yield warning("there is no wall")
        return
    homes = [(item, line) for item, line in placed if item.kind == "RobotHome"]
    if not homes and not starts:
        yield warning("there is no RobotHome: robots start at the origin of the map")
    for item, line in homes:
        problem = room(item.pose, line_map, model)
        if problem:
            yield warning(f"{shown(item)} {problem}", line)
    yield from some(_doubled(placed), "names")
    yield from some(_unheeded(placed), "areas and lines")
    goals = [(item, line) for item, line in placed if item.kind in GOALS]
    yield from some(_unreachable(line_map, model, goals), "goals")


Placed = Sequence[tuple[MapObject, int | None]]
"""Objects, and their lines of the file as far as known."""


def _doubled(placed: Placed) -> Iterator[MapProblem]:
    """Yield the places that have the name of another one: `goto` refuses it."""
    seen: dict[str, tuple[MapObject, int | None]] = {}
    for item, line in placed:
        key = item.name.strip().casefold()
        if not key or item.outline:
            continue
        first, at = seen.setdefault(key, (item, line))
        if first is not item:
            where = f" on line {at}" if at else f" at {first.pose.x:.2f} {first.pose.y:.2f}"
            yield warning(f"{shown(item)} has the name of {shown(first)}{where}: rename one", line)


def _unheeded(placed: Placed) -> Iterator[MapProblem]:
    """Yield the areas and lines that are drawn and no more, or count on planned ways alone."""
    for item, line in placed:
        if item.one_way or item.restrictive:
            told = "planned ways heed it, keys and straight drives do not"
        elif item.outline and not (item.solid or item.forbidden or item.speed is not None):
            told = "it is drawn, and robots do not heed it; they heed ForbiddenArea and SpeedArea"
        else:
            continue
        yield warning(f"{shown(item)}: {told}", line)


def room(pose: Pose2, line_map: LineMap, model: RobotModel) -> str:
    """Return the reason why `model` does not fit at `pose`, or an empty text."""
    walls, bounds = line_map.walls, line_map.bounds
    if not (bounds.x_min <= pose.x <= bounds.x_max and bounds.y_min <= pose.y <= bounds.y_max):
        return "is outside the walls"
    if footprint_hits(pose, model.length_front, model.length_rear, model.width / 2, walls):
        return f"stands in a wall: no room for {model.name}"
    nearest = float(distances(np.array([pose.x, pose.y]), walls).min())
    if nearest < model.radius:
        return f"is {nearest:.2f} m from a wall: {model.name} needs {model.radius:.2f} m to turn"
    return ""


def shown(item: MapObject) -> str:
    """Return a name of an object for messages."""
    name, kind = printable(item.name[:30]), printable(item.kind[:30])
    return f'{kind} "{name}"' if name else f"{kind} at {item.pose.x:.2f} {item.pose.y:.2f}"


def _unreachable(
    line_map: LineMap, model: RobotModel, goals: list[tuple[MapObject, int | None]]
) -> Iterator[MapProblem]:
    """Yield the goals that cannot be reached without touching walls or forbidden lines."""
    starts = [(home.x, home.y) for home in line_map.homes]
    origin = "any home"
    if not starts:
        others = [item for item in line_map.objects if item.kind.startswith("Dock")]
        first = (others or [item for item, _ in goals])[:1]
        starts = [(item.pose.x, item.pose.y) for item in first]
        origin = shown(first[0]) if first else ""
    if not starts or not goals:
        return
    forbidden = [side for o in line_map.objects if o.kind in FORBIDDEN for side in o.sides]
    barriers = np.concatenate([line_map.walls, np.array(forbidden).reshape(-1, 4)])
    places = np.array([*starts, *((item.pose.x, item.pose.y) for item, _ in goals)])
    low = np.minimum(line_map.bounds[:2], places.min(axis=0)).tolist()
    high = np.maximum(line_map.bounds[2:], places.max(axis=0)).tolist()
    floor = FreeGrid(barriers, Extent(*low, *high), model.width / 2)
    reached = floor.reached_from(starts)
    for item, line in goals:
        if not floor.is_free(item.pose.x, item.pose.y):
            yield warning(f"{shown(item)} is too near to a wall or forbidden line", line)
        elif not reached[floor.cell_of((item.pose.x, item.pose.y))]:
            yield warning(f"{shown(item)} cannot be reached from {origin}", line)
