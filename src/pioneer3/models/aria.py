"""Reads ARIA's `.p` robot parameter files (facts.md 6.1)."""

from dataclasses import replace
from math import tau

from pioneer3.models.model import (
    BOUNDS,
    BRAKING,
    BUMPERS,
    CAREFUL_BRAKING,
    CAREFUL_TURN_BRAKING,
    GYRO_SCALER,
    START_ACCELERATION,
    START_TURN_ACCELERATION,
    SWITCH_SPEED,
    SWITCH_SPEEDS,
    TURN_BRAKING,
    VEL2_UNIT,
    Bounds,
    IrMount,
    LaserMount,
    RobotModel,
    SonarMount,
)
from pioneer3.models.parameters import ParameterLine, Parameters, rounded, split
from pioneer3.units import MM

_HEADING_UNITS = (1024, 4096)
_LENGTH = Bounds(2 * BOUNDS["length_front"].low, 2 * BOUNDS["length_front"].high)
_TALL = ("p2pb", "p2pp", "peoplebot", "perfpb", "wheelchair")
_SKID = ("p2at", "p2it", "p3at", "pionat", "seekurjr")
_TITLES = {
    "p2at": "Pioneer 2-AT",
    "p2dx": "Pioneer 2-DX",
    "p3at": "Pioneer 3-AT",
    "p3dx": "Pioneer 3-DX",
    "amigo": "AmigoBot",
    "peoplebot": "PeopleBot",
}


def parse_aria(text: str, source: str, fallback_name: str) -> RobotModel:
    """Read the text of a parameter file; keys that do not concern us are skipped.

    A non-zero TransVelMax or RotVelMax below the absolute maximum takes its place, and a
    non-zero TransAccel, TransDecel, RotAccel or RotDecel that of the usual start value.

    Args:
        text: The whole file.
        source: Its name, for messages.
        fallback_name: Used where the file has no Subclass.

    Raises:
        ConfigError: Naming file, line and key.
    """
    lines = split(text, source)
    given = Parameters(source, lines)
    model = _with_dynamics(_body(given, fallback_name), given)
    model = _with_protocol(model, given)
    return replace(
        model,
        sonars=tuple(SonarMount(*pose) for pose in given.units("Sonar", 1, "x y th")),
        table_irs=_table_irs(given),
        front_bumpers=_bumpers(given, "Front"),
        rear_bumpers=_bumpers(given, "Rear"),
        laser=_laser(source, lines),
    )


def _body(given: Parameters, fallback_name: str) -> RobotModel:
    name = given.word("Subclass", fallback_name).lower()
    tall = name.startswith(_TALL)
    half = rounded(given.length("RobotLength", _LENGTH) / 2)
    return RobotModel(
        name=name,
        title=next((title for start, title in _TITLES.items() if name.startswith(start)), name),
        family=given.word("Class", "Pioneer"),
        radius=given.length("RobotRadius", BOUNDS["radius"]),
        width=given.length("RobotWidth", BOUNDS["width"]),
        length_front=given.length("RobotLengthFront", BOUNDS["length_front"], half),
        length_rear=given.length("RobotLengthRear", BOUNDS["length_rear"], half),
        max_speed=given.length("MaxVelocity", BOUNDS["max_speed"]),
        max_turn_rate=given.angle("MaxRVelocity", BOUNDS["max_turn_rate"]),
        wheel_base=_wheel_base(given),
        distance_factor=given.length("DistConvFactor", BOUNDS["distance_factor"]),
        drive="skid" if name.startswith(_SKID) else "differential",
        braking=CAREFUL_BRAKING if tall else BRAKING,
        turn_braking=CAREFUL_TURN_BRAKING if tall else TURN_BRAKING,
    )


