"""Decides who is let in: pairing, sessions of requests, and rate limits."""

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from math import inf
from pathlib import Path

from pioneer3.names import free_name
from pioneer3.web.access.hosts import is_from_here
from pioneer3.web.access.invitations import Invitations
from pioneer3.web.access.sessions import LoginSession, LoginSessions, Role, SessionKind


@dataclass(frozen=True, slots=True)
class Rate:
    """A `burst` of attempts in a row; after these, one more each `pause` [s]."""

    burst: int
    pause: float


GUESSES = Rate(10, 6.0)
"""Tokens from one address."""
GUESSES_IN_ALL = Rate(60, 1.0)
"""Tokens from everywhere."""
NO_LIMIT = Rate(1, 0.0)
MOST_KEYS = 10_000
REQUESTS = Rate(1000, 0.005)
"""HTTP requests from one address."""
VISITS = Rate(80, 0.25)
"""WebSockets from one address."""
STOPS = Rate(50, 0.05)
"""Stops from one session for each robot."""
STOP = re.compile(r"/api/(robots/\d+/)?(emergency_)?stop")
DEVICES = (("iPad", "tablet"), ("Tablet", "tablet"), ("Mobi", "phone"), ("Mozilla", "laptop"))


class RateLimiter:
    """Counts attempts, per key and in all, in leaky buckets: each drains by one per pause.

    `clock` returns the time [s, monotonic].
    """

    def __init__(
        self, clock: Callable[[], float], each: Rate = GUESSES, every: Rate = GUESSES_IN_ALL
    ) -> None:
        self._clock = clock
        self._each = each
        self._every = every
        self._all = -inf
        self._by_key: dict[str, float] = {}

    def wait(self, key: str) -> float:
        """Note an attempt of `key`, such as an address; return how long it must wait [s], or 0."""
        now, each, every = self._clock(), self._each, self._every
        if len(self._by_key) >= MOST_KEYS:
            self._by_key = {k: full for k, full in self._by_key.items() if full > now}
        one = max(now, self._by_key.get(key, -inf)) + each.pause
        all_ = max(now, self._all) + every.pause
        late = max(one - now - each.burst * each.pause, all_ - now - every.burst * every.pause)
        if late > 0 or len(self._by_key) >= MOST_KEYS:
            return late if late > 0 else each.pause
        self._by_key[key], self._all = one, all_
        return 0.0


class Access:
    """Decides who is let in. `clock` returns the time [s, monotonic].

    All requests from this machine belong to the session `here`, and need no token. `urls` are
    addresses of the page for other machines, the best first, and `authority` is the certificate of
    the one that signed ours, if there is one.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self.here = LoginSession(
            id="here", name="this computer", role=Role.DRIVER, kind=SessionKind.HERE
        )
        self.urls: tuple[str, ...] = ()
        self.authority: Path | None = None
        self.sessions = LoginSessions(clock)
        self.invitations = Invitations(clock)
        self.pairing_limiter = RateLimiter(clock)
        self._requests, self._visits, self._stops = (
            RateLimiter(clock, rate, NO_LIMIT) for rate in (REQUESTS, VISITS, STOPS)
        )

    def pair(
        self, token: str, name: str, role: Role | None, others: Iterable[str] = ()
    ) -> tuple[LoginSession, str] | None:
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
        return self.sessions.open(name, granted, SessionKind.BROWSER, others=others)

    def name_for(self, session: LoginSession, kind: str, others: set[str]) -> str:
        """Return a name for a client, from its session or kind of device, that no other has."""
        if session.role is Role.STUDENT:
            return session.name
        if session is not self.here:
            return free_name(session.name, others)
        return free_name(kind, others | self.sessions.names)

    def session(
        self, peer: str, headers: Mapping[str, str], cookie: str | None
    ) -> LoginSession | None:
        """Return the session of a request, or `None`.

        A secret that is sent must be good, also on this machine.
        """
        word, _, bearer = headers.get("authorization", "").partition(" ")
        if word:
            return self.sessions.find(bearer.strip()) if word.lower() == "bearer" else None
        session = self.sessions.find(cookie) if cookie else None
        if session is None and is_from_here(peer, headers):
            return self.here
        return session

    def is_stop(self, session: LoginSession | None, path: str) -> bool:
        """Whether this is a request to stop, with a session."""
        return session is not None and STOP.fullmatch(path) is not None

    def exceeds_rate(
        self, peer: str, session: LoginSession | None, path: str, *, visit: bool
    ) -> bool:
        """Count a request, or the `visit` of a page; return whether `peer` exceeds its rate.

        Stops are counted apart, so that a flood of other requests blocks none of them. Students
        are counted one by one: a class may share an address.
        """
        if session is not None and session.role is Role.STUDENT:
            peer = f"student {session.id}"
        if visit:
            return self._visits.wait(peer) > 0
        if session is not None and self.is_stop(session, path):
            return self._stops.wait(f"{session.id} {path}") > 0
        return self._requests.wait(peer) > 0


def device(user_agent: str, told: str = "") -> str:
    """Return the kind of device that a browser runs on, in a word; a page may have `told` it.

    Browsers of phones that ask for pages as on a desk say that they are laptops.
    """
    if told in {"phone", "tablet"}:
        return told
    return next((name for mark, name in DEVICES if mark in user_agent), "script")
