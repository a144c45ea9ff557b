"""Gamepads of this Linux machine: which are there, and the events that they send."""

import os
import struct
import sys
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

from pioneer3.errors import ConfigError, PortPermissionError
from pioneer3.teleop.gamepad import Gamepad
from pioneer3.teleop.terminal import chunks_of

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
    """The values of an axis at its two ends."""

    low: int
    high: int

    def part(self, value: int) -> float:
        """Return -1 to 1 for a value of the axis; the middle for an axis without a range."""
        if self.high <= self.low:
            return 0.0
        return min(1.0, max(-1.0, (2 * value - self.low - self.high) / (self.high - self.low)))


@dataclass(slots=True)
class Decoder:
    """Decodes events, and passes buttons and axes to `gamepad`.

    `ranges` are those of the axes, by code; `pressed` are the numbers of the buttons that were
    pressed since this was emptied.
    """

    gamepad: Gamepad
    ranges: Mapping[int, Range]
    pressed: list[int] = field(default_factory=list)
    _rest: bytes = field(default=b"", init=False)
    _lost: bool = field(default=False, init=False)

    def feed(self, data: bytes) -> None:
        """Take bytes that were read, whole events or not."""
        data = self._rest + data
        whole = len(data) - len(data) % EVENT.size
        self._rest = data[whole:]
        for _, _, kind, code, value in EVENT.iter_unpack(data[:whole]):
            self._take(kind, code, value)

    def place(self, axis: int, value: int) -> None:
        """Take the value of an axis, by its code."""
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


DEVICES, FACTS = Path("/dev/input"), Path("/sys/class/input")
ABSINFO = struct.Struct("@6i")
"""Value, minimum, maximum, fuzz, flat, resolution."""
LONGEST = 256
READ = 2
"""Direction of an ioctl that reads, in its number (asm-generic/ioctl.h)."""


@dataclass(frozen=True, slots=True)
class GamepadDevice:
    """An open gamepad, whose `descriptor` does not block.

    `ranges` of its axes, and `start`, their values when it was opened, are by code.
    """

    path: Path
    name: str
    descriptor: int
    ranges: dict[int, Range]
    start: dict[int, int]


@contextmanager
def open_gamepad(wanted: str = "") -> Iterator[GamepadDevice | None]:
    """Open the gamepad that is `wanted`: by path, by a part of its name, or the first.

    It yields `None` while there is none.

    Raises:
        ConfigError: this is no Linux, or the path is no gamepad's.
        PortPermissionError: this user may not read it; the message says what to do.
    """
    if sys.platform != "linux":
        raise ConfigError("gamepads are read on Linux only; the page takes them everywhere")
    device = _find(wanted)
    try:
        yield device
    finally:
        if device is not None:
            os.close(device.descriptor)


async def read(device: GamepadDevice) -> AsyncIterator[bytes]:
    """Yield the bytes of the gamepad as they come; ends when it is unplugged."""
    with chunks_of(device.descriptor) as chunks:
        while chunk := await chunks.get():
            yield chunk


def _find(wanted: str) -> GamepadDevice | None:
    if wanted.startswith("/"):
        return _open(Path(wanted), must=True)
    for path in sorted(DEVICES.glob("event*"), key=lambda path: (len(path.name), path.name)):
        try:
            device = _open(path)
        except PortPermissionError:
            if _may_be_gamepad(path):
                raise
            continue
        if device is not None:
            if wanted.lower() in device.name.lower():
                return device
            os.close(device.descriptor)
    return None


def _may_be_gamepad(path: Path) -> bool:
    """Return whether it has a gamepad's buttons, as everybody may know; `True` if that is not told.

    Words of the kernel's `unsigned long`, the highest first.
    """
    try:
        words = (FACTS / path.name / "device/capabilities/key").read_text("ascii").split()
        word, bit = divmod(BTN_SOUTH, 8 * struct.calcsize("@l"))
        return word < len(words) and bool(int(words[-1 - word], 16) >> bit & 1)
    except (OSError, ValueError):
        return True


def _open(path: Path, *, must: bool = False) -> GamepadDevice | None:
    """Open `path` if it is a gamepad's; `None` if it is not, or not there.

    Raises:
        ConfigError: it is there, `must` be one, and is not.
        PortPermissionError: this user may not read it.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except PermissionError:
        raise PortPermissionError(
            f"{path}: this user may not read it; let them with: sudo usermod -aG input $USER, "
            "then log in again"
        ) from None
    except OSError:
        return None
    with suppress(OSError):
        device = _describe(path, descriptor)
        if device is not None:
            return device
    os.close(descriptor)
    if must:
        raise ConfigError(f"{path}: this is no gamepad")
    return None


def _describe(path: Path, descriptor: int) -> GamepadDevice | None:
    """Return the open gamepad, `None` if it is none.

    Raises:
        OSError: it is no input device at all.
    """
    keys, axes = _bits(descriptor, EV_KEY), _bits(descriptor, EV_ABS)
    if not (keys >> BTN_SOUTH & 1 and axes >> ABS_X & 1 and axes >> ABS_Y & 1):
        return None
    name = _get(descriptor, 0x06, LONGEST).split(b"\0")[0].decode("utf-8", "replace")
    info = {axis: ABSINFO.unpack(_get(descriptor, 0x40 + axis, ABSINFO.size)) for axis in AXES}
    return GamepadDevice(
        path,
        name,
        descriptor,
        {axis: Range(low, high) for axis, (_, low, high, *_) in info.items()},
        {axis: value for axis, (value, *_) in info.items()},
    )


def _bits(descriptor: int, kind: int) -> int:
    """Return which codes of a kind of event the device has, a bit for each."""
    return int.from_bytes(_get(descriptor, 0x20 + kind, LONGEST), sys.byteorder)


def _get(descriptor: int, number: int, size: int) -> bytes:
    """Ask the device: EVIOCGNAME 0x06, EVIOCGBIT 0x20 + kind, EVIOCGABS 0x40 + axis."""
    from fcntl import ioctl

    return ioctl(descriptor, request(number, size), bytes(size))


def request(number: int, size: int) -> int:
    """Return the number of an ioctl that reads so many bytes from an input device."""
    return READ << 30 | size << 16 | ord("E") << 8 | number
