"""The middleware of ROS 1: topics, services, parameters and time, without an installation of it."""

import asyncio
import logging
from collections.abc import Callable, Coroutine
from contextlib import suppress
from functools import partial
from typing import Any, Final, TypeVar

from pioneer3.models.description.xml import MAKER
from pioneer3.ros.node.clock import RosClock
from pioneer3.ros.node.driving_parameters import DrivingParameters
from pioneer3.ros.node.middleware import QUEUE, Lose, Receive, Sender, Unsubscribe
from pioneer3.ros.node.parameters import NodeParameters
from pioneer3.ros.ros1.arguments import Ros1Arguments
from pioneer3.ros.ros1.reconfigure import Reconfigure
from pioneer3.ros.ros1.rosout import TYPE, RosoutHandler, loggers, set_level
from pioneer3.ros.tcpros.answers import MasterRefusalError
from pioneer3.ros.tcpros.master import LOST
from pioneer3.ros.tcpros.node import Ros1Node
from pioneer3.ros.tcpros.publisher import TopicPublisher
from pioneer3.ros.tcpros.services import ServiceError
from pioneer3.ros.tcpros.subscriber import PublisherConnection
from pioneer3.ros.tcpros.types import REQUEST, RESPONSE, Ros1Types
from pioneer3.tasks import hand_over, in_own_thread

T = TypeVar("T")
DESCRIPTION: Final = "robot_description"
"""The parameter in which rviz looks for the robot's description."""
USE_SIM_TIME: Final = "/use_sim_time"
ROSOUT_QUEUE: Final = 100
WAITING: Final = 10.0
"""Longest wait of a thread for the loop [s]; the master has less time."""
log = logging.getLogger("rosout")


class Ros1Publisher:
    """A publisher whose messages are serialized once."""

    def __init__(self, publisher: TopicPublisher, types: Ros1Types) -> None:
        self._publisher, self._types = publisher, types

    @property
    def subscribed(self) -> bool:
        """Whether anybody subscribes."""
        return self._publisher.matched

    def publish(self, message: Any) -> None:
        """Send a message, or the content of one that has a single field."""
        if not hasattr(message, "__msgtype__"):
            content, message = message, self._types.make(self._publisher.type.name)
            message.data = content
        self._publisher.write(self._types.encode(message))


class Ros1Topics:
    """Publishing and subscribing of a node, in the loop or in a thread."""

    def __init__(self, node: Ros1Node, types: Ros1Types, arguments: Ros1Arguments) -> None:
        self.node = node
        self._types, self._arguments = types, arguments
        self._loop = asyncio.get_running_loop()
        self._asked: set[str] = set()
        self._is_leaving = False

    def make(self, type_name: str) -> Any:
        """Return an empty message."""
        return self._types.make(type_name)

    def resolve(self, name: str) -> str:
        """Return the full name of a topic, service or parameter after remapping."""
        self._asked.add(self._arguments.full(name))
        return self._arguments.resolved(name)

    async def tell_unused_rules(self) -> None:
        """Warn of each remapping of a name that this node does not have."""
        own = f"{self.node.name}/"
        for source, target in self._arguments.rules.items():
            full, last = self._arguments.full(source), source.rpartition("/")[2].lstrip("~")
            if full in self._asked or await self._is_known(self._arguments.full(target)):
                continue
            meant = sorted(each for each in self._asked if each.rpartition("/")[2] == last)
            name = meant[0].replace(own, "~") if meant else ""
            hint = f"; did you mean '{name}:={target}'?" if name else ""
            self.warn(f"{source}:={target} changes nothing: there is no {full} here{hint}")

    async def _is_known(self, name: str) -> bool:
        """Return whether a topic, service or parameter is there."""
        try:
            return self.node.has(name) or bool(await self.node.master.call("hasParam", name))
        except (*LOST, MasterRefusalError):
            return True

    def warn(self, sentence: str) -> None:
        """Log a warning."""
        log.warning("%s", sentence)

    def advertise(
        self, name: str, type_name: str, *, latched: bool = False, queue: int = QUEUE
    ) -> Ros1Publisher:
        """Return a publisher."""
        full, type_ = self.resolve(name), self._types.definition(type_name)
        made = self.node.advertise(full, type_, latched=latched, queue=queue)
        return Ros1Publisher(made, self._types)

    def subscribe(
        self, name: str, type_name: str, receive: Receive, *, queue: int, left: Lose | None = None
    ) -> Unsubscribe:
        """Call `receive` and `left` in the loop; other bytes are told of once."""
        full, type_ = self.resolve(name), self._types.definition(type_name)
        senders: dict[PublisherConnection, Sender] = {}
        refused: set[str] = set()

        def received(data: bytes, connection: PublisherConnection, old: bool) -> None:
            try:
                message = self._types.decode(data, type_name)
            except ValueError as error:
                if connection.node not in refused:
                    refused.add(connection.node)
                    self.warn(
                        f"{connection.node} sends bytes on {full} that are no {type_name}: {error}"
                    )
                return
            if (sender := senders.get(connection)) is None:
                sender = Sender(connection.node, connection, connection.is_latched)
                senders[connection] = sender
            receive(message, sender)

        def ended(connection: PublisherConnection) -> None:
            sender = senders.pop(connection, None)
            if left is not None and sender is not None and not self._is_leaving:
                left(sender)

        subscription = self.node.subscribe(full, type_, received, ended, queue)
        return partial(hand_over, self._loop, self.node.unsubscribe, subscription)

    def _wait(self, work: Coroutine[Any, Any, T]) -> T:
        """Return the result of work in the loop, in a thread; TimeoutError if that takes long."""
        return asyncio.run_coroutine_threadsafe(work, self._loop).result(WAITING)


