"""Canon VC-C4 as ARIA's `ArVCC4` drives it.

Frames are FF "00" 00 command parameters EF, answers FE "00" error "0" data EF; numbers are digits
of hexadecimal ASCII, angles steps of 0.1125 degrees around 8000; pan counts to the right.
"""

import re
from collections.abc import Sequence

from pioneer3.robot.devices.camera_kind import Aim, Reach
from pioneer3.units import DEGREE

STEP = 0.1125 * DEGREE
CENTRE = 0x8000
LOWEST_STEPS = -267
"""Lowest tilt: -30 degrees."""
HIGHEST_STEPS = 782
"""Highest tilt: 88 degrees."""
ZOOM_STEPS = 1960
POWER_ON, HOST_CONTROL, INIT, RANGE = b"\xa01", b"\x900", b"\x580", b"\x641"
PAN_TILT, POSITION, ZOOM = b"\x62", b"\x63", b"\xb3"
ANSWER = re.compile(rb"\xfe00\x30.([0-9A-Fa-f]{8})\xef", re.DOTALL)


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
        """Return the packet that turns to pan and tilt of `aim`."""
        pan, tilt = -self._sign * aim.pan, self._sign * aim.tilt
        return _frame(PAN_TILT + _angle(pan) + _angle(tilt))

    def zoom(self, aim: Aim) -> bytes:
        """Return the packet that zooms to that of `aim`."""
        return _frame(ZOOM + _hex4(round(aim.zoom * ZOOM_STEPS)))

    def position_in(self, received: bytes) -> bytes | None:
        """Return the eight digits of a position, or `None`."""
        found = ANSWER.search(received)
        return found[1] if found else None

    def read_position(self, answer: bytes) -> tuple[float, float]:
        """Return pan and tilt [rad]."""
        pan, tilt = (int(answer[at : at + 4], 16) - CENTRE for at in (0, 4))
        return -self._sign * pan * STEP, self._sign * tilt * STEP


def _frame(data: bytes) -> bytes:
    return b"\xff00\0" + data + b"\xef"


def _hex4(value: int) -> bytes:
    return b"%04X" % value


def _angle(angle: float) -> bytes:
    return _hex4(CENTRE + round(angle / STEP))
