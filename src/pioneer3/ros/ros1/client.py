"""Programs on ROS 1 that find robots and drive them by their topics, from any computer."""

import asyncio
import logging
import threading
from collections.abc import AsyncIterator, Callable, Coroutine, Iterable, Sequence
from contextlib import (
    AbstractAsyncContextManager,
    AsyncExitStack,
    asynccontextmanager,
    closing,
    suppress,
)
from functools import partial
from socket import create_connection
from typing import Any, Final
from urllib.parse import urlsplit

from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.models import find_model, load_model
from pioneer3.robot.session import SIMULATOR_SERIAL
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.ros.client.graph import RobotTopics, robots_on
from pioneer3.ros.client.joining import FIRST, LARGEST, info_of, joined
from pioneer3.ros.client.robot import TopicRobot
from pioneer3.ros.node.parameters import MODEL, SIMULATED
from pioneer3.ros.ros1.environment import checked_master, environment_warnings
from pioneer3.ros.ros1.middleware import RospyTopics, find_rospy
from pioneer3.ros.ros1.start import begin_node
from pioneer3.tasks import in_own_thread, running

ALIVE: Final = 0.5
"""A node that takes no connection within this time [s] has gone."""
MASTER_PATIENCE: Final = 2.0
"""A master that takes no connection within this time [s] is not there."""
FAREWELL: Final = 0.1
"""rospy sends in threads of its own; a stop needs this long to be on its way [s]."""
SERVED: Final = 0.5
"""A service that does not respond within this time [s] is not there."""
SWITCHED: Final = 2.0
"""Longest wait for a request that is under way when the program leaves the robot [s]."""
log = logging.getLogger(__name__)


def find_robots() -> list[RobotTopics]:
    """Return the robots on the master whose nodes are alive.

    Raises:
        ConfigError: ROS 1 is not installed, or ROS_MASTER_URI is no address.
        NoRobotError: there is no master.
    """
    find_rospy()
    import rosgraph

    uri = checked_master(rosgraph.get_master_uri())
    master = rosgraph.Master("/pioneer3")
    try:
        publishers, subscribers, _ = master.getSystemState()
        types = dict(master.getTopicTypes())
        found = robots_on(publishers, subscribers, types)
        return [robot for robot in found if _is_alive(master.lookupNode(robot.node))]
    except (OSError, rosgraph.MasterException) as error:
        raise NoRobotError(
            f"there is no ROS master at {uri} ({error}): start roscore, or set ROS_MASTER_URI"
        ) from error


async def run_program(
    name: str,
    arguments: Sequence[str],
    robots: Iterable[RobotTopics],
    model: str | None,
    work: Callable[[list[TopicRobot]], Coroutine[Any, Any, None]],
) -> None:
    """Be a ROS node and do `work` with robots, until it is done or the node is shut down.

    Then they stand. `model` of `None` stands for those in the parameters of their nodes; `name` is
    that of our node, unless ROS's own `arguments` have another.

    Raises:
        ConfigError: an argument is none of ROS's, or there is no such model.
        NoRobotError: a robot is silent.
    """
    async with _program(name, arguments) as ended, AsyncExitStack() as stack:
        driven = [await stack.enter_async_context(_joined(robot, model)) for robot in robots]

        async def working() -> None:
            await work(driven)
            ended.set()

        async with running(working()):
            await ended.wait()


@asynccontextmanager
async def robots_by_node(
    name: str, *, at_once: bool = False
) -> AsyncIterator[Callable[[str, str | None], AbstractAsyncContextManager[TopicRobot]]]:
    """Yield a function that connects to the robot of a node, given its name and a model or `None`.

    This program becomes the node `name` with the first robot, and is one until the block ends: who
    has no robot on ROS needs no ROS. `at_once` goes on before robots report, to stop them.

    Raises:
        ConfigError: by that function: ROS 1 is not installed.
        NoRobotError: by that function: there is no master, or no such robot on it.
    """
    async with AsyncExitStack() as stack:
        begun = asyncio.Lock()
        is_node = False

        @asynccontextmanager
        async def connect(node: str, model: str | None) -> AsyncIterator[TopicRobot]:
            nonlocal is_node
            topics = await asyncio.to_thread(_robot_of, node)
            async with begun:
                if not is_node:
                    await stack.enter_async_context(_program(name, ()))
                    is_node = True
            async with _joined(topics, model, at_once=at_once) as robot:
                yield robot

        yield connect


