"""The host's side of an LMS-2xx: finds the unit, sets it up, reads its scans. No I/O.

Rules:

1. The set-up is a script (`setup`); this class does its steps: it sends the request, repeats it
   after NAK or silence, and hands the answer back.
2. The first reading of a scan was taken one turn before the first byte of its telegram began to
   arrive. Of several turns that make one scan, the neighbouring readings are turns apart; the stamp
   is that of their middle, so that reading i is at most half the other turns from
   `stamp + i * beam_time`: 6.7 ms for half a degree, 20 ms for a quarter (lms2xx.md 1.10).
3. Without a scan for :attr:`Patience.silence`, or ten periods, the unit is lost.

Facts: lms2xx.md 1.8 to 1.11.
"""

from collections.abc import Sequence
from math import ceil, floor, inf
from typing import Final

from pioneer3.lasers.client import (
    Event,
    Measured,
    Patience,
    RawScan,
    Remarked,
    ScanSettings,
    ScansLost,
)
from pioneer3.lasers.dialogue import Dialogue, Pause
from pioneer3.lasers.line import ROUNDING, duration
from pioneer3.lasers.lms2xx import commands
from pioneer3.lasers.lms2xx.commands import MODE_OF_SPEED, OperatingMode, Unasked
from pioneer3.lasers.lms2xx.measuring import MIRROR_TURN, VARIANT_OF_COUNT, Variant
from pioneer3.lasers.lms2xx.scans import VALUES, Measurement
from pioneer3.lasers.lms2xx.setup import SetUp, Wait
from pioneer3.lasers.lms2xx.telegram import (
    FRAME,
    UNITS,
    Item,
    LmsTelegramReader,
    Sign,
    Telegram,
)

USUAL_SPEED: Final = 38400
"""The fastest that every serial port has [baud]; 500000 needs RS-422."""
AFTER_NAK: Final = 0.03
"""Pause before a refused request is repeated [s] (lms2xx.md 1.3)."""
MAX_NAKS: Final = 3
SCAN_OVERHEAD: Final = FRAME + 4
"""Bytes of a telegram of values beside the values: frame, code, header, status."""
SEVERITY: Final = 0x07
ERROR: Final = 3
POLLUTED: Final = 0x80
"""Bits of the status byte (lms2xx.md 1.11)."""
EDGE: Final = 1e-6
"""Share of a step that rounding may cost."""


