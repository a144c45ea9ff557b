"""Output of work on many robots: lines that begin with a robot's name, and a summary."""

import asyncio
import re
import sys
from collections.abc import Sequence
from getpass import getpass
from typing import Final

from rich.console import Console
from rich.table import Table
from rich.text import Text

from pioneer3.errors import ConfigError
from pioneer3.fleet.key import WITHOUT_PASSWORDS
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


class Person:
    """Asks the person at the terminal; see :class:`pioneer3.fleet.key.Asker`.

    Args:
        accept_new: Accept all host keys that are new.
    """

    def __init__(self, *, accept_new: bool = False) -> None:
        self._accept_new = accept_new

    async def accepts_host_key(self, robot: Robot, fingerprint: str) -> bool:
        """Show a host key, and wait for an answer."""
        shown = f"{robot.name} ({robot.address}) has the host key {fingerprint}"
        if self._accept_new:
            sys.stderr.write(f"{shown}: kept.\n")
            return True
        _needs_terminal("to compare host keys (or give --accept-new)")
        sys.stderr.write(
            f"{shown},\nwhich is new here. A terminal on that computer shows its own with\n"
            "  ssh-keygen -lf /etc/ssh/ssh_host_ed25519_key.pub\n"
        )
        return (await asked("Are they the same? [yes/no] ")).lower() in {"y", "yes"}

    async def password(self, robots: Sequence[Robot]) -> str:
        """Ask for the password, without showing it."""
        _needs_terminal("to ask for the password")
        users = ", ".join(f"{robot.user}@{robot.name}" for robot in robots)
        return await asked(f"Password of {users} (it is not kept): ", hidden=True)


async def asked(question: str, *, hidden: bool = False) -> str:
    """Ask at the terminal; unlike `input` in a thread, this can be interrupted.

    Args:
        question: Ends in a space.
        hidden: Whether the answer is a secret, and not shown.
    """
    if sys.platform == "win32":  # its event loop cannot wait for a terminal
        return await asyncio.to_thread(getpass if hidden else input, question)
    import termios

    loop, ready, terminal = asyncio.get_running_loop(), asyncio.Event(), sys.stdin.fileno()
    before = termios.tcgetattr(terminal)
    quiet = termios.tcgetattr(terminal)
    quiet[3] &= ~termios.ECHO
    termios.tcsetattr(terminal, termios.TCSADRAIN, quiet if hidden else before)
    sys.stderr.write(question)
    sys.stderr.flush()
    loop.add_reader(terminal, ready.set)
    try:
        await ready.wait()
        answer = sys.stdin.readline()
    finally:
        loop.remove_reader(terminal)
        termios.tcsetattr(terminal, termios.TCSADRAIN, before)
        if hidden:
            sys.stderr.write("\n")
    return answer.rstrip("\n")


def _needs_terminal(why: str) -> None:
    if not sys.stdin.isatty():
        raise ConfigError(f"a terminal is needed {why}")


def show_password_advice(names: Sequence[str]) -> None:
    """Say how to switch passwords off where they still let people in."""
    if not names:
        return
    console = Console(stderr=True, highlight=False)
    console.print(
        Text(
            f"\n{', '.join(names)}: passwords let people in, too. Whoever knows the shared one can "
            "drive these robots. To switch passwords off, run on each, as a user who may use sudo:"
        )
    )
    console.print(Text(f"  {WITHOUT_PASSWORDS}", "cyan"), soft_wrap=True)
    console.print("Stay logged in there until a second login with your key has worked.")
