"""Sony EVI-D30 in VISCA: the commands of ARIA's `ArSonyPTZ` and of libvisca, and the answers.

Packets are address, message, FF. A command is answered with 90 41 FF at once and with 90 51 FF
when it is done, an inquiry with 90 50 data FF, nonsense with 90 60 02 FF. Sources: `ArSonyPTZ.cpp`
of ARIA (init, absolute position, zoom), libvisca (replies), Sony's EVI-D70 and EVI-D100 manuals
on their D30 mode: 0370 is 100 degrees to the right and 012C is 25 up, speed 1 to 18 (hex) pans
3.33 degrees a second each, tilt 1 to 14 (hex) 2.5. Of its two sockets only the first is used.
"""

from collections import deque
from math import inf, radians

from pioneer3.sim.accessories.pan_tilt_zoom import PtzAxes, PtzAxis, PtzPosition

END = 0xFF
LONGEST = 16
BROADCAST, CAMERA = 0x88, 0x81
SET_ADDRESS, ADDRESS_SET = bytes([0x88, 0x30, 0x01]), bytes([0x88, 0x30, 0x02, END])
POWER = bytes([0x04, 0x00])
CLEAR = bytes([0x01, 0x00, 0x01])
ACK, DONE = bytes([0x90, 0x41, END]), bytes([0x90, 0x51, END])
SYNTAX_ERROR, NOT_NOW = bytes([0x90, 0x60, 0x02, END]), bytes([0x90, 0x61, 0x41, END])
PAN_STEPS, TILT_STEPS = 0x370, 0x12C
PAN_STEP, TILT_STEP = radians(100) / PAN_STEPS, radians(25) / TILT_STEPS
PAN_SPEED, TILT_SPEED = radians(10 / 3), radians(2.5)
FASTEST_PAN, FASTEST_TILT = 0x18, 0x14
ZOOM_STEPS = 1023
ZOOM_TIME = 3.0
"""From wide to tele [s], unverified."""
SETTINGS = 0x04
"""Category of settings; others than power and zoom are taken without effect."""
MOTION = 0x06
"""Category of motions."""


