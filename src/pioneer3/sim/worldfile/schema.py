"""The tables of a world file: their keys, ranges and defaults, and their meaning in SI.

msgspec reads and checks them. Tables have the field names of the objects in
:mod:`pioneer3.sim.worldfile.spec` that they stand for, and become them and are made of them.
"""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Optional, Self, get_type_hints

from msgspec import Meta, defstruct, field
from msgspec.structs import asdict

from pioneer3.geometry import Pose2
from pioneer3.maps.materials import Material
from pioneer3.models.lasers import LASERS
from pioneer3.models.model import BUMPERS
from pioneer3.sim.equipment import LAST_PORT, PICTURE_RANGES, EquipmentOptions
from pioneer3.sim.relief import WALL_HEIGHT
from pioneer3.sim.worldfile import solid_tables
from pioneer3.sim.worldfile.person import PATIENCE, RADIUS, SPEED, Person
from pioneer3.sim.worldfile.spec import (
    BOX_FRICTION,
    BOX_MASS,
    PHYSICS_STEP,
    Box,
    Physics,
    Place,
    RobotSpec,
    Wall,
)
from pioneer3.sim.worldfile.table import (
    Angle,
    Coordinate,
    Elevation,
    Friction,
    Height,
    Point,
    Size,
    Table,
    degrees_of,
    pose_of,
)
from pioneer3.units import DEGREE

MaterialName = Literal["plain", "black", "glass", "reflector"]
STEP_MS = PHYSICS_STEP * 1000
_START = {"expected": '{x, y, theta_deg} or "random" or "outside" or "home"'}
_FIRST = {"missing": "missing; a world starts with [world]"}


def _points(least: int) -> dict[str, str]:
    return {"expected": f"a list of {least} or more points [x, y]"}


class WorldTable(Table):
    """`[world]`."""

    name: str | None = None
    map: str = "empty"
    seed: Annotated[int, Meta(ge=0, le=2**63 - 1)] | None = None
    keep_session: bool = False
    physics: Physics = "planar"
    physics_step_ms: Annotated[float, Meta(ge=0.5, le=2.5)] = STEP_MS
    wall_height: Height = WALL_HEIGHT


class StartTable(Table):
    """The pose that a robot starts at."""

    x: Coordinate
    y: Coordinate
    theta_deg: Angle = 0.0


_ANGLES = {
    "north": "north_deg",
    "compass_noise": "compass_noise_deg",
    "gyro_bias": "gyro_bias_deg_s",
    "gyro_noise": "gyro_noise_deg_s",
}


def _picture_range(kind: type, name: str) -> Any:
    low, high = PICTURE_RANGES[name]
    return Annotated[kind, Meta(ge=low, le=high)]


_RANGES = {
    "gyro_type": Annotated[int, Meta(ge=0, le=2)],
    "bumpers": Annotated[int, Meta(ge=0, le=int(BUMPERS.high))],
    "camera_port": Annotated[int, Meta(ge=1, le=3)],
    "picture_port": Annotated[int, Meta(ge=1, le=LAST_PORT)],
    "picture_width": _picture_range(int, "picture_width"),
    "picture_height": _picture_range(int, "picture_height"),
    "picture_rate": _picture_range(float, "picture_rate"),
    "laser": Literal.__getitem__((*LASERS, "none")),
    "laser_port": Annotated[int, Meta(ge=1, le=LAST_PORT)],
    "north": Angle,
    "compass_noise": Annotated[float, Meta(ge=0, le=180)],
    "gyro_bias": Annotated[float, Meta(ge=-100.0, le=100.0)],
    "gyro_noise": Annotated[float, Meta(ge=0.0, le=100.0)],
}


class _EquipmentTable(Table):
    """The equipment of a robot, and the words of `--fit`."""

    def options(self) -> EquipmentOptions:
        """Return the choices in SI."""
        chosen = {name: value for name, value in asdict(self).items() if value is not None}
        angles = {name: chosen[name] * DEGREE for name in _ANGLES if name in chosen}
        return EquipmentOptions(**chosen | angles)

    @classmethod
    def of(cls, options: EquipmentOptions) -> Self:
        """Return the table of some choices."""
        angles = {name: getattr(options, name) for name in _ANGLES}
        in_degrees = {n: a if a is None else degrees_of(a) for n, a in angles.items()}
        return cls.like(options, **in_degrees)


if TYPE_CHECKING:
    EquipmentTable = _EquipmentTable
else:
    EquipmentTable = defstruct(
        "EquipmentTable",
        [
            (name, Optional[_RANGES[name]] if name in _RANGES else kind, None)  # noqa: UP045
            for name, kind in get_type_hints(EquipmentOptions).items()
        ],
        bases=(_EquipmentTable,),
        rename={"gyro_type": "gyro", **_ANGLES},
    )
    EquipmentTable.__doc__ = _EquipmentTable.__doc__


