"""The common part of the demos on ROS 1 topics: the robot, and a node that drives it."""

from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from pioneer3.cli.process import run_until_told_to_leave
from pioneer3.cli.topic_driving import drive_by_mode

if TYPE_CHECKING:
    from pioneer3.behaviors.modes import Mode
    from pioneer3.ros.client.robot import TopicRobot

RobotNames = Annotated[tuple[str, ...], Parameter(name=["--robot", "-r"], negative=())]
Arguments = Annotated[str, Parameter(show=False)]


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class Which:
    """The robot to drive.

    Attributes:
        robot: Its name, if there are several; pioneer3 ros1 robots lists them.
        model: What it is, where its node does not tell: p3at-sh, p3dx-sh.
    """

    robot: Annotated[str | None, Parameter(name=["--robot", "-r"])] = None
    model: str | None = None


ANY = Which()


def run_mode(
    arguments: tuple[str, ...],
    which: Which,
    mode: "Mode",
    *,
    seconds: float | None,
    json: bool,
    speed: float | None = None,
) -> int:
    """Let `mode` drive the robot for `seconds`, as the node of its name; `speed` was asked for."""

    async def drive(driven: "TopicRobot") -> None:
        await drive_by_mode(driven, mode, seconds=seconds, json=json, speed=speed)

    from pioneer3.cli.live import how_to_stop

    words = None if json else f"{mode.doing}; {how_to_stop()}"
    return drive_robot(mode.name(), arguments, which, drive, words=words)


def drive_robot(
    name: str,
    arguments: tuple[str, ...],
    which: Which,
    drive: "Callable[[TopicRobot], Coroutine[Any, Any, None]]",
    *,
    words: str | None = None,
) -> int:
    """Find the robot, be the node `name` and drive, until that ends or Ctrl-C."""
    from pioneer3.ros.client.graph import chosen
    from pioneer3.ros.ros1.client import find_robots, run_program

    async def work(robots: "list[TopicRobot]") -> None:
        from pioneer3.cli.live import announce

        (robot,) = robots
        if words is not None:
            announce(robot, words)
        await drive(robot)

    topics = chosen(find_robots(), which.robot)
    node = f"{name}_{topics.plain_name}"
    return run_until_told_to_leave(run_program(node, arguments, [topics], which.model, work))
