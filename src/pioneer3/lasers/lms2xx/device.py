"""A simulated LMS-2xx, as tolerant as the real one. No I/O.

Rules:

1. A request is acknowledged at once, a spoilt one refused with NAK; answers come one by one, in the
   order of the requests. An unknown request, or one in the wrong mode, is answered by REFUSED.
2. A new speed holds once the answer has left at the old one.
3. Scans go out no faster than the line carries them: a scan that is complete while the line is busy
   is left out. So a scan always begins to leave at the end of its last turn.
4. The unit knows nothing of hosts that come and go: it streams until it is told to stop.
5. The configuration survives a power cycle; mode and variant do not, nor does the speed, unless it
   is kept by KEEP_SPEED.
6. The unit starts in silence and then says READY, at its speed after power-on.

Facts: lms2xx.md 1.3 to 1.10.
"""

from collections import deque
from collections.abc import Mapping
from math import inf
from typing import Final

from pioneer3.lasers.device import DeviceConnection, MirrorTurn, Sweep
from pioneer3.lasers.line import ROUNDING, SerialLine
from pioneer3.lasers.lms2xx.blocks import REAL_TIME_INDICES
from pioneer3.lasers.lms2xx.commands import (
    ANSWER,
    MEANS,
    PARTS,
    STREAMS,
    CommandCode,
    OperatingMode,
    Unasked,
)
from pioneer3.lasers.lms2xx.measuring import MEASURING_MODES, Units
from pioneer3.lasers.lms2xx.mirror import Mirror, TurnReadings, mean_of
from pioneer3.lasers.lms2xx.scans import TELEGRAMS, VALUES, Measurement
from pioneer3.lasers.lms2xx.telegram import (
    ANY_UNIT,
    USUAL_STATUS,
    LmsTelegramReader,
    Sign,
    Telegram,
    encode,
)
from pioneer3.lasers.lms2xx.unit import DELIVERED_SPEED, LmsUnit
from pioneer3.models.lasers import LaserModel

BOOT: Final = 30.0
"""Time that real units take to start [s] (lms2xx.md 1.4)."""
MAX_REQUESTS: Final = 8
"""Requests that wait for their answer; more are ignored."""
MAX_WAITING: Final = 2048
"""Bytes on their way out above which no request is answered yet."""


