"""Times in a log, as people tell them."""

import re
from datetime import datetime, timedelta
from math import isfinite
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.names import printable
from pioneer3.units import DURATION

Moment = float | str
"""Time in a log: seconds after it began, the same with a unit such as `90s`, or a time of day,
before which the date may stand."""
TIME_OF_DAY: Final = re.compile(r"\d{1,2}:\d\d(:\d\d(\.\d{1,9})?)?", re.ASCII)
"""Form of a time of day."""
DATED: Final = re.compile(r"\d{4}-\d\d-\d\d[ T]\d\d:\d\d.*", re.ASCII)
"""Form of a time with its date, as `log verify` tells it."""
FARTHEST: Final = 1e9
"""Longest time after the beginning that is understood [s]: 30 years."""


def time_of(moment: Moment, began: int) -> int:
    """Return a moment of a log that `began` at a time; both in ns since 1970.

    Times of day are those of this computer.

    Raises:
        ConfigError: It is no time.
    """
    if isinstance(moment, str) and TIME_OF_DAY.fullmatch(moment):
        return _by_clock(moment, began)
    try:
        if isinstance(moment, str) and DATED.fullmatch(moment):
            return round(datetime.fromisoformat(moment).timestamp() * 1e9)
        seconds = DURATION.read(moment) if isinstance(moment, str) else float(moment)
    except ValueError as error:
        raise ConfigError(f"{error}; or as a time of day, 14:02:10") from None
    if not isfinite(seconds) or abs(seconds) > FARTHEST:
        raise ConfigError(f"{printable(str(moment))}: no log is so long")
    return began + round(seconds * 1e9)


def _by_clock(text: str, began: int) -> int:
    first = datetime.fromtimestamp(began / 1e9)  # without a zone: clocks are set on some days
    hour, minute, second = (*text.split(":"), "0")[:3]
    whole, _, part = second.partition(".")
    try:
        when = first.replace(hour=int(hour), minute=int(minute), second=int(whole), microsecond=0)
    except ValueError:
        raise ConfigError(f"{text}: there is no such time of day") from None
    today = when.replace(fold=0), when.replace(fold=1)  # an hour that comes twice
    earliest = began / 1e9 - 1
    later = (each for each in today if each.timestamp() >= earliest)
    when = next(later, today[0] + timedelta(days=1))  # it began before midnight
    return round(when.timestamp()) * 10**9 + int(part.ljust(9, "0")[:9] or 0)