class RobotTable(Table):
    """`[[robot]]`."""

    model: str = RobotSpec().model
    name: str = ""
    start: Annotated[StartTable | Literal["home", "random", "outside"], Meta(extra=_START)] = "home"
    port: Annotated[int, Meta(ge=1, le=65535)] | None = None
    equipment: EquipmentTable = field(default_factory=EquipmentTable)

    def robot(self) -> RobotSpec:
        """Return the robot."""
        start = self.start
        pose = start if isinstance(start, str) else pose_of(start.x, start.y, start.theta_deg)
        return RobotSpec(
            model=self.model,
            name=self.name,
            start=pose,
            port=self.port,
            equipment=self.equipment.options(),
        )

    @classmethod
    def of(cls, robot: RobotSpec) -> Self:
        """Return the table of a robot."""
        start: StartTable | str
        match robot.start:
            case Pose2(x, y, theta):
                start = StartTable(x=x, y=y, theta_deg=degrees_of(theta))
            case word:
                start = word
        return cls.like(robot, start=start, equipment=EquipmentTable.of(robot.equipment))


class BoxTable(Table):
    """`[[box]]`."""

    center: Point
    size: Size
    theta_deg: Angle = 0.0
    movable: bool = False
    name: str = ""
    material: MaterialName = "plain"
    height: Height | None = None
    z: Elevation = 0.0
    mass: Annotated[float, Meta(ge=0.01, le=1000)] = BOX_MASS
    friction: Friction = BOX_FRICTION

    def box(self) -> Box:
        """Return the box."""
        return Box(
            pose=pose_of(*self.center, self.theta_deg),
            size=self.size,
            movable=self.movable,
            name=self.name,
            material=Material(self.material),
            height=self.height,
            z=self.z,
            mass=self.mass,
            friction=self.friction,
        )

    @classmethod
    def of(cls, box: Box) -> Self:
        """Return the table of a box."""
        return cls.like(
            box,
            center=(box.pose.x, box.pose.y),
            theta_deg=degrees_of(box.pose.theta),
            material=box.material.value,
        )


class WallTable(Table):
    """`[[wall]]`."""

    points: Annotated[tuple[Point, ...], Meta(min_length=2, extra=_points(2))]
    closed: bool = False
    material: MaterialName = "plain"
    height: Height | None = None

    def wall(self) -> Wall:
        """Return the wall."""
        return Wall(
            points=self.points,
            closed=self.closed,
            material=Material(self.material),
            height=self.height,
        )

    @classmethod
    def of(cls, wall: Wall) -> Self:
        """Return the table of a wall."""
        return cls.like(wall, material=wall.material.value)


class PlaceTable(Table):
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
    def of(cls, place: Place) -> Self:
        """Return the table of a place."""
        heading = None if place.kind == "Goal" else degrees_of(place.pose.theta)
        return cls(x=place.pose.x, y=place.pose.y, theta_deg=heading, name=place.name)


class PersonTable(Table):
    """`[[person]]`."""

    path: Annotated[tuple[Point, ...], Meta(min_length=1, extra=_points(1))]
    speed: Annotated[float, Meta(ge=0.01, le=10)] = SPEED
    radius: Annotated[float, Meta(ge=0.05, le=2)] = RADIUS
    loop: bool = True
    pause: Annotated[float, Meta(ge=0, le=3600)] = 0.0
    patience: Annotated[float, Meta(ge=0)] = PATIENCE
    name: str = ""

    def person(self) -> Person:
        """Return the person."""
        return Person(**asdict(self))


class FileTable(Table):
    """All tables of a world file."""

    world: Annotated[WorldTable, Meta(extra=_FIRST)]
    robot: tuple[RobotTable, ...] = ()
    box: tuple[BoxTable, ...] = ()
    wall: tuple[WallTable, ...] = ()
    goal: tuple[PlaceTable, ...] = ()
    dock: tuple[PlaceTable, ...] = ()
    home: tuple[PlaceTable, ...] = ()
    person: tuple[PersonTable, ...] = ()
    step: tuple[solid_tables.StepTable, ...] = ()
    ramp: tuple[solid_tables.RampTable, ...] = ()
    carpet: tuple[solid_tables.CarpetTable, ...] = ()
    cylinder: tuple[solid_tables.CylinderTable, ...] = ()
    table: tuple[solid_tables.TableTable, ...] = ()
    heightfield: tuple[solid_tables.HeightFieldTable, ...] = ()
    mesh: tuple[solid_tables.MeshTable, ...] = ()
