"""Makes of cameras: the interface of all, Sony's EVI-D30 and Canon's VC-C4."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from pioneer3.units import DEGREE


@dataclass(frozen=True, slots=True)
class Aim:
    """Direction and zoom: `pan` to the left and `tilt` up [rad], `zoom` 0 wide to 1 tele."""

    pan: float = 0.0
    tilt: float = 0.0
    zoom: float = 0.0


@dataclass(frozen=True, slots=True)
class Reach:
    """The range of an axis, from `low` to `high` [rad]."""

    low: float
    high: float

    def bound(self, angle: float) -> float:
        """Return the nearest angle in range."""
        return max(self.low, min(self.high, angle))


class CameraKind(Protocol):
    """The bytes of one make; angles are in range, zoom is 0 to 1.

    Attributes:
        pan: Range to the left [rad].
        tilt: Range up [rad].
        position_size: Bytes of the answer to :attr:`where`.
    """

    title: str
    pan: Reach
    tilt: Reach
    position_size: int

    @property
    def where(self) -> bytes:
        """The question for the position."""

    def begin(self) -> Sequence[bytes]:
        """Return the packets that initialise the camera, in order."""

    def look(self, aim: Aim) -> bytes:
        """Return the packet that turns to pan and tilt of `aim`."""

    def zoom(self, aim: Aim) -> bytes:
        """Return the packet that zooms to that of `aim`."""

    def position_in(self, received: bytes) -> bytes | None:
        """Return the answer to :attr:`where` in `received`, or `None`."""

    def read_position(self, answer: bytes) -> tuple[float, float]:
        """Return pan and tilt [rad] of an answer that :meth:`position_in` found."""


PAN_STEP, TILT_STEP = 100 * DEGREE / 0x370, 25 * DEGREE / 0x12C
FASTEST_PAN, FASTEST_TILT = 0x18, 0x14
ZOOM_STEPS = 1023
ADDRESS, CLEAR = bytes([0x88, 0x30, 0x01, 0xFF]), bytes([0x88, 0x01, 0x00, 0x01, 0xFF])
ANSWER = re.compile(rb"\x90\x50([\x00-\x0f]{8})\xff")


class SonyEvi:
    """The camera, at address 1."""

    title = "Sony EVI-D30"
    pan = Reach(-100 * DEGREE, 100 * DEGREE)
    tilt = Reach(-25 * DEGREE, 25 * DEGREE)
    position_size = 11
    where = bytes([0x81, 0x09, 0x06, 0x12, 0xFF])

    def begin(self) -> Sequence[bytes]:
        """Return the packets that set address 1 and clear earlier commands."""
        return (ADDRESS, CLEAR)

    def look(self, aim: Aim) -> bytes:
        """Return the packet that turns to pan and tilt of `aim`, at top speed."""
        pan, tilt = round(-aim.pan / PAN_STEP), round(aim.tilt / TILT_STEP)
        speeds = bytes([FASTEST_PAN, FASTEST_TILT])
        return b"\x81\x01\x06\x02" + speeds + _halves(pan) + _halves(tilt) + b"\xff"

    def zoom(self, aim: Aim) -> bytes:
        return b"\x81\x01\x04\x47" + _halves(round(aim.zoom * ZOOM_STEPS)) + b"\xff"

    def position_in(self, received: bytes) -> bytes | None:
        """Return the eight halves of a position, or `None`."""
        found = ANSWER.search(received)
        return found[1] if found else None

    def read_position(self, answer: bytes) -> tuple[float, float]:
        return -_number(answer[:4]) * PAN_STEP, _number(answer[4:]) * TILT_STEP


def _halves(value: int) -> bytes:
    """Return 16 bits, two's complement, as four bytes of four bits."""
    return bytes(value >> shift & 0xF for shift in (12, 8, 4, 0))


def _number(halves: bytes) -> int:
    word = sum(half << shift for half, shift in zip(halves, (12, 8, 4, 0), strict=True))
    return word - 0x10000 if word & 0x8000 else word


STEP = 0.1125 * DEGREE
CENTRE = 0x8000
LOWEST_STEPS = -267
"""Lowest tilt: -30 degrees."""
HIGHEST_STEPS = 782
"""Highest tilt: 88 degrees."""
CANON_ZOOM_STEPS = 1960
POWER_ON, HOST_CONTROL, INIT, RANGE = b"\xa01", b"\x900", b"\x580", b"\x641"
PAN_TILT, POSITION, ZOOM = b"\x62", b"\x63", b"\xb3"
CANON_ANSWER = re.compile(rb"\xfe00\x30.([0-9A-Fa-f]{8})\xef", re.DOTALL)


class CanonVcc4:
    """The camera, upright or upside down."""

    pan = Reach(-98 * DEGREE, 98 * DEGREE)
    position_size = 14
    where = b"\xff00\0" + POSITION + b"\xef"

    def __init__(self, *, inverted: bool = False) -> None:
        self._sign = -1 if inverted else 1
        self.title = "Canon VC-C4, upside down" if inverted else "Canon VC-C4"
        low, high = LOWEST_STEPS * STEP, HIGHEST_STEPS * STEP
        self.tilt = Reach(-high, -low) if inverted else Reach(low, high)

    def begin(self) -> Sequence[bytes]:
        """Return the packets for power, control by the host, initialisation and range of tilt."""
        reach = _hex4(CENTRE + LOWEST_STEPS) + _hex4(CENTRE + HIGHEST_STEPS)
        return [_frame(data) for data in (POWER_ON, HOST_CONTROL, INIT, RANGE + reach)]

    def look(self, aim: Aim) -> bytes:
        pan, tilt = -self._sign * aim.pan, self._sign * aim.tilt
        return _frame(PAN_TILT + _angle(pan) + _angle(tilt))

    def zoom(self, aim: Aim) -> bytes:
        return _frame(ZOOM + _hex4(round(aim.zoom * CANON_ZOOM_STEPS)))

    def position_in(self, received: bytes) -> bytes | None:
        """Return the eight digits of a position, or `None`."""
        found = CANON_ANSWER.search(received)
        return found[1] if found else None

    def read_position(self, answer: bytes) -> tuple[float, float]:
        pan, tilt = (int(answer[at : at + 4], 16) - CENTRE for at in (0, 4))
        return -self._sign * pan * STEP, self._sign * tilt * STEP


def _frame(data: bytes) -> bytes:
    return b"\xff00\0" + data + b"\xef"


def _hex4(value: int) -> bytes:
    return b"%04X" % value


def _angle(angle: float) -> bytes:
    return _hex4(CENTRE + round(angle / STEP))