class LmsDevice:
    """One unit: see :class:`pioneer3.lasers.device.LaserDevice`.

    Its answers have `address`, 0x80 to 0x84. It is silent for `boot` after power-on and reset [s],
    but has started already, at `start_speed` [baud]: an earlier host may have left it at another
    than 9600. An answer takes `delays` [s], by the command's code, 0 without an entry; real units
    may take 3 s for MODE and 7 s for CONFIGURE (lms2xx.md 1.3).
    """

    def __init__(
        self,
        model: LaserModel,
        *,
        address: int = ANSWER,
        boot: float = BOOT,
        start_speed: int = DELIVERED_SPEED,
        delays: Mapping[int, float] | None = None,
    ) -> None:
        self.speed: int | None = start_speed
        self.deadline = inf
        self.unit = LmsUnit(model, address, start_speed)
        self._boot = boot
        self._delays = delays or {}
        self._reader = LmsTelegramReader({ANY_UNIT, address - ANSWER})
        self._line = SerialLine(start_speed)
        self._mirror = Mirror(self.unit.variant)
        self._requests: deque[Telegram] = deque()
        self._answer_at: float | None = None
        self._ready_at: float | None = None
        self._scan_wanted = False
        self._partial_number = 0
        self._sampled: list[TurnReadings] = []
        self._scans = self._telegrams = 0

    @property
    def turn(self) -> MirrorTurn | None:
        """The next turn of the mirror, or `None` while no host wants scans."""
        wanted = self._scan_wanted or self.unit.mode in STREAMS
        return self._mirror.turn if wanted and self._ready_at is None else None

    def connect(self, *, network: bool = False) -> DeviceConnection:
        """Return itself: whoever opens the port, there is one serial line."""
        if network:
            self._reader.discard()
            self._line.drop()
            self._schedule()
        return self

    def close(self) -> None:
        """Leave the unit as it is: it notices nothing."""

    def switch_on(self, now: float) -> None:
        """Begin as after a power cycle: only the EEPROM is known."""
        self._line.clear(self.unit.power_on_speed)
        self._restart(now)

    def tick(self, now: float) -> None:
        """Act on the passing of time."""
        if self._ready_at is not None and now >= self._ready_at - ROUNDING:
            self._ready_at = None
            self._send(Unasked.READY, self.unit.type_text, now)
        self.receive(b"", now)

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes of a host; a unit that starts does not hear them."""
        if self._ready_at is None:
            self._read(data, now)
            self._answer_requests(now)
        self._schedule()

    def outgoing(self, now: float) -> bytes:
        """Return and forget the bytes that have left by `now`, up to a change of speed."""
        data = self._line.take(now)
        self._use_speed_of_line()
        self._answer_requests(now)
        self._schedule()
        return data

    def measured(self, sweep: Sweep, now: float) -> None:
        """Take the readings of a turn that is over."""
        if sweep.turn != self.turn:
            return  # a host has changed the variant or the mode since it began
        now = min(now, sweep.began + sweep.turn.period)  # bytes leave from its end on
        number = self._mirror.number
        scan = self._mirror.add(sweep)
        self._scans += scan is not None
        if self.unit.mode in MEANS:
            scan = self._sample(scan)
        is_free = not self._line.is_busy(now)
        if self._scan_wanted:
            if scan is not None:
                self._scan_wanted = False
                self._send_scan(scan, now)
        elif self.unit.mode is OperatingMode.PARTIAL_SCANS:
            if is_free and number == self._partial_number:
                self._partial_number = self._mirror.number
                self._send_turn(TurnReadings([*sweep.ranges], [*sweep.intensities]), number, now)
        elif scan is not None and is_free:
            self._send_scan(scan, now)
        self._schedule()

    def _restart(self, now: float) -> None:
        """Start: say nothing, then READY."""
        self.unit.restart()
        self._use_speed_of_line()
        self._reader.discard()
        self._requests.clear()
        self._answer_at = None
        self._begin_measuring()
        self._ready_at = now + self._boot
        self._schedule()

    def _use_speed_of_line(self) -> None:
        speed = self._line.speed
        assert speed is not None  # it is a serial line
        self.speed = self.unit.speed = speed

    def _begin_measuring(self) -> None:
        self._scan_wanted, self._partial_number = False, 0
        self._sampled.clear()
        self._mirror.restart(self.unit.variant)

    def _schedule(self) -> None:
        """Set the deadline to the first of all that wait for their time."""
        waiting = (self._answer_at, self._ready_at)
        due = [at for at in waiting if at is not None]
        self.deadline = min(self._line.due, self._reader.due, *due)

    def _read(self, data: bytes, now: float) -> None:
        """Read requests, and acknowledge them."""
        rejected = self._reader.rejected
        for item in self._reader.feed(data, now):
            if isinstance(item, Telegram) and len(self._requests) < MAX_REQUESTS:
                self._line.send(bytes((Sign.ACK.value,)), now)
                self._requests.append(item)
        if self._reader.rejected > rejected and self._line.waiting < MAX_WAITING:
            self._line.send(bytes((Sign.NAK.value,)), now)

    def _answer_requests(self, now: float) -> None:
        """Answer the requests whose time has come, one by one."""
        while self._requests and self._line.waiting < MAX_WAITING:
            if self._answer_at is None:
                self._answer_at = now + self._delays.get(self._requests[0].code, 0.0)
            if now < self._answer_at - ROUNDING:
                return
            self._answer_at = None
            request = self._requests.popleft()
            self._answer(request.code, request.data, now)

    def _answer(self, code: int, data: bytes, now: float) -> None:
        if code == CommandCode.RESET:
            self._send(Unasked.RESETTING, b"", now)
            self._line.then_change_to(self.unit.power_on_speed)
            self._restart(self._line.free_at)
        elif (
            code == CommandCode.SCAN
            and data == b"\x01"
            and self.unit.mode is OperatingMode.ON_REQUEST
        ):
            self._begin_measuring()
            self._scan_wanted = True  # the scan is the answer
        elif (body := self.unit.answer(code, data)) is None:
            self._send(Unasked.REFUSED, b"", now)
        else:
            self._send(code + ANSWER, body, now)
            if (baud := self.unit.speed_after(code, data)) is not None:
                self._line.then_change_to(baud)
            elif code in {CommandCode.MODE, CommandCode.VARIANT}:
                self._begin_measuring()

    def _sample(self, scan: TurnReadings | None) -> TurnReadings | None:
        """Keep a scan; return the mean of all that are kept once they are enough."""
        if scan is not None:
            self._sampled.append(scan)
        if len(self._sampled) < self.unit.sample:
            return None
        sampled, self._sampled = self._sampled, []
        return mean_of(sampled)

    def _send_scan(self, scan: TurnReadings, now: float) -> None:
        unit, values = self.unit, self._values(scan)
        first, last = unit.subrange if unit.mode in PARTS else (1, len(values))
        telegram = Measurement(
            code=TELEGRAMS.get(unit.mode, VALUES),
            values=values[first - 1 : last],
            units=self._units,
            sample=unit.sample,
            first=first,
            last=last,
        )
        self._send_values(telegram, now)

    def _send_turn(self, readings: TurnReadings, number: int, now: float) -> None:
        telegram = Measurement(
            code=VALUES,
            values=self._values(readings),
            units=self._units,
            partial=True,
            offset_cdeg=number * self.unit.variant.step_cdeg,
        )
        self._send_values(telegram, now)

    @property
    def _units(self) -> Units:
        return Units(self.unit.config.units)

    def _values(self, readings: TurnReadings) -> tuple[int, ...]:
        mode = MEASURING_MODES[self.unit.config.measuring_mode]
        return tuple(mode.values(readings.ranges, readings.intensities, self._units))

    def _send_values(self, telegram: Measurement, now: float) -> None:
        body = telegram.to_body()
        if self.unit.config.availability & REAL_TIME_INDICES:
            body += bytes((self._scans & 0xFF, self._telegrams & 0xFF))
        self._telegrams += 1
        self._send(telegram.code, body, now)

    def _send(self, code: int, body: bytes, now: float) -> None:
        status = bytes((USUAL_STATUS,))
        self._line.send(encode(code, body + status, self.unit.address), now)
