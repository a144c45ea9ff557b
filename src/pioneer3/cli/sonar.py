"""`pioneer3 sonar`."""

import sys
from math import hypot, inf, isfinite
from typing import TYPE_CHECKING

from pioneer3.cli.live import looks, lost, watch
from pioneer3.cli.options import LINK, Flag, LinkOptions, Seconds
from pioneer3.cli.process import until_told_to_leave, write_json, write_line
from pioneer3.geometry import Pose2
from pioneer3.units import MM

if TYPE_CHECKING:
    from rich.console import RenderableType

    from pioneer3.demo.drawing import Canvas
    from pioneer3.models import RobotModel
    from pioneer3.robot.supervisor import RobotInfo
    from pioneer3.runtime.driven import Driven
    from pioneer3.state import Snapshot

BODY = (160, 220, 240, 240, 240, 240, 220, 160)
"""From the robot's centre to its hull in front of each front sonar, as the lab's p3_sonar takes
off [mm]."""
NUMBER = 6
"""Columns of a distance."""


@until_told_to_leave
async def sonar(
    *, link: LinkOptions = LINK, seconds: Seconds | None = None, json: Flag = False
) -> int:
    """Show the sonars: the distances of the front eight, and a picture to scale.

    Distances are in millimetres from the robot's hull, as the lab's p3_sonar has
    them; - where nothing echoes within 5 m. Nothing moves. Without a terminal, a
    line for each reading.

    Example: pioneer3 sonar --port /dev/ttyUSB0

    Args:
        seconds: End after this time.
        json: One JSON object for each reading, a line each.
    """
    length = inf if seconds is None else seconds
    async with link.connect(auto_enable=False) as robot:
        return await show_sonar(robot, length, json=json)


def hull_distances(model: "RobotModel", ranges: tuple[float, ...]) -> list[int | None]:
    """Return the distance of each front sonar's echo from the hull [mm]; `None` without an echo.

    It is the distance from the robot's centre less :data:`BODY`.
    """
    distances: list[int | None] = []
    for mount, metres, body in zip(model.sonars, ranges, BODY, strict=False):
        echo = Pose2(mount.x, mount.y, mount.theta) @ Pose2(metres) if isfinite(metres) else None
        distances.append(None if echo is None else round(hypot(echo.x, echo.y) / MM) - body)
    return distances


def line(distances: list[int | None]) -> str:
    """Return the distances side by side, a column each."""
    return "".join(f"{'-' if mm is None else mm:>{NUMBER}}" for mm in distances)


async def show_sonar(robot: "Driven", seconds: float, *, json: bool) -> int:
    """Show the sonars for `seconds`: a picture in a terminal, else a line or JSON a reading.

    Returns the exit code: 1 if the link is lost in the end.
    """

    def show(snapshot: "Snapshot") -> None:
        distances = hull_distances(robot.info.model, snapshot.sonar.ranges)
        if json:
            write_json({"stamp": snapshot.stamp, "hull_mm": distances, "sonar": snapshot.sonar})
        else:
            write_line(line(distances))

    def gone() -> None:
        if json:
            write_json({"stamp": None, "hull_mm": None, "sonar": None})
        else:
            write_line(lost(robot))

    if not json and sys.stdout.isatty():
        return await _show(robot, seconds)
    if not json:
        write_line("".join(f"{number:>{NUMBER}}" for number in range(len(BODY))))
    return await watch(robot, seconds, show, gone)


async def _show(robot: "Driven", seconds: float) -> int:
    from rich.live import Live

    from pioneer3.cli.terminal import Terminal
    from pioneer3.demo.drawing import ring
    from pioneer3.navigation.picture import reach_for

    console = Terminal()
    reach, code = 3.0, 0
    with Live(console=console, screen=True, auto_refresh=False) as live:
        async for snapshot in looks(robot, seconds):
            code = 1 if snapshot is None else 0
            if snapshot is None:
                live.update(lost(robot), refresh=True)
                continue
            ranges = snapshot.sonar.ranges
            reach = reach_for(ranges, reach)
            rows = max(4, console.height - 5)
            picture = ring(robot.info.model, ranges, console.width, rows, reach=reach)
            live.update(_view(robot.info, snapshot, picture), refresh=True)
    return code


def _view(info: "RobotInfo", snapshot: "Snapshot", picture: "Canvas") -> "RenderableType":
    from rich.console import Group
    from rich.text import Text

    from pioneer3.robot.supervisor import kind

    drawn = picture.text()
    drawn.end = "\n"
    state = "pinging" if snapshot.sonar.enabled else "SWITCHED OFF"
    return Group(
        Text(f"{kind(info)} {info.identity.name}, {info.model.title}, sonar {state}", "bold"),
        drawn,
        Text("sonar " + "".join(f"{number:>{NUMBER}}" for number in range(len(BODY))), "dim"),
        Text("mm    " + line(hull_distances(info.model, snapshot.sonar.ranges)), "bold"),
        Text("from the hull, front left to front right; Ctrl-C ends", "dim"),
    )
