"""What a ROS 1 node publishes of each reading."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from pioneer3.ros.interface.topics import Profile, Topic
from pioneer3.ros.messages.convert import Reading
from pioneer3.ros.ros1.messages import make, publisher

UNKNOWN: Final = object()
"""Told of what is latched while there is no robot."""
EARLY: Final = 0.05
"""Readings come a little early or late: what is due this soon [s] is due."""


@dataclass(slots=True)
class _Row:
    """A topic, the publishers of its names, what was told last, and when [s]."""

    topic: Topic
    publishers: list[Any] = field(default_factory=list)
    told: object = None
    at: float = float("-inf")

    def is_due(self, reading: Reading) -> bool:
        """Whether somebody listens or, where it is latched, will want to know."""
        topic, now = self.topic, reading.snapshot.stamp
        heard = topic.latched or any(each.get_num_connections() for each in self.publishers)
        if not heard or not topic.known(reading):
            return False
        news = topic.told(reading) if topic.told else None
        waited = topic.period is not None and now - self.at >= topic.period - EARLY
        if topic.told and news == self.told and not waited:
            return False
        self.told, self.at = news, now
        return True

    def publish(self, message: Any) -> None:
        for each in self.publishers:
            each.publish(message)


class Publishers:
    """Publishes the topics of `profile` that are in a table."""

    def __init__(self, topics: Sequence[Topic], profile: Profile) -> None:
        self._rows = [_Row(topic) for topic in topics if topic.names(profile)]
        self._profile = profile

    def advertise(self) -> None:
        """Tell the master, in a thread: it may take its time."""
        for row in self._rows:
            topic = row.topic
            row.publishers = [
                publisher(name, topic.kind, latch=topic.latched)
                for name in topic.names(self._profile)
            ]

    def publish(self, reading: Reading) -> None:
        """Publish what is due."""
        for row in self._rows:
            if row.is_due(reading):
                message = make(row.topic.kind)
                row.topic.fill(message, reading)
                row.publish(message)

    def unlatch(self) -> None:
        """Publish of what is latched that nothing is known, once: it must not outlive the robot."""
        for row in self._rows:
            topic = row.topic
            if topic.latched and topic.unknown is not None and row.told is not UNKNOWN:
                row.told = UNKNOWN
                row.publish(topic.unknown)
