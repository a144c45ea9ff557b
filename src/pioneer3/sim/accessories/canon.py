"""Canon VC-C4: the commands that ARIA's `ArVCC4` sends, and its answers.

Frames are FF "00" 00 command parameters EF, answers FE "00" error "0" data EF; numbers are digits
of hexadecimal ASCII, angles steps of 0.1125 degrees around 8000. Source: `ArVCC4.h` and
`ArVCC4.cpp` of ARIA, which expect 6 bytes, 14 for a position and 10 for a zoom. Unverified: the
zero after the error byte, which commands need the host control mode, and that a new target takes
the place of an old one without BUSY.
"""

from math import inf, radians

from pioneer3.sim.accessories.pan_tilt_zoom import PtzAxes, PtzAxis, PtzPosition

HEADER, ANSWER, FOOTER = 0xFF, 0xFE, 0xEF
LONGEST = 32
ID = b"00"
OK, BAD_PARAMETER, WRONG_MODE = b"0", b"5", b"9"
STEP = radians(0.1125)
CENTRE = 0x8000
PAN, TILT_DOWN, TILT_UP = 875 * STEP, -267 * STEP, 790 * STEP
TILT_UP_AT_FIRST = radians(30)
"""Until SETRANGE allows more."""
PAN_RATE, TILT_RATE = radians(90), radians(69)
SLEWS = range(8, 801)
ZOOM_STEPS = 1960
ZOOM_TIME = 3.0
"""From wide to tele [s], unverified."""
NAME = b"VC-C4"

POWER, CONTROL = 0xA0, 0x90
ACCEPTED = (0x8E, 0xA1, 0xA5, 0xB0, 0xB5, 0xB7, 0x76)
"""LED, focus, gain, filters and digital zoom: acknowledged, without effect."""

Answer = tuple[bytes, bytes]


class SimulatedCanonVcc4:
    """The camera, off at first; its own pan counts to the right, that of :meth:`position` left."""

    def __init__(self) -> None:
        self._axes = PtzAxes(
            PtzAxis(-PAN, PAN, PAN_RATE),
            PtzAxis(TILT_DOWN, TILT_UP_AT_FIRST, TILT_RATE),
            PtzAxis(0.0, 1.0, 1 / ZOOM_TIME),
        )
        self._powered = self._controlled = False
        self._received = bytearray()
        self._said = bytearray()

    def position(self, now: float) -> PtzPosition:
        """Return where the camera points."""
        return self._axes.position(now)

    @property
    def due(self) -> float:
        """Time of the next bytes [s]: at once, or never."""
        return -inf if self._said else inf

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes; a new header starts a frame anew."""
        for byte in data:
            if byte == HEADER or len(self._received) > LONGEST:
                self._received.clear()
            if byte == FOOTER and self._received:
                self._answer(bytes(self._received[1:]), now)
                self._received.clear()
            elif byte == HEADER or self._received:
                self._received.append(byte)

    def transmit(self, now: float) -> bytes:
        """Return the answers since the last call."""
        said = bytes(self._said)
        self._said.clear()
        return said

    def _answer(self, frame: bytes, now: float) -> None:
        if len(frame) < 4 or frame[:3] != ID + b"\0":
            return
        error, data = self._obey(frame[3], frame[4:], now)
        self._said += bytes([ANSWER]) + ID + error + b"0" + data + bytes([FOOTER])

    def _obey(self, command: int, parameters: bytes, now: float) -> Answer:
        if command == POWER:
            self._powered = parameters == b"1"
            self._controlled &= self._powered
        elif command == CONTROL and self._powered:
            self._controlled = parameters == b"0"
        elif not self._controlled:
            return (WRONG_MODE, b"")
        elif command not in ACCEPTED:
            try:
                return (OK, self._carry_out(command, parameters, now))
            except ValueError:
                return (BAD_PARAMETER, b"")
        return (OK, b"")

    def _carry_out(self, command: int, parameters: bytes, now: float) -> bytes:
        """Obey a command; return the data of the answer, or ValueError for a wrong one."""
        axes = self._axes
        match command:
            case 0x50:
                _set_rate(axes.pan, parameters, now)
            case 0x51:
                _set_rate(axes.tilt, parameters, now)
            case 0x53:
                axes.stop(now)
            case 0x58:
                axes.look(0.0, 0.0, now)  # initialize
            case 0x62:
                self._pan_tilt(parameters, now)
            case 0x63:
                return self._pan_tilt_position(now)
            case 0x64:
                self._range(parameters, now)
            case 0x87:
                return NAME
            case 0xA2:
                axes.zoom.stop(now)
            case 0xB3:
                self._zoom(parameters, now)
            case 0xB4:
                return _hex4(round(axes.zoom.at(now) * ZOOM_STEPS))
            case _:
                raise ValueError
        return b""

    def _range(self, parameters: bytes, now: float) -> None:
        if parameters[:1] == b"1":
            low, high = _angle(parameters[1:5]), _angle(parameters[5:])
            if not TILT_DOWN - STEP <= low <= high <= TILT_UP + STEP:
                raise ValueError
            self._axes.tilt.low, self._axes.tilt.high = low, high
            self._axes.tilt.stop(now)

    def _pan_tilt(self, parameters: bytes, now: float) -> None:
        pan, tilt = -_angle(parameters[:4]), _angle(parameters[4:])
        axis = self._axes.tilt
        if abs(pan) > PAN + STEP / 2 or not axis.low - STEP / 2 <= tilt <= axis.high + STEP / 2:
            raise ValueError
        self._axes.look(pan, tilt, now)

    def _pan_tilt_position(self, now: float) -> bytes:
        position = self.position(now)
        pan, tilt = round(-position.pan / STEP), round(position.tilt / STEP)
        return _hex4(CENTRE + pan) + _hex4(CENTRE + tilt)

    def _zoom(self, parameters: bytes, now: float) -> None:
        steps = _number(parameters, 4)
        if steps > ZOOM_STEPS:
            raise ValueError
        self._axes.zoom.go(steps / ZOOM_STEPS, now)


def _number(digits: bytes, count: int) -> int:
    """Return the number of exactly `count` hexadecimal digits."""
    if len(digits) != count or not digits.isalnum():
        raise ValueError
    return int(digits, 16)


def _angle(digits: bytes) -> float:
    return (_number(digits, 4) - CENTRE) * STEP


def _hex4(value: int) -> bytes:
    return b"%04X" % value


def _set_rate(axis: PtzAxis, parameters: bytes, now: float) -> None:
    steps = _number(parameters, 3)
    if steps not in SLEWS:
        raise ValueError
    target = axis.target
    axis.stop(now)
    axis.rate = steps * STEP
    axis.go(target, now)