class LmsClient:
    """One session with a unit: see :class:`pioneer3.lasers.client.LaserClient`.

    It tries `speeds` [baud] in their order, none for links without one, and scans at the fastest
    that the link has up to `target_speed`. The unit's own limits may be longer than `patience`; an
    answer may come `round_trip` later than over a cable [s].
    """

    def __init__(
        self,
        now: float,
        speeds: Sequence[int] = (),
        settings: ScanSettings | None = None,
        patience: Patience | None = None,
        *,
        round_trip: float = 0.0,
        target_speed: int = USUAL_SPEED,
    ) -> None:
        self.deadline = now
        self._settings = settings or ScanSettings()
        self._patience = patience or Patience()
        self._reader = LmsTelegramReader(UNITS)
        possible = [speed for speed in speeds if speed in MODE_OF_SPEED]
        target = max((s for s in possible if s <= target_speed), default=None)
        self._setup = SetUp(
            now,
            speeds=possible,
            target=target,
            settings=self._settings,
            patience=self._patience,
            round_trip=round_trip,
        )
        self._dialogue: Dialogue[Wait, Telegram | None, None] | None = Dialogue(
            self._setup.script()
        )
        self._step: Wait | Pause | None = None
        self._until = now
        self._tries = self._naks = 0
        self._repeat_at = inf
        self._lost_at = inf
        self._scans = 0
        self._told_status = 0
        self._outbox: list[bytes] = []

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Process received bytes; return the events that follow."""
        events: list[Event] = []
        self._setup.heard = self._setup.heard or bool(data)
        for item in self._reader.feed(data, now):
            events += self._take(item, now)
        if data and isinstance(self._step, Wait) and self._step.ends_with_noise:
            events += self._advance(None, now)
        self._schedule()
        return events

    def tick(self, now: float) -> list[Event]:
        """Act on the passing of time. Harmless to call too often."""
        if now < self.deadline - ROUNDING:
            return []
        now = max(now, self.deadline)
        events: list[Event] = []
        for item in self._reader.feed(b"", now):
            events += self._take(item, now)
        if self._dialogue is not None:
            events += self._keep_asking(now)
        elif now >= self._lost_at:
            events.append(self._lose(f"no scan has come for {self._silence:g} s"))
        self._schedule()
        return events

    def outgoing(self) -> bytes:
        """Return and forget the bytes to put on the wire."""
        data = b"".join(self._outbox)
        self._outbox.clear()
        return data

    def leave(self, now: float) -> None:
        """Queue the requests to stop, and for 9600 baud, at which other programs begin."""
        if self._step is not None or self._lost_at < inf:  # else nothing has been sent, or all ends
            self._outbox.append(commands.mode(OperatingMode.ON_REQUEST))
            if self._setup.speed is not None:
                self._outbox.append(commands.mode(OperatingMode.SPEED_9600))
        self._end()

    def _end(self) -> None:
        self._dialogue = self._step = None
        self._until = self._repeat_at = self._lost_at = inf
        self._reader.discard()
        self._schedule()

    def _lose(self, reason: str) -> ScansLost:
        self._end()
        return ScansLost(reason)

    @property
    def _silence(self) -> float:
        return max(self._patience.silence, 10 * self._period(self._setup.variant))

    def _schedule(self) -> None:
        waits = min(self._until, self._repeat_at) if self._dialogue is not None else self._lost_at
        self.deadline = min(waits, self._reader.due)

    def _take(self, item: Item, now: float) -> list[Event]:
        if self._dialogue is None:
            return self._measure(item, now) if isinstance(item, Telegram) else []
        if not isinstance(self._step, Wait):
            return []
        if isinstance(item, Telegram):
            wanted = self._step.codes is None or item.code in self._step.codes
            return self._advance(item, now) if wanted else []
        if item is Sign.NAK and self._step.request and self._naks < MAX_NAKS:
            self._naks += 1
            self._repeat_at = now + AFTER_NAK
        return []

    def _keep_asking(self, now: float) -> list[Event]:
        """Repeat a request, or go on without its answer, when it is time."""
        step = self._step if isinstance(self._step, Wait) else None
        if step is not None and now >= self._repeat_at:
            self._send(step, now)
        elif now >= self._until:
            if step is None or self._tries >= step.tries:
                return self._advance(None, now)
            self._tries += 1
            self._send(step, now)
        return []

    def _send(self, wait: Wait, now: float) -> None:
        self._repeat_at = inf
        self._until = now + wait.limit
        if wait.request:
            self._outbox.append(wait.request)

    def _advance(self, answer: Telegram | None, now: float) -> list[Event]:
        """Go on with the set-up; return its events."""
        assert self._dialogue is not None
        setup, speed = self._setup, self._setup.speed
        setup.now, setup.has_begun = now, self._reader.has_begun
        events = self._dialogue.go_on(answer)
        self._step, self._tries, self._naks = self._dialogue.step, 1, 0
        if isinstance(self._step, Wait):
            self._send(self._step, now)
        elif self._step is not None:
            self._until, self._repeat_at = now + self._step.seconds, inf
        elif self._dialogue.finished:
            self._dialogue, self._lost_at = None, now + self._silence
        else:
            self._end()
        if setup.speed != speed:
            self._reader.discard()
            self._reader.byte_time = duration(1, setup.speed)
        return events

    def _measure(self, telegram: Telegram, now: float) -> list[Event]:
        """Return the scan in a telegram."""
        if telegram.code == Unasked.READY:
            return [self._lose("the laser has started anew: its power has failed")]
        if telegram.code != VALUES:
            return []
        try:
            values = Measurement.from_body(telegram.code, telegram.body)
        except ValueError:
            return []
        variant = VARIANT_OF_COUNT.get(len(values.values))
        if variant is None or values.partial or self._lost_at == inf:
            return []
        self._lost_at = now + self._silence
        events = self._remark_on(telegram.status)
        if self._scans % (1 + self._settings.skip) == 0:
            events.append(Measured(self._scan(values, variant, telegram.began)))
        self._scans += 1
        return events

    def _scan(self, telegram: Measurement, variant: Variant, began: float) -> RawScan:
        """Return the wanted part of the readings in `telegram`."""
        mode = self._setup.measuring_mode
        start, stop = self._part(variant)
        values = telegram.values[start:stop]
        since_first = (variant.turns + 1) / 2 * MIRROR_TURN
        return RawScan(
            stamp=began - since_first + start * variant.beam_time,
            first=variant.first + start * variant.step,
            step=variant.step,
            beam_time=variant.beam_time,
            period=self._period(variant) * (1 + self._settings.skip),
            near=0.0,
            far=mode.far(telegram.units),
            ranges=mode.ranges(values, telegram.units),
            intensities=mode.reflectivities(values) if self._settings.intensities else (),
        )

    def _part(self, variant: Variant) -> tuple[int, int]:
        """Return the first reading that is wanted, and the one after the last."""
        first, last = self._settings.first, self._settings.last
        start, stop = 0, variant.count
        if first is not None:
            start = max(0, ceil((first - variant.first) / variant.step - EDGE))
        if last is not None:
            stop = min(stop, floor((last - variant.first) / variant.step + EDGE) + 1)
        return (start, stop) if start < stop else (0, variant.count)

    def _period(self, variant: Variant) -> float:
        """Return the time from one scan to the next [s]: the line leaves out whole scans."""
        transfer = duration(2 * variant.count + SCAN_OVERHEAD, self._setup.line_speed)
        return max(1, ceil(transfer / variant.scan_time - EDGE)) * variant.scan_time

    def _remark_on(self, status: int) -> list[Event]:
        """Remark each change of the status byte."""
        known = status & (SEVERITY | POLLUTED)
        if known == self._told_status:
            return []
        self._told_status = known
        events: list[Event] = []
        if known & POLLUTED:
            events.append(Remarked("the laser's window is dirty"))
        if known & SEVERITY >= ERROR:
            events.append(Remarked(f"the laser reports an error, in status 0x{status:02X}"))
        return events
