"""Reads world files: TOML with a `[world]`, and tables of robots, boxes, walls, places, people."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType

from pioneer3.geometry import Pose2
from pioneer3.models.toml import load_toml
from pioneer3.sim.maps.read import is_world
from pioneer3.sim.maps.shipped import shipped_maps
from pioneer3.sim.maps.text import decoded, read_bytes, shown, wrong
from pioneer3.sim.worldfile.fitting import AS_DELIVERED, read_fitting
from pioneer3.sim.worldfile.fitting import KEYS as EQUIPMENT
from pioneer3.sim.worldfile.person import RADIUS, SPEED, Person
from pioneer3.sim.worldfile.spec import Box, Place, RobotSpec, Start, Wall, WorldFile
from pioneer3.sim.worldfile.table import FARTHEST, Source, Table

LARGEST_WORLD = 1 << 20
"""Larger files are not worlds [bytes]; tomllib takes seconds for what is much larger."""
LARGEST_SEED = 2**63 - 1

PLACES = {"goal": "Goal", "dock": "Dock", "home": "RobotHome"}
"""Tables of places, and ARIA's type of each; a goal with a heading is a GoalWithHeading."""
_PLACE = ("x", "y", "theta_deg", "name")
KEYS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "world": ("name", "map", "seed", "keep_session"),
        "robot": ("model", "name", "start", "port", "equipment"),
        "robot.start": ("x", "y", "theta_deg"),
        "robot.equipment": EQUIPMENT,
        "box": ("center", "size", "theta_deg", "movable", "name"),
        "wall": ("points", "closed"),
        **dict.fromkeys(PLACES, _PLACE),
        "person": ("path", "speed", "radius", "loop", "pause", "name"),
    }
)
"""Every table of a world file and its keys."""
TABLES = tuple(table for table in KEYS if "." not in table)
_STARTS = ("random", "outside", "home")
MODEL_FILES = (".toml", ".p")


def read_world(path: Path) -> WorldFile:
    """Read a world file; the map it names is read by :meth:`WorldFile.line_map`.

    Raises:
        ConfigError: It cannot be read, or is wrong; names file, line and field.
    """
    return parse_world(path, decoded(read_bytes(path, LARGEST_WORLD)))


def parse_world(path: Path, text: str) -> WorldFile:
    """Read the text of a world file; paths in it count from the file's folder.

    Raises:
        ConfigError: It is wrong; names file, line and field.
    """
    name = str(path) if str(path).isprintable() else ascii(str(path))
    try:
        data = load_toml(text)
    except ValueError as error:
        problem = " ".join(str(error).split())
        problem = problem if problem.isprintable() else ascii(problem)
        raise wrong(path, f" not valid TOML: {problem}") from None
    top = Table(Source(name, text), "", data)
    top.only(TABLES)
    world = top.table("world")
    if world is None:
        raise wrong(path, " world: missing; a world starts with [world]")
    world.only(KEYS["world"])
    robots = tuple(_robot(table, path) for table in top.tables("robot"))
    _refuse_twins(top, robots)
    return WorldFile(
        name=world.string("name", path.stem),
        map=_map(world, path),
        seed=world.whole("seed", 0, LARGEST_SEED),
        keep_session=world.flag("keep_session", default=False),
        robots=robots,
        boxes=tuple(map(_box, top.tables("box"))),
        walls=tuple(map(_wall, top.tables("wall"))),
        places=tuple(_places(top)),
        people=tuple(map(_person, top.tables("person"))),
    )


def _map(world: Table, path: Path) -> str | Path:
    name = world.string("map", "empty")
    if name == "empty" or name in shipped_maps():
        return name
    if is_world(Path(name)):
        raise world.wrong("map", f"{shown(name)} is a world too; give a .map or .yaml file")
    found = path.parent / name
    try:
        if found.is_file():
            return found
    except (OSError, ValueError):
        pass
    ships = ", ".join((*shipped_maps(), "empty"))
    raise world.wrong("map", f"no such file: {shown(name)}, seen from here; there ships {ships}")


def _robot(table: Table, path: Path) -> RobotSpec:
    table.only(KEYS["robot"])
    model = table.string("model", RobotSpec().model)
    if Path(model).suffix.lower() in MODEL_FILES:
        model = str(path.parent / model)
    equipment = table.table("equipment")
    return RobotSpec(
        model=model,
        name=table.string("name", ""),
        start=_start(table),
        port=table.whole("port", 1, 65535),
        equipment=read_fitting(equipment) if equipment else AS_DELIVERED,
    )


def _start(table: Table) -> Start:
    start = table.data.get("start", "home")
    if isinstance(start, dict):
        place = Table(table.source, f"{table.place}.start", start)
        place.only(KEYS["robot.start"])
        return place.pose()
    match start:
        case "random" | "outside" | "home":
            return start
    words = " or ".join(f'"{word}"' for word in _STARTS)
    raise table.wrong("start", f"expected {{x, y, theta_deg}} or {words}")


def _refuse_twins(top: Table, robots: tuple[RobotSpec, ...]) -> None:
    for key in ("name", "port"):
        seen: dict[object, int] = {}
        for index, robot in enumerate(robots):
            value = robot.name if key == "name" else robot.port
            if value and value in seen:
                problem = f"{value} is robot[{seen[value]}]'s already"
                raise top.wrong(f"robot[{index}].{key}", problem)
            seen[value] = index


def _box(table: Table) -> Box:
    table.only(KEYS["box"])
    return Box(
        pose=Pose2(*table.pair("center", -FARTHEST, FARTHEST), table.angle("theta_deg")),
        size=table.pair("size", 0.01, 1000.0),
        movable=table.flag("movable", default=False),
        name=table.string("name", ""),
    )


def _wall(table: Table) -> Wall:
    table.only(KEYS["wall"])
    return Wall(points=table.points("points", 2), closed=table.flag("closed", default=False))


def _places(top: Table) -> Iterator[Place]:
    for key, kind in PLACES.items():
        for table in top.tables(key):
            table.only(KEYS[key])
            heading = key == "goal" and "theta_deg" in table.data
            exact = "GoalWithHeading" if heading else kind
            yield Place(kind=exact, pose=table.pose(), name=table.string("name", ""))


def _person(table: Table) -> Person:
    table.only(KEYS["person"])
    return Person(
        path=table.points("path", 1),
        speed=table.number("speed", 0.01, 10.0, SPEED),
        radius=table.number("radius", 0.05, 2.0, RADIUS),
        loop=table.flag("loop", default=True),
        pause=table.number("pause", 0.0, 3600.0, 0.0),
        name=table.string("name", ""),
    )
