"""The host's side of CoLa-A. No I/O: bytes and the time come in, events and bytes go out.

Rules:

1. A unit may still send scans: the first request ends that, and all telegrams that are no answer
   to the request in flight are passed over.
2. The configuration is read, and only written where it differs from the wishes. Nothing is written
   to the EEPROM: after a power cycle the laser is as its owner left it. A laser that refuses a
   setting is used as it is, with a remark.
3. Scans are asked for when the laser says that it measures. One that was stopped is started.
4. A request without an answer is repeated, more and more slowly, and given up after
   `Patience.give_up`. An answer to a repeated request may come twice; the second one is dropped.
5. A session without a scan for `Patience.silence` is lost, and does not mend itself.

Facts: cola.md 1.4, 2, 6.1.
"""

from dataclasses import replace
from math import inf
from typing import Final

from pioneer3.lasers.client import Event, Measured, Patience, Remarked, ScanSettings, ScansLost
from pioneer3.lasers.cola.clock import ColaClock
from pioneer3.lasers.cola.readings import raw_scan
from pioneer3.lasers.cola.scan import NAME, decode
from pioneer3.lasers.cola.script import ErrorAnswer, ScriptState, TelegramRequest, set_up
from pioneer3.lasers.cola.wire import (
    ColaTelegramReader,
    TelegramError,
    TelegramWords,
    encode,
    parse_number,
)
from pioneer3.lasers.dialogue import Dialogue, Pause
from pioneer3.lasers.line import ROUNDING

SLOWEST_REPEAT: Final = 1.0
"""Requests are repeated at least this often [s]."""
SILENT_PERIODS: Final = 10
STATUS: Final = {
    (0, 1): "the laser reports an error",
    (0, 2): "the laser's front screen is getting dirty: wipe it",
    (0, 4): "the laser's front screen is too dirty to measure well: wipe it",
}
SILENT: Final = "the laser sends no scans any more: check its power and its cable"
NO_ANSWER: Final = (
    "nothing answers as a laser that speaks CoLa-A: check the address and the port (2111 or 2112),"
    " and that the laser's host interface is set to CoLa-A, not CoLa-B"
)


