"""Slows down who guesses."""

from collections.abc import Callable
from math import inf

PER_ADDRESS, IN_ALL = 10, 60
"""Attempts in a row from one address, and from everywhere."""
PAUSE_PER_ADDRESS, PAUSE_IN_ALL = 6.0, 1.0
"""After these, one more each so often [s]."""
MOST_ADDRESSES = 10_000


class Throttle:
    """Counts attempts, per address and in all. `clock` returns the time [s, monotonic].

    Each count drains by one per pause, a leaky bucket: what a person does is never slowed.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._all = -inf
        self._by_address: dict[str, float] = {}

    def wait(self, address: str) -> float:
        """Note an attempt from `address`; return how long it must wait [s], 0 if it may pass."""
        now = self._clock()
        if len(self._by_address) >= MOST_ADDRESSES:
            self._by_address = {a: full for a, full in self._by_address.items() if full > now}
        one = max(now, self._by_address.get(address, -inf)) + PAUSE_PER_ADDRESS
        every = max(now, self._all) + PAUSE_IN_ALL
        late = max(one - now - PER_ADDRESS * PAUSE_PER_ADDRESS, every - now - IN_ALL * PAUSE_IN_ALL)
        if late > 0 or len(self._by_address) >= MOST_ADDRESSES:
            return max(late, PAUSE_IN_ALL)
        self._by_address[address], self._all = one, every
        return 0.0
