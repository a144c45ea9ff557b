"""One robot type as frozen numbers, and the range of each number.

The ranges are wide enough for any robot that drives in a building. They catch millimetres written
as metres, and degrees as radians.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, pi, radians, tau
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, ClassVar, Final, Literal, NamedTuple, get_args, get_type_hints

from msgspec import Meta

from pioneer3.errors import ConfigError
from pioneer3.geometry import wrap
from pioneer3.models.odometry import UNCORRECTED, EncoderNumbers, OdometryCorrection
from pioneer3.tables import FieldForm, degrees_of, in_degrees
from pioneer3.units import DEGREE, HEADING_UNIT, MM

Drive = Literal["skid", "differential"]
"""Wheels of a side turn together, or there is one driven wheel on each."""
Controller = Literal["ARCOS", "P2OS", "AmigoOS", "PSOS"]
"""Program in a robot: the older three send shorter reports and no CONFIG (protocol.md 4.2)."""

START_ACCELERATION = 0.3
"""Both ways, of a real P3-AT (protocol.md 5.1) [m/s^2]."""

START_TURN_ACCELERATION = radians(100)
"""Both ways, of a real P3-AT (protocol.md 5.1) [rad/s^2]."""

BRAKING = 1.5
"""The deceleration that the driver asks of a low robot: from 0.3 m/s it stands after 3 cm. Robots
take up to 2 m/s^2 (protocol.md 5.1) [m/s^2]."""

TURN_BRAKING = radians(300)
"""Braking of a turning robot; robots take up to this (protocol.md 5.1) [rad/s^2]."""

CAREFUL_BRAKING = 0.5
"""Braking of robots that are tall, or not known [m/s^2]."""

CAREFUL_TURN_BRAKING = radians(100)
"""Braking of their turns [rad/s^2]."""

VEL2_UNIT = 20 * MM
"""Unit of VEL2 on every Pioneer 2 and 3 (facts.md 6.3) [m/s]."""

GYRO_SCALER = 1.626
"""Scale of the gyro in every parameter file (facts.md 6.2)."""

SWITCH_SPEED = 38400
"""Fast serial speed of every Pioneer 2 and 3 (facts.md 6.3) [baud]."""


@dataclass(frozen=True, slots=True)
class Bounds:
    """A closed range, SI."""

    low: float
    high: float

    def holds(self, value: float) -> bool:
        """Whether `value` [SI] is inside; NaN never is."""
        return self.low <= value <= self.high

    def complaint(self, value: float, unit: float = 1.0) -> str:
        """Return the message for `value`; it and the limits are shown in `unit` [SI]."""
        shown = f"{value:g}" if not abs(value) > 1e300 else "this number"
        return f"{shown} is out of range, expected {self.in_words(unit)}"

    def in_words(self, unit: float = 1.0) -> str:
        """Return the limits, shown in `unit` [SI]."""
        return f"{self.low / unit:g} to {self.high / unit:g}"


REACH = Bounds(-10.0, 10.0)
"""Bounds of a sensor's position along one axis [m]."""

BEARING = Bounds(-tau, tau)
"""Bounds of a sensor's direction as files give it [rad]."""

HEADING = Bounds(-pi, pi)
"""Bounds of a sensor's direction in a model [rad]."""

BUMPERS = Bounds(0, 7)
"""Segments on one side: a stall byte has bits 1 to 7 for them (protocol.md 4.7)."""

SwitchSpeed = Literal[0, 9600, 19200, 38400, 57600, 115200]
"""Line speeds that HOSTBAUD can name [baud] (protocol.md 1.1); 0 means never switch."""
SWITCH_SPEEDS: Final[tuple[int, ...]] = get_args(SwitchSpeed)

_Word = Annotated[str, Meta(min_length=1, extra={"expected": "a text that is not empty"})]
_Count = Annotated[int, Meta(ge=int(BUMPERS.low), le=int(BUMPERS.high))]
_Reach = Annotated[float, Meta(ge=REACH.low, le=REACH.high)]
_Point = Annotated[tuple[_Reach, _Reach], Meta(extra={"expected": "two numbers"})]
_Size = Annotated[float, Meta(ge=0.01, le=10.0)]
_Speed = Annotated[float, Meta(ge=0.01, le=10.0)]
_TurnRate = Annotated[float, Meta(ge=0.01, le=50.0)]
_Acceleration = Annotated[float, Meta(ge=0.001, le=20.0)]
_TurnAcceleration = Annotated[float, Meta(ge=0.001, le=200.0)]
_Factor = Annotated[float, Meta(ge=1e-6, le=0.1)]
_Direction = Annotated[float, Meta(ge=-360.0, le=360.0)]
_Sector = Annotated[
    tuple[_Direction, _Direction],
    Meta(extra={"expected": "two directions in degrees, such as [-135, -120]"}),
]


def _heading(angle_deg: float) -> float:
    return wrap(angle_deg * DEGREE)


