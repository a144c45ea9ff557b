"""Who has been let in, until they are shown out."""

import asyncio
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import count

from pioneer3.web.access.role import Role
from pioneer3.web.access.secret import fingerprint, new_secret

IDLE = 12 * 3600.0
"""A session that is not used for this long ends [s]."""
MOST = 200
NAME = 40
"""Longest name [characters]."""


class Kind(StrEnum):
    """What a session belongs to."""

    HERE = "here"
    BROWSER = "browser"
    SCRIPT = "script"


@dataclass(slots=True, eq=False, kw_only=True)
class Session:
    """Somebody at one browser, or one script.

    Attributes:
        id: Told to people; of no use to who wants to come in.
        name: Shown to all.
        parent: Id of the session that made this one, empty for none.
        seen: When it was last used [s, monotonic].
        ended: Set when it is revoked: whatever it has open must close.
    """

    id: str
    name: str
    role: Role
    kind: Kind
    parent: str = ""
    seen: float = 0.0
    ended: asyncio.Event = field(default_factory=asyncio.Event)


class Sessions:
    """Opens, finds and ends sessions. They live as long as the program; nothing is on disk.

    `clock` returns the time [s, monotonic].

    Attributes:
        on_end: Called with each session that ends.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self.on_end: Callable[[Session], None] = lambda _: None
        self._clock = clock
        self._by_mark: dict[bytes, Session] = {}
        self._count = count(1)

    def make_room(self) -> None:
        """End what is idle.

        Raises:
            OverflowError: there is no room for another one.
        """
        self._end_idle()
        if len(self._by_mark) >= MOST:
            raise OverflowError(f"there are {MOST} sessions already; revoke some first")

    def open(
        self, name: str, role: Role, kind: Kind, parent: str = "", others: Iterable[str] = ()
    ) -> tuple[Session, str]:
        """Return a new session and its secret, which nobody can ask for again.

        It is called `name`, or something like it that no session is called, nor any of `others`.

        Raises:
            OverflowError: there are too many.
        """
        self.make_room()
        free = free_name(clean_name(name) or kind, {*self.names, *others})
        session = Session(
            id=str(next(self._count)),
            name=free,
            role=role,
            kind=kind,
            parent=parent,
            seen=self._clock(),
        )
        secret = new_secret()
        self._by_mark[fingerprint(secret)] = session
        return session, secret

    @property
    def names(self) -> set[str]:
        """What all are called."""
        return {session.name for session in self._by_mark.values()}

    def find(self, secret: str) -> Session | None:
        """Return the session of `secret`, and note that it is used."""
        self._end_idle()
        session = self._by_mark.get(fingerprint(secret))
        if session is not None:
            session.seen = self._clock()
        return session

    def revoke(self, id_: str) -> bool:
        """End a session and those that it made; return whether there was one."""
        ending = [s for s in self._by_mark.values() if id_ in {s.id, s.parent}]
        for session in ending:
            self._end(session)
        return any(session.id == id_ for session in ending)

    def listed(self) -> list[Session]:
        """Return all, the oldest first."""
        self._end_idle()
        return list(self._by_mark.values())

    def _end_idle(self) -> None:
        now = self._clock()
        for session in list(self._by_mark.values()):
            if now - session.seen >= IDLE:
                self._end(session)

    def _end(self, session: Session) -> None:
        self._by_mark = {mark: s for mark, s in self._by_mark.items() if s is not session}
        session.ended.set()
        self.on_end(session)


def clean_name(text: str) -> str:
    """Return `text` as a name: printable, single spaces, not long."""
    printable = "".join(c if c.isprintable() else " " for c in text)
    return " ".join(printable.split())[:NAME].strip()


def free_name(wish: str, taken: set[str]) -> str:
    """Return `wish`, or `wish 2`, `wish 3` if that is taken."""
    if wish not in taken:
        return wish
    return next(name for n in count(2) if (name := f"{wish} {n}") not in taken)
