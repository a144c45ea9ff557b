"""Reads and writes world files: TOML with the tables of :mod:`pioneer3.sim.worldfile.schema`.

:mod:`pioneer3.tables` checks them, and words the errors.
"""

from dataclasses import replace
from os.path import relpath
from pathlib import Path
from typing import Any, get_type_hints

from pioneer3.maps import shipped_maps
from pioneer3.maps.materials import Material
from pioneer3.maps.text import decoded, read_bytes, shown, write_bytes
from pioneer3.sim.equipment import EquipmentOptions
from pioneer3.sim.relief import SOLIDS, HeightField, Mesh
from pioneer3.sim.worldfile.solid_checks import check_solids
from pioneer3.sim.worldfile.spec import PHYSICS_STEP, Box, Place, RobotSpec, WorldFile
from pioneer3.tables import Source, converted, load, written

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
    """Read a world file; the map it names is read by :meth:`WorldFile.line_map`.

    Raises:
        ConfigError: It cannot be read, or is wrong; names file, line and key.
    """
    return parse_world(path, decoded(read_bytes(path, LARGEST_WORLD)))


def parse_world(path: Path, text: str) -> WorldFile:
    """Read the text of a world file; paths in it are relative to the file's folder.

    Raises:
        ConfigError: It is wrong; names file, line and key.
    """
    from pioneer3.sim.worldfile.schema import FileTable  # imports msgspec

    source = Source.of(path, text)
    file = converted(source, load(path, text), FileTable)
    robots = tuple(_model_beside(path, table.robot()) for table in file.robot)
    _refuse_doubles(source, robots)
    boxes = tuple(table.box() for table in file.box)
    _refuse_movable_glass(source, boxes)
    tables = {"goal": file.goal, "dock": file.dock, "home": file.home}
    solids = [getattr(file, kind.table) for kind in SOLIDS]
    world = WorldFile(
        name=path.stem if file.world.name is None else file.world.name,
        map=_map(source, path, file.world.map),
        seed=file.world.seed,
        keep_session=file.world.keep_session,
        physics=file.world.physics,
        physics_step=round(file.world.physics_step_ms / 1000, 9),
        wall_height=file.world.wall_height,
        robots=robots,
        boxes=boxes,
        walls=tuple(table.wall() for table in file.wall),
        places=tuple(table.place(KINDS[key]) for key in KINDS for table in tables[key]),
        people=tuple(table.person() for table in file.person),
        solids=tuple(table.solid(path.parent) for kind in solids for table in kind),
        source=source.name,
    )
    check_solids(source, world)
    return world


def parse_equipment(text: str) -> EquipmentOptions:
    """Read the value of `--fit`, such as `gripper,gyro=2,camera=vcc4,table-ir=new`.

    Raises:
        ConfigError: A word is unknown, or its value is wrong.
    """
    from pioneer3.sim.worldfile.schema import EquipmentTable  # imports msgspec

    switches = get_type_hints(EquipmentOptions).items()
    alone = {name: "true" for name, kind in switches if kind == bool | None} | _ALONE
    source = Source("--fit", "")
    said: dict[str, object] = {}
    for word in filter(None, (word.strip() for word in text.split(","))):
        key, equals, value = (part.strip() for part in word.partition("="))
        key = key.replace("-", "_")
        if key in EquipmentTable.__struct_encode_fields__ and not equals and key not in alone:
            value = _EXAMPLES.get(key, "1")
            example = f"{key.replace('_', '-')}={value}"
            raise source.wrong(key, f"needs a value, such as {example}")
        said[key] = _scalar(value if equals else alone.get(key, "true"))
    return converted(source, said, EquipmentTable).options()


def write_world(world: WorldFile, path: Path) -> None:
    """Write a world file; paths in it are relative to its folder.

    Raises:
        ConfigError: It cannot be written.
    """
    write_bytes(path, to_toml(world, path.parent).encode())


def to_toml(world: WorldFile, folder: Path) -> str:
    """Return the text of a world file that lies in `folder`; defaults are left out."""
    from pioneer3.sim.worldfile import schema  # imports msgspec

    places = {key: tuple(p for p in world.places if _key(p) == key) for key in KINDS}
    file = schema.FileTable(
        world=schema.WorldTable(
            name=world.name,
            map=_relative(world.map, folder) if isinstance(world.map, Path) else world.map,
            seed=world.seed,
            keep_session=world.keep_session,
            physics=world.physics,
            physics_step_ms=(
                schema.STEP_MS
                if world.physics_step == PHYSICS_STEP
                else round(world.physics_step * 1000, 6)
            ),
            wall_height=world.wall_height,
        ),
        robot=tuple(schema.RobotTable.of(_relative_model(r, folder)) for r in world.robots),
        box=tuple(map(schema.BoxTable.of, world.boxes)),
        wall=tuple(map(schema.WallTable.of, world.walls)),
        goal=tuple(map(schema.PlaceTable.of, places["goal"])),
        dock=tuple(map(schema.PlaceTable.of, places["dock"])),
        home=tuple(map(schema.PlaceTable.of, places["home"])),
        person=tuple(map(schema.PersonTable.like, world.people)),
        **_solid_tables(world, folder),
    )
    return written(file)


def _solid_tables(world: WorldFile, folder: Path) -> dict[str, Any]:
    """Return the tables of all solids, by kind."""
    from pioneer3.sim.worldfile.solid_tables import TABLES

    return {
        table.kind.table: tuple(
            table.of(solid, file=_relative(solid.file, folder))
            if isinstance(solid, HeightField | Mesh)
            else table.of(solid)
            for solid in world.solids
            if isinstance(solid, table.kind)
        )
        for table in TABLES
    }


def _map(source: Source, path: Path, name: str) -> str | Path:
    if name == "empty" or name in shipped_maps():
        return name
    if is_world(Path(name)):
        problem = f"{shown(name)} is a world too; give a .map or .yaml file"
        raise source.wrong("world.map", problem)
    found = path.parent / name
    try:
        if found.is_file():
            return found
    except (OSError, ValueError):
        pass
    ships = ", ".join((*shipped_maps(), "empty"))
    problem = f"no such file: {shown(name)}, seen from here; there ships {ships}"
    raise source.wrong("world.map", problem)


def _model_beside(path: Path, robot: RobotSpec) -> RobotSpec:
    """Return `robot` with the path of its model's file, which is relative to the world file."""
    is_file = Path(robot.model).suffix.lower() in MODEL_FILES
    return replace(robot, model=str(path.parent / robot.model)) if is_file else robot


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


def _key(place: Place) -> str:
    return {"Dock": "dock", "RobotHome": "home"}.get(place.kind, "goal")


def _relative_model(robot: RobotSpec, folder: Path) -> RobotSpec:
    is_file = Path(robot.model).suffix.lower() in MODEL_FILES
    return replace(robot, model=_relative(Path(robot.model), folder)) if is_file else robot


def _relative(path: Path, folder: Path) -> str:
    return path.as_posix() if path.is_absolute() else Path(relpath(path, folder)).as_posix()
