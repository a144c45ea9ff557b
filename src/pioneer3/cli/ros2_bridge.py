"""`pioneer3 ros2 bridge`."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

from cyclopts import Parameter

from pioneer3.cli.options import Flag, reads
from pioneer3.cli.process import run_until_told_to_leave, write_json, write_line
from pioneer3.cli.ros2_network import ANYWHERE, NetworkOptions, Several
from pioneer3.errors import ConfigError
from pioneer3.units import DURATION

if TYPE_CHECKING:
    from pioneer3.ros.bridge.start import BridgeOptions

Choice = TypeVar("Choice", bound=StrEnum)
Names = Annotated[tuple[str, ...], Several]
Duration = Annotated[float, reads(DURATION)]


def bridge(
    *,
    network: NetworkOptions = ANYWHERE,
    master: str | None = None,
    robot_in: str = "ros2",
    profile: str | None = None,
    namespace: str = "",
    ros1_namespace: str | None = None,
    ros1_node: str = "RosAria",
    frame_prefix: str = "",
    model: str = "p3at-sh",
    cmd_vel_timeout: Duration = 0.5,
    resume_cmd_vel: bool = True,
    only: Names = (),
    to_ros1: Names = (),
    to_ros2: Names = (),
    topics: Path | None = None,
    name: str = "pioneer3_bridge",
    list_: Annotated[bool, Parameter(name="--list", negative=())] = False,
    json: Flag = False,
) -> int:
    """Join a network of ROS 1 and one of ROS 2: old programs drive beside Nav2.

    It needs no ROS on this computer. With the robot in ROS 2 the programs of ROS 1
    publish cmd_vel and /RosAria/cmd_vel, and read odom, tf, scan, sonar/range_0 and
    the rest; with --robot-in ros1 those of ROS 2 do so. The robot stops when the
    program that drives is gone, and when the bridge ends.

    Example: pioneer3 ros2 bridge
    Example: pioneer3 ros2 bridge --robot-in ros1 --master http://robot1:11311
    Example: pioneer3 ros2 bridge --only cmd_vel --to-ros2 /joy:sensor_msgs/Joy

    Args:
        master: Address of the ROS 1 master; without it ROS_MASTER_URI, else this computer.
        robot_in: The side with the robot's node: ros2 or ros1.
        profile: The robot's names in ROS 1: compatibility (RosAria's), standard, or both; without
            it both towards ROS 1, and RosAria's from there.
        namespace: Of the robot's node in ROS 2, such as robot1.
        ros1_namespace: Of the robot's names in ROS 1; without it the same.
        ros1_node: Name of RosAria's node.
        frame_prefix: Before the frames in ROS 1, such as robot1/.
        model: Of the robot, by which its sonars are known.
        cmd_vel_timeout: A command lasts so long; 0, which is unsafe, until the next one.
        resume_cmd_vel: Let a stream that fell silent drive again when it has come steadily for
            0.3 s; else it needs a zero or another direction.
        only: Take this row of the table only, such as odom.
        to_ros1: Pass this topic on to ROS 1, too, such as /plan:nav_msgs/Path.
        to_ros2: Pass this topic on to ROS 2, too, such as /joy:sensor_msgs/Joy.
        topics: File with further rows (TOML).
        name: Of the bridge's node on both sides.
        list_: Only list the table.
        json: List it as JSON.
    """
    from pioneer3.ros.bridge.rows import Side
    from pioneer3.ros.bridge.start import BridgeOptions, serve
    from pioneer3.ros.node.names import Profile

    options = BridgeOptions(
        node=network.node(name),
        master=master,
        robot=_chosen(Side, robot_in, "--robot-in is ros1 or ros2"),
        profile=_chosen(Profile, profile, "--profile is compatibility, standard or both")
        if profile is not None
        else None,
        namespace=namespace or "/",
        ros1_namespace=ros1_namespace,
        ros1_node=ros1_node,
        frame_prefix=frame_prefix,
        model=model,
        timeout=cmd_vel_timeout,
        resumes=resume_cmd_vel,
        only=only,
        to_ros1=to_ros1,
        to_ros2=to_ros2,
        topics=topics,
    )
    if list_ or json:
        return _list(options, json=json)
    return run_until_told_to_leave(serve(options, write_line))


def _list(options: "BridgeOptions", *, json: bool) -> int:
    from pioneer3.ros.bridge.start import table_of

    table = table_of(options)
    if json:
        write_json({"topics": table.rows, "services": table.services})
        return 0
    for row in table.rows:
        write_line(str(row))
    for service in table.services:
        write_line(str(service))
    return 0


def _chosen(kind: type[Choice], text: str, words: str) -> Choice:
    try:
        return kind(text)
    except ValueError:
        raise ConfigError(f"{words}, not {text!r}") from None
