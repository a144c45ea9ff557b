"""Output of work on many robots: lines that begin with a robot's name, and a summary."""

import re
from collections.abc import Sequence
from typing import Final

from rich.console import Console
from rich.table import Table
from rich.text import Text

from pioneer3.fleet.run import Outcome, exit_code
from pioneer3.fleet.spec import Robot

ESCAPES: Final = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)|.)?")
"""Sequences that colour the text, or do worse to a terminal."""
COLOURS: Final = ("cyan", "magenta", "green", "yellow", "blue", "bright_red", "bright_cyan")


class Lines:
    """Prints lines of robots as they come; those of standard error go there."""

    def __init__(self, robots: Sequence[Robot]) -> None:
        width = max((len(robot.name) for robot in robots), default=0)
        self._prefixes = {
            robot.name: Text(f"{robot.name:{width}} | ", COLOURS[number % len(COLOURS)])
            for number, robot in enumerate(robots)
        }
        self._out = Console(highlight=False, soft_wrap=True)
        self._err = Console(highlight=False, soft_wrap=True, stderr=True)

    def show(self, robot: Robot, line: str, is_error: bool) -> None:
        """Print one line."""
        console = self._err if is_error else self._out
        console.print(self._prefixes[robot.name] + Text(printable(line)))


def printable(line: str) -> str:
    """Return `line` without what a terminal would obey."""
    if line.isprintable():
        return line
    plain = ESCAPES.sub("", line).expandtabs()
    return "".join(letter if letter.isprintable() else "\ufffd" for letter in plain)


def finish(outcomes: Sequence[Outcome]) -> int:
    """Print the summary to standard error; return the exit code."""
    console = Console(stderr=True, highlight=False)
    failed = [each for each in outcomes if not each.ok]
    if not outcomes:
        console.print("No robot is meant: that group is empty.")
        return exit_code(outcomes)
    if len(outcomes) > 1 or failed:
        console.print(outcome_table(outcomes))
    if failed:
        names = ", ".join(each.robot for each in failed)
        console.print(Text(f"{len(failed)} of {len(outcomes)} failed: {names}", "bold red"))
    return exit_code(outcomes)


def outcome_table(outcomes: Sequence[Outcome]) -> Table:
    """Return a row for each robot."""
    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(no_wrap=True)
    table.add_column(justify="right", no_wrap=True, style="dim")
    table.add_column(overflow="fold")
    for each in outcomes:
        sign = Text("ok", "green") if each.ok else Text("FAIL", "bold red")
        if not each.reached:
            sign = Text("NOT REACHED", "bold red")
        table.add_row(each.robot, sign, f"{each.seconds:.1f} s", Text(printable(each.why)))
    return table
