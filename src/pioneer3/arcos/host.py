"""The host's side of an ARCOS session. No I/O: bytes and the time come in, bytes go out.

::

    LISTENING ──silence──► SYNC0 ──echo──► SYNC1 ──echo──► SYNC2 ──identity──► OPEN ──► CLOSED
      ▲   │                  ▲ └── nothing for `retry`: again, then the next speed's turn ──┐
      │   └─ a report: STOP, CLOSE, `drain` ─┘                                              │
      └─────────────────────────────────────────────────────────────────────────────────────┘

Rules:

1. A robot that serves an earlier session gets STOP and CLOSE first: it would take SYNC0 for a
   PULSE, and firmware that receives one resumes the motion it had before. Such a robot streams
   reports, so the host listens before it sends anything. Bytes that make no packet, not even a
   spoilt one, come from a robot at another speed: nothing is sent until all speeds have been
   listened to. Where any byte arrived, each SYNC0 follows a STOP.
2. A robot that is silent gets SYNC0 first. AMRISim takes any first packet for a SYNC: after a STOP
   it never shakes hands any more (protocol.md 2.7). A SYNC0 without an answer may have reached a
   robot whose reports are lost, and the next ones follow a STOP.
3. After OPEN come STOP and ENABLE 0, then the request for CONFIG. Motion is the caller's business.
4. A session without an information packet for :attr:`Timing.silence` is lost. It does not mend
   itself: the caller opens a new one. Time in which the caller did not read is no silence:
   `held_up`.
5. A report that is not the awaited answer belongs to an earlier session and is ignored.

Facts: protocol.md 2.1 to 2.7.
"""

from collections.abc import Sequence
from math import inf
from typing import Final

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.host_events import (
    Configured,
    Event,
    Lost,
    Opened,
    ReportReceived,
    SessionState,
    SpeedWanted,
    Timing,
)
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.arcos.reports import Report
from pioneer3.errors import CommandError
from pioneer3.names import printable
from pioneer3.state import Identity

TRIES_PER_SPEED: Final = 2
TRIES_BEFORE_STOP: Final = 1
TRIES_BEFORE_STOP_OVER_NETWORK: Final = 2
"""Number of SYNC0 sent before one follows a STOP. A network may lead to AMRISim, and it may be slow
to answer."""
ROUNDING: Final = 1e-9
"""Event loops wake up this much early [s]."""
WAIT_FOR_REPORT: Final = 0.25
"""Once bytes come, a whole report has come after this [s], at 9600 baud too."""
CONFIG_STEP: Final = 0.5
"""Longest time between two reads that counts as one without CONFIG [s]: who reads may be late."""
CLOSE_AGAIN_EVERY: Final = 0.1
"""Shortest pause between two STOP and CLOSE to a robot that serves an earlier session [s]."""
PULSE_EARLY: Final = 0.75
"""Share of the longest pause between two packets after which a PULSE goes out with a report: to
wake up for it alone costs more."""
SLOWEST_RETRY: Final = 2.0
"""Networks may be slower than robots: without speeds to try, each try is as patient as two before,
up to this [s]."""


