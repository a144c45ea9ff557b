"""One-time tokens that let a phone in."""

from collections.abc import Callable
from dataclasses import dataclass

from pioneer3.web.access.role import Role
from pioneer3.web.access.secret import fingerprint, new_secret

TERM = 600.0
"""How long a token is good [s]."""
MOST = 100
"""Tokens that wait at once; more push out the oldest."""


@dataclass(frozen=True, slots=True)
class Invitation:
    """What a token is worth, and until when [s, monotonic]."""

    role: Role
    until: float


class Invitations:
    """Makes tokens and takes each back once. `clock` returns the time [s, monotonic]."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._open: dict[bytes, Invitation] = {}

    def invite(self, role: Role) -> str:
        """Return a new token; nobody can ask for it again."""
        self._forget_expired()
        while len(self._open) >= MOST:
            del self._open[next(iter(self._open))]
        token = new_secret()
        self._open[fingerprint(token)] = Invitation(role, self._clock() + TERM)
        return token

    def redeem(self, token: str) -> Role | None:
        """Return the role that `token` is good for, once; `None` if it is none, used or expired."""
        self._forget_expired()
        invitation = self._open.pop(fingerprint(token), None)
        return invitation.role if invitation else None

    def _forget_expired(self) -> None:
        now = self._clock()
        self._open = {mark: known for mark, known in self._open.items() if now < known.until}
