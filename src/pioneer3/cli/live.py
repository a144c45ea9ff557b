"""Shows a robot while a motion or mode drives it."""

import shutil
import sys
from collections.abc import AsyncIterator, Callable, Coroutine
from math import degrees, inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pioneer3.cli.options import NAVIGATION, LinkOptions, MotionOptions, NavigationOptions
from pioneer3.cli.process import (
    rewrite_line,
    run_until_told_to_leave,
    write_json,
    write_line,
    write_warning,
)
from pioneer3.errors import LinkError, MotionError
from pioneer3.names import printable
from pioneer3.units import SPEED, TURN_RATE

if TYPE_CHECKING:
    from pioneer3.geometry import Pose2
    from pioneer3.limits import Limits
    from pioneer3.runtime.driven import Driven
    from pioneer3.runtime.robot import Robot
    from pioneer3.state import Snapshot

QUIET = 1.0
"""Pause between two lines where the output is no terminal [s]."""
EXACT = 1e-6
"""Less than this is rounding [m/s], [rad/s]."""
AWAY = 0.5
"""Between two looks at a robot whose link is lost [s]."""


def carry_out(
    motion: Callable[["Robot"], Coroutine[Any, Any, None]],
    words: str,
    link: LinkOptions,
    options: MotionOptions,
    *,
    speed: float | None = None,
    turn_rate: float | None = None,
    max_speed: float | None = None,
    line_map: "str | Path | None" = None,
    start: "Pose2 | str | None" = None,
    navigation: NavigationOptions = NAVIGATION,
) -> int:
    """Connect, run `motion` and show it, until it ends or Ctrl-C; then stop. Return the exit code.

    `words` tell people the motion; `speed` and `turn_rate` are those asked for, `max_speed` bounds
    the connection [m/s, rad/s]. The robot navigates on `line_map`, and is at `start` on it.
    """

    async def command() -> None:
        connection = link.connect(
            max_speed=max_speed, line_map=line_map, start=start, navigation=navigation
        )
        async with connection as robot:
            tell_cuts(robot.info.limits, speed, turn_rate)
            announce(robot, f"{words}; {how_to_stop()}", json=options.json)
            await show_while(robot, motion(robot), json=options.json)

    return run_until_told_to_leave(command())


def how_to_stop() -> str:
    """Return which keys stop a robot that drives by itself."""
    from pioneer3.teleop.terminal import is_in_front

    return "\nany key stops it   k: emergency stop" if is_in_front() else "Ctrl-C stops it"


def tell_cuts(limits: "Limits", speed: float | None, turn_rate: float | None) -> None:
    """Say on stderr which of the speeds that were asked for the robot may not reach."""
    asked = (
        ("--speed", SPEED, speed, limits.max_speed),
        ("--turn-rate", TURN_RATE, turn_rate, limits.max_turn_rate),
    )
    for option, quantity, wanted, top in asked:
        if wanted is not None and wanted > top + EXACT:
            write_warning(
                f"{option} {quantity.written(wanted)} is more than this robot may: "
                f"it is limited to {quantity.written(top)}"
            )


async def show_while(
    robot: "Driven",
    motion: Coroutine[Any, Any, None],
    *,
    json: bool = False,
    words: "Callable[[Driven], str] | None" = None,
) -> None:
    """Run `motion`; meanwhile rewrite a line, or write one each second, or JSON for each snapshot.

    :func:`line` returns the line, unless `words` does. The last one tells where the motion has
    ended: the one before it may be a second old. In a terminal any key stops it, and k is the
    emergency stop.

    Raises:
        MotionError: as `motion` does.
    """
    import asyncio

    from pioneer3.teleop.terminal import is_in_front

    listens, pressed = is_in_front(), list[str]()
    tasks = [asyncio.ensure_future(_show(robot, words or line, json=json))]
    if listens:
        tasks.append(asyncio.ensure_future(_obey_keys(robot, pressed)))
    try:
        await motion
    except MotionError:
        if pressed:
            raise MotionError(pressed[-1]) from None
        raise
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        if not json and not listens and sys.stdout.isatty():
            write_line("")
    if not json and (now := robot.snapshot) is not None:
        write_line(f"done: {_place(robot, now)}")


