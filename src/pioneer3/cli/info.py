"""`pioneer3 info`."""

from typing import TYPE_CHECKING

from pioneer3.cli.loop import run_until_told_to_leave
from pioneer3.cli.options import LINK, Flag, LinkOptions

if TYPE_CHECKING:
    from pioneer3.runtime.robot import Robot


def info(*, link: LinkOptions = LINK, json: Flag = False) -> int:
    """Show who the robot is, its limits, its battery and its whole configuration.

    Nothing moves.

    Example: pioneer3 info --port /dev/ttyUSB0

    Args:
        link: The robot.
        json: Print JSON for programs, nothing else.
    """
    return run_until_told_to_leave(_info(link, json=json))


async def _info(link: LinkOptions, *, json: bool) -> int:
    from contextlib import AsyncExitStack  # noqa: PLC0415

    from pioneer3.cli.output import busy_sign, write_json  # noqa: PLC0415

    async with AsyncExitStack() as stack:
        with busy_sign(f"Connecting to {link.port} ..."):
            connecting = link.connect(auto_enable=False)
            robot = await stack.enter_async_context(connecting)
        if json:
            write_json(_as_data(robot), indent=2)
        else:
            _show(robot)
    return 0


def _show(robot: "Robot") -> None:
    from rich.console import Console  # noqa: PLC0415

    from pioneer3.cli.tables import robot_tables  # noqa: PLC0415

    console = Console(highlight=False)
    for table in robot_tables(robot.info, robot.snapshot):
        console.print(table)


def _as_data(robot: "Robot") -> dict[str, object]:
    from pioneer3.robot.identity import kind  # noqa: PLC0415

    info, snapshot = robot.info, robot.snapshot
    return {
        "kind": kind(info),
        "url": info.url,
        "speed": info.speed,
        "identity": info.identity,
        "model": info.model,
        "limits": info.limits,
        "battery": snapshot.battery if snapshot else None,
        "config": info.config,
    }
