"""What a check of a map has to say."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

MOST = 10
"""Remarks of one kind that are listed; the rest is counted."""


class Level(StrEnum):
    """How bad it is."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True, kw_only=True)
class Remark:
    """Something wrong with a map.

    Attributes:
        level: An error keeps it from being used.
        text: What is wrong, in one line.
        line: In the file, from 1; `None` where no line is to blame.
    """

    level: Level
    text: str
    line: int | None = None


def warning(text: str, line: int | None = None) -> Remark:
    """Return a warning."""
    return Remark(level=Level.WARNING, text=text, line=line)


def some(remarks: Iterable[Remark], what: str) -> Iterator[Remark]:
    """Yield the first :data:`MOST` of `remarks`, and how many more `what` there are."""
    found: Sequence[Remark] = tuple(remarks)
    yield from found[:MOST]
    if len(found) > MOST:
        yield Remark(level=found[0].level, text=f"and {len(found) - MOST} more {what}")