def _with_dynamics(model: RobotModel, given: Parameters) -> RobotModel:
    speed = given.length("TransVelMax", BOUNDS["max_speed"], model.max_speed)
    turn_rate = given.angle("RotVelMax", BOUNDS["max_turn_rate"], model.max_turn_rate)
    linear, angular = BOUNDS["acceleration"], BOUNDS["turn_acceleration"]
    return replace(
        model,
        max_speed=min(model.max_speed, speed),
        max_turn_rate=min(model.max_turn_rate, turn_rate),
        acceleration=given.length("TransAccel", linear, START_ACCELERATION),
        deceleration=given.length("TransDecel", linear, START_ACCELERATION),
        turn_acceleration=given.angle("RotAccel", angular, START_TURN_ACCELERATION),
        turn_deceleration=given.angle("RotDecel", angular, START_TURN_ACCELERATION),
    )


def _with_protocol(model: RobotModel, given: Parameters) -> RobotModel:
    return replace(
        model,
        heading_factor=_heading_factor(given),
        speed_factor=given.length("VelConvFactor", BOUNDS["speed_factor"], MM),
        range_factor=given.length("RangeConvFactor", BOUNDS["range_factor"], MM),
        vel2_unit=given.length("Vel2Divisor", BOUNDS["vel2_unit"], VEL2_UNIT),
        gyro_scaler=given.number("GyroScaler", BOUNDS["gyro_scaler"], GYRO_SCALER),
        has_move_command=given.flag("HasMoveCommand", default=True),
        settable_speed=given.flag("SettableVelMaxes", default=True),
        settable_acceleration=given.flag("SettableAccsDecs", default=True),
        request_io=given.flag("RequestIOPackets", default=False),
        request_encoders=given.flag("RequestEncoderPackets", default=False),
        switch_speed=given.one_of("SwitchToBaudRate", SWITCH_SPEEDS, SWITCH_SPEED),
    )


def _wheel_base(given: Parameters) -> float:
    """Return the wheel base [m]: the file gives 2 / wheel base [1/mm]."""
    base = BOUNDS["wheel_base"]
    ratio = given.number("DiffConvFactor", Bounds(2 * MM / base.high, 2 * MM / base.low))
    return rounded(2 * MM / ratio)


def _heading_factor(given: Parameters) -> float:
    """Return the exact factor where the file rounds it: 0.00153 is meant as a 4096th of a turn.

    As it stands it would be 0.47 degrees off at the far side of a turn (protocol.md 4.8).
    """
    factor = given.number("AngleConvFactor", BOUNDS["heading_factor"])
    near = (tau / n for n in _HEADING_UNITS if abs(factor * n / tau - 1) < 0.005)
    return next(near, factor)


def _bumpers(given: Parameters, side: str) -> int:
    count = given.count(f"Num{side}Bumpers", BUMPERS, 0)
    return count if given.flag(f"{side}Bumpers", default=False) else 0


def _table_irs(given: Parameters) -> tuple[IrMount, ...]:
    mounts = tuple(IrMount(x, y) for x, y, _ in given.units("IR", 3, "x y"))
    return mounts if given.flag("TableSensingIR", default=False) else ()


def _laser(source: str, lines: tuple[ParameterLine, ...]) -> LaserMount | None:
    """Return the first laser that the file names and says is on the robot."""
    sections: dict[str, list[ParameterLine]] = {}
    for line in lines:
        if line.key.lower().startswith("laser"):
            sections.setdefault(line.section, []).append(line)
    lasers = (_laser_in(Parameters(source, section)) for section in sections.values())
    return next((laser for laser in lasers if laser), None)


def _laser_in(given: Parameters) -> LaserMount | None:
    kind = given.word("LaserType")
    x, y, theta = given.pose("Laser")
    # "auto-connect" is the only key that says whether the laser exists (facts.md 6.3)
    mounted = given.flag("LaserAutoConnect", default=True)
    if not (kind and mounted):
        return None
    return LaserMount(
        kind=kind,
        x=x,
        y=y,
        theta=theta,
        upside_down=given.flag("LaserFlipped", default=False),
    )
