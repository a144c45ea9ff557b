"""Joins a robot by its topics, on any middleware."""

import asyncio
import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from typing import Any, Final

from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError, LinkError, NoRobotError
from pioneer3.geometry import Twist2
from pioneer3.models import RobotModel
from pioneer3.robot.limits import limits_for
from pioneer3.robot.supervisor import RobotInfo
from pioneer3.ros.client.graph import STAMPED, RobotTopics
from pioneer3.ros.client.robot import TopicRobot, TopicSupervisor
from pioneer3.ros.client.snapshots import SnapshotSubscriber
from pioneer3.ros.messages.motion import fill_twist
from pioneer3.ros.node.middleware import Publisher, Topics
from pioneer3.state import Identity
from pioneer3.tasks import in_own_thread, running

FIRST: Final = 5.0
"""Longest wait for the first snapshot [s]."""
MATCHED: Final = 0.15
"""A subscriber that is there is found within this time [s], commonly."""
LOOK: Final = 0.01
"""Pause between two looks for it [s]."""
LARGEST: Final = "p3at-sh"
"""The model of a robot of which nobody tells one."""
log = logging.getLogger(__name__)


def info_of(topics: RobotTopics, model: RobotModel, config: Config | None = None) -> RobotInfo:
    """Return the identity of a robot of a model."""
    return RobotInfo(
        identity=Identity(name=topics.name, family="Pioneer", model=model.name),
        model=model,
        limits=limits_for(model, None),
        config=config,
        url=topics.node,
        speed=None,
    )


@asynccontextmanager
async def joined(
    topics: RobotTopics,
    info: RobotInfo,
    middleware: Topics,
    switch: Callable[[bool], None],
    *,
    latch: Callable[[bool], None] | None = None,
    sonar: bool = True,
    at_once: bool = False,
) -> AsyncIterator[TopicRobot]:
    """Listen to a robot and be ready to drive it while the block lasts; then it stands.

    For `switch` and `latch` see :class:`TopicSupervisor`. Modes need the sonar, keys do not. With
    `at_once` it goes on before the robot reports: a silent one can be told to stop, and so can
    several of one name.

    Raises:
        ConfigError: several nodes have its name.
        NoRobotError: it is silent.
    """
    if topics.unclear and not at_once:
        raise ConfigError(topics.unclear)
    publisher = middleware.advertise(topics.commands, topics.command_type, queue=1)

    def publish(wanted: Twist2) -> None:
        message: Any = middleware.make(topics.command_type)
        # a stamp of 0 is now, whether the robot's time is a simulator's or not
        fill_twist(message.twist if topics.command_type == STAMPED else message, wanted)
        publisher.publish(message)

    tells = latch is not None and topics.emergency_stop is not None
    supervisor = TopicSupervisor(
        info, publish, switch, latch, unclear=topics.unclear, tells_stops=tells
    )
    robot = TopicRobot(supervisor)
    subscriber = SnapshotSubscriber(topics, info.model, supervisor.take, middleware, sonar=sonar)
    try:
        async with running(supervisor.run(), _opened(subscriber, goes_on=at_once)):
            if at_once:
                await _subscribed(publisher)
            else:
                await _reports(robot, topics)
            yield robot
    finally:
        await in_own_thread(subscriber.close)


async def _opened(subscriber: SnapshotSubscriber, *, goes_on: bool) -> None:
    """Subscribe; with `goes_on` a failure is logged, and stops are sent all the same."""
    try:
        await in_own_thread(subscriber.open)
    except Exception:
        if not goes_on:
            raise
        log.exception("the robot's topics cannot be subscribed to")


async def _subscribed(publisher: Publisher) -> None:
    """Wait until somebody takes the commands, or for :data:`MATCHED`."""
    with suppress(TimeoutError):
        async with asyncio.timeout(MATCHED):
            while not publisher.subscribed:  # noqa: ASYNC110  no middleware tells
                await asyncio.sleep(LOOK)


async def _reports(robot: TopicRobot, topics: RobotTopics) -> None:
    """Wait for the first snapshot."""
    try:
        await anext(robot.snapshots(FIRST, patience=FIRST))
    except LinkError:
        raise NoRobotError(
            f"{topics.node} publishes nothing on {topics.pose}: has it lost its robot?"
        ) from None
