"""The state of the robot, part by part, for diagnostic_msgs.

Needs no ROS. Names, levels and keys stay the same, so that monitors can be set up for them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import isfinite
from typing import Any, Final
from urllib.parse import urlsplit

from pioneer3.arcos.reports import Fault
from pioneer3.lasers.client import LaserIdentity
from pioneer3.robot.explain import Reason
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.state import Motors, Scan, Snapshot
from pioneer3.units import DECIVOLT, MS

ENABLE: Final = "enable_motors"
"""Service that switches the motors on."""
USUAL_CYCLE: Final = 0.1
"""Between two snapshots, where CONFIG does not say [s] (protocol.md 4.1)."""
SLOW: Final = 0.85
"""Share of the expected snapshots below which it is a warning."""
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


class DiagnosticLevel(IntEnum):
    """Numbers of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


OK, WARN, ERROR, STALE = DiagnosticLevel


Values = tuple[tuple[str, str], ...]
"""Numbers and texts by stable keys."""
Found = tuple[DiagnosticLevel, str, Values]
"""The state of a part, without its name."""


@dataclass(frozen=True, slots=True)
class DiagnosticStatus:
    """The state of one part of the robot, as in diagnostic_msgs/DiagnosticStatus, for people."""

    part: str
    level: DiagnosticLevel
    message: str
    values: Values = ()

    def __str__(self) -> str:
        return f"{self.part}: {self.message}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Health:
    """All that a diagnosis looks at; there is no snapshot while the link is `lost`, for a reason.

    A command switches the motors on with `auto_enable`; commands may be `refused` for a reason.
    `lasers` are those at the computer, `unheard` has a sentence for each endpoint of other nodes
    that cannot talk to this one.
    """

    info: RobotInfo
    snapshot: Snapshot | None
    lost: str = ""
    emergency: bool = False
    auto_enable: bool = True
    driver: str | None = None
    why_not_moving: Reason | None = None
    refused: str | None = None
    lasers: tuple[DiagnosticStatus, ...] = ()
    navigation: tuple[DiagnosticStatus, ...] = ()
    unheard: tuple[str, ...] = ()


def diagnose(health: Health) -> tuple[DiagnosticStatus, ...]:
    """Return the state of each part; without a robot all but the link are stale."""
    snapshot = health.snapshot
    if snapshot is None:
        gone = "no robot is connected"
        why, url = f"{gone}: {health.lost}" if health.lost else gone, ("url", health.info.url)
        link = DiagnosticStatus("Link", ERROR, why, (url,))
        parts = [DiagnosticStatus(part, STALE, gone) for part in PARTS]
    else:
        link = DiagnosticStatus("Link", *_link(health, snapshot))
        parts = [DiagnosticStatus(part, *check(health, snapshot)) for part, check in PARTS.items()]
    return link, *parts, *health.lasers, *health.navigation, *_topics(health)


def hardware_id(info: RobotInfo) -> str:
    """Return the robot's name and serial number (REP 107)."""
    serial = info.config.serial_number if info.config else ""
    return " ".join(filter(None, (info.identity.name, serial)))


@dataclass(frozen=True, slots=True, kw_only=True)
class DiagnosticsUpdate:
    """A new diagnosis of `hardware`, the robot; the name of `node` comes before that of each part.

    `stamp` is as the middleware writes times; `make` returns an empty message of the type named.
    """

    found: Sequence[DiagnosticStatus]
    node: str
    hardware: str
    stamp: Any
    make: Callable[[str], Any]


def diagnostics(message: Any, update: DiagnosticsUpdate) -> None:
    """Fill a diagnostic_msgs/DiagnosticArray."""
    message.header.stamp = update.stamp
    message.status = []
    for each in update.found:
        status = update.make("diagnostic_msgs/DiagnosticStatus")
        status.level = int(each.level)
        status.name = f"{update.node.lstrip('/')}: {each.part}"
        status.message, status.hardware_id = each.message, update.hardware
        status.values = []
        for key, value in each.values:
            pair = update.make("diagnostic_msgs/KeyValue")
            pair.key, pair.value = key, value
            status.values.append(pair)
        message.status.append(status)


def _link(health: Health, now: Snapshot) -> Found:
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
    values = (
        ("url", health.info.url),
        ("baud", str(health.info.speed or "")),
        ("readings_per_s", f"{link.rate:.2f}"),
        ("readings", str(link.reports)),
        ("bad_checksums", str(link.bad_checksums)),
        ("bytes_skipped", str(link.bytes_skipped)),
        ("sessions", str(link.sessions)),
    )
    return WARN if slow or noisy else OK, "; ".join(filter(None, words)) or "connected", values


def _motors(health: Health, now: Snapshot) -> Found:
    motors, faults, celsius = now.motors, _faults(now, DRIVE), now.inputs.temperature
    level, message = OK, "on" if motors.enabled else "off"
    if not (motors.enabled or health.auto_enable):
        level, message = WARN, f"off, and commands do not switch them on; {ENABLE} does"
    if motors.stalled:
        level, message = WARN, f"the {_stalled(motors)} stalled: something blocks them"
    if faults:
        level, message = ERROR, faults
    if motors.stop_button:
        level, message = ERROR, "the stop button on the robot is pressed"
    if health.emergency:
        level, message = ERROR, "the emergency stop is latched"
    values = (
        ("enabled", _yes(motors.enabled)),
        ("left_stalled", _yes(motors.left_stalled)),
        ("right_stalled", _yes(motors.right_stalled)),
        ("stop_button", _yes(motors.stop_button)),
        ("emergency_stop", _yes(health.emergency)),
        ("temperature_celsius", "" if celsius is None else str(celsius)),
        ("faults", faults),
    )
    return level, message, values


