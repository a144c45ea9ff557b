"""Whether what a publisher of commands sends may move the robot. Pure."""

from collections import deque
from math import inf, isfinite
from statistics import median
from typing import Final

from pioneer3.behaviors.actions import Hold
from pioneer3.geometry import STILL, Twist2
from pioneer3.stops import Stop, leads_away

FEWEST: Final = 3
"""So many commands in a row make a stream."""
SLOWEST: Final = 0.2
"""A stream with a longer period [s] cannot be told from a person who presses a key again."""
ROOM: Final = 1.5
"""How much longer than its period the pause within a stream may be."""


class Sender:
    """One publisher, over one connection.

    A publisher that was frozen, or cut off, goes on with its old stream. So does a person who
    presses a key again, for one command. So the first command after a silence waits for the next
    one as long as the stream's period makes likely: one that comes in this time gives the stream
    away, and it is ignored until it says zero or leads away.

    Args:
        name: Shown to people.
        timeout: How long a command lasts [s]; `inf` until the next one.

    Attributes:
        name: The same.
        deadline: When :meth:`due` must be called [s, as every `now`].
    """

    def __init__(self, name: str, timeout: float) -> None:
        self.name = name
        self.deadline = inf
        self._timeout = timeout
        self._hold = Hold(name, streams=isfinite(timeout))
        self._pauses: deque[float] = deque(maxlen=5)
        self._twist = STILL
        self._at = -inf

    @property
    def waits(self) -> bool:
        """Whether the last command waits to be told from an old stream."""
        return isfinite(self.deadline)

    def take(self, twist: Twist2, now: float, last: Stop) -> str | None:
        """Take a command; return why it is ignored after the stop `last`, or `None`."""
        came_back, pause = self._hold.fell_silent(now), now - self._at
        leaves = twist.is_zero or leads_away(twist, self._twist)
        self._twist, self._at = twist, now
        if came_back and not self.waits and not leaves:
            if self._is_stream():
                self.deadline = now + ROOM * median(self._pauses)
                return None
            self._hold.release()
        self.deadline = inf
        if pause < self._timeout and not twist.is_zero:
            self._pauses.append(pause)
        else:
            self._pauses.clear()
        self._hold.set(twist, now, self._timeout, last)
        return self._hold.ignored(last)

    def due(self, now: float, last: Stop) -> Twist2 | None:
        """Return the command that has turned out to be a new one, if any."""
        if now < self.deadline:
            return None
        self.deadline = inf
        self._pauses.clear()
        self._hold.release()
        self._hold.set(self._twist, now, self._timeout, last)
        return self._twist

    def _is_stream(self) -> bool:
        return len(self._pauses) >= FEWEST - 1 and median(self._pauses) <= SLOWEST
