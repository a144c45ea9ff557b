"""How it stands with the robot, part by part, for diagnostic_msgs.

Needs no ROS. Names, levels and keys stay the same, so that monitors can be set up for them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import isfinite
from typing import Any, Final

from pioneer3.arcos.reports import Fault
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Motors, Snapshot
from pioneer3.units import DECIVOLT, MS

USUAL_CYCLE: Final = 0.1
"""Between two readings, where CONFIG does not say [s] (protocol.md 4.1)."""
SLOW: Final = 0.85
"""Share of the readings expected below which it is a warning."""
NOISY: Final = 0.001
"""Share of spoilt frames above which it is a warning."""
ENCODERS: Final = Fault.ENCODER_DEGRADATION | Fault.ENCODER_FAILURE | Fault.GYRO_FAULT
DRIVE: Final = (
    Fault.HIGH_TEMPERATURE
    | Fault.CRITICAL_GENERAL_DRIVING_FAULT
    | Fault.ESTOP_MISMATCH_WARNING
    | Fault.ESTOP_SAFETY_FAULT
    | Fault.ZONE_SAFETY_FAULT
    | Fault.UNKNOWN_SAFETY_FAULT
    | Fault.BACKED_UP_TOO_FAST
    | Fault.JOYDRIVE_UNSAFE
)
POWER: Final = (
    Fault.UNDERVOLTAGE
    | Fault.BATTERY_OVERTEMPERATURE
    | Fault.BATTERY_BALANCE_REQUIRED
    | Fault.PDB_ERROR
    | Fault.PDB_LASER_STATUS_ERROR
)


class Level(IntEnum):
    """Numbers of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Health:
    """What is known at one moment.

    Attributes:
        info: Of the robot last connected.
        snapshot: The latest reading, or `None` while the link is lost.
        lost: Why it is lost, if it is.
        emergency: Whether the emergency stop is latched.
        driver: Who drives, or `None`.
        why_not_moving: A sentence, or `None` while the robot moves.
        refused: Why commands are ignored, or `None`.
    """

    info: RobotInfo
    snapshot: Snapshot | None
    lost: str = ""
    emergency: bool = False
    driver: str | None = None
    why_not_moving: str | None = None
    refused: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """One part of the robot.

    Attributes:
        part: Its name.
        level: How bad it is.
        message: In words.
        values: Numbers and texts by stable keys.
    """

    part: str
    level: Level
    message: str
    values: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        return f"{self.part}: {self.message}"


def conditions(health: Health) -> tuple[Condition, ...]:
    """Return how each part is; without a robot all but the link are stale."""
    snapshot = health.snapshot
    if snapshot is None:
        gone = f"no robot is connected{f': {health.lost}' if health.lost else ''}"
        link = Condition(
            part="Link", level=Level.ERROR, message=gone, values=(("url", health.info.url),)
        )
        return link, *(
            Condition(part=part, level=Level.STALE, message="no robot is connected")
            for part in PARTS
        )
    return _link(health, snapshot), *(check(health, snapshot) for check in PARTS.values())


def hardware_id(info: RobotInfo) -> str:
    """Return the robot's name and serial number (REP 107)."""
    serial = info.config.serial_number if info.config else ""
    return " ".join(filter(None, (info.identity.name, serial)))


def fill(
    message: Any,
    found: Sequence[Condition],
    *,
    stamp: Any,
    node: str,
    hardware: str,
    make: Callable[[str], Any],
) -> None:
    """Fill a diagnostic_msgs/DiagnosticArray; `node` comes before the name of each part."""
    message.header.stamp = stamp
    message.status = []
    for each in found:
        status = make("diagnostic_msgs/DiagnosticStatus")
        status.level = int(each.level)
        status.name = f"{node.lstrip('/')}: {each.part}"
        status.message, status.hardware_id = each.message, hardware
        status.values = []
        for key, value in each.values:
            pair = make("diagnostic_msgs/KeyValue")
            pair.key, pair.value = key, value
            status.values.append(pair)
        message.status.append(status)


def _link(health: Health, now: Snapshot) -> Condition:
    link, config = now.link, health.info.config
    cycle = (config.sip_cycle_ms or 0) * MS if config else 0.0
    expected = 1 / (cycle or USUAL_CYCLE)
    frames = link.reports + link.bad_checksums
    slow = link.reports > 2 * expected and link.rate < SLOW * expected
    noisy = link.bad_checksums > NOISY * frames
    words = [
        f"{link.rate:.1f} readings/s, {expected:g} expected" if slow else "",
        f"{link.bad_checksums} of {frames} frames spoilt" if noisy else "",
    ]
    return Condition(
        part="Link",
        level=Level.WARN if slow or noisy else Level.OK,
        message="; ".join(filter(None, words)) or "connected",
        values=(
            ("url", health.info.url),
            ("baud", str(health.info.speed or "")),
            ("readings_per_s", f"{link.rate:.2f}"),
            ("readings", str(link.reports)),
            ("bad_checksums", str(link.bad_checksums)),
            ("bytes_skipped", str(link.bytes_skipped)),
            ("sessions", str(link.sessions)),
        ),
    )


