"""The time in stamps: that of the system, or of a simulator."""

import time
from collections.abc import Callable
from typing import Any

from pioneer3.ros.messages.update import NANO, nanoseconds


class RosClock:
    """The time in stamps: that of the system, or of `/clock` where a simulator publishes it."""

    def __init__(self) -> None:
        self._simulated: int | None = None
        self.simulates = False

    def now(self) -> int:
        """Return the time [ns]; 0 before the first message on `/clock`."""
        return (self._simulated or 0) if self.simulates else time.time_ns()

    def take(self, message: Any, _: object) -> None:
        """Take a message of `/clock`."""
        self._simulated = nanoseconds(message.clock)

    def stamp(self, age: float, make: Callable[[str], Any]) -> Any:
        """Return the time of the moment `age` seconds ago as a message."""
        stamp = make("builtin_interfaces/Time")
        stamp.sec, stamp.nanosec = divmod(max(0, self.now() - round(age * NANO)), NANO)
        return stamp

    def age(self, stamp: Any) -> float | None:
        """Return the time since a stamp [s]; `None` for a stamp of 0."""
        moment = nanoseconds(stamp)
        return (self.now() - moment) / NANO if moment else None
