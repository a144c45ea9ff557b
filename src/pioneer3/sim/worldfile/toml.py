"""Reads and writes world files: TOML with a table for each object of a world.

The keys and their ranges are the fields of those objects, and :mod:`pioneer3.tables` reads them.
"""

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain
from os.path import relpath
from pathlib import Path
from typing import Annotated, Any, get_type_hints

from msgspec import Meta

from pioneer3.maps import shipped_maps
from pioneer3.maps.materials import Material
from pioneer3.names import printable
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.relief import (
    SOLIDS,
    Carpet,
    Cylinder,
    HeightField,
    Mesh,
    Ramp,
    Solid,
    Step,
    Table,
)
from pioneer3.sim.relief.shapes import Angle, Coordinate, pose_of
from pioneer3.sim.worldfile.person import Person
from pioneer3.sim.worldfile.solid_checks import check_solids
from pioneer3.sim.worldfile.spec import Box, Place, RobotSpec, Wall, WorldFile
from pioneer3.tables import Source, converted, degrees_of, keys, load, table_of, written
from pioneer3.text import decoded, read_bytes, shown, write_bytes

LARGEST_WORLD = 1 << 20
"""Larger files are not read [bytes]; tomllib takes seconds for them."""
MODEL_FILES = (".toml", ".p")
KINDS = {"goal": "Goal", "dock": "Dock", "home": "RobotHome"}
"""ARIA's type of the places in each table; a goal with a heading is a GoalWithHeading."""
_ALONE = {"bumpers": "5", "gyro": "1", "table_ir": "new"}
"""Values of the words of `--fit` that may stand without one; a switch is on then."""
_EXAMPLES = {"camera": "vcc4", "laser": "utm-30lx", "laser_port": "10940", "picture_port": "8181"}


def is_world(path: Path) -> bool:
    """Whether the name is that of a world file."""
    return path.suffix.lower() == ".toml"


def read_world(path: Path) -> WorldFile:
    """Read a world file, but not its map; ConfigError, with line and key, if it is wrong."""
    return parse_world(path, decoded(read_bytes(path, LARGEST_WORLD)))


def parse_world(path: Path, text: str) -> WorldFile:
    """Read the text of a world file; paths in it are relative to the file's folder.

    Raises:
        ConfigError: It is wrong; names file, line and key.
    """
    source = Source.of(path, text)
    tables = load(source)
    if isinstance(tables.get("world"), dict):
        tables["world"].setdefault("name", printable(path.stem))
    file = converted(source, tables, Tables)
    robots = tuple(
        _with_model(robot, lambda model: str(path.parent / model)) for robot in file.robot
    )
    _refuse_doubles(source, robots)
    _refuse_movable_glass(source, file.box)
    world = replace(
        file.world,
        map=_map(source, path, str(file.world.map)),
        robots=robots,
        boxes=file.box,
        walls=file.wall,
        places=tuple(
            table.place(kind) for key, kind in KINDS.items() for table in getattr(file, key)
        ),
        people=file.person,
        solids=tuple(_file_beside(path, solid) for solid in file.solids),
        source=source.name,
    )
    check_solids(source, world)
    return world


def parse_equipment(text: str) -> EquipmentOptions:
    """Read the value of `--fit`, such as `gripper,gyro=2,camera=vcc4`; ConfigError for others."""
    switches = get_type_hints(EquipmentOptions).items()
    alone = {name: "true" for name, kind in switches if kind == bool | None} | _ALONE
    source = Source("--fit", "")
    said: dict[str, object] = {}
    for word in filter(None, (word.strip() for word in text.split(","))):
        key, equals, value = (part.strip() for part in word.partition("="))
        key = key.replace("-", "_")
        if key in keys(EquipmentOptions) and not equals and key not in alone:
            value = _EXAMPLES.get(key, "1")
            example = f"{key.replace('_', '-')}={value}"
            raise source.wrong(key, f"needs a value, such as {example}")
        said[key] = _scalar(value if equals else alone.get(key, "true"))
    return converted(source, said, EquipmentOptions)


def write_world(world: WorldFile, path: Path) -> None:
    """Write a world file, whose paths are relative to its folder; ConfigError if that fails."""
    write_bytes(path, to_toml(world, path.parent).encode())


def to_toml(world: WorldFile, folder: Path) -> str:
    """Return the text of a world file that lies in `folder`; defaults are left out."""

    def relative(path: Path) -> str:
        return path.as_posix() if path.is_absolute() else Path(relpath(path, folder)).as_posix()

    map_name = relative(world.map) if isinstance(world.map, Path) else world.map
    many: dict[str, Any] = {key: _places(world, key) for key in KINDS} | {
        kind.table: tuple(
            replace(solid, file=Path(relative(solid.file)))
            if isinstance(solid, HeightField | Mesh)
            else solid
            for solid in world.solids
            if isinstance(solid, kind)
        )
        for kind in SOLIDS
    }
    tables = Tables(
        world=replace(world, map=map_name),
        robot=tuple(_with_model(robot, relative) for robot in world.robots),
        box=world.boxes,
        wall=world.walls,
        person=world.people,
        **many,
    )
    return written(table_of(tables))