def _motors(health: Health, now: Snapshot) -> Condition:
    motors, faults = now.motors, _faults(now, DRIVE)
    level, message = Level.OK, "on" if motors.enabled else "off"
    if motors.stalled:
        level, message = Level.WARN, f"the {_stalled(motors)} stalled: something blocks them"
    if faults:
        level, message = Level.ERROR, faults
    if motors.stop_button:
        level, message = Level.ERROR, "the stop button on the robot is pressed"
    if health.emergency:
        level, message = Level.ERROR, "the emergency stop is latched"
    return Condition(
        part="Motors",
        level=level,
        message=message,
        values=(
            ("enabled", _yes(motors.enabled)),
            ("left_stalled", _yes(motors.left_stalled)),
            ("right_stalled", _yes(motors.right_stalled)),
            ("stop_button", _yes(motors.stop_button)),
            ("emergency_stop", _yes(health.emergency)),
            (
                "temperature_celsius",
                "" if now.inputs.temperature is None else str(now.inputs.temperature),
            ),
            ("faults", faults),
        ),
    )


def _battery(health: Health, now: Snapshot) -> Condition:
    battery, faults = now.battery, _faults(now, POWER)
    config = health.info.config
    shutdown = (config.shutdown_decivolts or 0) * DECIVOLT if config else 0.0
    level, message = Level.OK, f"{battery.voltage:.1f} V"
    if battery.low:
        level, message = Level.WARN, f"{message}: low, charge it soon"
    if faults:
        level, message = Level.WARN, f"{message}: {faults}"
    if 0 < battery.voltage <= shutdown:
        level, message = Level.ERROR, f"{message}: at {shutdown:g} V the robot shuts down"
    return Condition(
        part="Battery",
        level=level,
        message=message,
        values=(
            ("voltage", f"{battery.voltage:.1f}"),
            ("charge", "" if battery.charge is None else f"{battery.charge:.2f}"),
            ("charging", battery.charging),
            ("faults", faults),
        ),
    )


def _sonar(_: Health, now: Snapshot) -> Condition:
    sonar = now.sonar
    known = [metres for metres in sonar.ranges if metres == metres]  # noqa: PLR0124
    nearest = sonar.nearest
    return Condition(
        part="Sonar",
        level=Level.OK,
        message=f"{len(known)} of {len(sonar.ranges)} transducers read" if sonar.enabled else "off",
        values=(
            ("enabled", _yes(sonar.enabled)),
            ("transducers", str(len(sonar.ranges))),
            ("read", str(len(known))),
            ("nearest", f"{nearest:.3f}" if isfinite(nearest) else ""),
        ),
    )


def _odometry(_: Health, now: Snapshot) -> Condition:
    faults, state = _faults(now, ENCODERS), now.odometry
    here, speed = state.robot_in_odom, state.twist
    return Condition(
        part="Odometry",
        level=Level.ERROR if faults else Level.OK,
        message=faults or f"{speed.v:.2f} m/s, {speed.w:.2f} rad/s",
        values=(
            ("x", f"{here.x:.3f}"),
            ("y", f"{here.y:.3f}"),
            ("heading", f"{here.theta:.3f}"),
            ("speed", f"{speed.v:.3f}"),
            ("turn_rate", f"{speed.w:.3f}"),
        ),
    )


def _command(health: Health, _: Snapshot) -> Condition:
    why = health.why_not_moving
    return Condition(
        part="Command",
        level=Level.WARN if health.refused else Level.OK,
        message=health.refused or why or "moving",
        values=(
            ("driver", health.driver or ""),
            ("why_not_moving", why or ""),
            ("ignored_because", health.refused or ""),
        ),
    )


PARTS: Final[dict[str, Callable[[Health, Snapshot], Condition]]] = {
    "Motors": _motors,
    "Battery": _battery,
    "Sonar": _sonar,
    "Odometry": _odometry,
    "Command": _command,
}


def _faults(now: Snapshot, about: Fault) -> str:
    up: Iterator[Fault] = iter(about & Fault(now.words.faults or 0))
    return ", ".join(str(fault.name).lower().replace("_", " ") for fault in up)


def _stalled(motors: Motors) -> str:
    sides = (("left", motors.left_stalled), ("right", motors.right_stalled))
    return f"{' and '.join(side for side, stalled in sides if stalled)} wheels are"


def _yes(value: bool) -> str:
    return "yes" if value else "no"
