"""The report of `pioneer3 ros2 check` in a terminal."""

import re
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Final

from rich.table import Table
from rich.text import Text

from pioneer3.cli.tables import SIGNS
from pioneer3.doctor.facts import Level
from pioneer3.ros.checks.facts import CheckReport, CheckRow, ReportPart

HEADS: Final = {
    ReportPart.NODE: "node",
    ReportPart.PUBLISHED: "publishes",
    ReportPart.SUBSCRIBED: "subscribes to",
    ReportPart.SERVICE: "services",
}
NUMBERED: Final = re.compile(r"(.*?)\d+")
PACKAGE: Final = re.compile(r"\b\w+/(?:msg|srv)/")
WIDTHS: Final = (18, 18, 15)
"""Widths of the first columns where the terminal is narrow."""
NARROW: Final = 120
COLORS: Final = {Level.OK: "green", Level.WARN: "yellow", Level.FAIL: "red"}


def table(report: CheckReport, width: int) -> Table:
    """Return the rows of a report, but for the parts that the robot is without."""
    made = Table(box=None, pad_edge=False, header_style="bold")
    for title, most in zip(("topic", "expected", "found"), WIDTHS, strict=True):
        made.add_column(title, overflow="fold", max_width=most if width < NARROW else None)
    made.add_column("verdict", overflow="fold")
    order = list(HEADS)
    present = (row for row in report.rows if not row.absent)
    there = sorted(present, key=lambda row: order.index(row.part))
    for part, rows in groupby(there, key=lambda row: row.part):
        made.add_row(Text(HEADS[part], "bold"))
        for each in _together(list(rows)):
            made.add_row(
                Text(f" {_name(each, report)}"),
                Text(PACKAGE.sub("", each[0].expected), "dim"),
                Text(_found(each)),
                verdict(each[0]),
            )
    return made


def verdict(row: CheckRow) -> Text:
    """Return the severity of a row, its reasons and advice."""
    if not row.faults:
        return SIGNS[row.level]
    lines = []
    for fault in row.faults:
        example = f" ({fault.example})" if fault.example else ""
        reason = PACKAGE.sub("", fault.reason + example)
        lines.append(Text.assemble(SIGNS[fault.level], " ", (reason, COLORS[fault.level])))
        if fault.advice:
            lines.append(Text(f"→ {fault.advice}", "cyan"))
    return Text("\n").join(lines)


def absent_line(report: CheckReport) -> Text | None:
    """Return a sentence about the parts that the robot is without; `None` for none."""
    parts: dict[str, list[Sequence[CheckRow]]] = {}
    absent = [row for row in report.rows if row.absent]
    for each in _together(absent):
        parts.setdefault(each[0].absent, []).append(each)
    if not parts:
        return None
    told = (
        f"{part} ({', '.join(_name(each, report) for each in rows)})"
        for part, rows in parts.items()
    )
    return Text(f"\nWithout: {', '.join(told)}.", "dim")


def summary(report: CheckReport) -> Text:
    """Return the sum of it in one line."""
    wrong, odd = report.count(Level.FAIL), report.count(Level.WARN)
    rows = sum(not row.absent for row in report.rows)
    head = f"\n{report.node}: {rows} things checked in {report.seconds:.0f} s"
    if wrong:
        return Text(f"{head}, {wrong} wrong, {odd} to look at.", "bold red")
    if odd:
        return Text(f"{head}, none wrong, {odd} to look at.", "bold yellow")
    return Text(f"{head}, all right.", "bold green")


def _together(rows: Sequence[CheckRow]) -> Iterator[Sequence[CheckRow]]:
    """Yield the rows, those together that differ in a number only."""
    for _, same in groupby(rows, key=_kind):
        yield list(same)


def _kind(row: CheckRow) -> tuple[object, ...]:
    match = NUMBERED.fullmatch(row.name)
    name = (match[1], "N") if match else (row.name,)
    return (name, row.expected, row.absent, row.faults)


def _name(rows: Sequence[CheckRow], report: CheckReport) -> str:
    """Return the name below the robot's namespace; of several rows with both ends."""
    space = report.node.rpartition("/")[0]
    names = [row.name.removeprefix(f"{space}/") for row in rows]
    if len(names) == 1:
        return names[0]
    last = re.search(r"\d+$", names[-1])
    return f"{names[0]}…{last[0] if last else names[-1]}"


def _found(rows: Sequence[CheckRow]) -> str:
    rates = sorted(row.rate for row in rows if row.rate is not None)
    if len(rows) == 1 or not rates:
        return PACKAGE.sub("", rows[0].found)
    low, high = f"{rates[0]:.1f}", f"{rates[-1]:.1f}"
    return f"{low} Hz" if low == high else f"{low} to {high} Hz"
