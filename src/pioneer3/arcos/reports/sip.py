"""The standard information packet, once per cycle (protocol.md 4), in the robot's own units.

Multiply `x_raw` by the model's DistConvFactor, wheel speeds by VelConvFactor and sonar ranges by
RangeConvFactor. Bytes are read and written by hand here: a simulator writes thousands of reports
per second.
"""

import struct
from enum import IntFlag
from functools import lru_cache, partial
from itertools import chain
from operator import attrgetter
from struct import calcsize, error, iter_unpack, pack
from typing import ClassVar, Final, NamedTuple

from pioneer3.arcos.layout import Report
from pioneer3.arcos.wire import Integer, checked
from pioneer3.errors import CommandError

__all__ = [
    "NO_TEMPERATURE",
    "SIP_MOVING",
    "SIP_STOPPED",
    "Fault",
    "Sip",
    "SipFlag",
    "SipFlag3",
    "SonarReading",
]

SIP_STOPPED: Final = 0x32
SIP_MOVING: Final = 0x33
SIP_NUMBERS: Final = range(0x30, 0x35)
"""Those that Player accepts; ARIA takes 0x32 and 0x33 only."""

NO_TEMPERATURE: Final = -128
"""The value of `temperature_celsius` without a sensor (AMRISim sends -127)."""


class SipFlag(IntFlag):
    """The robot's own state (protocol.md 4.4)."""

    MOTORS_ENABLED = 1 << 0
    SONAR_1 = 1 << 1
    SONAR_2 = 1 << 2
    SONAR_3 = 1 << 3
    SONAR_4 = 1 << 4
    STOP_BUTTON = 1 << 5
    LEGACY_IR_1 = 1 << 7
    LEGACY_IR_2 = 1 << 8
    JOYSTICK_BUTTON = 1 << 9
    CHARGER_POWER_GOOD = 1 << 10
    HIGH_TEMPERATURE = 1 << 11


class Fault(IntFlag):
    """Faults of the robot (protocol.md 4.5)."""

    PDB_LASER_STATUS_ERROR = 1 << 0
    HIGH_TEMPERATURE = 1 << 1
    PDB_ERROR = 1 << 2
    UNDERVOLTAGE = 1 << 3
    GYRO_FAULT = 1 << 4
    BATTERY_OVERTEMPERATURE = 1 << 5
    BATTERY_BALANCE_REQUIRED = 1 << 6
    ENCODER_DEGRADATION = 1 << 7
    ENCODER_FAILURE = 1 << 8
    CRITICAL_GENERAL_DRIVING_FAULT = 1 << 9
    ESTOP_MISMATCH_WARNING = 1 << 10
    ESTOP_SAFETY_FAULT = 1 << 11
    ZONE_SAFETY_FAULT = 1 << 12
    UNKNOWN_SAFETY_FAULT = 1 << 13
    BACKED_UP_TOO_FAST = 1 << 14
    JOYDRIVE_UNSAFE = 1 << 15


class SipFlag3(IntFlag):
    """More state of MTX robots (protocol.md 4.6)."""

    JOYSTICK_OVERRIDE = 1 << 0
    AMPLIFIER_COMMUNICATION_ERROR = 1 << 1
    SILENT_ESTOP = 1 << 2
    LASER_SAFETY_CIRCUIT_ERROR = 1 << 3
    ROTATION_LOOP_ENABLED = 1 << 4
    ROTATION_INTEGRATOR_SATURATED = 1 << 5


NO_FLAGS: Final = SipFlag(0)


class SonarReading(NamedTuple):
    """One sonar's range.

    Attributes:
        number: Of the transducer, 0 is front left.
        range_raw: [RangeConvFactor mm].
    """

    number: int
    range_raw: int