class SimulatedSonyEvi:
    """The camera, on at first; its own pan counts to the right, that of :meth:`position` left."""

    def __init__(self) -> None:
        pan, tilt = PAN_STEPS * PAN_STEP, TILT_STEPS * TILT_STEP
        self._axes = PtzAxes(
            PtzAxis(-pan, pan, FASTEST_PAN * PAN_SPEED),
            PtzAxis(-tilt, tilt, FASTEST_TILT * TILT_SPEED),
            PtzAxis(0.0, 1.0, 1 / ZOOM_TIME),
        )
        self._powered = True
        self._received = bytearray()
        self._said: deque[tuple[float, bytes]] = deque()

    def position(self, now: float) -> PtzPosition:
        """Return where the camera points."""
        return self._axes.position(now)

    @property
    def due(self) -> float:
        """Time of the next bytes [s]; `inf` if there are none."""
        return min((when for when, _ in self._said), default=inf)

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes; drop those beyond the longest packet."""
        for byte in data:
            if byte == END:
                self._answer(bytes(self._received), now)
                self._received.clear()
            elif len(self._received) < LONGEST:
                self._received.append(byte)

    def transmit(self, now: float) -> bytes:
        """Return the answers that are due since the last call."""
        due = [said for when, said in self._said if when <= now]
        self._said = deque((when, said) for when, said in self._said if when > now)
        return b"".join(due)

    def _say(self, said: bytes, when: float) -> None:
        self._said.append((when, said))

    def _answer(self, packet: bytes, now: float) -> None:
        if packet == SET_ADDRESS:
            self._say(ADDRESS_SET, now)
        elif packet[1:] == CLEAR and packet[0] in (BROADCAST, CAMERA):
            self._said.clear()
            broadcast = packet[0] == BROADCAST
            self._say(packet + bytes([END]) if broadcast else bytes([0x90, 0x50, END]), now)
        elif len(packet) >= 4 and packet[0] == CAMERA:
            self._obey(packet[1:], now)
        elif packet[:1] == bytes([CAMERA]):
            self._say(SYNTAX_ERROR, now)

    def _obey(self, message: bytes, now: float) -> None:
        if message[0] == 0x09:
            inquired = self._inquire(message[1:], now)
            said = SYNTAX_ERROR if inquired is None else bytes([0x90, 0x50]) + inquired + b"\xff"
            self._say(said, now)
            return
        if message[0] == 0x01 and not self._powered and message[1:3] != POWER:
            self._say(NOT_NOW, now)
            return
        done = self._command(message[1:], now) if message[0] == 0x01 else None
        if done is None:
            self._say(SYNTAX_ERROR, now)
        else:
            self._say(ACK, now)
            self._say(DONE, done)

    def _inquire(self, inquiry: bytes, now: float) -> bytes | None:
        position = self.position(now)
        match inquiry:
            case b"\x04\x00":
                return b"\x02" if self._powered else b"\x03"
            case b"\x04\x47":
                return _nibbles(round(position.zoom * ZOOM_STEPS))
            case b"\x06\x12":
                return _nibbles(round(-position.pan / PAN_STEP)) + _nibbles(
                    round(position.tilt / TILT_STEP)
                )
        return None

    def _command(self, message: bytes, now: float) -> float | None:
        """Obey; return when it will be done [s], or `None` if it makes no sense."""
        category, number, arguments = message[0], message[1], message[2:]
        if (category, number) == (SETTINGS, 0x00) and arguments in (b"\x02", b"\x03"):
            self._powered = arguments == b"\x02"
        elif category == MOTION:
            return self._move(number, arguments, now)
        elif (category, number) == (SETTINGS, 0x47):
            if len(arguments) != 4:
                return None
            self._axes.zoom.go(_word(arguments) / ZOOM_STEPS, now)
            return self._axes.zoom.arrival(now)
        elif category != SETTINGS or not arguments:
            return None
        return now

    def _move(self, number: int, arguments: bytes, now: float) -> float | None:
        match number:
            case 0x02 | 0x03 if len(arguments) == 10:
                return self._turn(arguments, now, relative=number == 0x03)
            case 0x04 | 0x05 if not arguments:
                self._axes.look(0.0, 0.0, now)
                return self._arrival(now)
            case 0x01 if arguments[2:] == b"\x03\x03":
                self._axes.stop(now)
                return now
        return None

    def _turn(self, arguments: bytes, now: float, *, relative: bool) -> float | None:
        pan_speed, tilt_speed = arguments[:2]
        if not (0 < pan_speed <= FASTEST_PAN and 0 < tilt_speed <= FASTEST_TILT):
            return None
        base = self.position(now) if relative else PtzPosition(0.0, 0.0, 0.0)
        self._axes.stop(now)
        self._axes.pan.rate = pan_speed * PAN_SPEED
        self._axes.tilt.rate = tilt_speed * TILT_SPEED
        pan, tilt = (_signed(_word(arguments[at : at + 4])) for at in (2, 6))
        self._axes.look(base.pan - pan * PAN_STEP, base.tilt + tilt * TILT_STEP, now)
        return self._arrival(now)

    def _arrival(self, now: float) -> float:
        return max(self._axes.pan.arrival(now), self._axes.tilt.arrival(now))


def _word(nibbles: bytes) -> int:
    """Return the number whose hexadecimal digits are the low halves of four bytes."""
    value = 0
    for nibble in nibbles:
        value = value << 4 | nibble & 0xF
    return value


def _signed(word: int) -> int:
    return word - 0x10000 if word & 0x8000 else word


def _nibbles(value: int) -> bytes:
    return bytes(value >> shift & 0xF for shift in (12, 8, 4, 0))
