"""Slows down who asks too much: who guesses tokens, who floods the page with requests."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf

MOST_KEYS = 10_000


@dataclass(frozen=True, slots=True)
class Rate:
    """So many in a row, after these one more each so often [s]."""

    burst: int
    pause: float


GUESSES, GUESSES_IN_ALL = Rate(10, 6.0), Rate(60, 1.0)
"""Tokens from one address, and from everywhere."""
NO_LIMIT = Rate(1, 0.0)


class Throttle:
    """Counts attempts, per key and in all. `clock` returns the time [s, monotonic].

    Each count drains by one per pause, a leaky bucket: what a person does is never slowed.
    """

    def __init__(
        self, clock: Callable[[], float], each: Rate = GUESSES, every: Rate = GUESSES_IN_ALL
    ) -> None:
        self._clock = clock
        self._each = each
        self._every = every
        self._all = -inf
        self._by_key: dict[str, float] = {}

    def wait(self, key: str) -> float:
        """Note an attempt of `key`, such as an address; return how long it must wait [s], or 0."""
        now, each, every = self._clock(), self._each, self._every
        if len(self._by_key) >= MOST_KEYS:
            self._by_key = {k: full for k, full in self._by_key.items() if full > now}
        one = max(now, self._by_key.get(key, -inf)) + each.pause
        all_ = max(now, self._all) + every.pause
        late = max(one - now - each.burst * each.pause, all_ - now - every.burst * every.pause)
        if late > 0 or len(self._by_key) >= MOST_KEYS:
            return late if late > 0 else each.pause
        self._by_key[key], self._all = one, all_
        return 0.0