class Sip(Report, frozen=True, kw_only=True):
    """The standard report (0x32 stopped, 0x33 moving).

    The fields from `analog_port` on are `None` where the packet ends before; it may end before
    `analog_port` and before every field from `battery_decivolts_wide` on.

    Attributes:
        number: Id of the packet, 0x30..0x34.
        x_raw: [DistConvFactor mm], of which the low 15 bits count.
        y_raw: Likewise.
        heading_raw: Counter-clockwise, 4096 to a turn, signed.
        left_speed_raw: [VelConvFactor mm/s], signed.
        right_speed_raw: Likewise.
        battery_decivolts: [0.1 V].
        left_stall_rear_bumpers: Bit 0 left motor stalled, bits 1..7 rear bumpers, right to left.
        right_stall_front_bumpers: Bit 0 right motor stalled, bits 1..7 front ones, left to right.
        control_raw: The firmware's heading set-point, 4096 to a turn.
        compass_raw: [2 degrees].
        analog_port: Number of the analog input that `analog` shows.
        gripper_state: Bits of :class:`GripperSwitch`.
        analog: 0..255 for 0..5 V.
        digital_in: Bits, 1 is high.
        digital_out: Bits, 1 is high.
        battery_decivolts_wide: [0.1 V], for batteries above 25.5 V.
        charge_state: 0 not charging, 1 bulk, 2 overcharge, 3 float, 4 balance.
        turn_rate_decidegrees: [0.1 degree/s], counter-clockwise.
        lateral_speed_mm: [mm/s], left.
        temperature_celsius: [degrees Celsius], -128 without sensor.
        charge_percent: 0 if the robot cannot tell.
        timestamp_us: [us], MTX only.
        flags3: MTX only.
    """

    ID: ClassVar[int] = SIP_STOPPED
    number: int = SIP_STOPPED
    x_raw: int = 0
    y_raw: int = 0
    heading_raw: int = 0
    left_speed_raw: int = 0
    right_speed_raw: int = 0
    battery_decivolts: int = 0
    left_stall_rear_bumpers: int = 0
    right_stall_front_bumpers: int = 0
    control_raw: int = 0
    flags: SipFlag = NO_FLAGS
    compass_raw: int = 0
    sonar: tuple[SonarReading, ...] = ()
    analog_port: int | None = None
    gripper_state: int | None = None
    analog: int | None = None
    digital_in: int | None = None
    digital_out: int | None = None
    battery_decivolts_wide: int | None = None
    charge_state: int | None = None
    turn_rate_decidegrees: int | None = None
    faults: Fault | None = None
    lateral_speed_mm: int | None = None
    temperature_celsius: int | None = None
    charge_percent: int | None = None
    timestamp_us: int | None = None
    flags3: SipFlag3 | None = None
    extra: bytes = b""

    @property
    def moving(self) -> bool:
        """Whether the firmware reports that it moves the robot."""
        return self.number == SIP_MOVING


HEAD: Final = (
    ("number", "B"),
    ("x_raw", "H"),
    ("y_raw", "H"),
    ("heading_raw", "h"),
    ("left_speed_raw", "h"),
    ("right_speed_raw", "h"),
    ("battery_decivolts", "B"),
    ("left_stall_rear_bumpers", "B"),
    ("right_stall_front_bumpers", "B"),
    ("control_raw", "h"),
    ("flags", "H"),
    ("compass_raw", "B"),
)
TAIL: Final = (
    ("analog_port", "B"),
    ("gripper_state", "B"),
    ("analog", "B"),
    ("digital_in", "B"),
    ("digital_out", "B"),
    ("battery_decivolts_wide", "H"),
    ("charge_state", "B"),
    ("turn_rate_decidegrees", "h"),
    ("faults", "H"),
    ("lateral_speed_mm", "h"),
    ("temperature_celsius", "b"),
    ("charge_percent", "B"),
    ("timestamp_us", "I"),
    ("flags3", "I"),
)
"""Names and :mod:`struct` letters in wire order (protocol.md 4.2)."""


