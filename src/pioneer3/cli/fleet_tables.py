"""`pioneer3 fleet list`."""

import os
import sys
from contextlib import AsyncExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from pioneer3.cli.options import Flag, FleetFile, Seconds, fleet_of
from pioneer3.cli.process import busy_sign, until_told_to_leave, write_json
from pioneer3.errors import ConfigError

if TYPE_CHECKING:
    from rich.table import Table

    from pioneer3.fleet.live import Live, Questions
    from pioneer3.fleet.spec import FleetRobot

GOOD = {True: "green", False: "red", None: ""}
ASKED_EVERY = 5.0


@until_told_to_leave
async def list_(
    *names: Annotated[str, Parameter(negative=(), metavar="NAME")],
    fleet: FleetFile = None,
    offline: Flag = False,
    watch: Flag = False,
    every: Seconds = ASKED_EVERY,
    patience: Annotated[Seconds, Parameter(name="--timeout")] = 3.0,
    json: Flag = False,
) -> int:
    """List the robots, and the answers of each now.

    All are asked at once; one that is off delays nobody by more than the timeout.
    Nothing moves. A robot's own port is asked by a short session, so its motors are
    off afterwards; a robot with ros = "1" is asked by its node, which goes on, and
    one with ros = "2" by its topics on its [[network]].
    ROS_MASTER_URI is asked first, then the master of the operator's computer, then
    the one on each robot. The exit code is 1 if a computer does not answer, and 3
    if none does.

    Example: pioneer3 fleet list
    Example: pioneer3 fleet list p3at-1 --watch

    Args:
        names: Robots or groups; all if none is given.
        offline: Show the file alone; ask nobody.
        watch: Ask again and again; Ctrl-C ends it.
        every: Pause before asking again.
        patience: For each answer.
        json: Print JSON for programs: one array, or with --watch one a line.
    """
    from pioneer3.cli.fleet_ros import asking
    from pioneer3.fleet.host_facts import clocks
    from pioneer3.fleet.live import Questions
    from pioneer3.fleet.ros_graph import NodeAddress, master_of

    given = fleet_of(fleet)
    robots = given.select(names or ("all",))
    if not robots:
        raise ConfigError(f"{given.path}: it has no robot yet; add one as [[robot]]")
    if offline:
        _print(robots, None, json=json)
        return 0

    masters = (os.environ.get("ROS_MASTER_URI"), master_of(given))
    questions = Questions(
        timeout=patience,
        masters=tuple(NodeAddress.of(master) for master in masters if master),
        clock=clocks(),
        addresses=given.addresses,
    )

    async with AsyncExitStack() as stack:
        if any(robot.ros == "2" for robot in robots):
            questions = replace(questions, ros2=await stack.enter_async_context(asking(given)))
        if watch:
            return await _watch(robots, questions, every, json=json)
        return await _list(robots, questions, json=json)


async def _list(robots: "tuple[FleetRobot, ...]", questions: "Questions", *, json: bool) -> int:
    from pioneer3.fleet.live import exit_code, look

    with busy_sign(f"Asking {len(robots)} robots ..."):
        answers = await look(robots, questions)
    _print(robots, answers, json=json)
    return exit_code(answers)


async def _watch(
    robots: "tuple[FleetRobot, ...]", questions: "Questions", every: float, *, json: bool
) -> int:
    import asyncio

    from rich.live import Live as Screen

    from pioneer3.cli.terminal import Terminal
    from pioneer3.fleet.live import look

    if json or not sys.stdout.isatty():
        while True:
            _print(robots, await look(robots, questions), json=json)
            await asyncio.sleep(every)
    console = Terminal()
    with Screen(console=console, auto_refresh=False) as screen:
        while True:
            answers = await look(robots, questions)
            screen.update(table(robots, answers, console.width), refresh=True)
            await asyncio.sleep(every)


def _print(
    robots: "tuple[FleetRobot, ...]", answers: "tuple[Live, ...] | None", *, json: bool
) -> None:
    if json:
        live = answers or (None,) * len(robots)
        rows = zip(robots, live, strict=True)
        write_json([{"robot": robot, "live": told} for robot, told in rows])
        return
    from pioneer3.cli.terminal import Terminal

    console = Terminal(wide=True)
    console.print(table(robots, answers, console.width))


def table(
    robots: "tuple[FleetRobot, ...]", answers: "tuple[Live, ...] | None", width: int
) -> "Table":
    """Return the table of a fleet; without answers, that of the file."""
    from rich.table import Table
    from rich.text import Text

    from pioneer3.fleet.columns import shown

    titles, rows = shown(robots, answers, width)
    made = Table(box=None, pad_edge=False, header_style="bold")
    for title in titles:
        made.add_column(title, overflow="fold")
    for row in rows:
        made.add_row(*(Text(cell.text, GOOD[cell.ok]) for cell in row))
    return made
