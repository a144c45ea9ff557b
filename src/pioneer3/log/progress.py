"""The progress of reading a log."""

from collections.abc import Callable, Iterable, Iterator

from pioneer3.log.reader import LogInfo, LogMessage

Tell = Callable[[float], None]
"""Told how much of a log was read, from 0 to 1."""


def followed(messages: Iterable[LogMessage], known: LogInfo, tell: Tell) -> Iterator[LogMessage]:
    """Yield messages of a log, and tell each hundredth of it."""
    step = max(1, known.ended - known.began) // 100 + 1
    told = -1
    for message in messages:
        if (done := (message.time - known.began) // step) > told:
            told = done
            tell(min(1.0, max(0, done) / 100))
        yield message
