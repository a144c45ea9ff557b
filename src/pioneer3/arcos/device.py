"""The robot's side of an ARCOS session, as tolerant as the firmware. No I/O.

::

    WAITING ──SYNC0, SYNC1, SYNC2──► READY ──OPEN──► OPEN ──CLOSE──► WAITING

Rules:

1. Each SYNC is answered, a repeated one again; SYNC0 begins anew.
2. The same numbers mean other things by phase: 0 is SYNC0 or PULSE, 1 SYNC1 or OPEN, 2 SYNC2 or
   CLOSE. OPEN may come without its argument, when it is SYNC1 to the letter.
3. Any packet with a right checksum restarts the watchdog. When it expires, the firmware stops the
   robot; when packets come again it goes on with the old motion, as real robots do.
4. Before OPEN nothing but the answers is sent.

Facts: protocol.md 1.3, 2.1, 2.4, 2.5, 2.7, facts.md 12.
"""

from enum import Enum, auto
from math import inf

from msgspec import Struct

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.arcos.reports import Report
from pioneer3.state import Identity


class SessionPhase(Enum):
    """Progress of the session."""

    WAITING = auto()
    SYNCED0 = auto()
    SYNCED1 = auto()
    READY = auto()
    OPEN = auto()


class SessionOpened(Struct, frozen=True):
    """The host sent OPEN: reports may flow."""


class SessionClosed(Struct, frozen=True):
    """The host sent CLOSE: everything stops."""


class Commanded(Struct, frozen=True):
    """The host sent a command."""

    command: Command


class WatchdogExpired(Struct, frozen=True):
    """The host has been silent for too long."""


class WatchdogFed(Struct, frozen=True):
    """The host sends again."""


Event = SessionOpened | SessionClosed | Commanded | WatchdogExpired | WatchdogFed


class Device:
    """One robot's session: call :meth:`receive` and :meth:`tick`, send :meth:`outgoing`.

    Attributes:
        identity: The answer to SYNC2; may be changed between two sessions.
        watchdog: Silence of the host that stops the robot [s]; 0 switches it off. May be changed at
            any time.
    """

    def __init__(self, identity: Identity, watchdog: float = 2.0) -> None:
        self.phase = SessionPhase.WAITING
        self.reader = PacketReader()
        self.watchdog = watchdog
        self.identity = identity
        self._heard_at = 0.0
        self._expired = False
        self._outbox: list[bytes] = []

    @property
    def is_open(self) -> bool:
        """Whether reports may be sent."""
        return self.phase is SessionPhase.OPEN

    @property
    def due(self) -> float:
        """When :meth:`tick` has something to do [s, monotonic]; `inf`: never."""
        waits = self.is_open and self.watchdog > 0 and not self._expired
        return self._heard_at + self.watchdog if waits else inf

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Process bytes received at `now` [s, monotonic]; return the events that follow."""
        events: list[Event] = []
        for payload in self.reader.feed(data, now):
            self._heard_at = now
            if self._expired:
                self._expired = False
                events.append(WatchdogFed())
            events += self._serve(payload) if self.is_open else self._shake_hands(payload)
        return events

    def tick(self, now: float) -> list[Event]:
        """Act on the passing of time."""
        if now >= self.due:
            self._expired = True
            return [WatchdogExpired()]
        return []

    def send(self, report: Report) -> None:
        """Queue one report; without an open session it goes nowhere."""
        if self.is_open:
            self._outbox.append(encode(reports.to_payload(report)))

    def send_frames(self, frames: bytes) -> None:
        """Queue reports that are whole packets already; without an open session, likewise."""
        if self.is_open:
            self._outbox.append(frames)

    def outgoing(self) -> bytes:
        """Return and forget the bytes to put on the wire."""
        data = b"".join(self._outbox)
        self._outbox.clear()
        return data

    def hang_up(self) -> list[Event]:
        """End the session because the link is gone; return the events that follow."""
        was_open, self.phase, self._expired = self.is_open, SessionPhase.WAITING, False
        self.reader = PacketReader()
        self._outbox.clear()
        return [SessionClosed()] if was_open else []

    def _serve(self, payload: bytes) -> list[Event]:
        match command := commands.from_payload(payload):
            case commands.Close():
                self.phase, self._expired = SessionPhase.WAITING, False
                return [SessionClosed()]
            case commands.Open() | commands.Pulse():
                return []
        return [Commanded(command)]

    def _shake_hands(self, payload: bytes) -> list[Event]:
        match payload[0], self.phase:
            case 0, _:
                self._answer(reports.SyncEcho(0), SessionPhase.SYNCED0)
            case 1, SessionPhase.READY:
                self.phase = SessionPhase.OPEN
                return [SessionOpened()]
            case 1, SessionPhase.SYNCED0 | SessionPhase.SYNCED1:
                self._answer(reports.SyncEcho(1), SessionPhase.SYNCED1)
            case 2, SessionPhase.SYNCED1 | SessionPhase.READY:
                own = self.identity
                identity = reports.SyncIdentity(name=own.name, family=own.family, model=own.model)
                self._answer(identity, SessionPhase.READY)
        return []

    def _answer(self, report: Report, phase: SessionPhase) -> None:
        self._outbox.append(encode(reports.to_payload(report)))
        self.phase = phase
