"""Writes world files."""

from collections.abc import Iterator
from math import degrees
from os.path import relpath
from pathlib import Path

from pioneer3.geometry import Pose2
from pioneer3.sim.maps.text import write_bytes
from pioneer3.sim.worldfile.fitting import Fitting
from pioneer3.sim.worldfile.parse import PLACES
from pioneer3.sim.worldfile.person import Person, Point
from pioneer3.sim.worldfile.spec import Box, Place, RobotSpec, Wall, WorldFile


def write_world(world: WorldFile, path: Path) -> None:
    """Write a world file; paths in it are relative to its folder.

    Raises:
        ConfigError: It cannot be written.
    """
    write_bytes(path, to_toml(world, path.parent).encode())


def to_toml(world: WorldFile, folder: Path) -> str:
    """Return the text of a world file that lies in `folder`; what is as usual is left out."""
    return "\n".join("\n".join(block) + "\n" for block in _blocks(world, folder))


def _blocks(world: WorldFile, folder: Path) -> Iterator[list[str]]:
    map_name = _relative(world.map, folder) if isinstance(world.map, Path) else world.map
    seed = [f"seed = {world.seed}"] if world.seed is not None else []
    kept = ["keep_session = true"] if world.keep_session else []
    yield ["[world]", f"name = {_text(world.name)}", f"map = {_text(map_name)}", *seed, *kept]
    for robot in world.robots:
        yield ["[[robot]]", *_robot(robot, folder)]
    for box in world.boxes:
        yield ["[[box]]", *_box(box)]
    for wall in world.walls:
        yield ["[[wall]]", *_wall(wall)]
    # as they are read: one kind after another
    for key in PLACES:
        for place in world.places:
            if _key(place) == key:
                yield [f"[[{key}]]", *_place(place)]
    for person in world.people:
        yield ["[[person]]", *_person(person)]


def _robot(robot: RobotSpec, folder: Path) -> Iterator[str]:
    is_file = Path(robot.model).suffix.lower() in {".toml", ".p"}
    yield f"model = {_text(_relative(Path(robot.model), folder) if is_file else robot.model)}"
    if robot.name:
        yield f"name = {_text(robot.name)}"
    if isinstance(robot.start, Pose2):
        yield f"start = {{ {', '.join(_pose(robot.start))} }}"
    else:
        yield f"start = {_text(robot.start)}"
    if robot.port is not None:
        yield f"port = {robot.port}"
    fitted = list(_fitting(robot.equipment))
    if fitted:
        yield f"equipment = {{ {', '.join(fitted)} }}"


def _fitting(fitting: Fitting) -> Iterator[str]:
    for key, value in (
        ("gripper", fitting.gripper),
        ("compass", fitting.compass),
        ("gyro", fitting.gyro_type),
        ("bumpers", fitting.bumpers),
        ("joystick", fitting.joystick),
        ("camera", fitting.camera),
        ("camera_port", fitting.camera_port),
        ("table_ir", fitting.table_ir),
    ):
        if value is not None:
            shown = _text(value) if isinstance(value, str) else str(value).lower()
            yield f"{key} = {shown}"
    for key, angle in (
        ("north_deg", fitting.north),
        ("compass_noise_deg", fitting.compass_noise),
        ("gyro_bias_deg_s", fitting.gyro_bias),
        ("gyro_noise_deg_s", fitting.gyro_noise),
    ):
        if angle is not None:
            yield f"{key} = {_angle(angle)}"


def _box(box: Box) -> Iterator[str]:
    yield f"center = {_point((box.pose.x, box.pose.y))}"
    yield f"size = {_point(box.size)}"
    if box.pose.theta:
        yield f"theta_deg = {_angle(box.pose.theta)}"
    if box.movable:
        yield "movable = true"
    if box.name:
        yield f"name = {_text(box.name)}"


def _wall(wall: Wall) -> Iterator[str]:
    yield f"points = [{', '.join(map(_point, wall.points))}]"
    if wall.closed:
        yield "closed = true"


def _place(place: Place) -> Iterator[str]:
    yield from _pose(place.pose, heading=place.kind != "Goal")
    if place.name:
        yield f"name = {_text(place.name)}"


def _person(person: Person) -> Iterator[str]:
    yield f"path = [{', '.join(map(_point, person.path))}]"
    yield f"speed = {_number(person.speed)}"
    yield f"radius = {_number(person.radius)}"
    yield f"loop = {str(person.loop).lower()}"
    if person.pause:
        yield f"pause = {_number(person.pause)}"
    if person.name:
        yield f"name = {_text(person.name)}"


def _key(place: Place) -> str:
    return {"Dock": "dock", "RobotHome": "home"}.get(place.kind, "goal")


def _pose(pose: Pose2, *, heading: bool = True) -> Iterator[str]:
    yield f"x = {_number(pose.x)}"
    yield f"y = {_number(pose.y)}"
    if heading:
        yield f"theta_deg = {_angle(pose.theta)}"


def _point(point: Point) -> str:
    return f"[{_number(point[0])}, {_number(point[1])}]"


def _angle(angle: float) -> str:
    return _number(round(degrees(angle), 12))


def _number(value: float) -> str:
    return repr(float(value))


def _relative(path: Path, folder: Path) -> str:
    return path.as_posix() if path.is_absolute() else Path(relpath(path, folder)).as_posix()


def _text(value: str) -> str:
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04X}" for c in escaped) + '"'
