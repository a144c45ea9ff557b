"""Roles and sessions: the permissions of a browser or a script, until they are revoked."""

import asyncio
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from hashlib import sha256
from itertools import count
from secrets import token_urlsafe

from pioneer3.names import clean_name, free_name

IDLE = 12 * 3600.0
"""A session that is not used for this long ends [s]."""
MOST = 200
SECRET_BYTES = 32
"""Entropy of a secret: 256 bits, where 128 would do."""
LONGEST_SECRET = 128
"""No secret has more characters."""


class Role(StrEnum):
    """Permissions. Viewers look, and stop robots. Drivers do the rest as well.

    Students of a class look at their own robot only, and drive it.
    """

    VIEWER = "viewer"
    STUDENT = "student"
    DRIVER = "driver"

    def covers(self, needed: "Role") -> bool:
        """Whether this role has all permissions of `needed`, a student for the own robot."""
        return self is Role.DRIVER or needed in {self, Role.VIEWER}


class SessionKind(StrEnum):
    """The kind of client that a session belongs to."""

    HERE = "here"
    BROWSER = "browser"
    SCRIPT = "script"


@dataclass(slots=True, eq=False, kw_only=True)
class LoginSession:
    """The login of one browser or one script; its id is shown to people, and no secret.

    It was last `seen` at a time [s, monotonic]. `parent` is the id of the session that made this
    one, empty for none. When it is revoked, `ended` is set and its connections must close.
    """

    id: str
    name: str
    role: Role
    kind: SessionKind
    parent: str = ""
    robot: int | None = None
    seen: float = 0.0
    ended: asyncio.Event = field(default_factory=asyncio.Event)


class LoginSessions:
    """Opens, finds and ends sessions; `on_end` is called with each. They are kept in memory only.

    `clock` returns the time [s, monotonic].
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self.on_end: Callable[[LoginSession], None] = lambda _: None
        self._clock = clock
        self._by_fingerprint: dict[bytes, LoginSession] = {}
        self._count = count(1)

    def make_room(self) -> None:
        """End idle sessions; OverflowError if there is no room for another one."""
        self._end_idle()
        if len(self._by_fingerprint) >= MOST:
            raise OverflowError(f"there are {MOST} sessions already; revoke some first")

    def open(
        self, name: str, role: Role, kind: SessionKind, parent: str = "", others: Iterable[str] = ()
    ) -> tuple[LoginSession, str]:
        """Return a new session and its secret, which is not kept.

        Its name is `name`, with a number if another session or one of `others` has that name.

        Raises:
            OverflowError: there are too many sessions.
        """
        self.make_room()
        free = free_name(clean_name(name) or kind, {*self.names, *others})
        session = LoginSession(
            id=str(next(self._count)),
            name=free,
            role=role,
            kind=kind,
            parent=parent,
            seen=self._clock(),
        )
        secret = new_secret()
        self._by_fingerprint[fingerprint(secret)] = session
        return session, secret

    @property
    def names(self) -> set[str]:
        """The names of all sessions."""
        return {session.name for session in self._by_fingerprint.values()}

    def find(self, secret: str) -> LoginSession | None:
        """Return the session of `secret`, and note its use."""
        self._end_idle()
        session = self._by_fingerprint.get(fingerprint(secret))
        if session is not None:
            session.seen = self._clock()
        return session

    def revoke(self, id_: str) -> bool:
        """End a session and those that it made; return whether it was there."""
        ending = [s for s in self._by_fingerprint.values() if id_ in {s.id, s.parent}]
        for session in ending:
            self._end(session)
        return any(session.id == id_ for session in ending)

    def listed(self) -> list[LoginSession]:
        """Return all sessions, the oldest first."""
        self._end_idle()
        return list(self._by_fingerprint.values())

    def _end_idle(self) -> None:
        now = self._clock()
        for session in list(self._by_fingerprint.values()):
            if now - session.seen >= IDLE:
                self._end(session)

    def _end(self, session: LoginSession) -> None:
        known = self._by_fingerprint.items()
        self._by_fingerprint = {key: one for key, one in known if one is not session}
        session.ended.set()
        self.on_end(session)


def new_secret() -> str:
    """Return a secret for a URL, a cookie or a header."""
    return token_urlsafe(SECRET_BYTES)


def fingerprint(secret: str) -> bytes:
    """Return the hash that is kept in place of `secret`.

    Looking it up leaks nothing by its timing: a caller who guesses does not choose the hash.
    """
    return sha256(secret[: LONGEST_SECRET + 1].encode("utf-8", "replace")).digest()
