"""Starts the ROS 1 node: ROS, parameters, robot, in this order, and ends it in the other."""

import asyncio
import os
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from math import isinf
from typing import Final
from urllib.parse import urlsplit

from pioneer3.doctor.ports import list_ports
from pioneer3.doctor.probe import SIMULATOR_URL, choose, probe, probe_all
from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.geometry import Pose2
from pioneer3.robot.identity import is_simulator, kind
from pioneer3.robot.lasers.spec import LaserSpec, parse_lasers
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.ros.node.driving_parameters import NAMES
from pioneer3.ros.node.laser_parameters import (
    BELOW,
    overridden_laser_parameters,
    unused_laser_parameters,
)
from pioneer3.ros.node.names import NODE, lab_node
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.parameters import (
    LONG,
    MODEL,
    SIMULATED,
    NodeParameters,
    laser_part,
    read_parameters,
    unused_parameters,
)
from pioneer3.ros.node.values import RawParameters
from pioneer3.ros.ros1.master import MasterWatch, wait_for_master
from pioneer3.ros.ros1.middleware import RospyMiddleware, find_move_base, find_rospy
from pioneer3.ros.ros1.rosout import log_in_background
from pioneer3.runtime.connect import connect_async

LAB_NAME: Final = "_lab_name:="
LOOPBACK: Final = {"localhost", "127.0.0.1", "::1"}


FindLasers = Callable[[str, Sequence[str]], Awaitable[Sequence[LaserSpec]]]
"""Given the robot's port, and those of lasers if the command line has none, looks for lasers."""


async def _of_parameters(robot: str, otherwise: Sequence[str]) -> Sequence[LaserSpec]:
    return parse_lasers(otherwise)


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """Options of the command line; they come before the ROS parameters of the same name.

    Attributes:
        port: URL of the robot.
        baud: Serial speed to try first.
        laser_ports: Of the robot's laser range finders.
        lasers: Looks for them.
        camera: URL of the MJPEG stream of the robot's camera.
        line_map: To navigate on: a file, or the name of a map that ships.
        start: Where the robot is on it: a pose, the name of a place, or `unknown`.
        arguments: ROS's own, such as `_port:=/dev/ttyS0`, `__name:=front`, `odom:=odometry`.
    """

    port: str | None = None
    baud: int | None = None
    laser_ports: Sequence[str] = ()
    lasers: FindLasers = _of_parameters
    camera: str | None = None
    line_map: str | None = None
    start: Pose2 | str | None = None
    arguments: Sequence[str] = ()


@asynccontextmanager
async def on_ros(
    name: str, arguments: Sequence[str], tell: Callable[[str], None]
) -> AsyncIterator[MasterWatch]:
    """Be a ROS node during the block; `tell` is given lines for a person.

    Args:
        name: Of the node, unless `arguments` have another.
        arguments: ROS's own.
        tell: Takes a line for a person.

    Raises:
        ConfigError: an argument is none of ROS's, or ROS is not installed.
    """
    odd = [argument for argument in arguments if ":=" not in argument]
    if odd:
        raise ConfigError(
            f"{odd[0]!r} is none of ROS's arguments, such as _port:=/dev/ttyS0, and no command:"
            " pioneer3 ros1 --help lists those"
        )
    find_rospy()
    import rosgraph
    import rospy

    master = rosgraph.get_master_uri()
    stay_on_this_computer(master)
    await wait_for_master(master, tell)
    await asyncio.to_thread(
        rospy.init_node, name, argv=["pioneer3", *arguments], disable_signals=True
    )
    log_in_background()
    watch = MasterWatch(rospy.get_name(), rospy.logwarn)
    try:
        yield watch
    finally:
        watch.stop()
        await asyncio.to_thread(_forget, arguments)
        rospy.signal_shutdown("the program ends")


def announce(tell: Callable[[str], None]) -> None:
    """Tell the names of the node and its master."""
    import rosgraph
    import rospy

    tell(f"node {rospy.get_name()} on {rosgraph.get_master_uri()}")


