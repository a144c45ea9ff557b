"""Drives a robot on topics by keys or by a mode; the same in ROS 1 and ROS 2."""

from collections.abc import Sequence
from math import inf
from typing import TYPE_CHECKING

from pioneer3.cli.live import announce, rewrite, show_while, tell_cuts
from pioneer3.cli.process import write_line

if TYPE_CHECKING:
    from pioneer3.behaviors.modes import Mode
    from pioneer3.ros.client.robot import TopicRobot
    from pioneer3.ros.node.middleware import Topics
    from pioneer3.teleop.keyboard import Manner


async def drive_by_keys(driven: "TopicRobot", manner: "Manner") -> None:
    """Drive by the keyboard until it says so."""
    from pioneer3.cli.drive import KEYS
    from pioneer3.teleop.keyboard_drive import KeyboardDriver
    from pioneer3.teleop.terminal import keys, raw_terminal

    with raw_terminal() as terminal:
        write_line(KEYS)
        limits = driven.info.limits
        tell_cuts(limits, manner.speed, manner.turn_rate)
        await KeyboardDriver(driven, manner.keyboard(limits), rewrite).run(keys(terminal))


async def drive_several_by_keys(driven: "Sequence[TopicRobot]", manner: "Manner") -> None:
    """Drive robots by one keyboard, one at a time or together, until it says so."""
    from pioneer3.teleop.keyboard_drive import KeyboardDriver
    from pioneer3.teleop.several import KEYS, KeyRouter, numbers
    from pioneer3.teleop.terminal import raw_terminal, tokens

    names = [each.info.identity.name for each in driven]
    board = KeyRouter(numbers(names), rewrite)
    for name, each in zip(names, driven, strict=True):
        announce(each, f"is number {board.selection.label(name)}")
        keyboard = manner.keyboard(each.info.limits)
        board.add(name, KeyboardDriver(each, keyboard, board.shows(name)))
    with raw_terminal() as terminal:
        write_line(KEYS)
        await board.run(tokens(terminal))


async def drive_by_phone(
    driven: "TopicRobot", topics: "Topics", imu: str, speed: float, turn_rate: float
) -> None:
    """Drive by the flicks of a phone that publishes on `imu`."""
    from pioneer3.ros.client.phone import flicks
    from pioneer3.teleop.keyboard import Manner
    from pioneer3.teleop.keyboard_drive import KeyboardDriver

    manner = Manner(speed=speed, turn_rate=turn_rate, latch=True)
    await KeyboardDriver(driven, manner.keyboard(driven.info.limits), rewrite).run(
        flicks(imu, topics)
    )


async def drive_by_mode(
    driven: "TopicRobot",
    mode: "Mode",
    *,
    seconds: float | None,
    json: bool,
    speed: float | None = None,
) -> None:
    """Let `mode` drive for `seconds`, and show it; `speed` was asked for."""
    limits = driven.info.limits
    tell_cuts(limits, speed, None)
    length = inf if seconds is None else seconds
    await show_while(driven, driven.run(mode.stack(limits), length), json=json)
