"""What the robot is to go on sending. No I/O: what is wanted, the reports and the time come in.

Rules:

1. A robot forgets with the session what it was asked to send: each session begins with asking anew.
2. What does not come is asked for again, every :data:`RENEW` seconds: the frame may have been lost.
3. It is asked to stop when the last one who wanted it lets go, and before the session is closed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from pioneer3.arcos.commands import Command, to_payload
from pioneer3.arcos.reports import Report

RENEW = 2.0
"""Silence of a report that is wanted after which it is asked for again [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """One thing that a robot sends from `begin` to `end`.

    Attributes:
        begin: Asks for it; harmless when said twice.
        end: Asks for no more of it.
        answers: The reports that come; empty if none do.

    Raises:
        CommandError: a command does not fit the protocol.
    """

    begin: tuple[Command, ...]
    end: tuple[Command, ...]
    answers: tuple[type[Report], ...] = ()

    def __post_init__(self) -> None:
        """Find out now: nobody could be told when it is sent."""
        for command in self.begin + self.end:
            to_payload(command)


@dataclass(slots=True)
class _Wanted:
    request: Request
    by: int = 0
    alive_at: float = 0.0


class Requests:
    """Everything that is wanted of one robot, over all sessions with it."""

    def __init__(self) -> None:
        self._wanted: dict[str, _Wanted] = {}
        self._outbox: list[Command] = []
        self._open = False

    def want(self, name: str, request: Request, now: float) -> None:
        """Ask for what `request` brings until as many :meth:`release`; `name` says what it is."""
        wanted = self._wanted.setdefault(name, _Wanted(request))
        wanted.by += 1
        if wanted.by == 1:
            self._begin(wanted, now)

    def change(self, name: str, request: Request, now: float) -> None:
        """Ask for it in another way from now on, if anybody wants it."""
        if name in self._wanted:
            self._wanted[name].request = request
            self._begin(self._wanted[name], now)

    def release(self, name: str) -> None:
        """Let go; the last one ends it."""
        wanted = self._wanted[name]
        wanted.by -= 1
        if wanted.by == 0:
            del self._wanted[name]
            if self._open:
                self._outbox += wanted.request.end

    def session_opened(self, now: float) -> None:
        """Ask for everything that is wanted."""
        self._open = True
        self._outbox.clear()
        for wanted in self._wanted.values():
            self._begin(wanted, now)

    def session_lost(self) -> None:
        """Keep what was to be sent to the session that is over from reaching the next."""
        self._open = False
        self._outbox.clear()

    def heard(self, report: Report, now: float) -> None:
        """Take note of a report."""
        for wanted in self._wanted.values():
            if type(report) in wanted.request.answers:
                wanted.alive_at = now

    def tick(self, now: float) -> None:
        """Ask again for what does not come."""
        for wanted in self._wanted.values():
            if wanted.request.answers and now >= wanted.alive_at + RENEW:
                self._begin(wanted, now)

    def outgoing(self) -> Sequence[Command]:
        """Return and forget the commands to send."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def farewell(self) -> Sequence[Command]:
        """Return what ends everything that is wanted."""
        return [command for wanted in self._wanted.values() for command in wanted.request.end]

    def _begin(self, wanted: _Wanted, now: float) -> None:
        wanted.alive_at = now
        if self._open:
            self._outbox += wanted.request.begin
