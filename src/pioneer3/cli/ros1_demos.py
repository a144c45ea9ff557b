"""`pioneer3 ros1 wander` and its like: the demos on topics, from any computer."""

from collections.abc import Callable
from inspect import Parameter as Argument
from math import inf
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from pioneer3.behaviors.modes import MODES, Mode
from pioneer3.cli.motion import keyword, mode_options, with_signature
from pioneer3.cli.options import Flag, Patience, Seconds, Speed, TurnRate
from pioneer3.cli.process import run_until_told_to_leave
from pioneer3.cli.ros1_program import ANY, Arguments, RobotNames, Which, drive_robot, run_mode
from pioneer3.cli.topic_driving import (
    KeyOptions,
    drive_by_keys,
    drive_by_phone,
    drive_several_by_keys,
)

if TYPE_CHECKING:
    from pioneer3.ros.client.robot import TopicRobot


def robots(*arguments: Arguments, json: Flag = False) -> int:
    """List the robots on the ROS master.

    Args:
        arguments: ROS's own; they change nothing.
        json: Print JSON.
    """
    from pioneer3.cli.process import write_json, write_line
    from pioneer3.ros.ros1.client import find_robots

    found = find_robots()
    if json:
        write_json(found)
        return 0
    for robot in found:
        write_line(f"{robot.name:24}  drive it on {robot.commands}, it is at {robot.pose}")
    if not found:
        write_line("None: start the node of one, as with pioneer3 ros1 --port /dev/ttyUSB0")
    return 0


def rob_key(
    *arguments: Arguments,
    which: Which = ANY,
    speed: Speed = 0.5,
    turn_rate: TurnRate = 0.5,
    latch: bool = True,
    patience: Patience = 10.0,
) -> int:
    """Drive a robot with the keyboard: a press keeps it moving, space stops, q quits.

    k is the emergency stop, Ctrl-R releases it. It sends ten commands a second:
    should this program or the network fail, the robot stops.

    Example: pioneer3 ros1 rob_key --robot p3at_1_113

    Args:
        arguments: ROS's own, such as __name:=mine.
        which: The robot.
        speed: Of the forward key; + and - change it.
        turn_rate: Of the turning keys; + and - change it.
        latch: One press keeps moving until another key; else a key acts for 0.6 s.
        patience: What a press keeps moving stops after so long without a key; 10 at most.
    """

    async def drive(driven: "TopicRobot") -> None:
        keys = KeyOptions(speed=speed, turn_rate=turn_rate, latch=latch, patience=patience)
        await drive_by_keys(driven, keys)

    return drive_robot("rob_key", arguments, which, drive, words="waits for keys")


def rob_key_multi(
    *arguments: Arguments,
    robot: RobotNames = (),
    model: str | None = None,
    speed: Speed = 0.1,
    turn_rate: TurnRate = 0.1,
    latch: bool = True,
    patience: Patience = 10.0,
) -> int:
    """Drive several robots with one keyboard, one at a time or all together.

    Arrows drive, q goes on to the next robot, a number chooses one, a all of them,
    s several: mark them, then y; who is left stands. Space stops all, k is the
    emergency stop of all, Ctrl-R releases it; Ctrl-D quits.

    Args:
        arguments: ROS's own, such as __name:=mine.
        robot: Which ones; all on the master if none is said.
        model: What they are, where their nodes do not tell.
        speed: Of the forward key.
        turn_rate: Of the turning keys.
        latch: One press keeps moving until another key; else a key acts for 0.6 s.
        patience: What a press keeps moving stops after so long without a key; 10 at most.
    """
    from pioneer3.ros.client.graph import chosen
    from pioneer3.ros.ros1.client import find_robots, run_program

    known = find_robots()
    wanted = [chosen(known, name) for name in robot] or known or [chosen(known, None)]
    keys = KeyOptions(speed=speed, turn_rate=turn_rate, latch=latch, patience=patience)

    async def drive(driven: "list[TopicRobot]") -> None:
        await drive_several_by_keys(driven, keys)

    return run_until_told_to_leave(run_program("rob_key_multi", arguments, wanted, model, drive))


def p3_sonar(
    *arguments: Arguments,
    which: Which = ANY,
    seconds: Seconds | None = None,
    json: Flag = False,
) -> int:
    """Show the sonars of a robot, distances in mm from its hull; nothing moves.

    Args:
        arguments: ROS's own, such as __name:=mine.
        which: The robot.
        seconds: End after this time.
        json: One JSON object for each reading, a line each.
    """

    async def show(driven: "TopicRobot") -> None:
        from pioneer3.cli.sonar import show_sonar

        await show_sonar(driven, inf if seconds is None else seconds, json=json)

    return drive_robot("p3_sonar", arguments, which, show)


def mode_demo(mode: type[Mode]) -> Callable[..., int]:
    """Return the function of the command that runs `mode` on topics."""

    def run(
        *arguments: str,
        which: Which = ANY,
        seconds: float | None = None,
        json: bool = False,
        **values: Any,
    ) -> int:
        speed = values.get("speed")
        return run_mode(arguments, which, mode(**values), seconds=seconds, json=json, speed=speed)

    run.__doc__ = f"{mode.summary()}\n\nSee pioneer3 {mode.name()} --help. Ctrl-C stops it."
    ros = Annotated[Arguments, Parameter(help="ROS's own, such as __name:=mine.")]
    length = Annotated[Seconds | None, Parameter(help="Stop after this time.")]
    lines = Annotated[Flag, Parameter(help="One JSON object for each reading, a line each.")]
    common = [
        Argument("arguments", Argument.VAR_POSITIONAL, annotation=ros),
        keyword("which", Which, ANY),
        *mode_options(mode),
        keyword("seconds", length, None),
        keyword("json", lines, default=False),
    ]
    return with_signature(run, mode.name(), common)


MODE_DEMOS = tuple(mode_demo(mode) for mode in MODES if not mode.arguments)
"""A place counts from odometry's origin, which people do not know of a robot on topics."""


def android_teleop(
    *arguments: Arguments,
    which: Which = ANY,
    imu: str = "/android/imu",
    speed: Speed = 0.2,
    turn_rate: TurnRate = 0.5,
) -> int:
    """Drive a robot by turning a phone that publishes sensor_msgs/Imu.

    Flick it, faster than 3 rad/s: about x for forward and back, about z to turn,
    about y to stop. A flick acts until the next one, for 10 s at most; when the
    phone falls silent, the robot stops.

    Args:
        arguments: ROS's own, such as __name:=mine.
        which: The robot.
        imu: Topic of the phone.
        speed: Of flicks forward and back.
        turn_rate: Of flicks to the side.
    """

    async def drive(driven: "TopicRobot") -> None:
        from pioneer3.ros.ros1.middleware import RospyTopics

        await drive_by_phone(driven, RospyTopics(), imu, speed, turn_rate)

    return drive_robot("android_teleop", arguments, which, drive, words=f"waits for {imu}")
