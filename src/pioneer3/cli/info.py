"""`p3 info`: who the robot is and how it is set up."""

from typing import TYPE_CHECKING

from pioneer3.cli.connection import DEFAULT_PORT, Baud, Json, Port

if TYPE_CHECKING:
    from pioneer3.robot.supervisor import RobotInfo
    from pioneer3.state import Snapshot


def info(*, port: Port = DEFAULT_PORT, baud: Baud = None, json: Json = False) -> None:
    """Show who the robot is, its limits and its whole configuration.

    Nothing moves. Example: `p3 info -p /dev/ttyUSB0`

    Args:
        port: Where the robot is: /dev/ttyUSB0, tcp://localhost:8101, replay:FILE.
        baud: Serial speed to try first.
        json: Print JSON for programs, nothing else.
    """
    import asyncio  # noqa: PLC0415

    from pioneer3.cli.output import busy_sign, write_json  # noqa: PLC0415

    with busy_sign(f"Connecting to {port} ..."):
        robot, snapshot = asyncio.run(_ask(port, baud))
    if json:
        write_json(_as_data(robot, snapshot), indent=2)
        return
    from rich.console import Console  # noqa: PLC0415

    from pioneer3.cli.tables import robot_tables  # noqa: PLC0415

    console = Console(highlight=False)
    for table in robot_tables(robot, snapshot):
        console.print(table)


async def _ask(port: str, baud: int | None) -> "tuple[RobotInfo, Snapshot | None]":
    from pioneer3.runtime.robot import connect_async  # noqa: PLC0415

    async with connect_async(port, baud=baud, auto_enable=False) as robot:
        return robot.info, robot.snapshot


def _as_data(robot: "RobotInfo", snapshot: "Snapshot | None") -> dict[str, object]:
    from pioneer3.runtime.identity import kind  # noqa: PLC0415

    return {
        "kind": kind(robot),
        "url": robot.url,
        "speed": robot.speed,
        "identity": robot.identity,
        "model": robot.model,
        "limits": robot.limits,
        "battery": snapshot.battery if snapshot else None,
        "config": robot.config,
    }