@dataclass(frozen=True, slots=True, kw_only=True)
class _PlaceTable:
    """`[[goal]]`, `[[dock]]` or `[[home]]`; a goal with `theta_deg` has a heading."""

    x: Coordinate
    y: Coordinate
    theta_deg: Angle | None = None
    name: str = ""

    def place(self, kind: str) -> Place:
        """Return the place; `kind` is ARIA's type."""
        if kind == "Goal" and self.theta_deg is not None:
            kind = "GoalWithHeading"
        return Place(kind=kind, pose=pose_of(self.x, self.y, self.theta_deg or 0.0), name=self.name)

    @classmethod
    def of(cls, place: Place) -> "_PlaceTable":
        """Return the table of a place."""
        heading = None if place.kind == "Goal" else degrees_of(place.pose.theta)
        return cls(x=place.pose.x, y=place.pose.y, theta_deg=heading, name=place.name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tables:
    """All tables of a world file."""

    world: Annotated[WorldFile, Meta(extra={"missing": "missing; a world starts with [world]"})]
    robot: tuple[RobotSpec, ...] = ()
    box: tuple[Box, ...] = ()
    wall: tuple[Wall, ...] = ()
    goal: tuple[_PlaceTable, ...] = ()
    dock: tuple[_PlaceTable, ...] = ()
    home: tuple[_PlaceTable, ...] = ()
    person: tuple[Person, ...] = ()
    step: tuple[Step, ...] = ()
    ramp: tuple[Ramp, ...] = ()
    carpet: tuple[Carpet, ...] = ()
    cylinder: tuple[Cylinder, ...] = ()
    table: tuple[Table, ...] = ()
    heightfield: tuple[HeightField, ...] = ()
    mesh: tuple[Mesh, ...] = ()

    @property
    def solids(self) -> Iterator[Solid]:
        """All solids, by kind."""
        return chain.from_iterable(getattr(self, kind.table) for kind in SOLIDS)


def _map(source: Source, path: Path, name: str) -> str | Path:
    if name == "empty" or name in shipped_maps():
        return name
    if is_world(Path(name)):
        problem = f"{shown(name)} is a world too; give a .map or .yaml file"
        raise source.wrong("world.map", problem)
    found = path.parent / name
    with suppress(OSError, ValueError):
        if found.is_file():
            return found
    ships = ", ".join((*shipped_maps(), "empty"))
    problem = f"no such file: {shown(name)}, seen from here; there ships {ships}"
    raise source.wrong("world.map", problem)


def _with_model(robot: RobotSpec, path_of: Callable[[Path], str]) -> RobotSpec:
    """Return `robot` with another path of its model's file, if it has one."""
    model = Path(robot.model)
    return replace(robot, model=path_of(model)) if model.suffix.lower() in MODEL_FILES else robot


def _file_beside(path: Path, solid: Solid) -> Solid:
    """Return `solid` with the path of its file, if it has one."""
    if isinstance(solid, HeightField | Mesh):
        return replace(solid, file=path.parent / solid.file)
    return solid


def _refuse_doubles(source: Source, robots: tuple[RobotSpec, ...]) -> None:
    for key in ("name", "port"):
        seen: dict[object, int] = {}
        for index, robot in enumerate(robots):
            value = robot.name if key == "name" else robot.port
            if value and value in seen:
                problem = f"{value} is robot[{seen[value]}]'s already"
                raise source.wrong(f"robot[{index}].{key}", problem)
            seen[value] = index


def _refuse_movable_glass(source: Source, boxes: tuple[Box, ...]) -> None:
    for index, box in enumerate(boxes):
        if box.movable and box.material is Material.GLASS:
            problem = "a movable box is never of glass: take another material, or movable = false"
            raise source.wrong(f"box[{index}].material", problem)


def _scalar(text: str) -> object:
    """Return `text` as TOML would: true or false, a number, else a text."""
    if text in {"true", "false"}:
        return text == "true"
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _places(world: WorldFile, key: str) -> tuple[_PlaceTable, ...]:
    """Return the places of one table; those of unknown kinds are goals."""
    keys_of = {kind: key for key, kind in KINDS.items()}
    places = (place for place in world.places if keys_of.get(place.kind, "goal") == key)
    return tuple(map(_PlaceTable.of, places))
