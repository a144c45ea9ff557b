"""`pioneer3 drive`."""

import sys
from collections.abc import Coroutine
from functools import partial
from math import radians
from typing import Annotated, Any

from cyclopts import Parameter

from pioneer3.cli.live import announce, rewrite, show_while, tell_cuts
from pioneer3.cli.options import (
    LINK,
    Flag,
    LinkOptions,
    MaxSpeed,
    Patience,
    Seconds,
    Speed,
    TurnRate,
)
from pioneer3.cli.process import rewrite_line, run_until_told_to_leave, write_line

KEYS = """\
arrows or w a s d: drive   + -: faster, slower   m: motors   q: quit
space: stop   k: emergency stop   Ctrl-R: release it"""
GAMEPAD = """\
hold L1: drive with the left stick   R1 as well: faster   B or circle: stop
Back or Share: emergency stop   Start or Options: release it   Ctrl-C: quit
on the keyboard space: stop   k: emergency stop"""
SPEED = 0.5
"""Speed of the keys [m/s]."""
TURN_RATE = radians(30)
"""Turn rate of the keys [rad/s]."""


def drive(
    *,
    link: LinkOptions = LINK,
    speed: Speed | None = None,
    turn_rate: TurnRate | None = None,
    max_speed: MaxSpeed | None = None,
    gamepad: Annotated[list[str] | None, Parameter(consume_multiple=True, negative=())] = None,
    latch: Flag = False,
    patience: Patience = 10.0,
    seconds: Seconds | None = None,
) -> int:
    """Drive with the keyboard of this terminal: arrows drive, space stops, q quits.

    k is the emergency stop, Ctrl-R releases it. A terminal does not tell when a key
    is let go: a key acts for 0.6 s, and its repeats extend that. Alternate two keys
    to drive a curve. With --gamepad no terminal is needed.

    Example: pioneer3 drive --port /dev/ttyUSB0 --speed 0.3

    Args:
        speed: Of the forward key, 0.5; + and - change it. Of a gamepad's stick, 0.4.
        turn_rate: Of the turning keys, 30; + and - change it. Of a gamepad's stick, 34.
        gamepad: Drive with a gamepad of this machine: the first, or by part of its name, or path.
        latch: One press keeps moving until another key, as in the lab's rob_key.
        patience: What --latch keeps moving stops after so long without a key; 10 at most.
        seconds: Stop, and end, after this time.
    """
    if gamepad is None:
        drives = _drive(link, speed, turn_rate, max_speed, latch=latch, patience=patience)
    else:
        drives = _drive_gamepad(link, speed, turn_rate, max_speed, " ".join(gamepad))
    return run_until_told_to_leave(_for(drives, seconds))


async def _for(driving: Coroutine[Any, Any, None], seconds: float | None) -> None:
    """Drive for so long, or until the driver quits."""
    import asyncio

    try:
        async with asyncio.timeout(seconds) as limit:
            await driving
    except TimeoutError:
        if not limit.expired():
            raise


async def _drive(
    link: LinkOptions,
    speed: float | None,
    turn_rate: float | None,
    max_speed: float | None,
    *,
    latch: bool,
    patience: float,
) -> None:
    from pioneer3.teleop.keyboard import Manner
    from pioneer3.teleop.keyboard_drive import KeyboardDriver
    from pioneer3.teleop.terminal import keys, raw_terminal

    speeds = {"speed": speed or SPEED, "turn_rate": turn_rate or TURN_RATE}
    manner = Manner(**speeds, latch=latch, patience=patience)
    with raw_terminal() as terminal:
        async with link.connect(max_speed=max_speed) as robot:
            limits = robot.info.limits
            tell_cuts(limits, speed, turn_rate)
            keyboard = manner.keyboard(limits)
            announce(robot, "waits for keys")
            write_line(KEYS)
            await KeyboardDriver(robot, keyboard, rewrite).run(keys(terminal))


async def _drive_gamepad(
    link: LinkOptions,
    speed: float | None,
    turn_rate: float | None,
    max_speed: float | None,
    name: str,
) -> None:
    from pioneer3.teleop.evdev import open_gamepad, read
    from pioneer3.teleop.gamepad import SCHEME
    from pioneer3.teleop.gamepad_drive import GamepadDriver

    def tell(news: str) -> None:
        if sys.stdout.isatty():
            rewrite_line("")
        write_line(news)

    with open_gamepad(name):
        pass  # what is wrong with it is said before anything moves
    async with link.connect(max_speed=max_speed) as robot:
        tell_cuts(robot.info.limits, speed, turn_rate)
        announce(robot, "waits for the gamepad")
        write_line(GAMEPAD)
        scheme = SCHEME.at(speed, turn_rate)
        driver = GamepadDriver(robot, partial(open_gamepad, name), read, tell, scheme)
        await show_while(robot, driver.run())
