"""Checks a map or world file: all that is wrong with it, not only the first."""

from collections.abc import Iterator
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path

from numpy.random import default_rng

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.maps.aria import AriaFile
from pioneer3.sim.maps.line_map import LineMap
from pioneer3.sim.maps.read import read_plan
from pioneer3.sim.maps.server import KEYS, ServerFile
from pioneer3.sim.maps.text import decoded, read_bytes
from pioneer3.sim.population.populate import Inhabitant, populate
from pioneer3.sim.worldfile.check_aria import as_remark, check_aria
from pioneer3.sim.worldfile.check_places import check_places, room
from pioneer3.sim.worldfile.load import load_world
from pioneer3.sim.worldfile.remark import Level, Remark, warning
from pioneer3.sim.worldfile.spec import RobotSpec, WorldFile


def check_world(name_or_path: str | Path, model: RobotModel) -> tuple[Remark, ...]:
    """Return all that is wrong with a map or world, errors first, then by line.

    Args:
        name_or_path: As for :func:`pioneer3.sim.worldfile.load_world`.
        model: The robot that homes and goals must have room for.
    """
    found = list(_remarks(name_or_path, model))
    return tuple(sorted(found, key=lambda r: (r.level is not Level.ERROR, r.line or 0)))


def _remarks(name_or_path: str | Path, model: RobotModel) -> Iterator[Remark]:
    path = Path(name_or_path)
    try:
        world = load_world(name_or_path)
        if isinstance(world.map, Path) and world.map == path:
            yield from _plan(path, model)
        else:
            yield from _world(world, model)
    except ConfigError as error:
        yield as_remark(path, error)


def _plan(path: Path, model: RobotModel) -> Iterator[Remark]:
    """Yield what is wrong with a file that holds a map and no more."""
    try:
        file: AriaFile | ServerFile = read_plan(path)
    except ConfigError as error:
        remarks = tuple(check_aria(path, decoded(read_bytes(path)))) if _is_aria(path) else ()
        yield from remarks or (as_remark(path, error),)
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


def _unknown_keys(file: ServerFile) -> Iterator[Remark]:
    for key, field in file.fields.items():
        if key not in KEYS:
            close = get_close_matches(key, KEYS, n=1)
            hint = f", did you mean {close[0]}?" if close else ""
            name = key if key.isprintable() else ascii(key)
            yield warning(f"{name}: unknown key, skipped{hint}", field.line.number)


def _world(world: WorldFile, model: RobotModel) -> Iterator[Remark]:
    line_map = world.line_map()
    yield from check_places(line_map, model)
    sound: dict[int, RobotSpec] = {}
    for index, robot in enumerate(world.robots):
        try:
            load_model(robot.model)
        except ConfigError as error:
            yield Remark(level=Level.ERROR, text=f"robot[{index}].model: {error}")
            continue
        sound[index] = robot
        if robot.start == "home" and not line_map.starts:
            yield warning(f"robot[{index}].start: there is no home and no dock")
    try:
        cleared = replace(world, robots=tuple(sound.values()))
        crew = populate(cleared, line_map, default_rng(world.seed))
    except ConfigError as error:
        yield Remark(level=Level.ERROR, text=str(error))
        return
    for (index, robot), each in zip(sound.items(), crew, strict=True):
        yield from _robot(f"robot[{index}]", robot, each, line_map)


def _robot(place: str, robot: RobotSpec, each: Inhabitant, line_map: LineMap) -> Iterator[Remark]:
    """Yield what is wrong with a robot and where it begins."""
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
