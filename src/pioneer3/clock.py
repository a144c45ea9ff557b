"""Where the time comes from: asked for at the edges, passed down as an argument."""

from typing import Protocol


class Clock(Protocol):
    """Monotonic seconds."""

    def __call__(self) -> float:
        """Return the time now [s]."""


class ManualClock:
    """A clock that moves only when told to."""

    def __init__(self, now: float = 0.0) -> None:
        self.now = now

    def __call__(self) -> float:
        """Return the time now [s]."""
        return self.now

    def advance(self, dt: float) -> float:
        """Move on by `dt` [s]; return the new time."""
        self.now += dt
        return self.now
