"""Programs on ROS 1 that find robots and drive them by their topics, from any computer."""

import asyncio
import logging
from collections.abc import AsyncIterator, Awaitable, Callable, Coroutine, Iterable, Sequence
from contextlib import AbstractAsyncContextManager, AsyncExitStack, asynccontextmanager, suppress
from functools import partial
from typing import Any, Final
from urllib.parse import urlsplit

from pioneer3.arcos.reports import Config
from pioneer3.errors import NoRobotError
from pioneer3.models import find_model, load_model
from pioneer3.robot.session import SIMULATOR_SERIAL
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.ros.client.graph import RobotTopics, robots_on
from pioneer3.ros.client.joining import LARGEST, info_of, joined
from pioneer3.ros.client.robot import TopicRobot
from pioneer3.ros.node.middleware import Topics
from pioneer3.ros.node.parameters import MODEL, SIMULATED
from pioneer3.ros.ros1.arguments import Ros1Arguments, parse
from pioneer3.ros.ros1.middleware import Ros1Topics
from pioneer3.ros.ros1.start import checked_addresses, on_ros
from pioneer3.ros.tcpros.answers import MasterRefusalError
from pioneer3.ros.tcpros.master import LOST, Api, connect
from pioneer3.ros.tcpros.node import Ros1Node
from pioneer3.ros.tcpros.services import ServiceError
from pioneer3.ros.tcpros.types import Ros1Types
from pioneer3.tasks import running

ALIVE: Final = 0.5
"""A node that takes no connection within this time [s] has gone."""
SWITCHED: Final = 2.0
"""Longest wait for a request that is under way when the program leaves the robot [s]."""
CALLER: Final = "/pioneer3"
"""Name of programs that only ask."""
log = logging.getLogger("rosout")


async def find_robots(arguments: Sequence[str] = ()) -> list[RobotTopics]:
    """Return the robots on the master whose nodes are alive; `arguments` are ROS's own.

    Raises:
        ConfigError: an argument or ROS_MASTER_URI is wrong.
        NoRobotError: there is no master.
    """
    master = Api(_master_of(parse(arguments, CALLER.strip("/"))), CALLER)
    try:
        publishers, subscribers, *_ = await master.call("getSystemState")
        types = dict(await master.call("getTopicTypes"))
        found = robots_on(publishers, subscribers, types)
        alive = [await _is_alive(await master.call("lookupNode", each.node)) for each in found]
    except (*LOST, MasterRefusalError) as error:
        raise NoRobotError(
            f"there is no ROS master at {master.uri} ({error}): start roscore, or set"
            " ROS_MASTER_URI"
        ) from error
    return [robot for robot, responds in zip(found, alive, strict=True) if responds]


def _master_of(arguments: Ros1Arguments) -> str:
    return checked_addresses(arguments).master


async def run_program(
    name: str,
    arguments: Sequence[str],
    robots: Iterable[RobotTopics],
    model: str | None,
    work: Callable[[list[TopicRobot], Topics], Coroutine[Any, Any, None]],
) -> None:
    """Be a ROS node and do `work` with robots and the topics of the node.

    When that is done, or the node is shut down, the robots stand. `model` of `None` stands for
    those in the parameters of their nodes; `name` is that of our node, unless ROS's own `arguments`
    have another.

    Raises:
        ConfigError: an argument is none of ROS's, or there is no such model.
        NoRobotError: a robot is silent.
    """
    async with _program(name, arguments) as program, AsyncExitStack() as stack:
        driven = [await stack.enter_async_context(program.joined(each, model)) for each in robots]

        async def working() -> None:
            await work(driven, program.topics)
            program.node.ended.set()

        async with running(working()):
            await program.node.ended.wait()


@asynccontextmanager
async def robots_by_node(
    name: str, *, at_once: bool = False
) -> AsyncIterator[Callable[[str, str | None], AbstractAsyncContextManager[TopicRobot]]]:
    """Yield a function that connects to the robot of a node, given its name and a model or `None`.

    This program becomes the node `name` with the first robot, and is one until the block ends.
    `at_once` goes on before robots report, to stop them.

    Raises:
        ConfigError: by that function: a variable of ROS 1 is wrong.
        NoRobotError: by that function: there is no master, or no such robot on it.
    """
    async with AsyncExitStack() as stack:
        begun = asyncio.Lock()
        programs: list[RosProgram] = []

        @asynccontextmanager
        async def connect(node: str, model: str | None) -> AsyncIterator[TopicRobot]:
            topics = await _robot_of(node)
            async with begun:
                if not programs:
                    programs.append(await stack.enter_async_context(_program(name, ())))
            async with programs[0].joined(topics, model, at_once=at_once) as robot:
                yield robot

        yield connect


