"""The doorkeeper: everything about who is in."""

import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from pioneer3.web.access.invitations import Invitations
from pioneer3.web.access.names import is_from_here
from pioneer3.web.access.role import Role
from pioneer3.web.access.sessions import Kind, Session, Sessions
from pioneer3.web.access.throttle import NO_LIMIT, Rate, Throttle

REQUESTS, VISITS, STOPS = Rate(1000, 0.005), Rate(80, 0.25), Rate(50, 0.05)
"""From one address: of HTTP, and WebSockets; from one session for each robot: stops."""
STOP = re.compile(r"/api/(robots/\d+/)?(emergency_)?stop")
DEVICES = (("iPad", "tablet"), ("Tablet", "tablet"), ("Mobi", "phone"), ("Mozilla", "laptop"))


class Access:
    """Who may come in. `clock` returns the time [s, monotonic].

    Attributes:
        here: The session of everybody at this very machine, who needs no token.
        authority: Certificate to trust so that https is trusted; `None` where there is none.
        urls: Where others find the page, the best first; empty where only this machine does.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self.here = Session(id="here", name="this computer", role=Role.DRIVER, kind=Kind.HERE)
        self.urls: tuple[str, ...] = ()
        self.authority: Path | None = None
        self.sessions = Sessions(clock)
        self.invitations = Invitations(clock)
        self.throttle = Throttle(clock)
        self._requests, self._visits, self._stops = (
            Throttle(clock, rate, NO_LIMIT) for rate in (REQUESTS, VISITS, STOPS)
        )

    def pair(
        self, token: str, name: str, role: Role | None, others: Iterable[str] = ()
    ) -> tuple[Session, str] | None:
        """Return a new session and its secret for `token`, or `None` if that is not good.

        `role` may be less than what the token is for; `others` are names that are taken.

        Raises:
            OverflowError: there are too many sessions.
        """
        self.sessions.make_room()  # before the token is used up
        allowed = self.invitations.redeem(token)
        if allowed is None:
            return None
        granted = role if role is not None and allowed.covers(role) else allowed
        return self.sessions.open(name, granted, Kind.BROWSER, others=others)

    def session(self, peer: str, headers: Mapping[str, str], cookie: str | None) -> Session | None:
        """Return whose request this is, `None` for a stranger's.

        A secret that is shown must be good, on this very machine too.
        """
        word, _, bearer = headers.get("authorization", "").partition(" ")
        if word:
            return self.sessions.find(bearer.strip()) if word.lower() == "bearer" else None
        session = self.sessions.find(cookie) if cookie else None
        if session is None and is_from_here(peer, headers):
            return self.here
        return session

    def is_stop(self, session: Session | None, path: str) -> bool:
        """Whether this is a request to stop, of somebody who may."""
        return session is not None and STOP.fullmatch(path) is not None

    def is_too_much(self, peer: str, session: Session | None, path: str, *, visit: bool) -> bool:
        """Note a request, or the `visit` of a page; return whether `peer` asks too much.

        Stops are counted apart, so that a flood of other requests keeps none of them out.
        """
        if visit:
            return self._visits.wait(peer) > 0
        if session is not None and self.is_stop(session, path):
            return self._stops.wait(f"{session.id} {path}") > 0
        return self._requests.wait(peer) > 0


def device(user_agent: str) -> str:
    """Return what a browser runs on, in a word, for those who choose no name."""
    return next((name for mark, name in DEVICES if mark in user_agent), "script")