_THETA = FieldForm("theta_deg", _Direction, _heading, degrees_of)
_MASKED = FieldForm(
    "masked_deg",
    tuple[_Sector, ...],
    lambda sectors: tuple((_heading(first), _heading(last)) for first, last in sectors),
    lambda sectors: tuple((degrees_of(first), degrees_of(last)) for first, last in sectors),
)
_HEADING_UNITS = FieldForm(
    "heading_units",
    Annotated[float, Meta(ge=64, le=1_000_000)],
    lambda units: tau / units,
    lambda factor: tau / factor,
)
_TABLE_IRS = FieldForm(
    "table_irs", tuple[_Point, ...], lambda points: tuple(IrMount(*point) for point in points)
)


@dataclass(frozen=True, slots=True)
class SonarMount:
    """Position [m] and direction [rad] of a sonar transducer, in the robot's frame."""

    x: _Reach
    y: _Reach
    theta: Annotated[float, _THETA]

    def __post_init__(self) -> None:
        """Refuse a pose that is not on a robot."""
        _check_mount(self.x, self.y, self.theta)


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserMount:
    """Position [m] and direction [rad] of the laser range finder, in the robot's frame.

    Attributes:
        kind: ARIA's name for the product, such as `lms2xx` or `urg2.0`.
        upside_down: Whether it hangs head down, so that it turns clockwise.
        masked: Sectors to leave out, such as posts of the robot itself: pairs of directions in the
            laser's frame, seen from above, the first counter-clockwise to the second [rad].
        delay: Time by which its scans are stamped too late [s].
    """

    kind: _Word
    x: _Reach
    y: _Reach
    theta: Annotated[float, _THETA]
    upside_down: bool = False
    masked: Annotated[tuple[tuple[float, float], ...], _MASKED] = ()
    delay: Annotated[float, Meta(ge=-0.25, le=0.25)] = 0.0

    def __post_init__(self) -> None:
        """Refuse a pose that is not on a robot."""
        _check_word("kind", self.kind)
        _check_mount(self.x, self.y, self.theta)
        for number, sector in enumerate(self.masked):
            for end in sector:
                _check(f"masked[{number}]", end, BEARING)


