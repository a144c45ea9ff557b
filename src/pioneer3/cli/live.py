"""Shows what a robot does while a motion or mode drives it."""

import shutil
import sys
from collections.abc import Callable, Coroutine
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.output import write_json, write_line

if TYPE_CHECKING:
    from pioneer3.runtime.driven import Driven
    from pioneer3.runtime.robot import Robot

QUIET = 1.0
"""Pause between two lines where nobody watches them come [s]."""


def carry_out(
    motion: Callable[["Robot"], Coroutine[Any, Any, None]],
    words: str,
    port: str,
    baud: int | None,
    *,
    json: bool,
    record: Path | None = None,
) -> int:
    """Connect, run `motion` (in a few `words`) and show it, until it ends or Ctrl-C; then stop.

    Returns the exit code.
    """

    async def command() -> None:
        from pioneer3.runtime.connect import connect_async  # noqa: PLC0415

        async with connect_async(port, baud=baud, record=record) as robot:
            announce(robot, f"{words}; Ctrl-C stops it", json=json)
            await show_while(robot, motion(robot), json=json)

    return run_until_told_to_leave(command())


async def show_while(
    robot: "Driven", motion: Coroutine[Any, Any, None], *, json: bool = False
) -> None:
    """Run `motion`; meanwhile rewrite a line, or write one each second, or JSON for each reading.

    Raises:
        MotionError: as `motion` does.
    """
    import asyncio  # noqa: PLC0415

    showing = asyncio.ensure_future(_show(robot, json=json))
    try:
        await motion
    finally:
        showing.cancel()
        await asyncio.gather(showing, return_exceptions=True)
        if not json and sys.stdout.isatty():
            write_line("")


def announce(robot: "Driven", words: str, *, json: bool = False) -> None:
    """Say which robot does what, unless a program reads."""
    from pioneer3.runtime.identity import kind  # noqa: PLC0415

    if not json:
        info = robot.info
        write_line(f"{kind(info)}: {info.model.title} on {info.url} {words}")


def line(robot: "Driven") -> str:
    """Return how it moves, where it is and who decides, the most important first."""
    now = robot.snapshot
    if now is None:
        status = robot.supervisor.status.latest
        return f"{status.connection.value.upper()}: {status.message}" if status else ""
    pose, twist = now.odometry.robot_in_odom, now.odometry.twist
    words = "; ".join(robot.helm.told) or robot.why_not_moving() or ""
    return (
        f"{twist.v:5.2f} m/s {degrees(twist.w):4.0f}°/s  "
        f"x{pose.x:6.2f} y{pose.y:6.2f} {degrees(pose.theta):4.0f}°  {words}"
    )


def rewrite(text: str) -> None:
    """Rewrite the live line, cut to the width of the terminal."""
    width = shutil.get_terminal_size().columns
    sys.stdout.write(f"\r\x1b[K{text[: width - 1]}")
    sys.stdout.flush()


async def _show(robot: "Driven", *, json: bool) -> None:
    if json:
        async for snapshot in robot.snapshots():
            mode = robot.helm.mode
            write_json(
                {
                    "snapshot": snapshot,
                    "mode": mode.name if mode else None,
                    "decided": robot.helm.told,
                    "why_not_moving": robot.why_not_moving(),
                }
            )
    elif sys.stdout.isatty():
        async for _ in robot.snapshots():
            rewrite(line(robot))
    else:
        import asyncio  # noqa: PLC0415

        while True:
            await asyncio.sleep(QUIET)
            write_line(line(robot))