async def _obey_keys(robot: "Driven", pressed: list[str]) -> None:
    """Stop at any key, and hard at k; note in `pressed` which it was."""
    from pioneer3.teleop.keyboard import Key
    from pioneer3.teleop.terminal import keys, raw_terminal

    with raw_terminal() as terminal:
        async for key in keys(terminal):
            if key is Key.EMERGENCY:
                pressed.append("emergency stop: k was pressed")
                robot.emergency_stop()
            else:
                pressed.append("stopped: a key was pressed")
                robot.stop()


def announce(robot: "Driven", words: str, *, json: bool = False) -> None:
    """Print the robot and its motion, unless a program reads."""
    from pioneer3.robot.supervisor import kind

    if not json:
        info = robot.info
        write_line(f"{kind(info)}: {info.model.title} on {info.url} {words}")


def line(robot: "Driven") -> str:
    """Return its motion, its place and the decision, the most important first."""
    now = robot.snapshot
    if now is None:
        return lost(robot)
    twist = now.odometry.twist
    words = "; ".join(robot.arbiter.told) or str(robot.why_not_moving() or "")
    return f"{twist.v:z5.2f} m/s {degrees(twist.w):z4.0f}°/s  {_place(robot, now)}  {words}"


def _place(robot: "Driven", now: "Snapshot") -> str:
    pose, odom_in_map, on = now.odometry.robot_in_odom, robot.odom_in_map, ""
    if odom_in_map is not None:
        pose, on = odom_in_map @ pose, "map "
    return f"{on}x{pose.x:z6.2f} y{pose.y:z6.2f} {degrees(pose.theta):z4.0f}°"


def lost(robot: "Driven") -> str:
    """Return that the link is lost, and why."""
    from pioneer3.robot.explain import advised

    return f"LOST: {advised(robot.why_not_moving())}"


async def looks(robot: "Driven", seconds: float = inf) -> AsyncIterator["Snapshot | None"]:
    """Yield each snapshot for `seconds`; `None` again and again while the link is lost."""
    import asyncio

    clock = asyncio.get_running_loop().time
    end = clock() + seconds
    while (left := end - clock()) > 0:
        try:
            async for snapshot in robot.snapshots(left, AWAY):
                yield snapshot
        except LinkError:
            yield None
        else:
            return


async def watch(
    robot: "Driven", seconds: float, show: Callable[["Snapshot"], None], gone: Callable[[], None]
) -> int:
    """Call `show` with each snapshot for `seconds`, and `gone` once at each loss of the link.

    Returns the exit code: 1 if the link is lost in the end.
    """
    there = True
    async for snapshot in looks(robot, seconds):
        if snapshot is not None:
            show(snapshot)
        elif there:
            gone()
        there = snapshot is not None
    return 0 if there else 1


def rewrite(text: str) -> None:
    """Rewrite the live line, cut to the width of the terminal."""
    width = shutil.get_terminal_size().columns
    rewrite_line(printable(text)[: width - 1])


async def _show(robot: "Driven", words: "Callable[[Driven], str]", *, json: bool) -> None:
    if json:
        async for snapshot in looks(robot):
            mode, why = robot.arbiter.mode, robot.why_not_moving()
            write_json(
                {
                    "snapshot": snapshot,
                    "mode": mode.name if mode else None,
                    "decided": robot.arbiter.told,
                    "why_not_moving": why and why.text,
                }
            )
    elif sys.stdout.isatty():
        async for _ in looks(robot):
            rewrite(words(robot))
    else:
        import asyncio

        clock, there = asyncio.get_running_loop().time, True
        due = clock() + QUIET
        async for snapshot in looks(robot):
            if clock() >= due or there != (snapshot is not None):
                there, due = snapshot is not None, clock() + QUIET
                write_line(words(robot))
