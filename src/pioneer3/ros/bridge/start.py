"""Starts a bridge: its table, both networks, in this order, and ends it in the other."""

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.models import load_model
from pioneer3.ros.addresses import addresses
from pioneer3.ros.bridge.bridge import TopicBridge
from pioneer3.ros.bridge.conversion import Converter, FrameNames
from pioneer3.ros.bridge.rows import (
    BridgedRobot,
    BridgedTopic,
    BridgeWay,
    ServiceRow,
    Side,
    chosen,
    rows_of,
    services_of,
)
from pioneer3.ros.bridge.topic_file import parse_topic, read_topics, refuse_circles
from pioneer3.ros.node.names import NODE, Profile
from pioneer3.ros.node.parameter_reading import SHORTEST
from pioneer3.ros.ros2.names import node_name
from pioneer3.ros.ros2.network import BackendName
from pioneer3.ros.ros2.start import NodeOptions, on_ros2
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.tcpros.node import ros1_node
from pioneer3.ros.tcpros.subscriber import BRIDGE_FIELD
from pioneer3.ros.tcpros.types import Ros1Types


@dataclass(frozen=True, slots=True, kw_only=True)
class BridgeOptions:
    """The options of a bridge between our `node` and a ROS 1 master; `robot` is its node's side.

    Without a master that of ROS_MASTER_URI counts; without a profile, the names that suit the side.
    The namespace is that of the robot's node in ROS 2, and of its names in ROS 1 unless these have
    another; RosAria's are below `ros1_node`. A velocity command lasts for the timeout [s], 0 until
    the next one; with `resumes` a stream that fell silent goes on. Rows called `only` are taken,
    empty for all; further ones are in the file `topics`, or such as `/plan:nav_msgs/Path`.
    """

    node: NodeOptions
    master: str | None = None
    robot: Side = Side.ROS2
    profile: Profile | None = None
    namespace: str = "/"
    ros1_namespace: str | None = None
    ros1_node: str = NODE
    frame_prefix: str = ""
    model: str = "p3at-sh"
    timeout: float = 0.5
    resumes: bool = True
    only: Sequence[str] = ()
    topics: Path | None = None
    to_ros1: Sequence[str] = ()
    to_ros2: Sequence[str] = ()

    @property
    def lasting(self) -> float:
        """How long a velocity command lasts [s], `inf` until the next; ConfigError if too short."""
        if self.timeout == 0:
            return inf
        if not (isfinite(self.timeout) and self.timeout >= SHORTEST):
            raise ConfigError(
                f"--cmd-vel-timeout is 0 or at least {SHORTEST:g} s, not {self.timeout:g}"
            )
        return self.timeout


@dataclass(frozen=True, slots=True, kw_only=True)
class BridgeTable:
    """Everything that a bridge passes on."""

    rows: tuple[BridgedTopic, ...]
    services: tuple[ServiceRow, ...]
    converter: Converter


def table_of(options: BridgeOptions) -> BridgeTable:
    """Return the table that the options mean; ConfigError if one, or the file, is wrong."""
    distro = options.node.network.distro_here()
    frames = FrameNames(options.frame_prefix)
    converter = Converter(Ros1Types(), MessageTypes(distro), frames)
    namespace = node_name(options.node.name, options.namespace).namespace
    own = options.ros1_namespace
    robot = BridgedRobot(
        side=options.robot,
        model=load_model(options.model),
        distro=distro,
        profile=profile_of(options),
        namespace=namespace,
        ros1_namespace=namespace if own is None else node_name(options.node.name, own).namespace,
        ros1_node=node_name(options.ros1_node).name,
    )
    further = [
        *(parse_topic(each, BridgeWay.TO_ROS1, converter) for each in options.to_ros1),
        *(parse_topic(each, BridgeWay.TO_ROS2, converter) for each in options.to_ros2),
        *(read_topics(options.topics, converter) if options.topics is not None else ()),
    ]
    own_rows = {(row.ros1, row.ros2): row for row in rows_of(robot)}
    to_robot = {key for key, row in own_rows.items() if row.to_robot}
    further = [replace(row, to_robot=(row.ros1, row.ros2) in to_robot) for row in further]
    replaced = {(row.ros1, row.ros2) for row in further}
    rows = chosen(
        (*(row for key, row in own_rows.items() if key not in replaced), *further), options.only
    )
    refuse_circles(rows)
    return BridgeTable(
        rows=rows, services=() if options.only else services_of(robot), converter=converter
    )


def profile_of(options: BridgeOptions) -> Profile:
    """Return the robot's names in ROS 1; ConfigError for a profile that cannot be here.

    Towards ROS 1 a topic may have several names; from there only one, or messages would come twice.
    """
    if options.profile is None:
        return Profile.BOTH if options.robot is Side.ROS2 else Profile.COMPATIBILITY
    if options.profile in {Profile.ROS2, Profile.P2OS}:
        raise ConfigError("--profile is compatibility, standard or both")
    if options.profile is Profile.BOTH and options.robot is Side.ROS1:
        raise ConfigError(
            "with the robot in ROS 1 --profile is compatibility or standard: with both names each"
            " message would come twice"
        )
    return options.profile


async def serve(options: BridgeOptions, tell: Callable[[str], None]) -> int:
    """Bridge until somebody shuts the node down, or this is cancelled.

    Raises:
        PioneerError: something could not be started; the message says what to do.
    """
    lasting, at = options.lasting, addresses(options.master)
    if options.node.network.chosen() is BackendName.RCLPY:
        tell("note: rclpy follows the variables of ROS 2")
    table = await asyncio.to_thread(table_of, options)
    async with on_ros2(options.node, tell) as (backend, name, _, arguments):
        if arguments.rules:
            raise ConfigError(
                "a bridge takes the names of topics from its table (--list, --topics FILE); of the"
                " remapping rules after --ros-args only __node and __ns count"
            )
        extra = {BRIDGE_FIELD: "1"}
        async with ros1_node(f"/{name.name}", at, tell, extra) as node:
            tell(f"node {node.name} of ROS 1 on {at.master}")
            bridge = TopicBridge(
                node,
                backend,
                name.full,
                table.converter,
                rows=table.rows,
                services=table.services,
                robot=options.robot,
                timeout=lasting,
                resumes=options.resumes,
                tell=tell,
            )
            await bridge.run()
    return 0
