"""Publishes the topics of the table: each one when it is due, and has subscribers."""

import asyncio
from collections import defaultdict
from collections.abc import AsyncGenerator, Callable, Sequence
from contextlib import aclosing
from dataclasses import dataclass, field
from math import inf
from typing import Any, Final, TypeVar

from pioneer3.errors import DeviceError, MissingTypeError
from pioneer3.ros.messages.diagnostics import DiagnosticStatus, DiagnosticsUpdate
from pioneer3.ros.messages.navigation import NavigationUpdate
from pioneer3.ros.messages.update import StateUpdate
from pioneer3.ros.node.middleware import Outlet, Publisher
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.topic import Topic, Update
from pioneer3.ros.node.topics import SLOWLY
from pioneer3.tasks import next_tick

V = TypeVar("V")

LOST: Final = object()
"""Last content of a latched topic while there is no robot."""
EARLY: Final = 0.05
"""Snapshots come a little early or late: a topic that is due this soon [s] is due."""
LOOK: Final = 0.2
"""Pause between two looks whether a device has subscribers, where no reports come [s]."""
SILENCE: Final = 1.0
"""Pause between two looks whether a device that is read still has subscribers [s]. With each of its
values it is looked at, too."""
TOGETHER: Final = 4
"""Most messages that are filled before the first of them is sent, so that none waits for many."""
PAUSE: Final = 0.5
"""Pause after a device turned out to be missing [s]."""


@dataclass(slots=True)
class _Row:
    """A topic, the publishers of its names, its last content, and when that was sent [s].

    The last message is filled again: to make one takes as long as to fill it.
    """

    topic: Topic
    publishers: list[Publisher] = field(default_factory=list)
    content: object = None
    at: float = -inf
    message: Any = None

    @property
    def subscribed(self) -> bool:
        for publisher in self.publishers:  # noqa: SIM110  a generator takes twice as long
            if publisher.subscribed:
                return True
        return False

    def is_due(self, update: Update, *, subscribed: bool) -> bool:
        """Return whether to publish now, and take note of it."""
        topic = self.topic
        if not topic.has_data(update):
            return False
        if topic.changes is None or not isinstance(update, StateUpdate | NavigationUpdate):
            self.content = None
            return True
        content, now = topic.changes(update), update.moment
        waits = subscribed and topic.period is not None
        waited = waits and now - self.at >= (topic.period or 0.0) - EARLY
        if content == self.content and not waited:
            return False
        self.content, self.at = content, now
        return True

    def publish(self, message: Any) -> None:
        for publisher in self.publishers:
            publisher.publish(message)


def _send(filled: list[_Row]) -> None:
    """Send the messages of rows, and forget these."""
    for row in filled:
        row.publish(row.message)
    filled.clear()


