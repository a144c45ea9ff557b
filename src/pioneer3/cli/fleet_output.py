"""Output of work on many robots: lines that begin with a robot's name, and a summary."""

import asyncio
import re
import sys
from collections.abc import Mapping, Sequence
from getpass import getpass
from typing import Final

from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from pioneer3.cli.process import read_line, write_error, write_json
from pioneer3.cli.tables import findings_table
from pioneer3.cli.terminal import Terminal
from pioneer3.doctor.facts import Level
from pioneer3.errors import ConfigError
from pioneer3.fleet.doctor import Diagnosis
from pioneer3.fleet.host_checks import CLOCKS_DIFFER
from pioneer3.fleet.host_facts import HostFacts
from pioneer3.fleet.key import WITHOUT_PASSWORDS
from pioneer3.fleet.run import Outcome, exit_code
from pioneer3.fleet.spec import FleetRobot

ESCAPES: Final = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)|.)?")
"""Sequences that colour the text, or do worse to a terminal; they are left out."""
COLOURS: Final = ("cyan", "magenta", "green", "yellow", "blue", "bright_red", "bright_cyan")


class RobotLines:
    """Prints lines of robots as they come; those of standard error go there."""

    def __init__(self, robots: Sequence[FleetRobot]) -> None:
        width = max((len(robot.name) for robot in robots), default=0)
        self._prefixes = {
            robot.name: Text(f"{robot.name:{width}} | ", COLOURS[number % len(COLOURS)])
            for number, robot in enumerate(robots)
        }
        self._out = Terminal(soft_wrap=True)
        self._err = Terminal(soft_wrap=True, stderr=True)

    def show(self, robot: FleetRobot, line: str, is_error: bool) -> None:
        """Print one line."""
        console = self._err if is_error else self._out
        console.print(self._prefixes[robot.name] + Text(ESCAPES.sub("", line).expandtabs()))


def finish(outcomes: Sequence[Outcome], *, quiet: bool = False) -> int:
    """Print the summary to standard error; return the exit code.

    It is `quiet` about robots where all went well.
    """
    console = Terminal(stderr=True)
    failed = [each for each in outcomes if not each.ok]
    if not outcomes:
        console.print("No robot is meant: that group is empty.")
        return exit_code(outcomes)
    if failed or (not quiet and (len(outcomes) > 1 or outcomes[0].why)):
        console.print(outcome_table(failed if quiet else outcomes))
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
        table.add_row(each.robot, sign, f"{each.seconds:.1f} s", Text(each.why))
    return table


def print_json(value: object, outcomes: Sequence[Outcome]) -> int:
    """Print `value` with the reasons of failures; return the exit code."""
    problems = {each.robot: each.why for each in outcomes if not each.ok}
    write_json({"robots": value, "problems": problems}, indent=2)
    return exit_code(outcomes)


def status_table(facts: Mapping[str, HostFacts]) -> Table:
    """Return a row for each robot's computer that was reached."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("robot", "up", "clock", "load", "disk free", "pioneer3", "service", "ROS"):
        table.add_column(heading, no_wrap=heading == "robot")
    for name, each in facts.items():
        offset = each.clock_offset or 0.0
        table.add_row(
            name,
            _hours(each.up),
            Text(f"{offset:+.2f} s", "bold yellow" if abs(offset) > CLOCKS_DIFFER else ""),
            "-" if each.load is None else f"{each.load:.1f}",
            "-" if each.free is None else f"{each.free / 1e9:.1f} GB",
            each.version or "-",
            each.service or "-",
            " ".join(each.ros) or "-",
        )
    return table


def _hours(seconds: float | None) -> str:
    if seconds is None:
        return "-"
    minutes, hours = seconds // 60 % 60, seconds // 3600
    return f"{hours / 24:.0f} days" if hours >= 48 else f"{hours:.0f}:{minutes:02.0f} h"


def print_diagnoses(diagnoses: Sequence[Diagnosis], *, every: bool) -> None:
    """Print the findings about each robot's computer; `every` one, or those that are not well."""
    console = Terminal()
    for each in diagnoses:
        well = [finding for finding in each.findings if finding.level is Level.OK]
        shown = each.findings if every else [f for f in each.findings if f not in well]
        console.print(Text(each.robot, "bold"), Text(f"{len(well)} checks are well", "green"))
        if shown:
            console.print(Padding(findings_table(shown), (0, 0, 0, 2)))


class TerminalAsker:
    """Asks the person at the terminal; see :class:`pioneer3.fleet.key.Asker`.

    It accepts all host keys that are new with `accept_new`.
    """

    def __init__(self, *, accept_new: bool = False) -> None:
        self._accept_new = accept_new

    async def accepts_host_key(self, robot: FleetRobot, fingerprint: str) -> bool:
        """Show a host key, and wait for an answer."""
        shown = f"{robot.name} ({robot.address}) has the host key {fingerprint}"
        if self._accept_new:
            write_error(f"{shown}: kept.")
            return True
        _needs_terminal("to compare host keys (or give --accept-new)")
        write_error(
            f"{shown},\nwhich is new here. A terminal on that computer shows its own with\n"
            "  ssh-keygen -lf /etc/ssh/ssh_host_ed25519_key.pub"
        )
        return (await asked("Are they the same? [yes/no] ")).lower() in {"y", "yes"}

    async def password(self, robots: Sequence[FleetRobot]) -> str:
        """Ask for the password, without showing it."""
        _needs_terminal("to ask for the password")
        users = ", ".join(f"{robot.user}@{robot.name}" for robot in robots)
        return await asked(f"Password of {users} (it is not kept): ", hidden=True)


async def asked(question: str, *, hidden: bool = False) -> str:
    """Ask at the terminal; unlike `input` in a thread, this can be interrupted.

    The question ends in a space; a `hidden` answer is a secret, and not shown.
    """
    if sys.platform == "win32":  # its event loop cannot wait for a terminal
        return await asyncio.to_thread(getpass if hidden else input, question)
    import termios

    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)
    quiet = termios.tcgetattr(terminal)
    quiet[3] &= ~termios.ECHO
    termios.tcsetattr(terminal, termios.TCSADRAIN, quiet if hidden else before)
    write_error(question, end="")
    try:
        return (await read_line()).rstrip("\n")
    finally:
        termios.tcsetattr(terminal, termios.TCSADRAIN, before)
        if hidden:
            write_error("")


def _needs_terminal(why: str) -> None:
    if not sys.stdin.isatty():
        raise ConfigError(f"a terminal is needed {why}")


def show_password_advice(names: Sequence[str]) -> None:
    """Say how to switch passwords off where they still let people in."""
    if not names:
        return
    console = Terminal(stderr=True)
    console.print(
        Text(
            f"\n{', '.join(names)}: passwords let people in, too. Whoever knows the shared one can "
            "drive these robots. To switch passwords off, run on each, as a user who may use sudo:"
        )
    )
    console.print(Text(f"  {WITHOUT_PASSWORDS}", "cyan"), soft_wrap=True)
    console.print("Stay logged in there until a second login with your key has worked.")
