"""Standard reports to bytes and back, by hand: a simulator writes thousands of them per second."""

from operator import attrgetter
from struct import Struct, calcsize, error, iter_unpack, pack
from typing import Final

from pioneer3.arcos.reports.flags import Fault, SipFlag, SipFlag3
from pioneer3.arcos.reports.sip import SIP_NUMBERS, Sip, SonarReading
from pioneer3.arcos.wire import Integer, checked
from pioneer3.errors import CommandError

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
"""Names and :mod:`struct` letters in wire order (arcos.md 4.2)."""


def _struct(fields: tuple[tuple[str, str], ...]) -> Struct:
    return Struct("<" + "".join(letter for _, letter in fields))


_HEAD: Final = _struct(HEAD)
_HEAD_NAMES: Final = tuple(name for name, _ in HEAD)
_TAIL_NAMES: Final = tuple(name for name, _ in TAIL)
_head_of: Final = attrgetter(*_HEAD_NAMES)
_tail_of: Final = attrgetter(*_TAIL_NAMES)
_TAILS: Final = {count: _struct(TAIL[:count]) for count in (0, *range(5, len(TAIL) + 1))}
"""How a packet may end: after the sonars, or after any field from `digital_out` on."""

_LONGEST_FIRST: Final = tuple(reversed(_TAILS.values()))
_FLAG_TYPES: Final = {"flags": SipFlag, "faults": Fault, "flags3": SipFlag3}


def read_sip(payload: bytes) -> Sip:
    """Return the report that `payload` spells; EOFError when it ends too early."""
    if len(payload) <= _HEAD.size:
        raise EOFError
    start = _HEAD.size + 1
    end = start + 3 * payload[_HEAD.size]
    if end > len(payload):
        raise EOFError
    sonar = tuple(SonarReading(*reading) for reading in iter_unpack("<BH", payload[start:end]))
    tail = next(tail for tail in _LONGEST_FIRST if tail.size <= len(payload) - end)
    values = dict(zip(_HEAD_NAMES, _HEAD.unpack_from(payload), strict=True))
    values |= zip(_TAIL_NAMES, tail.unpack_from(payload, end), strict=False)
    for name, flags in _FLAG_TYPES.items():
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
    ranges = [part for reading in sip.sonar for part in (reading.number, reading.range_raw)]
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
    """Return what is wrong with a report that :mod:`struct` refused."""
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
