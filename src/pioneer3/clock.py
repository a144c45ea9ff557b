"""The source of time: read at the edges, passed down as an argument."""

from typing import Protocol


class Clock(Protocol):
    """A monotonic clock."""

    def __call__(self) -> float:
        """Return the time now [s]."""
