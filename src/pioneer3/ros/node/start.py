"""The part of a node's start that is the same on every middleware: its options and its robot."""

from collections.abc import AsyncIterator, Awaitable, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import isinf
from typing import Final

from pioneer3.doctor.ports import list_ports
from pioneer3.doctor.probe import SIMULATOR_URL, choose, probe, probe_all
from pioneer3.errors import NoRobotError
from pioneer3.geometry import Pose2
from pioneer3.models import GivenModel
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.lasers.spec import LaserSpec, parse_lasers
from pioneer3.robot.supervisor import kind
from pioneer3.ros.node.laser_parameters import (
    BELOW,
    overridden_laser_parameters,
    unused_laser_parameters,
)
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter import full_name
from pioneer3.ros.node.parameter_reading import part_of, read_parameters, unused_parameters
from pioneer3.ros.node.parameters import NodeParameters
from pioneer3.runtime.recording import Record
from pioneer3.runtime.robot import Robot

LONG: Final = 2.0
"""With a longer timeout [s] a robot drives on for metres when its publisher has crashed."""
FindLasers = Callable[[str, Sequence[str]], Awaitable[Sequence[LaserSpec]]]
"""Given the robot's port, and those of lasers if the command line has none, looks for lasers."""


async def _of_parameters(robot: str, otherwise: Sequence[str]) -> Sequence[LaserSpec]:
    return parse_lasers(otherwise)


@dataclass(frozen=True, slots=True, kw_only=True)
class StartOptions:
    """Options of the command line; they come before the ROS parameters of the same name.

    `lasers` looks for those at `laser_ports`; the camera has an MJPEG stream. The map is a file, or
    the name of one that ships, and the start on it a pose, the name of a place, or `unknown`. The
    arguments are ROS's own, such as `_port:=/dev/ttyS0`, `__name:=front`, `odom:=odometry`. The
    robot is recorded as :func:`connect_async` explains.
    """

    port: str | None = None
    model: GivenModel = None
    baud: int | None = None
    laser_ports: Sequence[str] = ()
    lasers: FindLasers = _of_parameters
    camera: str | None = None
    line_map: str | None = None
    start: Pose2 | str | None = None
    arguments: Sequence[str] = ()
    record: Record = None


def checked_parameters(
    raw: Mapping[str, object],
    laser_ports: Sequence[str],
    warn: Callable[[str], None],
    profile: Profile | None = None,
) -> NodeParameters:
    """Return the parameters of a node, and warn of those that are unused or unsafe.

    Ports of lasers are those of the command line. Without a profile a parameter tells it. Raises
    ConfigError if a value is of the wrong kind or out of range.
    """
    parameters = read_parameters(raw, profile)
    profile = parameters.profile
    of_laser = part_of(raw, BELOW, profile)
    for sentence in (
        *unused_parameters(raw, profile),
        *unused_laser_parameters(of_laser, profile, BELOW),
        *overridden_laser_parameters(of_laser, laser_ports, profile, BELOW),
    ):
        warn(sentence)
    if parameters.timeout > LONG:
        length = "0" if isinf(parameters.timeout) else f"{parameters.timeout:g} s"
        warn(
            f"{full_name('cmd_vel_timeout', profile)} is {length}, which is UNSAFE: the robot goes"
            " on as the last message said for as long as its publisher is there, also when that"
            " hangs"
        )
    return parameters


@asynccontextmanager
async def connected_robot(
    options: StartOptions, parameters: NodeParameters, tell: Callable[[str], None]
) -> AsyncIterator[Robot]:
    """Find the robot and drive it during the block; `tell` is given lines for a person.

    Raises:
        PioneerError: it cannot be reached; the message says what to do.
    """
    port = options.port or parameters.url or await simulator_or_robot(tell)
    lasers = await options.lasers(port, parameters.laser.ports)
    async with connect_async(
        port,
        baud=options.baud or parameters.baud,
        model=options.model or parameters.model or None,
        max_speed=parameters.max_linear_velocity,
        max_turn_rate=parameters.max_angular_velocity,
        auto_enable=parameters.auto_enable_motors,
        record=options.record,
        lasers=parameters.laser.applied_to(lasers),
        camera=options.camera or parameters.camera_url or None,
        line_map=options.line_map or parameters.map or None,
        start=options.start or parameters.initial_pose,
        settings=parameters.navigation,
    ) as robot:
        tell(f"{kind(robot.info)}: {robot.info.model.title} on {robot.info.url}")
        yield robot


async def simulator_or_robot(tell: Callable[[str], None]) -> str:
    """Return the URL of the usual simulator, or of a robot at a serial port; else NoRobotError."""
    simulated = await probe(SIMULATOR_URL)
    found = choose([simulated])
    if found is None:
        tell(f"no simulator at {SIMULATOR_URL} ({simulated.detail}); asks the serial ports")
        found = choose(await probe_all(list_ports()))
    if found is None:
        raise NoRobotError(
            f"neither a simulator at {SIMULATOR_URL} nor a robot at a serial port: start `pioneer3"
            " sim`, or say where the robot is with --port or the parameter port; `pioneer3"
            " find-port` tells more"
        )
    return found.url
