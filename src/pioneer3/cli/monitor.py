"""`pioneer3 monitor`."""

import sys
from collections.abc import Awaitable
from math import inf
from typing import TYPE_CHECKING

from pioneer3.cli.live import looks, lost, watch
from pioneer3.cli.options import LINK, Flag, LinkOptions, Seconds
from pioneer3.cli.process import run_until_told_to_leave, write_json, write_line

if TYPE_CHECKING:
    from pioneer3.robot.lasers.driver import LaserDriver
    from pioneer3.runtime.robot import Robot
    from pioneer3.state import Snapshot


def monitor(
    *,
    link: LinkOptions = LINK,
    seconds: Seconds | None = None,
    raw: Flag = False,
    json: Flag = False,
) -> int:
    """Show live everything the robot says; Ctrl-C ends it.

    Nothing moves, and the motors stay off. On a terminal it is a screen, else a
    line for each reading. A lost link is shown, in JSON by a snapshot or report
    that is null; if it is still lost at the end, the exit code is 1. In JSON each
    scan of a laser is an object of its own.

    Example: pioneer3 monitor --port /dev/ttyUSB0

    Args:
        seconds: End after this time.
        raw: One line for each report, as the robot sent it.
        json: One JSON object for each reading (with --raw: report), a line each.
    """
    length = inf if seconds is None else seconds
    if raw:
        return run_until_told_to_leave(_raw(link, length, json=json))
    return run_until_told_to_leave(_monitor(link, length, json=json))


async def _monitor(link: LinkOptions, seconds: float, *, json: bool) -> int:
    async with link.connect(auto_enable=False, shown=True) as robot:
        if json:
            return await _print_json(robot, seconds)
        if sys.stdout.isatty():
            return await _show_screen(robot, seconds)
        return await _print_lines(robot, seconds)


async def _print_json(robot: "Robot", seconds: float) -> int:
    from pioneer3.tasks import running

    def show(snapshot: "Snapshot | None" = None) -> None:
        why = robot.why_not_moving()
        write_json({"snapshot": snapshot, "why_not_moving": why and why.text})

    async def show_scans(laser: "LaserDriver") -> None:
        async for scan in laser.values():
            write_json({"laser": laser.name, "scan": scan})

    async with running(*(show_scans(laser) for laser in _lasers(robot))):
        return await watch(robot, seconds, show, show)


def _lasers(robot: "Robot") -> "list[LaserDriver]":
    """Return the lasers at this computer."""
    from pioneer3.robot.lasers.driver import LaserDriver

    return [laser for laser in robot.lasers if isinstance(laser, LaserDriver)]


async def _print_lines(robot: "Robot", seconds: float) -> int:
    from pioneer3.cli.screen import line

    lasers = _lasers(robot)
    return await watch(
        robot,
        seconds,
        lambda snapshot: write_line("  ".join([line(snapshot), *(o.words for o in lasers)])),
        lambda: write_line(lost(robot)),
    )


async def _show_screen(robot: "Robot", seconds: float) -> int:
    from rich.live import Live
    from rich.text import Text

    from pioneer3.cli.screen import screen
    from pioneer3.cli.terminal import Terminal

    console, code, lasers = Terminal(), 0, _lasers(robot)
    with Live(console=console, screen=True, auto_refresh=False) as live:
        async for snapshot in looks(robot, seconds):
            status = robot.supervisor.status.latest
            why = robot.why_not_moving()
            view = screen(
                robot.info,
                robot.snapshot,
                why,
                status,
                width=console.width,
                lasers=[Text(o.words, "bold red" if o.lost else "") for o in lasers],
            )
            live.update(view, refresh=True)
            code = 1 if snapshot is None else 0
    return code


async def _raw(link: LinkOptions, seconds: float, *, json: bool) -> int:
    import asyncio

    from pioneer3.arcos.reports import Report
    from pioneer3.doctor.decoding_link import DecodingLink, described
    from pioneer3.links import Link, opener
    from pioneer3.navigation.connect import connect_async

    began = asyncio.get_running_loop().time()

    def tell(stamp: float, report: Report) -> None:
        if json:
            kind = type(report).__name__
            write_json({"time": stamp - began, "report": kind, "fields": report})
        else:
            write_line(f"{stamp - began:9.3f} {described(report)}")

    open_ = opener(link.url, baud=link.baud)

    async def opened() -> Link:
        return DecodingLink(await open_(), tell)

    def overhear() -> Awaitable[Link]:
        return asyncio.ensure_future(opened())

    async with connect_async(
        overhear, auto_enable=False, record=link.log.where(watches=True), model=link.given_model
    ) as robot:

        def gone() -> None:
            time = asyncio.get_running_loop().time() - began
            if json:
                write_json({"time": time, "report": None, "fields": lost(robot)})
            else:
                write_line(f"{time:9.3f} {lost(robot)}")

        return await watch(robot, seconds, lambda snapshot: None, gone)
