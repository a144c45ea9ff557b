"""The table of a fleet, column by column: the contents of each, and its meaning."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Final, Generic, TypeVar

from pioneer3.fleet.live import Live, SshAnswer
from pioneer3.fleet.spec import FleetRobot

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class TableCell:
    """A text, and whether it is good news; `None` for neither."""

    text: str
    ok: bool | None = None


@dataclass(frozen=True, slots=True)
class Column(Generic[T]):
    """A column of the table: title, meaning for the reference, and its cell of a robot."""

    title: str
    meaning: str
    of: Callable[[T], TableCell]


NOTHING: Final = "-"
LEAST: Final = ("note", "model", "laser", "port", "ROS graph", "ROS", "host")
"""Columns that a narrow terminal can do without, the first of them first."""
GAP: Final = 2
"""Between two columns."""
COLUMNS: Final[tuple[Column[FleetRobot], ...]] = (
    Column("name", "of the robot", lambda robot: TableCell(robot.name)),
    Column("host", "name of its computer, if another", lambda robot: TableCell(robot.host)),
    Column("address", "of its computer", lambda robot: TableCell(robot.address)),
    Column(
        "port",
        "the robot's own, and that of its bridge",
        lambda robot: TableCell(f"{robot.port} {robot.bridge}" if robot.bridge else robot.port),
    ),
    Column("model", "its type", lambda robot: TableCell(robot.model)),
    Column("laser", "as `--laser` takes it", lambda robot: TableCell(robot.laser)),
    Column("ROS", "version on its computer", lambda robot: TableCell(robot.ros)),
    Column("note", "for people", lambda robot: TableCell(robot.note)),
)


LIVE_COLUMNS: Final[tuple[Column[Live], ...]] = (
    Column(
        "up",
        "its computer answers on TCP port 22, if only to refuse",
        lambda live: _answer(live.up),
    ),
    Column("ssh", "its ssh server answers", lambda live: _answer(live.ssh)),
    Column(
        "driver",
        "its ROS node is on the graph and answers; else its own TCP port does",
        lambda live: _answer(live.driver),
    ),
    Column("battery", "as the robot tells it", lambda live: _battery(live.battery)),
    Column(
        "motors",
        "whether they have power",
        lambda live: TableCell(NOTHING if live.motors is None else "on" if live.motors else "off"),
    ),
    Column(
        "e-stop",
        "whether the emergency stop is latched or the robot's button pressed, as ROS 2 tells it",
        lambda live: _stopped(live.stopped),
    ),
    Column(
        "age",
        "of its newest odometry over ROS 2, by its clock and this computer's",
        lambda live: _age(live.age),
    ),
    Column(
        "ROS graph",
        "the master that answers, or the network of ROS 2",
        lambda live: _answer(live.ros),
    ),
    Column(
        "clock", "how far its clock is ahead of this computer's", lambda live: _clock(live.clock)
    ),
)
WARN_VOLTAGE: Final = 11.5
"""Below it a 12 V battery wants its charger [V]."""
WARN_CLOCK: Final = 0.1
"""Transforms of ROS are late or early beyond this [s]."""
WARN_AGE: Final = 1.0
"""Ten odometry messages come each second; one is old beyond this [s]."""
OLDEST_SHOWN: Final = 1000.0


def _answer(answer: SshAnswer) -> TableCell:
    return TableCell(answer.said or NOTHING, answer.ok)


def _battery(voltage: float | None) -> TableCell:
    if voltage is None:
        return TableCell(NOTHING)
    return TableCell(f"{voltage:.1f} V", voltage >= WARN_VOLTAGE)


def _stopped(stopped: bool | None) -> TableCell:
    if stopped is None:
        return TableCell(NOTHING)
    return TableCell("STOP" if stopped else "no", not stopped)


def _age(seconds: float | None) -> TableCell:
    if seconds is None:
        return TableCell(NOTHING)
    shown = f"{seconds:z.1f} s" if seconds < OLDEST_SHOWN else "very old"
    return TableCell(shown, abs(seconds) <= WARN_AGE)


def _clock(ahead: float | None) -> TableCell:
    if ahead is None:
        return TableCell(NOTHING)
    return TableCell(f"{ahead:+.3f} s", abs(ahead) <= WARN_CLOCK)


def shown(
    robots: Sequence[FleetRobot], answers: Sequence[Live] | None, width: float = inf
) -> tuple[tuple[str, ...], tuple[tuple[TableCell, ...], ...]]:
    """Return the titles and rows of the table, which has room for `width` characters.

    Columns in which no robot has anything are left out, and those of :data:`LEAST`, in their order,
    until the rest fits. `answers` are those of the same robots; `None` if nobody was asked.
    """
    columns = {one.title: [one.of(robot) for robot in robots] for one in COLUMNS}
    if all(robot.host == robot.name for robot in robots):
        del columns["host"]
    if answers is not None:
        columns |= {one.title: [one.of(told) for told in answers] for one in LIVE_COLUMNS}
    columns = {
        title: cells
        for title, cells in columns.items()
        if any(cell.text not in {"", NOTHING} for cell in cells)
    }
    for title in LEAST:
        if _width(columns) > width:
            columns.pop(title, None)
    return tuple(columns), tuple(zip(*columns.values(), strict=True))


def _width(columns: Mapping[str, Sequence[TableCell]]) -> int:
    return sum(
        max(len(title), *(len(cell.text) for cell in cells)) + GAP
        for title, cells in columns.items()
    )