async def serve(options: Options, tell: Callable[[str], None]) -> int:
    """Run the node until it is shut down or cancelled; `tell` is given lines for a person.

    Raises:
        PioneerError: something could not be started; the message says what to do.
    """
    async with on_ros(node_name(options.arguments), options.arguments, tell) as watch:
        import rospy

        raw = rospy.get_param("~", {})
        parameters = _parameters(raw, options.laser_ports)
        watch.start()
        port = options.port or parameters.port or await simulator_or_robot(tell)
        baud = options.baud or parameters.baud
        lasers = await options.lasers(port, parameters.laser.ports)
        line_map = options.line_map or parameters.line_map
        if line_map:
            find_move_base()
        async with connect_async(
            port,
            baud=baud,
            max_speed=parameters.max_speed,
            max_turn_rate=parameters.max_turn_rate,
            auto_enable=parameters.auto_enable,
            lasers=parameters.laser.applied_to(lasers),
            camera=options.camera or parameters.camera,
            line_map=line_map,
            start=options.start or parameters.start,
        ) as robot:
            tell(f"{kind(robot.info)}: {robot.info.model.title} on {robot.info.url}")
            await asyncio.to_thread(_introduce, robot.info)
            node = RobotNode(robot, parameters, RospyMiddleware(), raw)
            watch.on_registered = node.describe_robot
            await node.run(lambda: announce(tell))
    return 0


def node_name(arguments: Sequence[str]) -> str:
    """Return RosAria's name, or the one that the lab's programs expect of `_lab_name:=`.

    Raises:
        ConfigError: the lab's name is none.
    """
    given = [each.removeprefix(LAB_NAME) for each in arguments if each.startswith(LAB_NAME)]
    return lab_node(given[-1]) if given else NODE


def stay_on_this_computer(master: str) -> None:
    """Listen on loopback only, unless the environment says otherwise or the master is elsewhere."""
    chosen = os.environ.keys() & {"ROS_IP", "ROS_HOSTNAME"}
    if not chosen and urlsplit(master).hostname in LOOPBACK:
        os.environ["ROS_IP"] = "127.0.0.1"


async def simulator_or_robot(tell: Callable[[str], None]) -> str:
    """Return the URL of the usual simulator, or of the robot at a serial port.

    Raises:
        NoRobotError: there is neither.
    """
    simulated = await probe(SIMULATOR_URL)
    found = choose([simulated])
    if found is None:
        tell(f"no simulator at {SIMULATOR_URL} ({simulated.detail}); asks the serial ports")
        found = choose(await probe_all(list_ports()))
    if found is None:
        raise NoRobotError(
            f"neither a simulator at {SIMULATOR_URL} nor a robot at a serial port: start `pioneer3"
            " sim`, or say where the robot is with --port or _port:=; `pioneer3 find-port` tells"
            " more"
        )
    return found.url


def _introduce(info: RobotInfo) -> None:
    """Let programs know the robot's model, and whether it is a simulator."""
    import rospy

    rospy.set_param(f"~{MODEL}", info.model.name)
    rospy.set_param(f"~{SIMULATED}", is_simulator(info))


def _forget(arguments: Sequence[str]) -> None:
    """Delete the parameters that were for this run only: they would hold for the next one."""
    import rospy

    private = [each[1:] for each in arguments if each.startswith("_") and each[1:2] != "_"]
    for name in (*(each.partition(":=")[0] for each in private), MODEL, SIMULATED):
        with suppress(OSError, KeyError, rospy.ROSException):
            rospy.delete_param(f"~{name}")


def _parameters(raw: RawParameters, laser_ports: Sequence[str]) -> NodeParameters:
    """Return the parameters below the node's name, and warn of those that are unused or unsafe.

    `laser_ports` are those of the command line.
    """
    import rospy

    parameters = read_parameters(raw)
    unused = unused_parameters(raw, parameters.profile, NAMES)
    of_laser = laser_part(raw)
    for sentence in (
        *unused,
        *unused_laser_parameters(of_laser, BELOW),
        *overridden_laser_parameters(of_laser, laser_ports, BELOW),
    ):
        rospy.logwarn(sentence)
    if parameters.timeout > LONG:
        length = "0" if isinf(parameters.timeout) else f"{parameters.timeout:g} s"
        rospy.logwarn(
            f"~cmd_vel_timeout is {length}, which is UNSAFE: the robot goes on as the last message"
            " said, also when its publisher has gone"
        )
    return parameters