class Ros1Middleware(Ros1Topics):
    """All that a node needs; :meth:`begin` comes first."""

    serves = True
    mismatches = None

    def __init__(self, node: Ros1Node, types: Ros1Types, arguments: Ros1Arguments) -> None:
        super().__init__(node, types, arguments)
        self._clock = RosClock()
        self._described: str | None = None
        self._reconfigure: Reconfigure | None = None
        self._rosout: logging.Handler | None = None

    @property
    def name(self) -> str:
        """Full name of the node."""
        return self.node.name

    async def begin(self) -> None:
        """Publish the log, set the parameters of the arguments, take the time of a simulator.

        Raises:
            OSError, EOFError: the master is lost.
        """
        published = self.advertise("/rosout", TYPE, latched=True, queue=ROSOUT_QUEUE)
        self._rosout = RosoutHandler(self.name, self._types, published.publish)
        logging.getLogger().addHandler(self._rosout)
        self.serve("~get_loggers", "roscpp/GetLoggers", lambda request: loggers(self._types))
        self.serve("~set_logger_level", "roscpp/SetLoggerLevel", set_level)
        for name, value in self._arguments.parameters.items():
            await self.node.master.call("setParam", self._arguments.full(f"~{name}"), value)
        if await self.node.get(USE_SIM_TIME):
            self._clock.simulates = True
            self.subscribe("/clock", "rosgraph_msgs/Clock", self._clock.take, queue=1)

    def end(self) -> None:
        """Publish the log no more."""
        if self._rosout is not None:
            logging.getLogger().removeHandler(self._rosout)

    def stamp(self, age: float) -> Any:
        """Return the ROS time of the moment `age` seconds ago."""
        return self._clock.stamp(age, self._types.make)

    def age(self, stamp: Any) -> float | None:
        """Return the time since a stamp [s]; `None` for a stamp of 0."""
        return self._clock.age(stamp)

    def serve(self, name: str, type_name: str, handle: Callable[[Any], Any]) -> None:
        """Offer a service; each request is handled in a thread of its own."""
        full = self.resolve(name)
        request_type, response_type = f"{type_name}{REQUEST}", f"{type_name}{RESPONSE}"

        async def respond(data: bytes) -> bytes:
            request = self._types.decode(data, request_type)
            try:
                result = await in_own_thread(partial(handle, request))
            except Exception as error:
                log.exception("the service %s", full)
                raise ServiceError(f"error processing request: {error}") from error
            return self._types.encode(self._types.filled(response_type, result))

        self.node.serve(full, self._types.service_definition(type_name), respond)

    def describe(self, urdf: str) -> None:
        """Set `robot_description`, unless it has a description that is not of this package."""
        name = self.resolve(DESCRIPTION)
        there = self._wait(self.node.get(name, ""))
        if there and MAKER not in str(there):
            self.warn(f"{name} is somebody else's: it stays as it is")
            return
        if there != urdf:
            self._wait(self.node.master.call("setParam", name, urdf))
        self._described = urdf

    def reconfigure(self, parameters: NodeParameters, driving: DrivingParameters) -> None:
        """Offer dynamic_reconfigure of the driving parameters."""
        self._wait(self._open_reconfigure(driving))

    async def _open_reconfigure(self, driving: DrivingParameters) -> None:
        self._reconfigure = Reconfigure(driving, self.node, self._types, self.warn)
        await self._reconfigure.open(self)

    def forget(self) -> None:
        """Leave the parameter server as it was."""
        self._is_leaving = True
        with suppress(TimeoutError):  # the master hangs
            self._wait(self._forget())

    async def _forget(self) -> None:
        with suppress(*LOST, MasterRefusalError):  # the master may be gone
            name = self.resolve(DESCRIPTION)
            if self._described is not None and await self.node.get(name) == self._described:
                await self.node.master.call("deleteParam", name)
            if self._reconfigure is not None:
                await self._reconfigure.forget()

    def on_shutdown(self, call: Callable[[], None]) -> None:
        """Call `call` in the loop when somebody shuts the node down."""
        self.node.on_shutdown.append(call)
