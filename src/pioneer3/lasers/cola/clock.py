"""From the laser's clock to ours (cola.md 3.6).

Each scan has the laser's time at which it was sent; :mod:`pioneer3.lasers.clock` tells how that,
and the time of arrival, give the difference of the clocks.
"""

from typing import Final

from pioneer3.lasers.clock import Envelope

DRIFT: Final = 1e-4
"""Most that the laser's clock gains or loses, as a share; quartz oscillators stay within that."""
WRAP_US: Final = 1 << 32
LONGEST_US: Final = 60_000_000
"""A scan that claims to be older than this when it was sent has no valid time."""


class ColaClock:
    """Map the times in scans, of 32 bits in microseconds, to the host's clock."""

    def __init__(self) -> None:
        self._sent_us: int | None = None
        self._elapsed = 0.0
        self._envelope = Envelope(DRIFT)

    def first_reading(self, sensed_us: int, sent_us: int, arrival: float, span: float) -> float:
        """Return the time of a scan's first reading [s, monotonic].

        The laser's time of the scan is that of the first reading on some lasers, and a later one on
        others. A scan cannot be sent before its last reading, `span` after the first [s], so the
        earlier of the two holds. `arrival` is the host's time [s].
        """
        if self._sent_us == sent_us or not sent_us:
            return arrival - span  # this clock stands still
        offset = self._follow(sent_us, arrival)
        age_us = (sent_us - sensed_us) % WRAP_US
        age = age_us / 1e6 if age_us <= LONGEST_US else 0.0
        return min(self._elapsed + offset, arrival) - max(age, span)

    def _follow(self, sent_us: int, arrival: float) -> float:
        """Keep the laser's time since the first scan; return ours less that, without the delay."""
        if self._sent_us is not None:
            self._elapsed += (sent_us - self._sent_us) % WRAP_US / 1e6
        self._sent_us = sent_us
        return self._envelope.follow(arrival - self._elapsed, arrival)
