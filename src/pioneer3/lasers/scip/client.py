"""The host's side of a SCIP laser. No I/O: bytes and the time come in, bytes go out.

Rules:

1. The dialogue of `start` brings the laser from any state to scanning. An answer that is under way
   is waited for, however slow the line is.
2. A scan counts only if its echo is the command that was sent and every line and number is as it
   must be. All others are refused and counted; the next one is taken again.
3. When scans stop coming, the dialogue begins again, at the same speed first. A laser that does not
   answer either is lost after :attr:`Patience.silence`; one that answers, but sends no scan, after
   :attr:`Patience.give_up`.
4. The stamp of a scan is the time of its first reading. The laser dates the step 0 of the turn,
   whether or not that is measured: the first reading is `start` steps later (scip.md 5.1).

Facts: scip.md 1 to 6.
"""

from collections.abc import Sequence
from math import inf
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
from pioneer3.lasers.line import ROUNDING
from pioneer3.lasers.scip.scans import ScanReadings, decode, ranges_of
from pioneer3.lasers.scip.start import NOTHING, OK, Ask, Reply, Start
from pioneer3.lasers.scip.stream import ScanStream
from pioneer3.lasers.scip.wire import Answer, AnswerReader, decode_stamp
from pioneer3.units import MM

SCANNED: Final = b"99b"
PERIODS: Final = 10
"""A silence is at least this many scan periods."""
SLOWEST_ANSWER: Final = 3.0
"""The rest of an old scan at 19200 baud, and the answer behind it, have come after this [s]; so has
a scan over a device server, whose speed nobody knows."""
TEXT: Final = bytes(range(0x20, 0x7F)) + b"\r\n"


