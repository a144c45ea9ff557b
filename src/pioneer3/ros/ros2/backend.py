"""The seam between ROS 2 and the wire: serialized messages, services, and the graph of nodes.

A backend is one node on one network. All of its calls may take their time, so they are made in
threads, but for :meth:`Writer.write`. Callbacks come in threads of the backend.
"""

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from math import inf
from threading import Lock
from typing import Final, Protocol

from pioneer3.errors import ConfigError

DEPTH: Final = 10
"""Messages that wait for a slow subscriber."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Qos:
    """Quality of service of a publisher or a subscriber: else best effort, volatile.

    Of the history the newest `depth` stay. From the age of its lifespan [s] on a message reaches
    nobody; the deadline is the longest time between two messages, the lease that between two signs
    of life [s], which the publisher itself gives if they are `manual`. `inf` is for none.
    """

    reliable: bool = True
    transient_local: bool = False
    depth: int = DEPTH
    lifespan: float = inf
    deadline: float = inf
    lease: float = inf
    manual: bool = False


LATCHED: Final = Qos(transient_local=True, depth=1)


def strictest(offered: Sequence[Qos], depth: int) -> Qos:
    """Return the strictest quality of service that all publishers offer; none offer nothing."""
    return Qos(
        reliable=bool(offered) and all(each.reliable for each in offered),
        transient_local=bool(offered) and all(each.transient_local for each in offered),
        depth=depth,
    )


def to_dds(name: str) -> str:
    """Return `nav_msgs::msg::dds_::Odometry_` for `nav_msgs/msg/Odometry`."""
    *packages, last = name.split("/")
    return "::".join((*packages, "dds_", f"{last}_"))


def from_dds(name: str) -> str:
    """Return `nav_msgs/msg/Odometry` for `nav_msgs::msg::dds_::Odometry_`."""
    parts = name.split("::")
    if parts[-2:-1] == ["dds_"]:
        parts[-2:] = [parts[-1].removesuffix("_")]
    return "/".join(parts)


@dataclass(frozen=True, slots=True)
class MessageType:
    """A type of messages such as `nav_msgs/msg/Odometry`; before Iron there is no hash."""

    name: str
    hash: str = ""


@dataclass(frozen=True, slots=True)
class ServiceType:
    """A type of services such as `std_srvs/srv/SetBool`; the hash is that of the whole service."""

    name: str
    hash: str
    request: MessageType
    response: MessageType


class EndpointKind(StrEnum):
    """The kinds of endpoints of a node."""

    PUBLISHER = "publisher"
    SUBSCRIBER = "subscriber"
    SERVER = "server"
    CLIENT = "client"


@dataclass(frozen=True, slots=True, kw_only=True)
class Endpoint:
    """An endpoint that was found on the network; what is not known of it is empty.

    Names are full ones such as `/robot1/odom`, types such as `nav_msgs/msg/Odometry`; the `gid` of
    a publisher comes with each message, too.
    """

    kind: EndpointKind
    node: str
    name: str
    type_name: str
    type_hash: str = ""
    qos: Qos = field(default_factory=Qos)
    gid: bytes = b""


@dataclass(frozen=True, slots=True)
class Graph:
    """All nodes and endpoints that are known, our own among them.

    Nodes are full names, sorted; two nodes of one name are there twice.
    """

    nodes: tuple[str, ...] = ()
    endpoints: tuple[Endpoint, ...] = ()


@dataclass(frozen=True, slots=True)
class NodeName:
    """Name of a node: `name` in `namespace`, which is `/` or such as `/robot1`."""

    name: str
    namespace: str = "/"

    @property
    def full(self) -> str:
        """Such as `/robot1/pioneer3`."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


class Writer(Protocol):
    """A publisher."""

    @property
    def matched(self) -> bool:
        """Whether anybody subscribes; cheap, for it is asked before each message."""

    def write(self, cdr: bytes) -> None:
        """Send a serialized message with its header of 4 bytes; never waits for a subscriber."""

    def close(self) -> None:
        """Publish no more."""


class Closable(Protocol):
    """A subscriber, or a service that is offered."""

    def close(self) -> None:
        """Receive no more."""


