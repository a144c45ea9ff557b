"""The difference between a laser's clock and ours, as arrivals tell it. No I/O.

Nothing arrives early: the lag of an arrival, which is our time less the laser's, is the difference
of the clocks plus a delay. The quickest arrivals have hardly any. Each quicker one counts at once;
between them the lag rises no faster than clocks drift.
"""


class Envelope:
    """The lower envelope of lags.

    `lag` is the smallest one, with drift since then [s], `None` before the first; the last one came
    at `at` [s]. `drift` is the most that one clock gains on the other, as a share.
    """

    def __init__(self, drift: float) -> None:
        self.lag: float | None = None
        self.at = 0.0
        self._drift = drift

    def follow(self, lag: float, now: float) -> float:
        """Take the lag of an arrival at `now` [s]; return the smallest one."""
        if self.lag is None:
            self.lag = lag
        else:
            self.lag = min(lag, self.lag + self._drift * (now - self.at))
        self.at = now
        return self.lag
