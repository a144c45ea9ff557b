"""The middleware of ROS 2 over any backend: names, types, quality of service, time and logs."""

import logging
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from operator import attrgetter
from typing import Any, Final

from pioneer3.ros.node.clock import RosClock
from pioneer3.ros.node.driving_parameters import DrivingParameters
from pioneer3.ros.node.middleware import QUEUE, Lose, Receive, Unsubscribe
from pioneer3.ros.node.parameters import NodeParameters
from pioneer3.ros.ros2.arguments import RosArguments
from pioneer3.ros.ros2.backend import (
    LATCHED,
    Backend,
    Closable,
    EndpointKind,
    NodeName,
    Qos,
    Writer,
    overridden,
    strictest,
)
from pioneer3.ros.ros2.lifecycle import Callbacks, Lifecycle
from pioneer3.ros.ros2.mismatches import Own, OwnKey, mismatches
from pioneer3.ros.ros2.names import checked_topic
from pioneer3.ros.ros2.parameter_services import ParameterServices
from pioneer3.ros.ros2.remapping import Remapping, Resource, resolved
from pioneer3.ros.ros2.senders import REMEMBERED, Senders
from pioneer3.ros.ros2.types import MessageTypes

WARN: Final = 30
"""`rcl_interfaces/msg/Log.WARN`."""
ROSOUT: Final = Qos(transient_local=True, depth=1000, lifespan=10.0)
"""As `rcl_qos_profile_rosout_default` has it: programs that come late get no old warnings."""
EVENTS: Final = Qos(depth=1000)
"""As `rmw_qos_profile_parameter_events` has it."""
CLOCK: Final = Qos(reliable=False, depth=1)
"""Quality of subscriptions to `/clock`, as `rclcpp::ClockQoS`: its publishers are best effort."""
LONGEST: Final = 2**20
"""Longest message that is read [B]: the backend's thread, which reads it, hears for all topics."""
log = logging.getLogger(__name__)


class SerializedPublisher:
    """Publishes messages that are serialized once."""

    def __init__(self, writer: Writer, type_name: str, types: MessageTypes) -> None:
        self._writer, self._type, self._types = writer, type_name, types

    subscribed = property(attrgetter("_writer.matched"), doc="Whether anybody subscribes.")

    def publish(self, message: Any) -> None:
        """Send a message, or the content of one that has a single field."""
        if not hasattr(message, "__msgtype__"):
            content, message = message, self._types.make(self._type)
            message.data = content
        self._writer.write(self._types.encode(message))