class IrMount(NamedTuple):
    """Position of an upward-looking table sensor [m], in the robot's frame."""

    x: float
    y: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotModel:
    """Sizes, limits, conversion factors and equipment of one robot type (facts.md 6).

    Attributes:
        name: Parameter-file name in lower case, such as `p3at-sh`.
        title: For people, such as `Pioneer 3-AT`.
        family: `Pioneer` for every P2, P3, PeopleBot and AmigoBot.
        radius: Of the circle that the robot needs to turn in [m].
        length_front: From the centre of rotation to the front end [m].
        length_rear: From the centre of rotation to the rear end [m].
        max_speed: Never to be exceeded [m/s].
        max_turn_rate: Never to be exceeded [rad/s].
        wheel_base: Effective distance of the wheels [m]; a skid drive's is wider than it looks.
        distance_factor: Metres per unit of the reported x and y.
        heading_factor: Radians per unit of the reported heading.
        speed_factor: Metres per second per unit of the reported wheel speeds.
        range_factor: Metres per unit of the reported sonar ranges.
        vel2_unit: Metres per second per unit of a VEL2 command.
        acceleration: Start value where CONFIG gives none [m/s^2], as the next three [rad/s^2].
        braking: Deceleration the driver asks for, where CONFIG allows it [m/s^2]; lower for tall
            robots, which tip.
        turn_braking: The same, turning [rad/s^2].
        gyro_scaler: Factor on the readings of a gyro that the computer has to apply.
        sonars: By transducer number.
        table_irs: By sensor number; empty without table sensing.
        front_bumpers: Number of segments, as of those behind.
        controller: The program in the robot.
        drive: `skid` where the wheels of one side are coupled and turning means slipping.
        has_move_command: Whether the firmware knows MOVE.
        settable_speed: Whether SETV and SETRV may be sent.
        settable_acceleration: Whether SETA and SETRA may be sent.
        request_io: Whether to ask for IO packets on connecting.
        request_encoders: Whether to ask for ENCODER packets on connecting.
        switch_speed: Line speed to change to after connecting [baud]; 0 never.
        odometry: Measured errors of this robot's odometry, which the driver corrects.
        encoders: Numbers that the controller had then, and is given again; `None` to leave them.

    Raises:
        ConfigError: A number is out of its range.
    """

    name: _Word
    title: _Word
    family: _Word = "Pioneer"
    radius: _Size
    width: _Size
    length_front: _Size
    length_rear: _Size
    max_speed: _Speed
    max_turn_rate: Annotated[_TurnRate, in_degrees("max_turn_rate_deg", 0.01, 50.0)]
    wheel_base: _Size
    distance_factor: _Factor
    heading_factor: Annotated[_Factor, _HEADING_UNITS] = HEADING_UNIT
    speed_factor: _Factor = MM
    range_factor: _Factor = MM
    vel2_unit: Annotated[float, Meta(ge=1e-4, le=1.0)] = VEL2_UNIT
    acceleration: _Acceleration = START_ACCELERATION
    deceleration: _Acceleration = START_ACCELERATION
    turn_acceleration: Annotated[
        _TurnAcceleration, in_degrees("turn_acceleration_deg", 0.001, 200.0)
    ] = START_TURN_ACCELERATION
    turn_deceleration: Annotated[
        _TurnAcceleration, in_degrees("turn_deceleration_deg", 0.001, 200.0)
    ] = START_TURN_ACCELERATION
    braking: _Acceleration = BRAKING
    turn_braking: Annotated[_TurnAcceleration, in_degrees("turn_braking_deg", 0.001, 200.0)] = (
        TURN_BRAKING
    )
    gyro_scaler: Annotated[float, Meta(ge=0.001, le=1000.0)] = GYRO_SCALER
    sonars: tuple[SonarMount, ...] = ()
    table_irs: Annotated[tuple[IrMount, ...], _TABLE_IRS] = ()
    front_bumpers: _Count = 0
    rear_bumpers: _Count = 0
    laser: LaserMount | None = None
    controller: Controller = "ARCOS"
    drive: Drive = "differential"
    has_move_command: bool = True
    settable_speed: bool = True
    settable_acceleration: bool = True
    request_io: bool = False
    request_encoders: bool = False
    switch_speed: Annotated[int, FieldForm("switch_speed", SwitchSpeed)] = SWITCH_SPEED
    odometry: OdometryCorrection = UNCORRECTED
    encoders: EncoderNumbers | None = None

    refusal: ClassVar[str | None] = None
    """The reason that nothing may drive it, or `None`."""

    def __post_init__(self) -> None:
        """Refuse numbers out of range, naming the field."""
        for field, bounds in BOUNDS.items():
            _check(field, getattr(self, field), bounds)
        for field in ("name", "title", "family"):
            _check_word(field, getattr(self, field))
        for number, ir in enumerate(self.table_irs):
            _check_mount(ir.x, ir.y, 0.0, f"table_irs[{number}].")
        if self.switch_speed not in SWITCH_SPEEDS:
            speeds = ", ".join(map(str, SWITCH_SPEEDS))
            raise ConfigError(f"switch_speed: {self.switch_speed} is not one of {speeds}")

    @property
    def true_base(self) -> float:
        """Effective distance of the wheels, as measured where the robot was calibrated [m]."""
        return self.wheel_base * self.odometry.base_ratio

    @property
    def corner(self) -> float:
        """Distance of the farthest corner from the centre [m]."""
        return hypot(max(self.length_front, self.length_rear), self.width / 2)

    @property
    def length(self) -> float:
        """From the rear end to the front end [m]."""
        return self.length_front + self.length_rear


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnLaser:
    """A laser range finder of one robot: its port as for `--laser`, and its place."""

    port: str
    mount: Annotated[LaserMount, FieldForm(type=LaserMount, spread=True)]


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnFile:
    """The file of one robot: its model, lasers and camera.

    Attributes:
        camera: URL of its camera; `None` without one.
        serial_number: Of the only robot that it is of, by whatever name; empty for any.
        path: Of the file.
    """

    model: Annotated[RobotModel, FieldForm(type=RobotModel, spread=True)]
    lasers: tuple[OwnLaser, ...] = ()
    camera: str | None = None
    serial_number: str = ""
    path: Annotated[Path, FieldForm()] = Path()


BOUNDS: Mapping[str, Bounds] = MappingProxyType(
    {
        name: Bounds(note.ge, note.le)
        for name, hint in get_type_hints(RobotModel, include_extras=True).items()
        for note in getattr(hint, "__metadata__", ())
        if isinstance(note, Meta) and note.ge is not None and note.le is not None
    }
)
"""Range of each numeric field of `RobotModel` [SI]."""


class UnknownModel(RobotModel):
    """The guess at a type that nobody has described: with it a robot is read, and not driven.

    Older robots count in other units. Of a P2-AT a metre would be 1.32 m, and echoes of a wall a
    quarter as far as it is.
    """

    __slots__ = ()

    @property
    def refusal(self) -> str:  # type: ignore[override]
        """The reason that nothing may drive it, and what helps."""
        return (
            f"it says that it is a {self.name!r}, which is not known here, so nobody knows what a"
            " metre is: give its model, --model NAME or --model FILE.p, ARIA's parameter file"
            " (model= in a program or in fleet.toml, the parameter model of a ROS node)"
        )


def _check(field: str, value: float, bounds: Bounds) -> None:
    if not bounds.holds(value):
        raise ConfigError(f"{field}: {bounds.complaint(value)}")


def _check_word(field: str, value: str) -> None:
    if not value or not value.isprintable():
        raise ConfigError(f"{field}: {value!r} is empty or not printable")


def _check_mount(x: float, y: float, theta: float, where: str = "") -> None:
    _check(f"{where}x", x, REACH)
    _check(f"{where}y", y, REACH)
    _check(f"{where}theta", theta, HEADING)
