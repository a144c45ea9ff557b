"""How commands for a fleet reach robots over ROS 1 and ROS 2."""

import os
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pioneer3.fleet.live import OnTopics
    from pioneer3.fleet.members import Connect
    from pioneer3.fleet.spec import Fleet, FleetRobot
    from pioneer3.ros.ros2.network import Network
    from pioneer3.runtime.driven import Driven

PATIENCE = 5.0
"""Longest wait for a node of ROS 2 [s], unless somebody says otherwise."""


@asynccontextmanager
async def connecting(
    fleet: "Fleet",
    name: str,
    max_speed: float | None,
    *,
    patience: float = PATIENCE,
    sonar: bool = False,
    at_once: bool = False,
) -> "AsyncIterator[Connect]":
    """Yield the function that connects to a robot; over ROS this is the node `name`.

    `max_speed` bounds the speeds at ports [m/s]; `patience` is the longest wait for a node on a
    network of ROS 2 [s]. Modes need the `sonar` of ROS 2, keys do not. With `at_once` it goes on
    before robots on ROS report, to stop them, whatever their model.
    """
    from pioneer3.fleet.members import connects
    from pioneer3.fleet.reach import model_of
    from pioneer3.fleet.ros_graph import missing_variables
    from pioneer3.ros.ros1.client import robots_by_node
    from pioneer3.ros.ros2.sessions import sessions

    os.environ.update(missing_variables(fleet, os.environ))  # nodes take them from there
    async with (
        robots_by_node(name, at_once=at_once) as by_node,
        sessions(name, patience, sonar=sonar, at_once=at_once) as networks,
    ):

        def ros1(robot: "FleetRobot") -> "AbstractAsyncContextManager[Driven]":
            return by_node(robot.node, None if at_once else model_of(fleet, robot) or None)

        def ros2(robot: "FleetRobot") -> "AbstractAsyncContextManager[Driven]":
            model = None if at_once else model_of(fleet, robot) or None
            return networks.robot(network_of(fleet, robot), robot.node, model)

        yield connects(fleet, ros1, ros2, max_speed=max_speed)


@asynccontextmanager
async def asking(
    fleet: "Fleet",
) -> "AsyncIterator[Callable[[FleetRobot, float], Awaitable[OnTopics]]]":
    """Yield the function that asks a robot's topics of ROS 2."""
    import asyncio

    from pioneer3.fleet.live import OnTopics
    from pioneer3.ros.ros2.sessions import sessions

    async with sessions("fleet_list") as networks:

        async def ask(robot: "FleetRobot", patience: float) -> "OnTopics":
            until = asyncio.get_running_loop().time() + patience
            session = await networks.on(network_of(fleet, robot))
            told = await session.state(robot.node, until)
            return OnTopics(
                network=session.backend.title,
                battery=told.battery,
                motors=told.motors,
                stopped=told.emergency_stop,
                age=told.age,
                nodes=told.nodes,
            )

        yield ask


def network_of(fleet: "Fleet", robot: "FleetRobot") -> "Network":
    """Return the network of ROS 2 that a robot is on; its files are beside the fleet file."""
    from pioneer3.ros.ros2.network import BackendName, Network

    given, folder = fleet.network(robot), fleet.path.parent
    return Network(
        backend=BackendName(given.backend),
        distro=given.distro or None,
        domain=given.domain,
        interface=given.interface,
        peer=given.peer,
        dds_services=given.dds_services,
        connect=given.connect,
        zenoh_config=given.file("zenoh_config", folder),
        ca=given.file("ca", folder),
        certificate=given.file("certificate", folder),
        key=given.file("key", folder),
        credentials=given.file("credentials", folder),
    )
