"""Robots on several networks of ROS 2 at once: this program is one node on each of them.

Calls that may hang are made in threads of their own, so that a network or a robot out of reach
delays no other one.
"""

import asyncio
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Final

from pioneer3.errors import NoNodeError
from pioneer3.ros.client.graph import RobotTopics
from pioneer3.ros.client.robot import TopicRobot
from pioneer3.ros.ros2.backend import Backend, NodeName
from pioneer3.ros.ros2.client import driven_robot, robots_of
from pioneer3.ros.ros2.middleware import ClientTopics
from pioneer3.ros.ros2.names import node_name
from pioneer3.ros.ros2.network import Network, open_backend
from pioneer3.ros.ros2.state import RobotState, StateReader
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.tasks import in_own_thread

FOUND: Final = 5.0
"""A node that is not found within this time [s] is not there."""
LOOK: Final = 0.1
"""Pause between two looks at the graph [s]."""
SETTLED: Final = 0.3
"""A node whose topics are the same for this time [s] has no more of them; a stop goes out once they
are the same for one :data:`LOOK`."""
LEAVING: Final = 6.0
"""Longest time to leave a network [s]."""


class NetworkNode:
    """This program as a node on one network; for `sonar` and `at_once` see :func:`sessions`."""

    def __init__(
        self, backend: Backend, node: NodeName, types: MessageTypes, *, sonar: bool, at_once: bool
    ) -> None:
        self.backend, self._sonar, self._at_once = backend, sonar, at_once
        self._node, self._types = node, types
        self._clock = asyncio.get_running_loop().time
        self._robots: dict[str, RobotTopics] = {}
        self._looked_at = -LOOK
        self._readers: dict[str, StateReader] = {}

    @asynccontextmanager
    async def robot(self, node: str, model: str | None, until: float) -> AsyncIterator[TopicRobot]:
        """Connect to the robot of a node; in the end it stands.

        It is looked for up to `until` [s, loop time]; without a model it is the largest.

        Raises:
            ConfigError: there is no such model, or several nodes have this name.
            NoNodeError: there is no such node, or it is silent.
        """
        topics = await self._found(node, until)
        middleware = self._topics()
        try:
            async with driven_robot(
                topics,
                model,
                self.backend,
                self._types,
                middleware,
                sonar=self._sonar,
                at_once=self._at_once,
            ) as driven:
                yield driven
        finally:
            await in_own_thread(middleware.close)

    async def state(self, node: str, until: float) -> RobotState:
        """Return the state of the robot of a node, as soon as it has told all of it.

        Raises:
            NoNodeError: there is no such node at the time `until` [s, loop time].
        """
        topics = await self._found(node, until)
        if topics.unclear:
            return RobotState(nodes=topics.nodes)
        reader = self._readers.get(topics.node)
        if reader is None:
            reader = self._readers[topics.node] = StateReader(topics, self._topics())
            await in_own_thread(reader.open)
        return await reader.state(until - self._clock())

    async def _found(self, node: str, until: float) -> RobotTopics:
        full, settled = f"/{node.lstrip('/')}", LOOK if self._at_once else SETTLED
        seen, since = None, self._clock()
        while True:
            topics, now = self._look().get(full), self._clock()
            if topics != seen:  # the rest of its topics may still be on the way
                seen, since = topics, now
            known = now - since >= settled or full in self._readers or now > until
            if topics is not None and known:
                return topics
            if now > until:
                raise NoNodeError(self._missing(full))
            await asyncio.sleep(LOOK)

    def _look(self) -> dict[str, RobotTopics]:
        """Return the robots by node; all that wait for one share a look at the graph."""
        now = self._clock()
        if now >= self._looked_at + LOOK / 2:
            self._robots = {each.node: each for each in robots_of(self.backend.graph())}
            self._looked_at = now
        return self._robots

    def _missing(self, node: str) -> str:
        others = ", ".join(name for name in self._robots if name != node)
        there = f"; there are {others}" if others else ""
        return f"no node {node} that drives a robot is on {self.backend.title}{there}"

    def _topics(self) -> ClientTopics:
        return ClientTopics(self.backend, self._node, self._types)


class NetworkNodes:
    """The networks that this program is on; one is joined with the first robot on it."""

    def __init__(self, name: str, patience: float, *, sonar: bool, at_once: bool) -> None:
        self._name, self._patience = name, patience
        self._sonar, self._at_once = sonar, at_once
        self._joining: dict[Network, asyncio.Task[NetworkNode]] = {}
        self._open = True

    async def on(self, network: Network) -> NetworkNode:
        """Return this program's node on a network; after a failure the next call tries again.

        Raises:
            ConfigError: a library is missing, or an option is wrong.
            LinkError: the network cannot be joined.
        """
        task = self._joining.get(network)
        if task is None or (task.done() and task.exception() is not None):
            task = self._joining[network] = asyncio.create_task(self._join(network))
        return await asyncio.shield(task)

    @asynccontextmanager
    async def robot(
        self, network: Network, node: str, model: str | None
    ) -> AsyncIterator[TopicRobot]:
        """Connect to the robot of a node on a network; in the end it stands.

        Raises:
            PioneerError: see :meth:`on` and :meth:`NetworkNode.robot`.
        """
        until = asyncio.get_running_loop().time() + self._patience
        session = await self.on(network)
        async with session.robot(node, model, until) as driven:
            yield driven

    async def close(self) -> None:
        """Leave all networks, side by side; one that hangs is not waited for."""
        self._open = False
        await asyncio.gather(*map(_left, self._joining.values()))

    async def _join(self, network: Network) -> NetworkNode:
        node = node_name(f"{self._name}_{os.getpid()}", "/")

        def opened() -> tuple[Backend, MessageTypes]:
            types = MessageTypes(network.distro_here())
            backend = open_backend(network, node, types)
            if not self._open:
                backend.close()  # nobody waits for it any more
            return backend, types

        backend, types = await in_own_thread(opened)
        return NetworkNode(backend, node, types, sonar=self._sonar, at_once=self._at_once)


@asynccontextmanager
async def sessions(
    name: str, patience: float = FOUND, *, sonar: bool = False, at_once: bool = False
) -> AsyncIterator[NetworkNodes]:
    """Be the node `name` on the networks of robots that are asked for during the block.

    The node of a robot is waited for up to `patience` [s]. Most topics of a robot are of its sonar.
    With `at_once` it goes on before robots report, to stop them.
    """
    made = NetworkNodes(name, patience, sonar=sonar, at_once=at_once)
    try:
        yield made
    finally:
        await made.close()


async def _left(joining: "asyncio.Task[NetworkNode]") -> None:
    """Leave one network."""
    if not joining.done():
        joining.cancel()
        await asyncio.gather(joining, return_exceptions=True)
    elif joining.exception() is None:
        with suppress(TimeoutError):
            async with asyncio.timeout(LEAVING):
                await in_own_thread(joining.result().backend.close)
