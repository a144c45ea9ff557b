"""Wheel counters that wrap around, turned into totals that do not (protocol.md 4.8)."""

POSITION_MODULUS = 1 << 15
"""X and Y count in 15 bits; servers that count in 16 agree with that."""


def difference(new: int, old: int, modulus: int) -> int:
    """Return the shortest signed way from `old` to `new` on a counter of `modulus` steps.

    In [-modulus / 2, modulus / 2): exact while the counter moves less than half its range between
    two readings, which at 1 mm a count and 100 ms is 163 m/s.
    """
    half = modulus >> 1
    return (new - old + half) % modulus - half


class Counter:
    """A running total of a wrapping counter, in whole counts so that nothing is lost."""

    def __init__(self, modulus: int) -> None:
        self.total = 0
        self._modulus = modulus
        self._last: int | None = None

    def update(self, raw: int) -> int:
        """Take the next reading; return the total since the first one of this session."""
        if self._last is not None:
            self.total += difference(raw, self._last, self._modulus)
        self._last = raw
        return self.total
