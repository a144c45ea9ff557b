"""Programs on ROS 2 that find robots and drive them by their topics, from any computer."""

import asyncio
from collections import Counter, defaultdict
from collections.abc import AsyncIterator, Callable, Coroutine, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from typing import Any, Final

from pioneer3.models import load_model
from pioneer3.ros.client.graph import NodeTopics, RobotTopics, robots_among, wanted
from pioneer3.ros.client.joining import LARGEST, info_of, joined
from pioneer3.ros.client.robot import TopicRobot
from pioneer3.ros.node.middleware import Topics
from pioneer3.ros.ros2.backend import Backend, EndpointKind, Graph
from pioneer3.ros.ros2.middleware import ClientTopics
from pioneer3.ros.ros2.requests import NodeRequests
from pioneer3.ros.ros2.start import NodeOptions, on_ros2
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.tasks import in_own_thread

DISCOVERY: Final = 2.0
"""Nodes find each other within this time [s], commonly."""
LOOK: Final = 0.1
"""Pause between two looks at the graph [s]."""


def robots_of(graph: Graph) -> list[RobotTopics]:
    """Return the robots in a graph: nodes that publish odometry and take velocity commands."""
    nodes: dict[str, NodeTopics] = defaultdict(NodeTopics)
    for each in graph.endpoints:
        kind = each.type_name.replace("/msg/", "/")
        if each.node and each.kind is EndpointKind.PUBLISHER:
            nodes[each.node].published[each.name] = kind
        elif each.node and each.kind is EndpointKind.SUBSCRIBER:
            nodes[each.node].heard[each.name] = kind
    for name, number in Counter(graph.nodes).items():
        nodes[name].nodes = number
    return robots_among(nodes)


async def find_robots(options: NodeOptions) -> list[RobotTopics]:
    """Return the robots that are found on the network in time; ConfigError for a wrong option."""
    async with on_ros2(options, lambda line: None) as (backend, _, _, _):
        await asyncio.sleep(DISCOVERY)
        return robots_of(backend.graph())


async def run_program(
    options: NodeOptions,
    names: Sequence[str],
    model: str | None,
    work: Callable[[list[TopicRobot], Topics], Coroutine[Any, Any, None]],
    *,
    several: bool = False,
) -> int:
    """Be a node and do `work` with robots, given the topics of the node, too; then they stand.

    Without names it is the only robot, or with `several` all there are; without a model it is the
    largest.

    Raises:
        ConfigError: an option is wrong, there are several robots, or no such model.
        NoRobotError: there is no such robot, or it is silent.
    """
    async with on_ros2(options, lambda line: None) as (backend, node, types, arguments):
        found = await _found(backend, names, several=several)
        middleware = ClientTopics(backend, node, types, arguments)
        async with AsyncExitStack() as stack:
            driven = [
                await stack.enter_async_context(
                    driven_robot(topics, model, backend, types, middleware)
                )
                for topics in found
            ]
            await work(driven, middleware)
    return 0


@asynccontextmanager
async def driven_robot(
    topics: RobotTopics,
    model: str | None,
    backend: Backend,
    types: MessageTypes,
    middleware: ClientTopics,
    *,
    sonar: bool = True,
    at_once: bool = False,
) -> AsyncIterator[TopicRobot]:
    """Be ready to drive a robot while the block lasts; then it stands; see :func:`joined`.

    Without a model it is the largest. Backend, types and middleware are those of this program.

    Raises:
        ConfigError: there is no such model, or several nodes have its name.
        NoRobotError: it is silent.
    """
    requests = NodeRequests(backend, types, middleware, topics.node)
    try:
        requests.open()
        async with joined(
            topics,
            info_of(topics, load_model(model or LARGEST)),
            middleware,
            requests.switch_motors,
            latch=requests.latch,
            sonar=sonar,
            at_once=at_once,
        ) as driven:
            yield driven
    finally:
        await in_own_thread(requests.close)


async def _found(backend: Backend, names: Sequence[str], *, several: bool) -> list[RobotTopics]:
    """Return the robots, as soon as those of these names are there, or nodes had time to appear."""
    loop = asyncio.get_running_loop()
    until = loop.time() + DISCOVERY
    while loop.time() < until:
        await asyncio.sleep(LOOK)
        known = robots_of(backend.graph())
        if names and all(any(name in each.names for each in known) for name in names):
            await asyncio.sleep(LOOK)  # for the rest of their topics
            break
    return wanted(robots_of(backend.graph()), names, several=several)
