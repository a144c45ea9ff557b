"""One host at a simulated SCIP laser: commands in, answers out. No I/O.

Facts: scip.md 1.2, 1.5, 2, 4, 5.2.
"""

from collections.abc import Callable, Mapping
from typing import Final

from pioneer3.lasers.device import Sweep
from pioneer3.lasers.line import SerialLine
from pioneer3.lasers.scip.requests import ScanRequest, read_request, read_scip1_request
from pioneer3.lasers.scip.scans import FORMATS, WIDE_RANGE
from pioneer3.lasers.scip.sweeps import data_lines
from pioneer3.lasers.scip.unit import MULTI_ECHO, ScipUnit
from pioneer3.lasers.scip.wire import STAMP, encode_values, pair, seal

LONGEST_COMMAND: Final = 128
LONGEST_COMMENT: Final = 16
MOST_WAITING: Final = 8
"""Commands for one scan that wait for it; more are ignored."""
MOST_SCANS: Final = 1 << 17
"""A network host that does not read loses further scans from here on [bytes]."""
MOST_UNSENT: Final = 1 << 18
"""Bytes on their way out, more than any scan has, above which commands are ignored."""
REBOOT_WITHIN: Final = 1.0
"""The second RB must follow the first one within this [s]."""
UNKNOWN: Final = "0E"


