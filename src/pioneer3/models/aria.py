"""Reads and writes ARIA's `.p` robot parameter files (facts.md 6.1)."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import degrees, tau
from typing import Final

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
    Controller,
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
_CONTROLLERS: Mapping[str, Controller] = {
    "p2": "P2OS",
    "amigo": "AmigoOS",
    "pion1": "PSOS",
    "pionat": "PSOS",
    "psos": "PSOS",
}
"""Programs by the beginnings of the names of robots, but for those with an SH2 controller."""
_SH2 = "-sh"
LENGTH_KEY: Final = "RobotLength"
"""The length of the whole robot; the keys of its parts begin as it does."""
NOT_IN_FILES: Final = ("title", "controller", "drive", "braking", "turn_braking")
"""Fields that parameter files have no keys for: the name of the type stands for them."""
_FIRST_LASER = "laser parameters"
_TITLES = {
    "p2at": "Pioneer 2-AT",
    "p2dx": "Pioneer 2-DX",
    "p3at": "Pioneer 3-AT",
    "p3dx": "Pioneer 3-DX",
    "amigo": "AmigoBot",
    "peoplebot": "PeopleBot",
}


def parse_aria(
    text: str, source: str, fallback_name: str, base: RobotModel | None = None
) -> RobotModel:
    """Read the text of a parameter file; keys that do not concern us are skipped.

    A non-zero TransVelMax or RotVelMax below the absolute maximum takes its place, and a
    non-zero TransAccel, TransDecel, RotAccel or RotDecel that of the usual start value.
    `source` is the file's name; without a Subclass in it the robot has the name `fallback_name`.
    Values of `base` count where the file has none, as in a robot's own file.

    Raises:
        ConfigError: Naming file, line and key.
    """
    lines = split(text, source)
    if base is not None:
        lines = _lines_below(lines, base) + lines
    given = Parameters(source, lines)
    model = _with_dynamics(_body(given, fallback_name), given)
    model = _with_protocol(model, given)
    if base is not None and model.name == base.name:
        model = replace(model, **{field: getattr(base, field) for field in NOT_IN_FILES})
    return replace(
        model,
        sonars=tuple(SonarMount(*pose) for pose in given.units("Sonar", 1, "x y th")),
        table_irs=_table_irs(given),
        front_bumpers=_bumpers(given, "Front"),
        rear_bumpers=_bumpers(given, "Rear"),
        laser=_laser(source, lines),
    )


def _lines_below(lines: tuple[ParameterLine, ...], base: RobotModel) -> tuple[ParameterLine, ...]:
    """Return the lines of `base` that `lines` replace; a new length replaces its two parts, too."""
    told = split(aria_text(base), base.name)
    if not any(line.key.lower() == LENGTH_KEY.lower() for line in lines):
        return told
    return tuple(line for line in told if not line.key.startswith(LENGTH_KEY))


def _body(given: Parameters, fallback_name: str) -> RobotModel:
    name = given.word("Subclass", fallback_name).lower()
    tall = name.startswith(_TALL)
    half = rounded(given.length(LENGTH_KEY, _LENGTH) / 2)
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
        controller=_controller(name),
        drive="skid" if name.startswith(_SKID) else "differential",
        braking=CAREFUL_BRAKING if tall else BRAKING,
        turn_braking=CAREFUL_TURN_BRAKING if tall else TURN_BRAKING,
    )


def _controller(name: str) -> Controller:
    """Return the program in a robot of this type: ARCOS, but for old ones."""
    if _SH2 in name:
        return "ARCOS"
    return next((p for start, p in _CONTROLLERS.items() if name.startswith(start)), "ARCOS")


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
            sections.setdefault(line.section or _FIRST_LASER, []).append(line)
    lasers = (_laser_in(Parameters(source, section)) for section in sections.values())
    return next((laser for laser in lasers if laser), None)


def _laser_in(given: Parameters) -> LaserMount | None:
    kind = given.word("LaserType")
    x, y, theta = given.pose("Laser")
    # "auto-connect" is the only key that says whether the laser exists (facts.md 6.3)
    mounted = given.flag("LaserAutoConnect", default=True)
    if not (kind and mounted):
        return None
    flipped = given.flag("LaserFlipped", default=False)
    return LaserMount(kind=kind, x=x, y=y, theta=theta, upside_down=flipped)


def aria_text(model: RobotModel) -> str:
    """Return the parameter file of a model, for ARIA; masked sectors are left out."""
    return "".join(f"{line}\n" for line in _lines(model))


def _lines(model: RobotModel) -> Iterator[str]:
    """Yield keys with their values, in mm and degrees."""
    lengths = {
        "RobotRadius": model.radius,
        "RobotWidth": model.width,
        "RobotLength": model.length,
        "RobotLengthFront": model.length_front,
        "RobotLengthRear": model.length_rear,
        "MaxVelocity": model.max_speed,
        "DistConvFactor": model.distance_factor,
        "VelConvFactor": model.speed_factor,
        "RangeConvFactor": model.range_factor,
        "Vel2Divisor": model.vel2_unit,
        "TransAccel": model.acceleration,
        "TransDecel": model.deceleration,
    }
    angles = {
        "MaxRVelocity": model.max_turn_rate,
        "RotAccel": model.turn_acceleration,
        "RotDecel": model.turn_deceleration,
    }
    flags = {
        "HasMoveCommand": model.has_move_command,
        "SettableVelMaxes": model.settable_speed,
        "SettableAccsDecs": model.settable_acceleration,
        "RequestIOPackets": model.request_io,
        "RequestEncoderPackets": model.request_encoders,
        "TableSensingIR": bool(model.table_irs),
        "FrontBumpers": model.front_bumpers > 0,
        "RearBumpers": model.rear_bumpers > 0,
    }
    yield f'Class "{model.family}"'
    yield f'Subclass "{model.name}"'
    yield from (f"{key} {value / MM:.10g}" for key, value in lengths.items())
    yield from (f"{key} {degrees(value):.10g}" for key, value in angles.items())
    yield from (f"{key} {str(value).lower()}" for key, value in flags.items())
    yield f"AngleConvFactor {model.heading_factor:.10g}"
    yield f"DiffConvFactor {2 * MM / model.wheel_base:.10g}"
    yield f"GyroScaler {model.gyro_scaler:.10g}"
    yield f"SwitchToBaudRate {model.switch_speed}"
    yield f"NumFrontBumpers {model.front_bumpers}"
    yield f"NumRearBumpers {model.rear_bumpers}"
    for number, ir in enumerate(model.table_irs):
        yield f"IRUnit {number} 1 2 {ir.x / MM:.10g} {ir.y / MM:.10g}"
    yield f"SonarNum {len(model.sonars)}"
    for number, sonar in enumerate(model.sonars):
        pose = f"{sonar.x / MM:.10g} {sonar.y / MM:.10g} {degrees(sonar.theta):.10g}"
        yield f"SonarUnit {number} {pose}"
    if model.laser is None:
        return
    yield f"LaserType {model.laser.kind}"
    yield f"LaserX {model.laser.x / MM:.10g}"
    yield f"LaserY {model.laser.y / MM:.10g}"
    yield f"LaserTh {degrees(model.laser.theta):.10g}"
    yield f"LaserFlipped {str(model.laser.upside_down).lower()}"