class Ros2Topics:
    """Publishing and subscribing, for one node."""

    def __init__(
        self,
        backend: Backend,
        node: NodeName,
        types: MessageTypes,
        arguments: RosArguments | None = None,
    ) -> None:
        self._backend, self._node, self._types = backend, node, types
        self._arguments = arguments or RosArguments()
        self._own: dict[OwnKey, Own] = {}
        self._open: list[Closable] = []
        self._senders = Senders(backend.graph)
        self.clock = RosClock()

    @property
    def name(self) -> str:
        """Full name of the node."""
        return self._node.full

    def make(self, type_name: str) -> Any:
        """Return an empty message."""
        return self._types.make(type_name)

    def resolve(self, name: str) -> str:
        """Return the full name of a topic after remapping."""
        return resolved(name, self._node, self._arguments.rules)

    def add_rules(self, *rules: Remapping) -> None:
        """Add remapping rules, which count after those of the arguments."""
        self._arguments = replace(self._arguments, rules=(*self._arguments.rules, *rules))

    def advertise(
        self, name: str, type_name: str, *, latched: bool = False, queue: int = QUEUE
    ) -> SerializedPublisher:
        """Return a publisher: reliable, as RViz and Nav2 expect; latched is transient local."""
        full = checked_topic(self.resolve(name))
        qos = replace(LATCHED if latched else Qos(), depth=1 if latched else queue)
        qos = overridden(qos, full, EndpointKind.PUBLISHER, self._arguments.parameters)
        type_ = self._types.message_type(type_name)
        writer = self._backend.advertise(full, type_, qos)
        self._own[EndpointKind.PUBLISHER, full] = Own(EndpointKind.PUBLISHER, type_, qos)
        self._open.append(writer)
        return SerializedPublisher(writer, type_name, self._types)

    def subscribe(
        self, name: str, type_name: str, receive: Receive, *, queue: int, left: Lose | None = None
    ) -> Unsubscribe:
        """Call `receive` in a thread of the backend; other bytes are told of once, and counted."""
        full = checked_topic(self.resolve(name))
        return self._subscribe(full, type_name, receive, self._qos_to_read(full, queue), left)

    def _subscribe(
        self, full: str, type_name: str, receive: Receive, qos: Qos, left: Lose | None = None
    ) -> Unsubscribe:
        type_ = self._types.message_type(type_name)
        qos = overridden(qos, full, EndpointKind.SUBSCRIBER, self._arguments.parameters)
        refused: dict[bytes, int] = {}

        def received(cdr: bytes, gid: bytes) -> None:
            sender = self._senders.of(full, gid)
            try:
                if len(cdr) > LONGEST:
                    raise ValueError(f"{len(cdr)} bytes, of {LONGEST} at most")  # noqa: TRY301
                message = self._types.decode(cdr, type_.name)
            except ValueError as error:
                if gid not in refused and len(refused) < REMEMBERED:
                    refused[gid] = 0
                    self.warn(
                        f"{sender.node} sends bytes on {full} that are no {type_.name}: {error}"
                    )
                if gid in refused:
                    refused[gid] += 1
                return
            receive(message, sender)

        def gone(gid: bytes) -> None:
            sender = self._senders.lose(full, gid)
            if (number := refused.pop(gid, 0)) > 1 and sender is not None:
                self.warn(f"{sender.node} has left {full}: {number} messages were refused")
            if left is not None and sender is not None:
                left(sender)

        reader = self._backend.subscribe(full, type_, qos, received, gone)
        self._own[EndpointKind.SUBSCRIBER, full] = Own(EndpointKind.SUBSCRIBER, type_, qos)
        self._open.append(reader)
        return reader.close

    def warn(self, sentence: str) -> None:
        """Log a warning."""
        log.warning("%s", sentence)

    def mismatches(self) -> Sequence[str]:
        """Return a sentence for each endpoint of others that cannot talk to one of ours.

        And one if another node has the name of this one.
        """
        graph = self._backend.graph()
        found = list(mismatches(self._own, graph, self.name, strict=self._backend.strict))
        if (number := graph.nodes.count(self.name)) > 1:
            found.append(
                f"{number} nodes are called {self.name}: a command for one of them drives all; give"
                " each robot a --namespace"
            )
        return found

    def close(self) -> None:
        """End all publishers, subscriptions and services."""
        for each in self._open:
            each.close()
        self._open.clear()
        self._own.clear()

    def _qos_to_read(self, name: str, queue: int) -> Qos:
        return Qos(depth=queue)


class ClientTopics(Ros2Topics):
    """Topics for programs that listen to nodes of others, whatever their quality of service is."""

    def _qos_to_read(self, name: str, queue: int) -> Qos:
        """Return the strictest quality of service that all publishers of a topic offer."""
        offered = [
            each.qos
            for each in self._backend.graph().endpoints
            if each.name == name and each.kind is EndpointKind.PUBLISHER
        ]
        return strictest(offered, queue)


