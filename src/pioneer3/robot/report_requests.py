"""Requests for reports that the robot sends only when asked. No I/O, no clock.

Rules:

1. A robot forgets requests at the end of a session: each session begins with sending all again.
2. A request without answer is sent again every :data:`RENEW` seconds: a frame may have been lost.
3. A request ends when its last user releases it, and before the session is closed.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from pioneer3.arcos.commands import Command, to_payload
from pioneer3.arcos.reports import Report

RENEW = 2.0
"""A request without a report for this long is sent again [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportRequest:
    """A request for reports of the classes `answers`, empty if none come.

    Commands that `begin` them are harmless when sent twice.

    Raises:
        CommandError: a command does not fit the protocol.
    """

    begin: tuple[Command, ...]
    end: tuple[Command, ...]
    answers: tuple[type[Report], ...] = ()

    def __post_init__(self) -> None:
        """Check the commands now: an error at the time of sending would reach no caller."""
        for command in self.begin + self.end:
            to_payload(command)


@dataclass(slots=True)
class _Wanted:
    request: ReportRequest
    by: int = 0
    alive_at: float = 0.0


class ReportRequests:
    """All requests to one robot, over all sessions with it."""

    def __init__(self) -> None:
        self._wanted: dict[str, _Wanted] = {}
        self._outbox: list[Command] = []
        self._open = False

    def want(self, name: str, request: ReportRequest, now: float) -> None:
        """Add a user of `request`, known by `name`, until :meth:`release`."""
        wanted = self._wanted.setdefault(name, _Wanted(request))
        wanted.by += 1
        if wanted.by == 1:
            self._begin(wanted, now)

    def change(self, name: str, request: ReportRequest, now: float) -> None:
        """Replace the request of this `name`, if it has a user."""
        if name in self._wanted:
            self._wanted[name].request = request
            self._begin(self._wanted[name], now)

    def release(self, name: str) -> None:
        """Remove a user of the request; the last one ends it."""
        wanted = self._wanted[name]
        wanted.by -= 1
        if wanted.by == 0:
            del self._wanted[name]
            if self._open:
                self._outbox += wanted.request.end

    def session_opened(self, now: float) -> None:
        """Send every request."""
        self._open = True
        self._outbox.clear()
        for wanted in self._wanted.values():
            self._begin(wanted, now)

    def session_lost(self) -> None:
        """Drop the commands of the session that is over; they must not reach the next."""
        self._open = False
        self._outbox.clear()

    def received(self, report: Report, now: float) -> None:
        """Note the time of a report."""
        for wanted in self._wanted.values():
            if type(report) in wanted.request.answers:
                wanted.alive_at = now

    def tick(self, now: float) -> None:
        """Send requests without answer again."""
        for wanted in self._wanted.values():
            if wanted.request.answers and now >= wanted.alive_at + RENEW:
                self._begin(wanted, now)

    @property
    def is_due(self) -> bool:
        """Whether :meth:`outgoing` has something to send."""
        return bool(self._outbox)

    def outgoing(self) -> Sequence[Command]:
        """Return and forget the commands to send."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def end_commands(self) -> Sequence[Command]:
        """Return the commands that end every request."""
        return [command for wanted in self._wanted.values() for command in wanted.request.end]

    def _begin(self, wanted: _Wanted, now: float) -> None:
        wanted.alive_at = now
        if self._open:
            self._outbox += wanted.request.begin