class HostSession:
    """The connection of one host: the `line` to it, `closed` once it is gone for good.

    `changed` is called after each change of the line or the unit.
    """

    def __init__(self, unit: ScipUnit, changed: Callable[[], None]) -> None:
        self.line = SerialLine(unit.start_speed)
        self.closed = False
        self._unit = unit
        self._changed = changed
        self._received = b""
        self._scip1 = unit.begins_in_scip1
        self._bilingual = False
        self._adjusting = False
        self._stream: ScanRequest | None = None
        self._left = 0
        self._skipped = 0
        self._waiting: list[ScanRequest] = []
        self._reboot_asked_at = float("-inf")

    @property
    def wants_readings(self) -> bool:
        """Whether scans are to be sent."""
        return self._stream is not None or bool(self._waiting)

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes of the host, in any pieces; LF, CR or both end a command."""
        if self.closed or not self._unit.hears(now):
            return
        *commands, rest = (self._received + data.replace(b"\r", b"\n")).split(b"\n")
        self._received = rest[-LONGEST_COMMAND:]
        for command in commands:
            if command and self.line.waiting < MOST_UNSENT:
                self._obey(command[-LONGEST_COMMAND:].decode("latin-1"), now)
        self._changed()

    def outgoing(self, now: float) -> bytes:
        """Return and forget the bytes that may leave by `now`."""
        data = self.line.take(now)
        self._changed()
        return data

    def serve(self, *, network: bool) -> None:
        """Serve another host at a serial line; one in the network finds it empty.

        Programs take a laser in the network for one that has always spoken SCIP 2.0.
        """
        self._bilingual = network and self._unit.knows_scip2
        if network:
            self._received = b""
            self._waiting.clear()
            self.line.drop()
            self._changed()

    def close(self) -> None:
        """End the connection of a network host, and its stream. A serial line stays as it is."""
        if self._unit.start_speed is None:
            self.closed = True
            self._waiting.clear()
            self.line.clear(None)
            self._end_stream()
            self._changed()

    def restart(self) -> None:
        """Begin as after a power cycle; the unit's own state has been reset."""
        self._received = b""
        self._scip1 = self._unit.begins_in_scip1
        self._adjusting = False
        self._stream = None
        self._waiting.clear()

    def cut_off(self) -> None:
        """Lose the bytes that have not left."""
        self.line.clear(self._unit.start_speed)

    def measured(self, sweep: Sweep, stamp_ms: int, now: float) -> None:
        """Send the readings of a turn to this host, if it wants them.

        `stamp_ms` is the unit's time at step 0 of the turn.
        """
        waiting, self._waiting = self._waiting, []
        for request in waiting:
            self._send_scan(request, sweep, stamp_ms, now)
        stream, line = self._stream, self.line
        if stream is None:
            return
        self._skipped += 1
        congested = line.is_busy(now) if line.speed else line.waiting > MOST_SCANS
        if self._skipped <= stream.skip or congested:
            return
        self._skipped = 0
        self._left -= bool(stream.scans)
        self._send_scan(stream, sweep, stamp_ms, now, left=self._left)
        if stream.scans and not self._left:
            self._end_stream()

    def _send_scan(
        self, request: ScanRequest, sweep: Sweep, stamp_ms: int, now: float, *, left: int = 0
    ) -> None:
        """Queue a scan; `left` more will follow it, or it is one of a stream without end."""
        unit = self._unit
        scip1 = request.letters == "G"
        lines = data_lines(
            sweep,
            FORMATS[request.letters],
            unit.steps,
            unit.codes,
            start=request.start,
            end=request.end,
            cluster=request.cluster,
            summed=not scip1,
        )
        if not scip1:
            lines = seal(encode_values([stamp_ms], STAMP)) + b"\n" + lines
        echo, status = request.text, "0" if scip1 else "00"
        if FORMATS[request.letters].streamed:
            echo, status = f"{echo[:13]}{left:02}{echo[15:]}", "99"
        self._answer(echo, status, lines, now)

    def _answer(self, echo: str, status: str, data: bytes, now: float) -> None:
        """Queue an answer; a status of one character is SCIP 1.1's, without a checksum."""
        code = status.encode() if len(status) == 1 else seal(status.encode())
        self.line.send(echo.encode("latin-1") + b"\n" + code + b"\n" + data + b"\n", now)

    def _obey(self, text: str, now: float) -> None:
        command, mark, comment = text.partition(";")
        if self._scip1 and self._bilingual and is_scip2(command):
            self._scip1 = self._unit.laser_on = False
        if self._scip1:
            status, data = self._obey_scip1(text)
        elif mark and len(comment) > LONGEST_COMMENT:
            status, data = "0G", b""
        elif mark and not all(c.isascii() and (c.isalnum() or c in " ._+@") for c in comment):
            status, data = "0H", b""
        elif self._adjusting and not command.startswith("TM"):
            status, data = UNKNOWN, b""
        else:
            status, data = self._obey_scip2(command, text, now)
        if status:
            self._answer(text, status, data, now)
        if status in {"0", "00"}:
            self._after(command, now)

    def _obey_scip2(  # noqa: PLR0911
        self, command: str, text: str, now: float
    ) -> tuple[str, bytes]:
        """Return status and data; an empty status: the answer comes with the readings."""
        unit = self._unit
        match command[:2], command[2:]:
            case "VV", "":
                return "00", lines_of(unit.identity)
            case "PP", "":
                return "00", lines_of(unit.parameters)
            case "II", "":
                return "00", lines_of(unit.state(self.line.speed, now))
            case "BM", "":
                return self._switch_laser_on(), b""
            case ("QT" | "RS", "") | ("%S", "L"):
                return "00", b""
            case "RB", "":
                second = now <= self._reboot_asked_at + REBOOT_WITHIN
                self._reboot_asked_at = now
                return "00" if second else "01", b""
            case "SS", digits:
                return self._check_speed(digits), b""
            case "TM", code:
                return self._adjust(code, now)
            case "CR", ratio:
                return self._slow_down(ratio), b""
            case "HS", code:
                return self._sensitivity(code), b""
            case letters, _ if letters in FORMATS and self._knows(letters):
                return self._measure(command, text), b""
        return UNKNOWN, b""

    def _obey_scip1(self, text: str) -> tuple[str, bytes]:  # noqa: PLR0911
        match text[:1], text[1:]:
            case "V", "":
                return "0", lines_of(
                    {**self._unit.identity, "STAT": self._unit.status}, summed=False
                )
            case "L", "0" | "1":
                return "0", b""
            case "S", "CIP2.0" if self._unit.knows_scip2:
                return "0", b""
            case "S", digits if len(digits) == 13 and digits.isdecimal():
                return "0" if self._check_speed(digits[:6]) in {"00", "03"} else "1", b""
            case "G", _:
                request = read_scip1_request(text, self._unit.steps)
                if request is None or not self._unit.laser_on:
                    return "1", b""
                self._keep(request)
                return "", b""
        return "E", b""

    def _after(self, command: str, now: float) -> None:
        """Do those parts of a command that follow its answer."""
        unit = self._unit
        match command:
            case "QT" | "%SL":
                self._end_stream()
            case "RS":
                self._end_stream()
                unit.reset(now)
                self._change_speed(unit.start_speed)
            case "RB":
                unit.restart(now)
                self._change_speed(unit.start_speed)
            case "SCIP2.0":
                self._scip1 = unit.laser_on = False
            case "L0" | "L1":
                unit.laser_on = command == "L1"
            case _ if command.startswith("SS"):
                self._change_speed(int(command[2:]))
            case _ if self._scip1 and command.startswith("S"):
                self._change_speed(int(command[1:7]))

    def _change_speed(self, baud: int | None) -> None:
        if baud is not None:
            self.line.then_change_to(baud)

    def _knows(self, letters: str) -> bool:
        format_, unit = FORMATS[letters], self._unit
        if format_.multi_echo:
            return unit.model.name in MULTI_ECHO
        return not format_.intensities or unit.steps.longest > WIDE_RANGE

    def _measure(self, command: str, text: str) -> str:
        """Begin to measure; return the status, empty where the scan itself is the answer."""
        request = read_request(command, text, self._unit.steps)
        if isinstance(request, str):
            return request
        if self._unit.fault:
            return self._unit.fault
        if FORMATS[request.letters].streamed:
            if self._stream is None:
                self._unit.streams += 1
            self._stream, self._left, self._skipped = request, request.scans, request.skip
            self._unit.laser_on = True
            return "00"
        if not self._unit.laser_on:
            return "10"
        self._keep(request)
        return ""

    def _keep(self, request: ScanRequest) -> None:
        """Keep a command for one scan until the scan is there."""
        if len(self._waiting) < MOST_WAITING:
            self._waiting.append(request)

    def _end_stream(self) -> None:
        """End this host's scans; the laser goes off with the last stream."""
        if self._stream is not None:
            self._stream = None
            self._unit.streams -= 1
        self._waiting.clear()
        if not self._unit.streams:
            self._unit.laser_on = False

    def _switch_laser_on(self) -> str:
        if self._unit.fault:
            return self._unit.fault
        was_on, self._unit.laser_on = self._unit.laser_on, True
        return "02" if was_on else "00"

    def _check_speed(self, digits: str) -> str:
        if self._unit.start_speed is None:
            model = self._unit.model
            return "04" if model.speeds or model.usb else "0F"
        if len(digits) != 6 or not digits.isdecimal():
            return "01"
        if int(digits) == self.line.speed:
            return "03"
        return "00" if int(digits) in self._unit.speeds else "02"

    def _adjust(self, code: str, now: float) -> tuple[str, bytes]:  # noqa: PLR0911
        match code, self._adjusting:
            case "0", False:
                self._end_stream()
                self._adjusting = True
                return "00", b""
            case "0", True:
                return "02", b""
            case "1", True:
                return "00", seal(encode_values([self._unit.stamp(now)], STAMP)) + b"\n"
            case "1", False:
                return "04", b""
            case "2", True:
                self._adjusting = False
                return "00", b""
            case "2", False:
                return "03", b""
        return "01", b""

    def _slow_down(self, ratio: str) -> str:
        unit = self._unit
        if unit.steps.longest > WIDE_RANGE:
            return "04"
        if len(ratio) != 2 or not ratio.isdecimal():
            return "01"
        percent = 0 if ratio == "99" else int(ratio)
        if percent > 10:
            return "02"
        was, unit.slower = unit.slower, percent
        return "03" if was == percent else "00"

    def _sensitivity(self, code: str) -> str:
        if code not in {"0", "1"}:
            return "01"
        was, self._unit.sensitive = self._unit.sensitive, code == "1"
        return "02" if was == self._unit.sensitive else "00"


def is_scip2(command: str) -> bool:
    """Tell whether a command is one of SCIP 2.0; those of SCIP 1.1 have one letter."""
    return len(command) > 1 and command[:2].isalpha() and command != "SCIP2.0"


def lines_of(pairs: Mapping[str, object], *, summed: bool = True) -> bytes:
    """Return the lines of VV, PP or II."""
    if summed:
        return b"".join([pair(key, value) for key, value in pairs.items()])
    return "".join([f"{key}:{value}\n" for key, value in pairs.items()]).encode("ascii")
