"""Programs on ROS 1 that drive robots by their topics, from any computer."""

import asyncio
import threading
from collections.abc import AsyncIterator, Callable, Coroutine, Iterable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager, suppress
from functools import partial
from typing import Any, Final

from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError, LinkError, NoRobotError
from pioneer3.geometry import Twist2
from pioneer3.models import find_model, load_model
from pioneer3.robot.identity import SIMULATOR_SERIAL
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.ros.interface.graph import TWIST, RobotTopics
from pioneer3.ros.interface.parameters import MODEL, SIMULATED
from pioneer3.ros.remote import TopicRobot, TopicSupervisor
from pioneer3.ros.ros1.ears import Ears
from pioneer3.ros.ros1.messages import message_class
from pioneer3.ros.ros1.start import stay_on_this_computer
from pioneer3.state import Identity
from pioneer3.tasks import running

FIRST: Final = 5.0
"""Longest wait for the first reading [s]."""
FAREWELL: Final = 0.1
"""rospy sends in threads of its own; a stop needs this long to be on its way [s]."""
SERVED: Final = 0.5
"""A service that does not answer within this time [s] is not there."""
UNKNOWN_MODEL: Final = "p3at-sh"
"""What a robot is taken for whose node does not tell: the largest."""


async def run_program(
    name: str,
    arguments: Sequence[str],
    robots: Iterable[RobotTopics],
    model: str | None,
    work: Callable[[list[TopicRobot]], Coroutine[Any, Any, None]],
) -> None:
    """Be a ROS node and do `work` with robots, until it is done or the node is shut down.

    Then they stand.

    Args:
        name: Of the node, unless `arguments` have another.
        arguments: ROS's own.
        robots: On the master.
        model: What they are; if `None`, what their nodes say.
        work: Drives them.

    Raises:
        ConfigError: an argument is none of ROS's, or there is no such model.
        NoRobotError: a robot is silent.
    """
    async with _program(name, arguments) as ended, _joined_all(robots, model) as driven:
        await _unless_shut_down(ended, work(driven))


@asynccontextmanager
async def _program(name: str, arguments: Sequence[str]) -> AsyncIterator[asyncio.Event]:
    """Be a ROS node while the block lasts; the event says that somebody shut it down."""
    import rosgraph  # noqa: PLC0415
    import rospy  # noqa: PLC0415

    odd = [argument for argument in arguments if ":=" not in argument]
    if odd:
        raise ConfigError(f"{odd[0]!r} is none of ROS's arguments, such as __name:=mine")
    stay_on_this_computer(rosgraph.get_master_uri())
    loop, ended, left = asyncio.get_running_loop(), asyncio.Event(), threading.Event()

    def end() -> None:
        with suppress(RuntimeError):  # the loop has ended before
            loop.call_soon_threadsafe(ended.set)
            left.wait(FIRST)  # the robot is to be stopped while topics still work

    argv = ["pioneer3", *arguments]
    await asyncio.to_thread(rospy.init_node, name, argv=argv, disable_signals=True)
    rospy.on_shutdown(end)
    try:
        yield ended
    finally:
        await asyncio.sleep(FAREWELL)
        left.set()
        await asyncio.to_thread(rospy.signal_shutdown, "the program ends")


async def _unless_shut_down(ended: asyncio.Event, work: Coroutine[Any, Any, None]) -> None:
    """Do `work`, or as much of it as there is time for until the node is shut down."""
    working, ending = asyncio.create_task(work), asyncio.create_task(ended.wait())
    try:
        await asyncio.wait({working, ending}, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in (working, ending):
            task.cancel()
        await asyncio.gather(working, ending, return_exceptions=True)
    if not working.cancelled():
        working.result()


@asynccontextmanager
async def _joined_all(
    robots: Iterable[RobotTopics], model: str | None
) -> AsyncIterator[list[TopicRobot]]:
    """Listen to robots and be ready to drive them while the block lasts; then they stand."""
    async with AsyncExitStack() as stack:
        ones = [await stack.enter_async_context(_joined(topics, model)) for topics in robots]
        yield ones


@asynccontextmanager
async def _joined(topics: RobotTopics, model: str | None) -> AsyncIterator[TopicRobot]:
    import rospy  # noqa: PLC0415

    info = await asyncio.to_thread(_info, topics, model)
    twists = rospy.Publisher(topics.commands, message_class(TWIST), queue_size=1, tcp_nodelay=True)
    supervisor = TopicSupervisor(
        info, partial(_publish, twists), partial(_switch_motors, topics.node)
    )
    robot = TopicRobot(supervisor)
    ears = Ears(topics, info.model, supervisor)
    await asyncio.to_thread(ears.open)
    try:
        async with running(supervisor.run()):
            try:
                await anext(robot.snapshots(FIRST, patience=FIRST))
            except LinkError:
                raise NoRobotError(
                    f"{topics.node} publishes nothing on {topics.pose}: has it lost its robot?"
                ) from None
            yield robot
    finally:
        await asyncio.to_thread(ears.close)


def _info(topics: RobotTopics, model: str | None) -> RobotInfo:
    """Return what the node of a robot says of it."""
    import rospy  # noqa: PLC0415

    said = str(rospy.get_param(f"{topics.node}/{MODEL}", UNKNOWN_MODEL))
    found = load_model(model) if model else find_model(said) or load_model(UNKNOWN_MODEL)
    simulated = rospy.get_param(f"{topics.node}/{SIMULATED}", False)
    return RobotInfo(
        identity=Identity(name=topics.name, family="Pioneer", model=found.name),
        model=found,
        limits=limits_for(found, None),
        config=Config(family="", model="", serial_number=SIMULATOR_SERIAL) if simulated else None,
        url=topics.node,
        speed=None,
    )


def _publish(twists: Any, wanted: Twist2) -> None:
    message = message_class(TWIST)()
    message.linear.x, message.angular.z = wanted.v, wanted.w
    twists.publish(message)


def _switch_motors(node: str, on: bool) -> None:
    """Call the service of the robot's node; nobody waits for it."""
    import rospy  # noqa: PLC0415
    from std_srvs.srv import Empty  # noqa: PLC0415

    name = "enable_motors" if on else "disable_motors"

    def call() -> None:
        for full in (f"{node}/{name}", f"{node.rpartition('/')[0]}/{name}"):
            with suppress(rospy.ROSException, rospy.ServiceException):
                rospy.wait_for_service(full, SERVED)
                rospy.ServiceProxy(full, Empty)()
                return
        rospy.logwarn(f"{node} has no service {name}")

    asyncio.get_running_loop().run_in_executor(None, call)