class ColaClient:
    """The host's side of an LMS-1xx, an LMS-5xx or a TiM.

    An answer may come `round_trip` later than over a cable [s]. `reader` counts telegrams and
    noise, `refused` the scans that were no valid telegrams.
    """

    def __init__(
        self,
        now: float,
        settings: ScanSettings | None = None,
        patience: Patience | None = None,
        round_trip: float = 0.0,
    ) -> None:
        self.deadline = now
        self.reader = ColaTelegramReader()
        self.refused = 0
        self._patience = patience or Patience()
        self._round_trip = round_trip
        self._session = ScriptState(settings or ScanSettings(), now)
        self._dialogue: Dialogue[TelegramRequest, TelegramWords | ErrorAnswer, None] = Dialogue(
            set_up(self._session)
        )
        self._answered = self._running = self._closed = False
        self._asked_at = self._repeat = now
        self._surplus = self._refused_since = 0
        self._clock = ColaClock()
        self._events: list[Event] = []
        self._told: set[str] = set()
        self._outbox: list[bytes] = []

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Process bytes received at `now`; return the events that follow."""
        for text in self.reader.feed(data):
            if self._closed:
                break
            self._take(text.split(" "), now)
        return self._take_events()

    def tick(self, now: float) -> list[Event]:
        """Act on the passing of time. Harmless to call too often."""
        if self._closed or now < self.deadline - ROUNDING:
            return []
        if self._running:
            unread = f"the last {self._refused_since} scans of the laser could not be read"
            self._lose(unread if self._refused_since else SILENT)
        elif isinstance(step := self._dialogue.step, TelegramRequest):
            self._ask_again(step, max(now, self.deadline))
        else:
            self._resume(None, now)
        return self._take_events()

    def outgoing(self) -> bytes:
        """Return and forget the bytes to put on the wire."""
        data = b"".join(self._outbox)
        self._outbox.clear()
        return data

    def leave(self, now: float) -> None:
        """Queue the request that ends scanning; the laser's mirror goes on turning."""
        if not self._closed:
            self._close()
            self._outbox.append(encode(f"sEN {NAME} 0"))

    def _take_events(self) -> list[Event]:
        events, self._events = self._events, []
        return events

    def _take(self, words: list[str], now: float) -> None:
        """Take one telegram."""
        if words[:2] == ["sSN", NAME]:
            if self._running:
                self._measure(words, now)
        elif isinstance(step := self._dialogue.step, TelegramRequest):
            self._answer(step, words, now)

    def _answer(self, request: TelegramRequest, words: list[str], now: float) -> None:
        """Take a telegram that may be the answer to `request`."""
        if words[0] == "sFA":
            if self._surplus:  # perhaps that of the request before, which was repeated
                self._surplus -= 1
            else:
                self._resume(_refusal(words), now)
        elif tuple(words[:2]) == request.answer:
            rest = words[2:-1] if words[-1] == "" else words[2:]  # some lasers end with a space
            self._resume(TelegramWords(rest), now)
        elif self._surplus and words[0] in {"sRA", "sWA", "sAN", "sEA"}:
            self._surplus -= 1

    def _resume(self, reply: TelegramWords | ErrorAnswer | None, now: float) -> None:
        """Go on with the script until it asks or waits again, or is over."""
        self._session.now = now
        self._answered = self._answered or reply is not None
        events, step = self._dialogue.go_on(reply), self._dialogue.step
        for event in events:
            if isinstance(event, Remarked):
                self._tell(event.text, event.text)
            else:
                self._events.append(event)
        if isinstance(step, TelegramRequest):
            self._asked_at = now
            self._repeat = max(self._patience.answer, step.patience) + self._round_trip
            self._send(step, now)
        elif isinstance(step, Pause):
            self.deadline = now + step.seconds
        elif self._dialogue.finished:
            self._running = True
            self.deadline = now + self._patience.give_up + self._round_trip
        else:
            self._close()

    def _send(self, request: TelegramRequest, now: float) -> None:
        self._outbox.append(encode(request.text))
        self.deadline = min(now + self._repeat, self._give_up_at(request))

    def _ask_again(self, request: TelegramRequest, now: float) -> None:
        if now >= self._give_up_at(request) - ROUNDING:
            fallen_silent = f"the laser answered at first, but not to `{request.text}`"
            self._lose(fallen_silent if self._answered else NO_ANSWER)
            return
        self._repeat = min(2 * self._repeat, max(SLOWEST_REPEAT + self._round_trip, self._repeat))
        self._surplus += 1
        self._send(request, now)

    def _give_up_at(self, request: TelegramRequest) -> float:
        return self._asked_at + max(self._patience.give_up, 2 * request.patience) + self._round_trip

    def _measure(self, words: list[str], now: float) -> None:
        """Take a scan."""
        session = self._session
        try:
            scan = decode(TelegramWords(words[2:]))
            raw = raw_scan(
                scan,
                arrival=now,
                interval=session.interval,
                limits=session.limits,
                wishes=session.wishes,
            )
        except TelegramError as error:
            self.refused += 1
            self._refused_since += 1
            unlike = "a scan is not as the protocol has it, and is dropped"
            self._tell(f"{unlike}: {error}", unlike)
            return
        self._refused_since = 0
        if session.wishes.calibrate_time:
            span = raw.beam_time * (len(raw.ranges) - 1)
            stamp = self._clock.first_reading(scan.sensed_us, scan.sent_us, now, span)
            raw = replace(raw, stamp=stamp)
        silence = max(self._patience.silence, SILENT_PERIODS * raw.period)
        self.deadline = now + silence + self._round_trip
        if (trouble := STATUS.get(scan.status)) is not None:
            self._tell(trouble, trouble)
        self._events.append(Measured(raw))

    def _tell(self, text: str, trouble: str) -> None:
        """Remark `text`, once for each trouble."""
        if trouble not in self._told:
            self._told.add(trouble)
            self._events.append(Remarked(text))

    def _lose(self, reason: str) -> None:
        self._close()
        self._events.append(ScansLost(reason))

    def _close(self) -> None:
        self._closed, self._running, self._dialogue.step = True, False, None
        self.deadline = inf


def _refusal(words: list[str]) -> ErrorAnswer:
    try:
        return ErrorAnswer(parse_number(words[1]))
    except (IndexError, TelegramError):
        return ErrorAnswer(0)
