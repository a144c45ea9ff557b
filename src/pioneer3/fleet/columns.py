"""The table of a fleet, column by column: what each says about a robot, and its meaning."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from pioneer3.fleet.live import Answer, Live
from pioneer3.fleet.spec import Robot


@dataclass(frozen=True, slots=True)
class Cell:
    """A text, and whether it is good news; `None` for neither."""

    text: str
    ok: bool | None = None


@dataclass(frozen=True, slots=True)
class Column:
    """A column of the table.

    Attributes:
        title: Above it.
        meaning: For the reference.
        of: Returns its cell for a robot.
    """

    title: str
    meaning: str
    of: Callable[[Robot], Cell]


@dataclass(frozen=True, slots=True)
class LiveColumn:
    """A column of what a robot answered.

    Attributes:
        title: Above it.
        meaning: For the reference.
        of: Returns its cell for the answers of a robot.
    """

    title: str
    meaning: str
    of: Callable[[Live], Cell]


COLUMNS: Final = (
    Column("name", "of the robot", lambda robot: Cell(robot.name)),
    Column("host", "name of its computer", lambda robot: Cell(robot.host)),
    Column("address", "of its computer", lambda robot: Cell(robot.address)),
    Column("port", "the robot's own", lambda robot: Cell(robot.port)),
    Column("model", "its type", lambda robot: Cell(robot.model)),
    Column("laser", "as `--laser` takes it", lambda robot: Cell(robot.laser)),
    Column("ROS", "version on its computer", lambda robot: Cell(robot.ros)),
    Column("note", "for people", lambda robot: Cell(robot.note)),
)
LIVE_COLUMNS: Final = (
    LiveColumn(
        "up",
        "its computer answers on TCP port 22, if only to refuse",
        lambda live: _answer(live.up),
    ),
    LiveColumn("ssh", "its ssh server answers", lambda live: _answer(live.ssh)),
    LiveColumn(
        "driver",
        "its ROS node is on the graph and answers; else its own TCP port does",
        lambda live: _answer(live.driver),
    ),
    LiveColumn("battery", "as the robot tells it", lambda live: _battery(live.battery)),
    LiveColumn(
        "motors",
        "whether they have power",
        lambda live: Cell("-" if live.motors is None else "on" if live.motors else "off"),
    ),
    LiveColumn("ROS graph", "the master that answers", lambda live: _answer(live.ros)),
)
CLOCK: Final = LiveColumn(
    "clock",
    "how far its clock is ahead of this computer's",
    lambda live: _clock(live.clock),
)
WARN_VOLTAGE: Final = 11.5
"""Below it a 12 V battery wants its charger [V]."""
WARN_CLOCK: Final = 0.1
"""Transforms of ROS are late or early beyond this [s]."""


def _answer(answer: Answer) -> Cell:
    return Cell(answer.said or "-", answer.ok)


def _battery(voltage: float | None) -> Cell:
    if voltage is None:
        return Cell("-")
    return Cell(f"{voltage:.1f} V", voltage >= WARN_VOLTAGE)


def _clock(ahead: float | None) -> Cell:
    if ahead is None:
        return Cell("-")
    return Cell(f"{ahead:+.3f} s", abs(ahead) <= WARN_CLOCK)


def shown(
    robots: Sequence[Robot], answers: Sequence[Live] | None
) -> tuple[tuple[str, ...], tuple[tuple[Cell, ...], ...]]:
    """Return the titles and rows of the table; columns in which no robot has anything are left out.

    Args:
        robots: One row each.
        answers: Of the same robots; `None` if nobody was asked.
    """
    static = tuple(tuple(column.of(robot) for column in COLUMNS) for robot in robots)
    titles = tuple(column.title for column in COLUMNS)
    live: tuple[LiveColumn, ...] = () if answers is None else LIVE_COLUMNS
    if any(told.clock is not None for told in answers or ()):
        live = (*live, CLOCK)
    told_cells = tuple(tuple(column.of(told) for column in live) for told in answers or ())
    rows = (
        static
        if answers is None
        else tuple((*left, *right) for left, right in zip(static, told_cells, strict=True))
    )
    titles = (*titles, *(column.title for column in live))
    kept = [n for n in range(len(titles)) if any(row[n].text not in {"", "-"} for row in rows)]
    return tuple(titles[n] for n in kept), tuple(tuple(row[n] for n in kept) for row in rows)