def _struct(fields: tuple[tuple[str, str], ...]) -> struct.Struct:
    return struct.Struct("<" + "".join(letter for _, letter in fields))


_HEAD: Final = _struct(HEAD)
_HEAD_NAMES: Final = tuple(name for name, _ in HEAD)
_TAIL_NAMES: Final = tuple(name for name, _ in TAIL)
_head_of: Final = attrgetter(*_HEAD_NAMES)
_tail_of: Final = attrgetter(*_TAIL_NAMES)
_TAILS: Final = {count: _struct(TAIL[:count]) for count in (0, *range(5, len(TAIL) + 1))}
"""How a packet may end: after the sonars, or after any field from `digital_out` on."""

_reading: Final = partial(tuple.__new__, SonarReading)
"""Makes a reading of its two values, without a check of their number."""

_FLAGS: Final = {
    name: lru_cache(kind)
    for name, kind in (("flags", SipFlag), ("faults", Fault), ("flags3", SipFlag3))
}
"""Makers of the flags in a field. Each value is made once: that takes a tenth of a report."""


@lru_cache
def _tail_within(size: int) -> struct.Struct:
    """Return the longest tail that fits into a number of bytes."""
    return max((tail for tail in _TAILS.values() if tail.size <= size), key=attrgetter("size"))


def read_sip(payload: bytes) -> Sip:
    """Return the report in `payload`; EOFError when it ends too early."""
    if len(payload) <= _HEAD.size:
        raise EOFError
    start = _HEAD.size + 1
    end = start + 3 * payload[_HEAD.size]
    if end > len(payload):
        raise EOFError
    sonar = tuple(map(_reading, iter_unpack("<BH", payload[start:end])))
    tail = _tail_within(len(payload) - end)
    values = dict(zip(_HEAD_NAMES, _HEAD.unpack_from(payload), strict=True))
    values |= zip(_TAIL_NAMES, tail.unpack_from(payload, end), strict=False)
    for name, flags in _FLAGS.items():
        if name in values:
            values[name] = flags(values[name])
    return Sip(**values, sonar=sonar, extra=payload[end + tail.size :])


def write_sip(sip: Sip) -> bytes:
    """Return the payload of `sip`; CommandError names the field that does not fit."""
    tail = _tail_of(sip)
    count = tail.index(None) if None in tail else len(tail)
    if sip.number not in SIP_NUMBERS:
        raise CommandError(f"Sip.number: {sip.number!r} is outside 0x30..0x34")
    if count not in _TAILS:
        raise CommandError(f"Sip.{TAIL[count][0]}: None, but a field of its group is set")
    if tail.count(None) != len(tail) - count:
        raise CommandError(f"Sip.{TAIL[count][0]}: None, but a field behind it is set")
    ranges = chain.from_iterable(sip.sonar)
    try:
        return b"".join(
            (
                _HEAD.pack(*_head_of(sip)),
                pack("<B" + "BH" * len(sip.sonar), len(sip.sonar), *ranges),
                _TAILS[count].pack(*tail[:count]),
                sip.extra,
            )
        )
    except error:
        raise _misfit(sip) from None


def _misfit(sip: Sip) -> CommandError:
    """Return the error of a report that :mod:`struct` refused."""
    values = [(name, letter, getattr(sip, name)) for name, letter in (*HEAD, *TAIL)]
    values.append(("len(sonar)", "B", len(sip.sonar)))
    for index, reading in enumerate(sip.sonar):
        values.append((f"sonar[{index}].number", "B", reading.number))
        values.append((f"sonar[{index}].range_raw", "H", reading.range_raw))
    for name, letter, value in values:
        try:
            if value is not None:
                checked(value, Integer(calcsize("<" + letter), signed=letter.islower()))
        except CommandError as problem:
            return CommandError(f"Sip.{name}: {problem}")
    return CommandError(f"{sip!r} does not fit into a packet")
