"""`pioneer3 log stats`: figures of runs."""

from collections.abc import Iterator
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING

from pioneer3.cli.options import Flag
from pioneer3.cli.process import write_json, write_line, write_warning
from pioneer3.errors import PioneerError
from pioneer3.units import MS

if TYPE_CHECKING:
    from pioneer3.analysis.open_log import OpenLog
    from pioneer3.analysis.stats import RobotStats


def stats(*names: str, json: Flag = False) -> int:
    """Add up what robots did: way, time under way, stops, losses of the link.

    Example: pioneer3 log stats drive
    Example: pioneer3 log stats lab/*.mcap --json

    Args:
        names: Of the logs; without one, all of yours.
        json: Print JSON.
    """
    from rich.table import Table

    from pioneer3.analysis.stats import stats_of
    from pioneer3.cli.terminal import Terminal
    from pioneer3.log import open as open_log
    from pioneer3.log.folder import has_messages, logs_folder, user_logs
    from pioneer3.names import printable

    found, failed = [], 0
    read: set[Path] = set()
    for name in names or map(str, filter(has_messages, user_logs(logs_folder()))):
        try:
            log = open_log(name)
            if log.path in read:  # another file of it
                continue
            read |= {log.path, *log.more}
            found.append((log, stats_of(log)))
        except PioneerError as error:
            write_warning(str(error))
            failed = 1
    if json:
        write_json([_facts(log, robots) for log, robots in found])
        return failed
    if not names and not found:
        write_line(f"No logs in {logs_folder()}.")
    terminal = Terminal()
    for log, robots in found:
        for robot in robots:
            grid = Table.grid(padding=(0, 2))
            grid.add_column(no_wrap=True)
            grid.add_column(overflow="fold")
            for label, words in _rows(log, robot):
                grid.add_row(label, printable(words))
            terminal.print(grid)
            terminal.print()
    return failed


def _facts(log: "OpenLog", robots: "list[RobotStats]") -> dict[str, object]:
    known = log.info()
    return {
        "file": str(log.path),
        "began": known.began / 1e9,
        "seconds": known.seconds,
        "robots": robots,
    }


def _rows(log: "OpenLog", robot: "RobotStats") -> Iterator[tuple[str, str]]:
    """Yield labels and words."""
    seconds = log.info().seconds
    yield "log", log.path.name
    yield "robot", f"{robot.robot}, {robot.reports} reports"
    yield "way", f"{robot.distance:.1f} m, turned {degrees(robot.turned):.0f}°"
    yield "under way", f"{robot.under_way:.0f} s of {seconds:.0f} s, up to {robot.fastest:.2f} m/s"
    yield "stops", str(robot.stops.total())
    for reason, count in robot.stops.most_common():
        yield "", f"{count} x {reason}"
    counts = {
        "emergency stops": robot.emergency_stops,
        "stalls": robot.stalls,
        "bumps": robot.bumps,
        "links lost": robot.link_losses,
    }
    yield from ((label, str(count)) for label, count in counts.items())
    if robot.report_to_decision is not None:
        wire = robot.report_to_wire
        later = f", {wire / MS:.0f} ms to the robot" if wire is not None else ""
        yield "slowest answer", f"{robot.report_to_decision / MS:.0f} ms to a decision{later}"
    if robot.voltage is not None:
        first, last = robot.voltage
        yield "battery", f"{first:.1f} V to {last:.1f} V"
