"""A measured figure beside the bar it has to meet."""

from dataclasses import dataclass
from statistics import median, quantiles


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table: what, how much, and the bar; `None` where it is only good to know."""

    what: str
    measured: float
    unit: str
    bar: float | None
    more_is_better: bool = False

    @property
    def met(self) -> bool:
        """Whether the bar is met, if there is one."""
        if self.bar is None:
            return True
        return self.measured >= self.bar if self.more_is_better else self.measured <= self.bar

    def __str__(self) -> str:
        measured = f"{self.what:<58} {self.measured:>10.3f} {self.unit:<5}"
        if self.bar is None:
            return measured.rstrip()
        sign = ">=" if self.more_is_better else "<="
        verdict = "met" if self.met else "MISSED"
        bar = f"{sign} {self.bar:g} {self.unit}"
        return f"{measured} {bar:>14}  {verdict}"


def percentile_99(values: list[float]) -> float:
    """Return the 99th percentile."""
    return quantiles(values, n=100)[98]


def rows_of_latency(what: str, seconds: list[float], *, bar_ms: float) -> list[Row]:
    """Return median and 99th percentile in milliseconds; the latter may be five times the bar."""
    in_ms = [value * 1000 for value in seconds]
    return [
        Row(f"{what}, median", median(in_ms), "ms", bar_ms),
        Row(f"{what}, 99th percentile", percentile_99(in_ms), "ms", 5 * bar_ms),
    ]
