"""The laser's clock beside ours (scip.md 5). No I/O, no clock: times are arguments [s, monotonic].

Two sources are joined:

1. TM asks the laser for its time. The answer with the shortest round trip is the best; its middle
   is the moment at which the laser looked at its clock.
2. Each scan came some time after it was stamped. The quickest of them tell how the clocks drift:
   see :mod:`pioneer3.lasers.clock`.
"""

from typing import Final

from pioneer3.lasers.clock import Envelope
from pioneer3.units import MS

WRAP: Final = 1 << 24
"""Stamps are of 24 bits [ms]."""
MAX_DRIFT: Final = 2e-4
"""Clocks of lasers and computers differ by less than this share."""
SETTLING: Final = 3.0
"""Time in which a scan comes without delays [s]."""


class ScipClock:
    """Maps the laser's stamps onto our time; `compared` once there was an answer to TM."""

    def __init__(self) -> None:
        self.compared = False
        self._seconds = 0.0
        self._last_ms: int | None = None
        self._round_trip = 0.0
        self._offset = 0.0
        self._envelope = Envelope(MAX_DRIFT)
        self._settled_at = 0.0
        self._delay = 0.0

    def unwrap(self, stamp_ms: int) -> float:
        """Return the laser's time without wrap-around [s]: the middle of its millisecond."""
        if self._last_ms is None:
            self._last_ms, self._seconds = stamp_ms, (stamp_ms + 0.5) * MS
        ahead = (stamp_ms - self._last_ms) % WRAP
        if ahead >= WRAP // 2:
            ahead -= WRAP
        self._last_ms = stamp_ms
        self._seconds += ahead * MS
        return self._seconds

    def compare(self, stamp_ms: int, asked: float, answered: float, lead: float = 0.0) -> None:
        """Take an answer to TM1, the laser's time, that was asked for and answered then [s].

        The laser looked at its clock `lead` nearer to the request than to the answer, because the
        answer is longer [s].
        """
        seconds = self.unwrap(stamp_ms)
        if not self.compared or answered - asked < self._round_trip:
            self.compared, self._round_trip = True, answered - asked
            self._offset = (asked + answered - lead) / 2 - seconds

    def our_time(self, stamp_ms: int, arrived: float | None, took: float) -> float | None:
        """Return our time of a scan's stamp, or `None` while nothing is known to derive it from.

        The first byte of the scan `arrived` then, or at a time that is not known, and `took` at
        least so long after the stamp [s].
        """
        seconds = self.unwrap(stamp_ms)
        if arrived is not None:
            self._follow(arrived - seconds, arrived)
        lag = self._envelope.lag
        if lag is None:
            return seconds + self._offset if self.compared else None
        if not self.compared:
            return seconds + lag - took
        if self._envelope.at <= self._settled_at:
            return seconds + self._offset
        return seconds + lag - self._delay

    def _follow(self, lag: float, now: float) -> None:
        if self._envelope.lag is None:
            self._settled_at = now + SETTLING
        smallest = self._envelope.follow(lag, now)
        if now <= self._settled_at:
            self._delay = smallest - self._offset
