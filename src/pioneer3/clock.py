"""Where the time comes from: asked for at the edges, passed down as an argument."""

from typing import Protocol


class Clock(Protocol):
    """Monotonic seconds."""

    def __call__(self) -> float:
        """Return the time now [s]."""