class Host:
    """One session: call :meth:`receive` and :meth:`tick`, obey the events, send :meth:`outgoing`.

    Args:
        now: The time [s, monotonic]; so for every `now` below.
        speeds: Baud rates to try in this order; empty for links without a speed.
        timing: How patient to be.
        round_trip: How much later than over a cable an answer may come [s].

    Attributes:
        identity: Known once open.
        config: Known once :class:`Configured` has been returned, where the robot sent it.
    """

    def __init__(
        self,
        now: float,
        speeds: Sequence[int] = (),
        timing: Timing | None = None,
        *,
        round_trip: float = 0.0,
    ) -> None:
        self.state = SessionState.LISTENING
        self._tick_at = now
        self.identity: Identity | None = None
        self.config: reports.Config | None = None
        self.reader = PacketReader()
        self._timing = timing or Timing()
        self._listening = self._timing.listen + round_trip
        self._retry = self._timing.retry + round_trip
        self._speeds = tuple(speeds)
        self._turns = self._tries = self._frames_before = 0
        self._overheard = False
        self._noise = False
        self._began = self._sent_at = self._sip_at = now
        self._closed_earlier_at = float("-inf")
        self._config_due: float | None = None
        self._opened_at = self._read_at = now
        self._waited = 0.0
        self._doubtful_config = b""
        self._heard_sip = self._left = False
        self._outbox: list[bytes] = []

    @property
    def deadline(self) -> float:
        """When :meth:`tick` must next be called [s]."""
        if self.state is not SessionState.OPEN:
            return self._tick_at
        config_due = inf if self._config_due is None else self._config_due
        return min(
            self._sip_at + self._timing.silence, self._sent_at + self._timing.pulse, config_due
        )

    @property
    def speed(self) -> int | None:
        """The speed in use [baud], or `None` on a link without one."""
        return self._speeds[max(self._turns - 1, 0) % len(self._speeds)] if self._speeds else None

    @property
    def config_settled(self) -> bool:
        """Whether the session is open and :class:`Configured` has been returned."""
        return self.state is SessionState.OPEN and self._config_due is None

    def send(self, command: Command, now: float) -> None:
        """Queue one command; CommandError without a session, or for a value that does not fit."""
        if self.state is not SessionState.OPEN:
            raise CommandError(f"cannot send {type(command).__name__}: no session is open")
        self._queue(command, now)

    def leave(self, now: float) -> None:
        """Queue STOP, ENABLE 0, SONAR 0 and CLOSE: in every state the robot then stands still."""
        if self._left:
            return
        self._left = True
        self._queue(commands.Stop(), now)
        self._queue(commands.Enable(on=False), now)
        self._queue(commands.Sonar(on=False), now)
        self._queue(commands.Close(), now)
        self.state = SessionState.CLOSED

    @property
    def is_due(self) -> bool:
        """Whether :meth:`outgoing` has something to send."""
        return bool(self._outbox)

    def outgoing(self) -> bytes:
        """Return and forget the bytes to put on the wire."""
        data = b"".join(self._outbox)
        self._outbox.clear()
        return data

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Process received bytes; return the events that follow."""
        events = self._consider_silence(now)
        skipped = self.reader.bytes_skipped
        if self.state is SessionState.LISTENING and self._turns and data and not self._overheard:
            self._overheard, self._tick_at = True, now + WAIT_FOR_REPORT
        for payload in self.reader.feed(data, now):
            match self.state:
                case SessionState.OPEN:
                    events += self._serve(reports.from_payload(payload), now)
                case SessionState.CLOSED:
                    break
                case _ if self._turns:
                    events += self._shake_hands(payload, now)
        if self.reader.bytes_skipped > skipped:
            self._noise = self._overheard = True
        if self.state is SessionState.OPEN and self._config_due is not None:
            events += self._consider_doubtful_config(now)
        return events

    def tick(self, now: float) -> list[Event]:
        """Act on the passing of time. Harmless to call too often."""
        if now < self.deadline - ROUNDING or self.state is SessionState.CLOSED:
            return []
        now = max(now, self.deadline)
        if self.state is SessionState.OPEN:
            return self._keep_open(now)
        if now >= self._began + self._timing.give_up:
            return [self._lose(self._reason_for_no_answer())]
        worn_out = self._speeds and self._tries >= TRIES_PER_SPEED
        if self._turns == 0 or worn_out or self._is_noise():
            return self._listen(now)
        self._begin_handshake(now)
        return []

    def held_up(self, seconds: float) -> None:
        """Do not count the last `seconds` as silence: the caller did not read meanwhile."""
        self._began += seconds
        self._sip_at += seconds
        if self.state is not SessionState.OPEN:  # else a pulse may be due
            self._tick_at += seconds

    def _is_noise(self) -> bool:
        """Whether a robot sends at a speed that has not been listened to yet."""
        return (
            self.state is SessionState.LISTENING
            and self._turns <= len(self._speeds)
            and self._overheard
            and self._frames_before == self._frames
        )

    @property
    def _frames(self) -> int:
        """Number of frames received, good or spoilt."""
        return self.reader.packets + self.reader.bad_checksums

    def _listen(self, now: float) -> list[Event]:
        """Send nothing at the next speed until it is clear whether a robot sends reports."""
        self.state = SessionState.LISTENING
        self._turns += 1
        self._tries, self._overheard = 0, False
        self.reader.discard()
        self._frames_before = self._frames
        self._wait(now, self._listening)
        return [] if self.speed is None else [SpeedWanted(self.speed)]

    def _begin_handshake(self, now: float) -> None:
        """Begin the handshake."""
        if self._tries and not self._speeds:
            self._retry = min(2 * self._retry, max(SLOWEST_RETRY, self._retry))
        alone = TRIES_BEFORE_STOP if self._speeds else TRIES_BEFORE_STOP_OVER_NETWORK
        if self._overheard or self._tries >= alone:
            self._queue(commands.Stop(), now)
        self._tries += 1
        self._sync(SessionState.SYNC0, now)

    def _sync(self, state: SessionState, now: float) -> None:
        self.state = state
        self._queue_payload(bytes([state.value]), now)
        self._wait(now, self._retry)

    def _wait(self, now: float, seconds: float) -> None:
        self._tick_at = min(now + seconds, self._began + self._timing.give_up)

    def _shake_hands(self, payload: bytes, now: float) -> list[Event]:
        answer = reports.from_payload(payload)
        match self.state, answer:
            case _, reports.Sip():
                return self._close_earlier_session(now)
            case SessionState.SYNC0, reports.SyncEcho(0):
                self._sync(SessionState.SYNC1, now)
            case SessionState.SYNC1, reports.SyncEcho(1):
                self._sync(SessionState.SYNC2, now)
            case SessionState.SYNC2, reports.SyncIdentity():
                return self._open(answer, now)
            case _, reports.SyncEcho() | reports.SyncIdentity():
                pass
            case _:
                self._overheard = True
        return []

    def _close_earlier_session(self, now: float) -> list[Event]:
        """Close the session that the robot still serves; begin when it has fallen silent."""
        if now >= self._began + self._timing.give_up:
            return [self._lose("the robot sends, but does not receive: its receive line is dead")]
        self.state, self._tries = SessionState.SYNC0, 1  # it answers, so this is its speed
        self._overheard = True
        self._tick_at = now + self._timing.drain
        if now >= self._closed_earlier_at + CLOSE_AGAIN_EVERY:
            self._closed_earlier_at = now
            self._queue(commands.Stop(), now)
            self._queue(commands.Close(), now)
        return []

    def _open(self, answer: reports.SyncIdentity, now: float) -> list[Event]:
        self.state = SessionState.OPEN
        self.identity = Identity(
            name=printable(answer.name),
            family=printable(answer.family),
            model=printable(answer.model.lower()),
        )
        self._sip_at = self._opened_at = self._read_at = self._config_due = now
        for command in (commands.Open(), commands.Stop(), commands.Enable(on=False)):
            self._queue(command, now)
        return [Opened(self.identity), *self._keep_open(now)]

    def _serve(self, report: Report, now: float) -> list[Event]:
        match report:
            case reports.LinkLost():
                return [self._lose("the robot ended the session")]
            case reports.Config() if self._config_due is not None:
                return [self._configure(report)]
            case reports.Sip():
                self._sip_at, self._heard_sip = now, True
                self._pulse(now, PULSE_EARLY * self._timing.pulse)
        return [ReportReceived(report)]

    def _configure(self, config: reports.Config | None, *, trusted: bool = True) -> Configured:
        self.config, self._config_due = config, None
        return Configured(config, trusted)

    def _consider_doubtful_config(self, now: float) -> list[Event]:
        """Accept a CONFIG whose checksum is wrong once it has come twice alike.

        Some P3-DX-SH always get it wrong (facts.md 14.1); noise does not repeat itself.
        """
        assert self.identity is not None
        for payload in self.reader.rejected:
            config = reports.from_payload(payload)
            if not isinstance(config, reports.Config):
                continue
            if (config.family, config.model.lower()) != (self.identity.family, self.identity.model):
                continue
            if payload == self._doubtful_config:
                return [self._configure(config, trusted=False)]
            if not self._doubtful_config:  # ask again at once, once
                self._config_due = now
            self._doubtful_config = payload
        return []

    def _consider_silence(self, now: float) -> list[Event]:
        """Go on without CONFIG after a time, told by reads alone: so it is the same in a replay."""
        if self.state is not SessionState.OPEN or self._config_due is None:
            return []
        self._waited += min(now - self._read_at, CONFIG_STEP)
        self._read_at = now
        is_over = self._waited >= self._timing.config_patience - ROUNDING
        return [self._configure(None)] if is_over else []

    def _keep_open(self, now: float) -> list[Event]:
        if now >= self._sip_at + self._timing.silence:
            return [self._lose(f"the robot has said nothing for {self._timing.silence:g} s")]
        if self._config_due is not None and now >= self._config_due:
            if not self._heard_sip and now > self._opened_at:  # the OPEN may have been lost
                self._queue(commands.Open(), now)
            self._queue(commands.RequestConfig(), now)
            self._config_due = now + self._timing.config_retry
        self._pulse(now, self._timing.pulse)
        return []

    def _pulse(self, now: float, pause: float) -> None:
        """Send a PULSE if nothing has been sent for a `pause` [s]."""
        if now >= self._sent_at + pause:
            if not self._outbox:  # packets that wait for the link restart the watchdog too
                self._queue(commands.Pulse(), now)
            self._sent_at = now

    def _lose(self, reason: str) -> Lost:
        self.state = SessionState.CLOSED
        return Lost(reason)

    def _reason_for_no_answer(self) -> str:
        if self.reader.packets:
            return "it speaks the robot's protocol, but does not finish the handshake"
        if self._noise:
            return "something answers, but not as a Pioneer robot does"
        at = f" at {', '.join(map(str, sorted(self._speeds)))} baud" if self._speeds else ""
        return f"nothing answers{at}"

    def _queue(self, command: Command, now: float) -> None:
        self._queue_payload(commands.to_payload(command), now)

    def _queue_payload(self, payload: bytes, now: float) -> None:
        self._outbox.append(encode(payload))
        self._sent_at = now