class Publishing:
    """The publishers of `topics`, by their names in `profile`."""

    def __init__(self, topics: Sequence[Topic], profile: Profile, middleware: Outlet) -> None:
        self._rows = [_Row(topic) for topic in topics]
        self._rows_of: dict[tuple[type[Update], str], list[_Row]] = defaultdict(list)
        self._awaited: dict[tuple[type[Update], str], list[_Row]] = defaultdict(list)
        for row in self._rows:
            topic = row.topic
            self._rows_of[topic.source, topic.sensor].append(row)
            if not topic.latched or topic.is_repeated:
                self._awaited[topic.source, topic.sensor].append(row)
        self._unread: dict[tuple[type[Update], str], asyncio.Event] = {}
        self._profile = profile
        self._middleware = middleware

    def advertise(self, available: Callable[[Topic], bool]) -> None:
        """Advertise the topics that are `available`, in a thread; warn of types that ROS lacks."""
        left_out: dict[str, list[str]] = defaultdict(list)
        for row in self._rows:
            topic = row.topic
            names = topic.names(self._profile) if available(topic) else ()
            try:
                row.publishers = [
                    self._middleware.advertise(name, topic.type_name, latched=topic.latched)
                    for name in names
                ]
            except MissingTypeError as error:
                left_out[str(error)] += names
        for reason, several in left_out.items():
            self._middleware.warn(f"nothing is published on {' and '.join(several)}: {reason}")

    def publish(self, update: Update, sensor: str = "") -> None:
        """Publish the topics of this kind of update, and of this sensor, that are due.

        Some are filled first and then sent together: whom the first wakes finds the others, too.
        """
        filled: list[_Row] = []
        for row in self._rows_of[type(update), sensor]:
            subscribed = row.subscribed
            wanted = subscribed or (row.topic.latched and row.publishers)
            if wanted and row.is_due(update, subscribed=subscribed):
                assert row.topic.fill is not None
                if row.message is None or row.topic.latched:  # rclpy may keep a latched one
                    row.message = self._middleware.make(row.topic.type_name)
                row.topic.fill(row.message, update)
                filled.append(row)
                if len(filled) == TOGETHER:
                    _send(filled)
        _send(filled)

    def has_subscribers(self, source: type[Update], sensor: str = "") -> bool:
        """Return whether anybody subscribes to a topic of this kind of update and sensor.

        Latched ones that are sent when their content changes do not count.
        """
        return any(row.subscribed for row in self._awaited[source, sensor])

    def lose_robot(self) -> None:
        """Publish on latched topics that nothing is known: they must not outlive it.

        Topics that every snapshot has say so at each call, the others at the first one.
        """
        for row in self._rows:
            topic = row.topic
            again = topic.is_repeated or row.content is not LOST
            if topic.latched and topic.when_lost is not None and again:
                row.content = LOST
                row.publish(topic.when_lost)

    def look(self) -> None:
        """Begin to read the devices that have subscribers now."""
        for (source, sensor), wanted in self._unread.items():
            if not wanted.is_set() and self.has_subscribers(source, sensor):
                wanted.set()

    async def keep_looking(self) -> None:
        """Look again and again, where no reports come to do it with."""
        while True:
            self.look()
            await next_tick(LOOK)

    async def publish_diagnostics(
        self, found: Callable[[], tuple[DiagnosticStatus, ...]], hardware: Callable[[], str]
    ) -> None:
        """Publish the states of parts that are found again and again, also of a lost robot."""
        while True:
            if self.has_subscribers(DiagnosticsUpdate):
                self.publish(
                    DiagnosticsUpdate(
                        found=found(),
                        node=self._middleware.name,
                        hardware=hardware(),
                        stamp=self._middleware.stamp(0.0),
                        make=self._middleware.make,
                    )
                )
            await next_tick(SLOWLY)

    async def publish_device(
        self,
        source: type[Update],
        values: Callable[[], AsyncGenerator[V, None]],
        update_of: Callable[[V], Update],
        sensor: str = "",
    ) -> None:
        """Read the values of a device while its topic has subscribers; without that, do nothing.

        Somebody must :meth:`look` again and again whether it has.
        """
        key = source, sensor
        while any(row.publishers for row in self._rows_of[key]):
            if not self.has_subscribers(source, sensor):
                self._unread[key] = asyncio.Event()
                await self._unread[key].wait()
                continue

            async def read() -> bool:
                async with aclosing(values()) as found:
                    async for value in found:
                        if not self.has_subscribers(source, sensor):
                            return False
                        self.publish(update_of(value), sensor)
                return True

            reading = asyncio.ensure_future(read())
            try:
                # a device that gives nothing is left, too, when nobody subscribes any more
                while not reading.done() and self.has_subscribers(source, sensor):
                    await asyncio.wait({reading}, timeout=SILENCE)
                if reading.done() and await reading:
                    return
            except DeviceError:  # another robot is at the other end now
                await asyncio.sleep(PAUSE)
            finally:
                reading.cancel()
                await asyncio.wait({reading})
