"""Listens to the topics of one robot, and makes readings of what they say."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from math import inf
from typing import Any, Final

from pioneer3.models import RobotModel
from pioneer3.ros.interface.graph import ODOMETRY, RobotTopics
from pioneer3.ros.messages.gather import Gatherer
from pioneer3.ros.remote import TopicSupervisor
from pioneer3.ros.ros1.messages import BUMPER_KIND, message_class

TOGETHER: Final = 0.01
"""Messages of one reading come over several connections, all within this time [s]."""


class Ears:
    """Subscribes to what a robot publishes. rospy's threads end at one hand-over to the loop.

    Args:
        topics: Of the robot.
        model: Of the robot.
        supervisor: Takes the snapshots.
    """

    def __init__(self, topics: RobotTopics, model: RobotModel, supervisor: TopicSupervisor) -> None:
        self._topics = topics
        self._motors = topics.topic("std_msgs/Bool", "motors_state")
        self._gatherer = Gatherer(model, motors_on=self._motors is None)
        self._supervisor = supervisor
        self._loop = asyncio.get_running_loop()
        self._subscribers: list[Any] = []
        self._open = True

    def open(self) -> None:
        """Subscribe, in a thread."""
        gather, clock = self._gatherer, self._loop.time
        self._listen(self._topics.pose, ODOMETRY, self._begin_reading)
        self._listen_to("sensor_msgs/PointCloud", "sonar", lambda m: gather.sonar_cloud(m, clock()))
        self._listen_to(BUMPER_KIND, "", gather.bumpers)
        self._listen_to("std_msgs/Bool", "motors_state", gather.motors)
        self._listen_to("std_msgs/Float64", "battery_voltage", lambda m: gather.voltage(m.data))
        self._listen_to("sensor_msgs/BatteryState", "", lambda m: gather.voltage(m.voltage))
        for number, name in self._topics.numbered("sensor_msgs/Range").items():
            self._listen(name, "sensor_msgs/Range", partial(self._hear, number))

    def close(self) -> None:
        """Listen no more, in a thread."""
        self._open = False
        for subscriber in self._subscribers:
            subscriber.unregister()

    def _listen_to(self, kind: str, ending: str, take: Callable[[Any], None]) -> None:
        name = self._topics.topic(kind, ending)
        if name is not None:
            self._listen(name, kind, take)

    def _listen(self, name: str, kind: str, take: Callable[[Any], None]) -> None:
        import rospy  # noqa: PLC0415

        def received(message: Any) -> None:
            with suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(take, message)

        self._subscribers.append(
            rospy.Subscriber(name, message_class(kind), received, queue_size=1, tcp_nodelay=True)
        )

    def _hear(self, number: int, message: Any) -> None:
        silent = message.range >= message.max_range
        metres = inf if silent else message.range
        self._gatherer.sonar_range(number, metres, self._loop.time())

    def _begin_reading(self, message: Any) -> None:
        self._gatherer.pose(message)
        self._loop.call_later(TOGETHER, self._end_reading)

    def _end_reading(self) -> None:
        snapshot = self._gatherer.snapshot(self._loop.time())
        if snapshot is not None and self._open:
            self._supervisor.take(snapshot)