class Ros2Middleware(Ros2Topics):
    """All that a node needs; `tell` is given each warning, for the terminal."""

    def __init__(
        self,
        backend: Backend,
        node: NodeName,
        types: MessageTypes,
        arguments: RosArguments | None = None,
        tell: Callable[[str], None] = log.warning,
    ) -> None:
        super().__init__(backend, node, types, arguments)
        self._tell = tell
        rosout = types.message_type("rcl_interfaces/Log")
        self._rosout = backend.advertise("/rosout", rosout, ROSOUT)
        self._kept: dict[OwnKey, Own] = {}

    @property
    def serves(self) -> bool:
        """Whether others can call services of this node."""
        return self._backend.serves

    def stamp(self, age: float) -> Any:
        """Return the ROS time of the moment `age` seconds ago."""
        return self.clock.stamp(age, self._types.make)

    def age(self, stamp: Any) -> float | None:
        """Return the time since a stamp [s]; `None` for a stamp of 0."""
        return self.clock.age(stamp)

    def use_sim_time(self) -> None:
        """Take the time of `/clock` from now on."""
        self.clock.simulates = True
        name = checked_topic(self.resolve("/clock"))
        self._subscribe(name, "rosgraph_msgs/Clock", self.clock.take, CLOCK)

    def serve(self, name: str, type_name: str, handle: Callable[[Any], Any]) -> None:
        """Offer a service; fields of the response are copied from the object that it returns."""
        type_ = self._types.service_type(type_name)

        def respond(cdr: bytes) -> bytes:
            result = handle(self._types.decode(cdr, type_.request.name))
            return self._types.encode(self._types.filled(type_.response.name, result))

        full = resolved(name, self._node, self._arguments.rules, Resource.SERVICE)
        self._open.append(self._backend.serve(checked_topic(full), type_, respond))

    def describe(self, urdf: str) -> None:
        """Do nothing: in ROS 2 the description is a topic, which the table has."""

    def reconfigure(self, parameters: NodeParameters, driving: DrivingParameters) -> None:
        """Drive by the first values, and let others see and set them where services are."""
        driving.set(driving.wanted)
        if not self.serves:
            return
        events = self._backend.advertise(
            "/parameter_events", self._types.message_type("rcl_interfaces/ParameterEvent"), EVENTS
        )
        self._open.append(events)

        def changed(event: Any) -> None:
            event.node, event.stamp = self.name, self.stamp(0.0)
            events.write(self._types.encode(event))

        declared = {**parameters.values, **driving.declared}
        services = ParameterServices(self._types, declared, driving.change, changed)
        for name, (type_name, respond) in services.services.items():
            self.serve(name, type_name, respond)
        changed(services.declared())

    def lifecycle(self, callbacks: Callbacks) -> Lifecycle:
        """Return the life cycle of this node, which others see and change where services are."""
        if not self.serves:
            return Lifecycle(self._types, callbacks, lambda event: None)
        events = self._backend.advertise(
            self.resolve("~/transition_event"),
            self._types.message_type("lifecycle_msgs/TransitionEvent"),
            Qos(),
        )
        self._open.append(events)

        def changed(event: Any) -> None:
            event.timestamp = self.clock.now()
            events.write(self._types.encode(event))

        lifecycle = Lifecycle(self._types, callbacks, changed)
        for name, (type_name, respond) in lifecycle.services.items():
            self.serve(name, type_name, respond)
        return lifecycle

    def keep(self) -> None:
        """Let :meth:`forget` spare the endpoints that there are now; they end with the backend."""
        self._open.clear()
        self._kept = dict(self._own)

    def forget(self) -> None:
        """End all publishers, subscriptions and services but those that are kept."""
        self.close()
        self._own |= self._kept

    def on_shutdown(self, call: Callable[[], None]) -> None:
        """Do nothing: in ROS 2 others end a node by its life cycle only."""

    def warn(self, sentence: str) -> None:
        """Log a warning, here and on `/rosout`."""
        with suppress(OSError):  # nobody reads any more, and the next message may be a stop
            self._tell(sentence)
        message = self._types.make("rcl_interfaces/Log")
        message.stamp, message.level = self.stamp(0.0), WARN
        message.name, message.msg = self.name.strip("/").replace("/", "."), sentence
        self._rosout.write(self._types.encode(message))