async def _robot_of(node: str) -> RobotTopics:
    """Return the robot of a node; errors as of :func:`robots_by_node`."""
    for robot in await find_robots():
        if robot.node.lstrip("/") == node.lstrip("/"):
            return robot
    uri = _master_of(parse((), CALLER.strip("/")))
    raise NoRobotError(f"no node {node} that drives a robot is on the ROS master at {uri}")


@asynccontextmanager
async def _program(name: str, arguments: Sequence[str]) -> AsyncIterator["RosProgram"]:
    """Be a ROS node while the block lasts."""
    async with on_ros(name, arguments, partial(log.warning, "%s")) as (node, types, given):
        yield RosProgram(node, types, Ros1Topics(node, types, given))


class RosProgram:
    """A node that drives robots by the `topics` of their nodes."""

    def __init__(self, node: Ros1Node, types: Ros1Types, topics: Ros1Topics) -> None:
        self.node, self.topics, self._types = node, topics, types

    @asynccontextmanager
    async def joined(
        self, topics: RobotTopics, model: str | None, *, at_once: bool = False
    ) -> AsyncIterator[TopicRobot]:
        """Listen to a robot and be ready to drive it while the block lasts; then it stands."""
        info = await self._info(topics, model)
        switch = MotorSwitch(partial(self._switch_motors, topics.node))
        async with running(switch.run()):
            try:
                async with joined(topics, info, self.topics, switch, at_once=at_once) as robot:
                    yield robot
            finally:
                await switch.finish()

    async def _info(self, topics: RobotTopics, model: str | None) -> RobotInfo:
        """Return the identity of a robot by its node's parameters."""
        said = str(await self.node.get(f"{topics.node}/{MODEL}", LARGEST))
        found = load_model(model) if model else find_model(said) or load_model(LARGEST)
        simulated = await self.node.get(f"{topics.node}/{SIMULATED}", False)
        config = Config(family="", model="", serial_number=SIMULATOR_SERIAL) if simulated else None
        return info_of(topics, found, config)

    async def _switch_motors(self, node: str, on: bool) -> None:
        """Call the service of the robot's node."""
        name = "enable_motors" if on else "disable_motors"
        type_ = self._types.service_definition("std_srvs/Empty")
        for full in (f"{node}/{name}", f"{node.rpartition('/')[0]}/{name}"):
            with suppress(ServiceError):
                await self.node.call(full, type_, b"")
                return
        self.topics.warn(f"{node} has no service {name}")


class MotorSwitch:
    """Makes `call` to switch motors, one at a time; a node may hang."""

    def __init__(self, call: Callable[[bool], Awaitable[None]]) -> None:
        self._call = call
        self._wanted: bool | None = None
        self._news = asyncio.Event()
        self._idle = asyncio.Event()
        self._idle.set()

    def __call__(self, on: bool) -> None:
        """Ask for power, or none; of the requests that wait only the last one is made."""
        self._wanted = on
        self._idle.clear()
        self._news.set()

    async def run(self) -> None:
        """Make the calls, for ever."""
        while True:
            await self._news.wait()
            self._news.clear()
            while self._wanted is not None:
                wanted, self._wanted = self._wanted, None
                try:
                    await self._call(wanted)
                except Exception:
                    log.exception("the motors are not switched")
            self._idle.set()

    async def finish(self) -> None:
        """Wait for the last request, but not for a node that hangs."""
        with suppress(TimeoutError):
            async with asyncio.timeout(SWITCHED):
                await self._idle.wait()


async def _is_alive(uri: str) -> bool:
    """Return whether a node answers at its address: one that was killed stays registered."""
    address = urlsplit(uri)
    try:
        async with asyncio.timeout(ALIVE):
            _, writer = await connect(address.hostname, address.port)
    except (OSError, ValueError):
        return False
    writer.close()
    return True
