"""Sony EVI-D30 in VISCA, as ARIA's `ArSonyPTZ` drives it.

Packets are address, message, FF; a byte of a number holds four bits. 0x370 is 100 degrees to the
right, 0x12C is 25 up (Sony's EVI-D70 and EVI-D100 manuals on their D30 mode).
"""

import re
from collections.abc import Sequence

from pioneer3.robot.devices.camera_kind import Aim, Reach
from pioneer3.units import DEGREE

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
        """Return the packet that zooms to that of `aim`."""
        return b"\x81\x01\x04\x47" + _halves(round(aim.zoom * ZOOM_STEPS)) + b"\xff"

    def position_in(self, received: bytes) -> bytes | None:
        """Return the eight halves of a position, or `None`."""
        found = ANSWER.search(received)
        return found[1] if found else None

    def read_position(self, answer: bytes) -> tuple[float, float]:
        """Return pan and tilt [rad]."""
        return -_number(answer[:4]) * PAN_STEP, _number(answer[4:]) * TILT_STEP


def _halves(value: int) -> bytes:
    """Return 16 bits, two's complement, as four bytes of four bits."""
    return bytes(value >> shift & 0xF for shift in (12, 8, 4, 0))


def _number(halves: bytes) -> int:
    word = sum(half << shift for half, shift in zip(halves, (12, 8, 4, 0), strict=True))
    return word - 0x10000 if word & 0x8000 else word