class ScipClient:
    """One laser: call :meth:`receive` and :meth:`tick`, obey the events, send :meth:`outgoing`.

    It tries `speeds` [baud] in their order; links without a speed have none. An answer may come
    `round_trip` later than over a cable [s].
    """

    def __init__(
        self,
        now: float,
        speeds: Sequence[int] = (),
        settings: ScanSettings | None = None,
        patience: Patience | None = None,
        *,
        round_trip: float = 0.0,
    ) -> None:
        self.deadline = now
        self.scans = 0
        self._refused = 0
        self._reader = AnswerReader()
        self._patience = patience or Patience()
        self._answer_time = self._patience.answer + round_trip
        self._start = Start(speeds, settings or ScanSettings())
        self._dialogue: Dialogue[Ask, Reply, ScanStream] | None = None
        self._asked: Ask | None = None
        self._asked_at = self._sent_at = now
        self._stream: ScanStream | None = None
        self._interval = 0.0
        self._scanned_at = now
        self._answered_at = inf
        self._begun_at = now
        self._device_time: float | None = None
        self._ended = self._left = False
        self._noise = self._heard_noise = False
        self._outbox: list[bytes] = []

    @property
    def refused(self) -> int:
        """Answers that were not as they must be."""
        return self._refused + self._start.refused

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Process received bytes; return the events that follow."""
        if self._ended:
            return []
        events: list[Event] = []
        if self._asked and data:
            self._wait_for_more(data, now)
        for answer in self._reader.feed(data, now):
            if self._stream is not None:
                events += self._take_scan(answer, now)
            elif self._asked is not None:
                events += self._take_reply(answer, now)
            if self._ended:
                break
        if self._stream is not None:
            began = self._reader.began(self._stream.command)
            if began is not None:  # noise that has no end may follow
                comes = data.translate(None, TEXT) == b"" and now < began + SLOWEST_ANSWER
                self._answered_at = max(self._answered_at, now if comes else began)
                self._plan_watch()
        return events

    def tick(self, now: float) -> list[Event]:
        """Act on the passing of time. Harmless to call too often."""
        if self._ended or now < self.deadline - ROUNDING:
            return []
        now = max(now, self.deadline)
        if now >= self._begun_at + self._patience.give_up - ROUNDING:
            return [self._lose(self._reason_for_no_scan())]
        if self._stream is not None:
            return self._begin_again(now, f"no scan for {now - self._scanned_at:.2f} s")
        if now >= self._answered_at + self._silence - ROUNDING:
            return [self._lose(f"the laser has said nothing for {self._silence:g} s")]
        if self._dialogue is None:
            self._dialogue = Dialogue(self._start.run())
            return self._go_on(None, now)
        return self._go_on(NOTHING, now)

    def outgoing(self) -> bytes:
        """Return and forget the bytes to put on the wire."""
        data = b"".join(self._outbox)
        self._outbox.clear()
        return data

    def leave(self, now: float) -> None:
        """Queue QT, which also switches the laser off, and the speed at which it was found."""
        del now
        if self._left:
            return
        self._left = True
        self._end()
        scip1 = self._stream is not None and not self._stream.summed
        self._outbox.append(b"L0\n" if scip1 else b"\nTM2\nQT\n" if self._dialogue else b"QT\n")
        if (speed := self._start.started_at) is not None:
            text = f"S{speed:06}7654321\n" if scip1 else f"SS{speed:06}\n"
            self._outbox.append(text.encode())

    @property
    def _silence(self) -> float:
        return max(self._patience.silence, PERIODS * self._interval)

    def _go_on(self, reply: Reply | None, now: float) -> list[Event]:
        """Go on with the dialogue until it waits for something."""
        assert self._dialogue is not None
        self._asked = None
        events, step = self._dialogue.go_on(reply), self._dialogue.step
        if isinstance(step, Ask):
            self._asked, self._asked_at = step, now
            self._heard_noise = self._heard_noise or self._noise
            self._noise = False
            self._send_question(step, now)
            self._wait(now, self._answer_time)
        elif isinstance(step, Pause):
            self._answered_at += step.seconds  # it was asked nothing
            self._wait(now, step.seconds)
        elif self._dialogue.result is not None:
            self._watch(self._dialogue.result, now)
        else:
            self._end()
        return events

    def _send_question(self, question: Ask, now: float) -> None:
        self._sent_at = now
        self._outbox.append(question.prefix + question.command + b"\n")

    def _wait(self, now: float, seconds: float) -> None:
        self.deadline = min(
            now + seconds,
            self._begun_at + self._patience.give_up,
            self._answered_at + self._silence,
        )

    def _wait_for_more(self, data: bytes, now: float) -> None:
        """Give an answer more time while only text comes: at the wrong speed other bytes do."""
        self._noise = self._noise or bool(data.translate(None, TEXT))
        if not self._noise and now < self._asked_at + SLOWEST_ANSWER:
            self._wait(now, self._answer_time)

    def _take_reply(self, answer: Answer, now: float) -> list[Event]:
        """Go on with the dialogue if this is the awaited answer."""
        assert self._asked is not None
        found = answer.after(self._asked.command)
        if found is None:
            if answer.began >= self._sent_at + self._answer_time:
                self._send_question(self._asked, now)  # it was lost: old scans go on
            return []
        if not found.status or found.lines[1] == SCANNED:
            self._refused += not found.status
            return []
        if self._answered_at < inf:
            self._answered_at = now
        reply = Reply(found.status, found.lines[2:], self._asked_at, now)
        return self._go_on(reply, now)

    def _watch(self, stream: ScanStream, now: float) -> None:
        """Wait for scans from now on."""
        self._stream, self._dialogue = stream, None
        self._interval = stream.period
        if self._start.baud is not None:
            self._interval = max(self._interval, stream.size * 10 / self._start.baud)
        self._scanned_at = self._answered_at = now
        self._device_time = None
        self._poll(now)
        self._plan_watch()

    def _plan_watch(self) -> None:
        self.deadline = min(
            self._answered_at + self._silence / 2, self._begun_at + self._patience.give_up
        )

    def _poll(self, now: float) -> None:
        """Ask for the next scan, where the laser does not send them by itself."""
        if self._stream is not None and not self._stream.format.streamed:
            self._asked_at = now
            self._outbox.append(self._stream.command + b"\n")

    def _begin_again(self, now: float, reason: str) -> list[Event]:
        """Start the scans again, which have stopped."""
        self._stream, self._dialogue = None, Dialogue(self._start.run())
        self._reader.discard()
        return [Remarked(f"{reason}: starting the laser again"), *self._go_on(None, now)]

    def _take_scan(self, answer: Answer, now: float) -> list[Event]:
        """Return the scan in `answer`, if it is good."""
        stream = self._stream
        assert stream is not None
        if len(answer.lines) == 2:
            return self._take_status(answer, now)
        scan = self._scan_from(stream, answer.lines, answer.began)
        if scan is None:
            self._refused += 1
            later = Answer(answer.lines[1:], answer.began).after(stream.command)
            scan = self._scan_from(stream, later.lines, None) if later else None
        if scan is None:
            if answer.after(stream.command) and now >= self._asked_at + stream.turn / 2:
                self._poll(now)  # what answers at once measures nothing
            return []
        self.scans += 1
        self._interval = max(stream.period, now - self._scanned_at)
        self._scanned_at = self._answered_at = self._begun_at = now
        self._start.scanned()
        self._poll(now)
        self._plan_watch()
        return [Measured(scan)]

    def _take_status(self, answer: Answer, now: float) -> list[Event]:
        """Start again if the laser reports an error in place of a scan."""
        assert self._stream is not None
        found = answer.after(self._stream.command)
        if found is None or not found.status:
            self._refused += 1
            return []
        if found.status in OK:
            return []
        reason = f"the laser reports status {found.status}"
        if not self._stream.summed and self._start.findings:
            reason += f"; {self._start.findings}"
        return self._begin_again(now, reason)

    def _scan_from(
        self, stream: ScanStream, lines: Sequence[bytes], arrived: float | None
    ) -> RawScan | None:
        """Return the scan in `lines`, whose first byte `arrived` then, or `None`."""
        if len(lines) < 3 or lines[0] != stream.command:
            return None
        took = stream.step_time * stream.end
        if not stream.summed:
            readings = decode(lines[2:], stream.format, stream.count, summed=False)
            if readings is None or lines[1] != b"0":
                return None
            date = arrived - took if arrived is not None else None
            return self._scan_of(stream, readings, date, None)
        stamp_ms = decode_stamp(lines[2])
        readings = decode(lines[3:], stream.format, stream.count)
        if lines[1] != SCANNED or stamp_ms is None or readings is None:
            return None
        date = self._start.clock.our_time(stamp_ms, arrived, took)
        return self._scan_of(stream, readings, date, self._start.clock.unwrap(stamp_ms))

    def _scan_of(
        self,
        stream: ScanStream,
        readings: ScanReadings,
        date: float | None,
        device_time: float | None,
    ) -> RawScan | None:
        """Return the scan of `readings`, dated with the time of step 0, or `None` without that."""
        if date is None:
            return None
        period, steps = stream.period, stream.steps
        if device_time is not None:
            if self._device_time is not None:  # a slow line carries each second scan only, or less
                turns = round((device_time - self._device_time) / stream.turn)
                period = max(period, turns * stream.turn)
            self._device_time = device_time
        return RawScan(
            stamp=date + stream.start * stream.step_time,
            first=stream.first,
            step=stream.step,
            beam_time=stream.step_time * stream.cluster,
            period=period,
            near=steps.shortest * MM,
            far=steps.longest * MM,
            ranges=ranges_of(readings.distances, steps),
            intensities=tuple(readings.intensities),
            echoes=tuple([ranges_of(echoes, steps) for echoes in readings.echoes]),
            device_time=device_time,
        )

    def _lose(self, reason: str) -> ScansLost:
        self._end()
        return ScansLost(reason)

    def _end(self) -> None:
        self._ended, self.deadline = True, inf

    def _reason_for_no_scan(self) -> str:
        if self._start.findings:
            return f"no scan comes from the laser: {self._start.findings}"
        if self._heard_noise or self._noise:
            return (
                "something answers, but not as a Hokuyo laser does: "
                "is it one, and is its speed among those tried?"
            )
        return "no laser answers: check its power, its cable and the port or address"
