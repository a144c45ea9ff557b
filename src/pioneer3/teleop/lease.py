"""Who may drive when several people could: the first, until they let go for a moment."""

from typing import Generic, TypeVar

W = TypeVar("W")

TERM = 1.0
"""How long the wheel stays with somebody who has let go [s]."""


class Lease(Generic[W]):
    """One holder at a time; a lease that is not renewed ends."""

    def __init__(self, term: float = TERM) -> None:
        self._term = term
        self._holder: W | None = None
        self._until = float("-inf")

    def take(self, who: W, now: float, term: float | None = None) -> bool:
        """Take or renew the lease at `now` [s, monotonic]; return whether `who` holds it.

        It lasts for `term` [s], or longer if it did already.
        """
        holder = self.holder(now)
        if holder is not None and holder != who:
            return False
        until = now + (self._term if term is None else term)
        self._until = max(self._until, until) if holder == who else until
        self._holder = who
        return True

    def holder(self, now: float) -> W | None:
        """Return who holds the lease, or `None`."""
        return self._holder if now < self._until else None

    def give_up(self, who: W) -> None:
        """End the lease of `who`; nothing happens if another holds it."""
        if self._holder == who:
            self._holder, self._until = None, float("-inf")