def _battery(health: Health, now: Snapshot) -> Found:
    battery, faults = now.battery, _faults(now, POWER)
    config = health.info.config
    shutdown = (config.shutdown_decivolts or 0) * DECIVOLT if config else 0.0
    level, message = OK, f"{battery.voltage:.1f} V"
    if battery.low:
        level, message = WARN, f"{message}: low, charge it soon"
    if faults:
        level, message = WARN, f"{message}: {faults}"
    if 0 < battery.voltage <= shutdown:
        level, message = ERROR, f"{message}: at {shutdown:g} V the robot shuts down"
    values = (
        ("voltage", f"{battery.voltage:.1f}"),
        ("charge", "" if battery.charge is None else f"{battery.charge:.2f}"),
        ("charging", battery.charging),
        ("faults", faults),
    )
    return level, message, values


def _sonar(_: Health, now: Snapshot) -> Found:
    sonar = now.sonar
    known = [metres for metres in sonar.ranges if metres == metres]  # noqa: PLR0124
    nearest = sonar.nearest
    values = (
        ("enabled", _yes(sonar.enabled)),
        ("transducers", str(len(sonar.ranges))),
        ("read", str(len(known))),
        ("nearest", f"{nearest:.3f}" if isfinite(nearest) else ""),
    )
    count = f"{len(known)} of {len(sonar.ranges)} transducers read"
    return OK, count if sonar.enabled else "off", values


def _odometry(_: Health, now: Snapshot) -> Found:
    faults, state = _faults(now, ENCODERS), now.odometry
    here, speed = state.robot_in_odom, state.twist
    values = (
        ("x", f"{here.x:.3f}"),
        ("y", f"{here.y:.3f}"),
        ("heading", f"{here.theta:.3f}"),
        ("speed", f"{speed.v:.3f}"),
        ("turn_rate", f"{speed.w:.3f}"),
    )
    return ERROR if faults else OK, faults or f"{speed.v:.2f} m/s, {speed.w:.2f} rad/s", values


def _command(health: Health, _: Snapshot) -> Found:
    why = health.why_not_moving
    words = why.text if why else ""
    warns = why.wants_help if why else health.refused is not None
    values = (
        ("driver", health.driver or ""),
        ("why_not_moving", words),
        ("help", why.symptom.command if why else ""),
        ("ignored_because", health.refused or ""),
    )
    return WARN if warns else OK, (health.refused if warns else None) or words or "moving", values


def _topics(health: Health) -> Iterator[DiagnosticStatus]:
    """Yield a warning while endpoints of other nodes cannot talk to this one."""
    if health.unheard:
        numbered = ((f"endpoint_{number}", each) for number, each in enumerate(health.unheard))
        yield DiagnosticStatus("Topics", WARN, "; ".join(health.unheard), tuple(numbered))


PARTS: Final[dict[str, Callable[[Health, Snapshot], Found]]] = {
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


SLOW_SCANS: Final = 0.8
"""Fewer scans than this share of what the laser is to give are a warning."""
LATE: Final = 2.0
"""For so long after the first scan the rate is not judged [s]."""


def laser_status(laser: LaserDriver) -> DiagnosticStatus:
    """Return the state of a laser."""
    state, identity = laser.status.latest, laser.identity or LaserIdentity()
    lost = "" if laser.connected else state.message if state else "not asked yet"
    about = (
        *_place(laser.config.url),
        ("Vendor Name", identity.vendor),
        ("Product Name", identity.product),
        ("Firmware Version", identity.firmware),
        ("Firmware Date", identity.firmware_date),
        ("Protocol Version", identity.protocol),
        ("Device ID", device_id(identity)),
        ("Device Status", identity.status),
        ("Computed Latency", f"{laser.latency:.4f}"),
        ("User Time Offset", f"{laser.config.time_offset:.4f}"),
    )
    scans = ScanCounts(latest=laser.latest, scans=laser.scans, rate=laser.rate, losses=laser.losses)
    return scans_status(laser.name, scans, lost, about)


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanCounts:
    """The last scan of a laser, and counts of all, of those in a second [1/s], and of losses."""

    latest: Scan | None
    scans: int
    rate: float
    losses: int


def scans_status(name: str, told: ScanCounts, lost: str, about: Values = ()) -> DiagnosticStatus:
    """Return the state of a laser by its scans, `lost` for a reason, with more values about it."""
    level, message = OK, "scans"
    expected = 1 / told.latest.period if told.latest is not None and told.latest.period else 0.0
    if lost:
        level, message = ERROR, lost
    elif told.scans > LATE * expected and told.rate < SLOW_SCANS * expected:
        level, message = WARN, f"{told.rate:.1f} scans/s, {expected:.1f} expected"
    values = (
        *about,
        ("Scan Rate", f"{told.rate:.2f}"),
        ("Scans", str(told.scans)),
        ("Scan Thread Lost Count", str(told.losses)),
    )
    return DiagnosticStatus(name.capitalize(), level, message, values)


def device_id(identity: LaserIdentity) -> str:
    """Return the serial number as hokuyo_node writes it: `H` in place of a leading 0."""
    serial = identity.serial
    if not serial or serial.startswith("H"):
        return serial
    return f"H{serial[1:]}" if serial.startswith("0") else f"H{serial}"


def _place(url: str) -> tuple[tuple[str, str], ...]:
    scheme, _, rest = url.partition(":")
    if scheme == "tcp":
        parts = urlsplit(url)
        return ("IP Address", parts.hostname or ""), ("IP Port", str(parts.port or ""))
    return (("Serial Port", rest if scheme == "serial" else url),)