Received = Callable[[bytes, bytes], None]
"""Given a serialized message, and the identity of its publisher; quick: the backend hears nothing
meanwhile."""
Left = Callable[[bytes], None]
"""Given the identity of a publisher that is no longer there."""
Respond = Callable[[bytes], bytes]
"""Given a serialized request, returns the serialized response."""
Failed = Callable[[str], None]
"""Given a sentence for a person on a network that is lost for good."""


class Backend(Protocol):
    """A node on a network.

    Attributes:
        title: For people, such as `DDS (Cyclone DDS 11.0.1), domain 0`.
        serves: Whether it can offer services that the peers can call.
        strict: Whether publishers and subscribers with incompatible QoS do not match.
        lacks: Sentence about the parts of ROS 2 that it does not have; empty for none.
    """

    title: str
    serves: bool
    strict: bool
    lacks: str

    def advertise(self, name: str, type_: MessageType, qos: Qos) -> Writer:
        """Publish on the topic with this full name, such as `/robot1/odom`."""

    def subscribe(
        self, name: str, type_: MessageType, qos: Qos, received: Received, left: Left
    ) -> Closable:
        """Subscribe to the topic with this full name."""

    def serve(self, name: str, type_: ServiceType, respond: Respond) -> Closable:
        """Offer a service; `respond` is given a serialized request and returns the response.

        Requests come in threads that may wait; one that waits does not hold up messages.
        """

    def call(self, name: str, type_: ServiceType, request: bytes, timeout: float) -> bytes:
        """Call a service; return the serialized response; TimeoutError after `timeout` [s]."""

    def graph(self) -> Graph:
        """Return the nodes and endpoints that are known now."""

    def on_failure(self, call: Failed) -> None:
        """Call `call`, in any thread, if nothing is received any more; publishers leave before."""

    def close(self) -> None:
        """Leave the network; nothing is received afterwards."""


log = logging.getLogger(__name__)


class Unread:
    """Counts things such as `requests of /x` that cannot be read, and tells of the first.

    Any thread may use it.
    """

    def __init__(self, what: str) -> None:
        self._what = what
        self._number = 0
        self._lock = Lock()

    def add(self, error: Exception) -> None:
        """Count one, with the reason."""
        with self._lock:
            self._number += 1
            is_first = self._number == 1
        if is_first:
            log.warning("%s cannot be read: %s; others are only counted", self._what, error)

    def close(self) -> None:
        """Tell how many there were, if the first was not the only one."""
        if self._number > 1:
            log.warning("%d %s could not be read", self._number, self._what)


OWNERS: Final = {EndpointKind.PUBLISHER: "publisher", EndpointKind.SUBSCRIBER: "subscription"}


def overridden(qos: Qos, topic: str, kind: EndpointKind, parameters: Mapping[str, object]) -> Qos:
    """Return `qos` as parameters want it for a topic's full name; ConfigError for odd values."""
    prefix = f"qos_overrides.{topic}.{OWNERS[kind]}."
    for name, value in parameters.items():
        if name.startswith(prefix):
            qos = _changed(qos, name, name.removeprefix(prefix), value)
    return qos


def _changed(qos: Qos, name: str, policy: str, value: object) -> Qos:
    match policy:
        case "reliability":
            reliable = _chosen(name, value, {"reliable": True, "best_effort": False})
            return replace(qos, reliable=reliable)
        case "durability":
            late = _chosen(name, value, {"transient_local": True, "volatile": False})
            return replace(qos, transient_local=late)
        case "depth" if isinstance(value, int) and 1 <= value <= 1000:
            return replace(qos, depth=value)
        case "history" if value == "keep_last":
            return qos
        case "depth" | "history":
            wanted = "a number from 1 to 1000" if policy == "depth" else "keep_last"
            raise ConfigError(f"{name} must be {wanted}, not {value!r}")
        case _:
            raise ConfigError(
                f"{name}: reliability, durability, history and depth can be overridden"
            )


def _chosen(name: str, value: object, known: Mapping[str, bool]) -> bool:
    if not isinstance(value, str) or value not in known:
        raise ConfigError(f"{name} must be {' or '.join(known)}, not {value!r}")
    return known[value]
