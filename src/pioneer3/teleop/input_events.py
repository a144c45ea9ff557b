"""Linux input events of a gamepad, as the kernel writes them -> buttons and axes. Pure.

The struct is `input_event` of linux/input.h, the codes are of linux/input-event-codes.h, and which
button is where on a gamepad is the kernel's Documentation/input/gamepad.rst.
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field

from pioneer3.teleop.gamepad import Gamepad

EVENT = struct.Struct("@llHHi")
"""Seconds, microseconds, type, code, value."""
EV_SYN, EV_KEY, EV_ABS = 0x00, 0x01, 0x03
SYN_REPORT, SYN_DROPPED = 0, 3
ABS_X, ABS_Y = 0x00, 0x01
BTN_SOUTH = 0x130
"""Gamepads have it, and by that they are known."""
BUTTONS = {
    BTN_SOUTH: 0,
    0x131: 1,  # BTN_EAST
    0x136: 4,  # BTN_TL
    0x137: 5,  # BTN_TR
    0x13A: 8,  # BTN_SELECT
    0x13B: 9,  # BTN_START
}
"""Codes of buttons -> their numbers in the W3C's "standard gamepad"."""
AXES = {ABS_X: 0, ABS_Y: 1}
"""Codes of the left stick's axes -> their numbers there."""


@dataclass(frozen=True, slots=True)
class Range:
    """What an axis says at its two ends."""

    low: int
    high: int

    def part(self, value: int) -> float:
        """Return -1 to 1 for what the axis says; the middle for an axis without a range."""
        if self.high <= self.low:
            return 0.0
        return min(1.0, max(-1.0, (2 * value - self.low - self.high) / (self.high - self.low)))


@dataclass(slots=True)
class Decoder:
    """Tells `gamepad` what the events say.

    Attributes:
        gamepad: Takes buttons and axes.
        ranges: Of the axes, by code.
        pressed: Numbers of the buttons that were pressed since this was emptied.
    """

    gamepad: Gamepad
    ranges: Mapping[int, Range]
    pressed: list[int] = field(default_factory=list)
    _rest: bytes = field(default=b"", init=False)
    _lost: bool = field(default=False, init=False)

    def feed(self, data: bytes) -> None:
        """Take what was read, whole events or not."""
        data = self._rest + data
        whole = len(data) - len(data) % EVENT.size
        self._rest = data[whole:]
        for _, _, kind, code, value in EVENT.iter_unpack(data[:whole]):
            self._take(kind, code, value)

    def place(self, axis: int, value: int) -> None:
        """Take what an axis says, by its code."""
        self.gamepad.axis(AXES[axis], self.ranges[axis].part(value))

    def _take(self, kind: int, code: int, value: int) -> None:
        if kind == EV_SYN and code == SYN_DROPPED:
            # the kernel's buffer ran over, and nobody knows what was let go meanwhile
            self._lost = True
            self.gamepad.let_go()
        elif self._lost:  # what comes until the next report is a part of the whole
            self._lost = not (kind == EV_SYN and code == SYN_REPORT)
        elif kind == EV_KEY and code in BUTTONS:
            if value == 1:  # 2 is a repeat
                self.pressed.append(BUTTONS[code])
            self.gamepad.button(BUTTONS[code], pressed=value != 0)
        elif kind == EV_ABS and code in AXES and code in self.ranges:
            self.place(code, value)