def _robot_of(node: str) -> RobotTopics:
    """Return the robot of a node; errors as of :func:`robots_by_node`."""
    find_rospy()
    import rosgraph

    uri = checked_master(rosgraph.get_master_uri())
    if not _is_alive(uri, MASTER_PATIENCE):  # rospy would wait for minutes
        raise NoRobotError(f"there is no ROS master at {uri}: start roscore, or set ROS_MASTER_URI")
    for robot in find_robots():
        if robot.node.lstrip("/") == node.lstrip("/"):
            return robot
    raise NoRobotError(f"no node {node} that drives a robot is on the ROS master at {uri}")


@asynccontextmanager
async def _program(name: str, arguments: Sequence[str]) -> AsyncIterator[asyncio.Event]:
    """Be a ROS node while the block lasts; the event says that somebody shut it down."""
    import rosgraph
    import rospy

    odd = [argument for argument in arguments if ":=" not in argument]
    if odd:
        raise ConfigError(f"{odd[0]!r} is none of ROS's arguments, such as __name:=mine")
    wrong = await asyncio.to_thread(environment_warnings)
    loop, ended, left = asyncio.get_running_loop(), asyncio.Event(), threading.Event()

    def end() -> None:
        with suppress(RuntimeError):  # the loop has ended before
            loop.call_soon_threadsafe(ended.set)
            left.wait(FIRST)  # the robot is to be stopped while topics still work

    await begin_node(name, arguments, rosgraph.get_master_uri())
    for sentence in wrong:
        rospy.logwarn(sentence)
    rospy.on_shutdown(end)
    try:
        yield ended
    finally:
        await asyncio.sleep(FAREWELL)
        left.set()
        await asyncio.to_thread(rospy.signal_shutdown, "the program ends")


@asynccontextmanager
async def _joined(
    topics: RobotTopics, model: str | None, *, at_once: bool = False
) -> AsyncIterator[TopicRobot]:
    """Listen to a robot and be ready to drive it while the block lasts; then it stands."""
    info = await asyncio.to_thread(_info, topics, model)
    switch = MotorSwitch(partial(_switch_motors, topics.node))
    try:
        async with joined(topics, info, RospyTopics(), switch, at_once=at_once) as robot:
            yield robot
    finally:
        await in_own_thread(switch.close)


def _info(topics: RobotTopics, model: str | None) -> RobotInfo:
    """Return the identity of a robot by its node's parameters."""
    import rospy

    said = str(rospy.get_param(f"{topics.node}/{MODEL}", LARGEST))
    found = load_model(model) if model else find_model(said) or load_model(LARGEST)
    simulated = rospy.get_param(f"{topics.node}/{SIMULATED}", False)
    config = Config(family="", model="", serial_number=SIMULATOR_SERIAL) if simulated else None
    return info_of(topics, found, config)


class MotorSwitch:
    """Makes `call` to switch motors, one at a time, in a thread: a node may hang for ever."""

    def __init__(self, call: Callable[[bool], None]) -> None:
        self._call = call
        self._wanted: bool | None = None
        self._is_busy = False
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def __call__(self, on: bool) -> None:
        """Ask for power, or none; of the requests that wait only the last one is made."""
        with self._lock:
            self._wanted = on
            if self._is_busy:
                return
            self._is_busy = True
            self._thread = threading.Thread(target=self._run, name="motor switch", daemon=True)
            self._thread.start()

    def close(self) -> None:
        """Wait for the last request, but not for a node that hangs; in a thread."""
        with self._lock:
            thread = self._thread
        if thread is not None:
            thread.join(SWITCHED)

    def _run(self) -> None:
        while True:
            with self._lock:
                wanted, self._wanted = self._wanted, None
                if wanted is None:
                    self._is_busy = False
                    return
            try:
                self._call(wanted)
            except Exception:
                log.exception("the motors are not switched")


def _switch_motors(node: str, on: bool) -> None:
    """Call the service of the robot's node."""
    import rospy
    from std_srvs.srv import Empty

    name = "enable_motors" if on else "disable_motors"
    for full in (f"{node}/{name}", f"{node.rpartition('/')[0]}/{name}"):
        with suppress(rospy.ROSException, rospy.ServiceException):
            rospy.wait_for_service(full, SERVED)
            rospy.ServiceProxy(full, Empty)()
            return
    rospy.logwarn(f"{node} has no service {name}")


def _is_alive(uri: str, patience: float = ALIVE) -> bool:
    """Return whether a node answers at its address: one that was killed stays registered."""
    address = urlsplit(uri)
    try:
        with closing(create_connection((address.hostname, address.port), patience)):
            return True
    except OSError:
        return False
