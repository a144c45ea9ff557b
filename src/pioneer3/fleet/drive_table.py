"""The table of robots that are driven, column by column; each has words for its colours."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import degrees
from typing import Final

from pioneer3.fleet.columns import TableCell
from pioneer3.fleet.members import Member, Reached
from pioneer3.robot.explain import Reason, ReasonKind
from pioneer3.teleop.several import Selection

WIDEST_NAME: Final = 16
OLD: Final = 0.5
"""A robot's report is old after this [s]; ten come each second."""


@dataclass(frozen=True, slots=True)
class Look:
    """A robot, and the keys' choice of robots, at one instant [s, monotonic]."""

    member: Member
    selection: Selection
    now: float


@dataclass(frozen=True, slots=True)
class DriveColumn:
    """A column of so many characters; 0 for the room that is left."""

    title: str
    meaning: str
    width: int
    of: Callable[[Look], TableCell]


def _keys(look: Look) -> TableCell:
    name, marked = look.member.name, look.selection.marked
    if marked is not None and name in marked:
        return TableCell("marked", True)
    return TableCell("drives", True) if name in look.selection.chosen else TableCell("")


def _state(look: Look) -> TableCell:
    member = look.member
    if member.told is not None and member.told.age > OLD:
        return TableCell(f"old {member.told.age:.1f} s", False)
    if member.reached is Reached.CONNECTED:
        return TableCell(member.reached.value, True)
    return TableCell(f"{member.reached.value} {_time(look.now - member.since)}", False)


def _time(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 99.5 else f"{seconds / 60:.0f} min"


def _motion(look: Look) -> TableCell:
    told = look.member.told
    return TableCell(f"{told.speed:z5.2f} {degrees(told.turn_rate):z4.0f}" if told else "-")


def _motors(look: Look) -> TableCell:
    told = look.member.told
    return TableCell("-" if told is None else "on" if told.motors else "off")


def _battery(look: Look) -> TableCell:
    told = look.member.told
    if told is None:
        return TableCell("-")
    return TableCell(f"{told.voltage:.1f}{' LOW' if told.low else ''}", not told.low)


def _why(look: Look) -> TableCell:
    why = why_of(look.member)
    if why is None or why.kind is ReasonKind.IDLE:
        return TableCell("")
    if why.wants_help:
        return TableCell(ADDRESS.sub("", why.text), False)
    return TableCell(why.text)


def why_of(member: Member) -> Reason | None:
    """Return the trouble of a robot, or the reason that it stands; `None` while it moves."""
    if member.told is None:
        return Reason(ReasonKind.FAULT, member.why) if member.why else None
    return TAKEN if member.told.taken else member.told.stands


COLUMNS: Final = (
    DriveColumn("keys", "drives with the keys, or is marked to do so next", 6, _keys),
    DriveColumn(
        "nr", "its number", 3, lambda look: TableCell(look.selection.label(look.member.name))
    ),
    DriveColumn("robot", "its name", 0, lambda look: TableCell(look.member.name)),
    DriveColumn(
        "state", "whether it is connected, and its report is not old; else since when", 12, _state
    ),
    DriveColumn(" m/s deg/s", "how it moves", 10, _motion),
    DriveColumn("motors", "whether they have power", 6, _motors),
    DriveColumn("volt", "of the battery", 8, _battery),
    DriveColumn("why", "its trouble, or the reason that it stands", 0, _why),
)
TAKEN: Final = Reason(ReasonKind.NORMAL, "another program drives it; only stops count")
GAP: Final = 1
ADDRESS: Final = re.compile(r"^\w+://\S+: ")
"""Errors of links begin with it; the file has it, and the row little room."""


def widths(names: Sequence[str], columns: int) -> tuple[int, ...]:
    """Return the width of each column for robots with these names, on so many columns."""
    longest = min(WIDEST_NAME, max(map(len, names), default=0))
    fixed = [
        column.width or (max(5, longest) if column.title == "robot" else 0) for column in COLUMNS
    ]
    rest = columns - sum(fixed) - GAP * (len(COLUMNS) - 1)
    return (*fixed[:-1], max(1, rest))


def cells(look: Look) -> tuple[TableCell, ...]:
    """Return the row of a robot."""
    return tuple(column.of(look) for column in COLUMNS)


def headline(looks: Sequence[Look], *, emergency: bool) -> str:
    """Return how many robots there are, and how many of them are not well."""
    counts = dict.fromkeys(Reached, 0)
    for look in looks:
        counts[look.member.reached] += 1
    moving = sum(1 for look in looks if look.member.told and look.member.told.stands is None)
    words = [f"{count} {kind}" for kind, count in counts.items() if count]
    latched = "   EMERGENCY STOP is latched" if emergency else ""
    return f"{len(looks)} robots: {', '.join(words)}; {moving} move{latched}"
