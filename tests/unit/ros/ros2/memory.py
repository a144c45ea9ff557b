"""A backend whose network is in this process: all that its nodes send is there at once."""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count

from pioneer3.ros.ros2.backend import (
    Endpoint,
    EndpointKind,
    Failed,
    Graph,
    Left,
    MessageType,
    NodeName,
    Qos,
    Received,
    ServiceType,
)
from pioneer3.ros.ros2.mismatches import Own, incompatible

GIDS = count(1)


@dataclass
class MemoryEndpoint:
    """An endpoint in this process."""

    network: "MemoryNetwork"
    endpoint: Endpoint
    received: Received | None = None
    left: Left | None = None
    last: bytes | None = None
    sent: list[bytes] = field(default_factory=list)

    def hears(self, other: "MemoryEndpoint") -> bool:
        """Return whether this subscriber gets the messages of a publisher."""
        mine, theirs = self.endpoint, other.endpoint
        if mine.name != theirs.name or mine.type_name != theirs.type_name:
            return False
        own = Own(EndpointKind.SUBSCRIBER, MessageType(mine.type_name), mine.qos)
        are_pair = (mine.kind, theirs.kind) == (EndpointKind.SUBSCRIBER, EndpointKind.PUBLISHER)
        return are_pair and not incompatible(own, theirs)

    @property
    def matched(self) -> bool:
        return any(each.hears(self) for each in self.network.endpoints)

    def write(self, cdr: bytes) -> None:
        self.last = cdr
        self.sent.append(cdr)
        for each in list(self.network.endpoints):
            if each.hears(self) and each.received is not None:
                each.received(cdr, self.endpoint.gid)

    def close(self) -> None:
        if self in self.network.endpoints:
            self.network.endpoints.remove(self)
            for each in list(self.network.endpoints):
                if each.hears(self) and each.left is not None:
                    each.left(self.endpoint.gid)


@dataclass(eq=False)
class MemoryNetwork:
    """Everything that nodes have on this network.

    Attributes:
        endpoints: Of all nodes.
        servers: Theirs, by name of the service.
        nodes: Their names; if empty, those of the endpoints.
    """

    endpoints: list[MemoryEndpoint] = field(default_factory=list)
    servers: dict[str, Callable[[bytes], bytes]] = field(default_factory=dict)
    nodes: list[str] = field(default_factory=list)


class MemoryBackend:
    """A node on such a network."""

    title = "memory"
    strict = True
    lacks = ""

    def __init__(
        self, network: MemoryNetwork, node: NodeName | None = None, *, serves: bool = True
    ) -> None:
        self.network, self.node, self.serves = network, node or NodeName("test"), serves
        self.mine: list[MemoryEndpoint] = []

    def _add(self, kind: EndpointKind, name: str, type_: MessageType, qos: Qos) -> MemoryEndpoint:
        endpoint = Endpoint(
            kind=kind,
            node=self.node.full,
            name=name,
            type_name=type_.name,
            type_hash=type_.hash,
            qos=qos,
            gid=next(GIDS).to_bytes(16, "big"),
        )
        self.mine.append(MemoryEndpoint(self.network, endpoint))
        self.network.endpoints.append(self.mine[-1])
        return self.mine[-1]

    def advertise(self, name: str, type_: MessageType, qos: Qos) -> MemoryEndpoint:
        return self._add(EndpointKind.PUBLISHER, name, type_, qos)

    def subscribe(
        self, name: str, type_: MessageType, qos: Qos, received: Received, left: Left
    ) -> MemoryEndpoint:
        reader = self._add(EndpointKind.SUBSCRIBER, name, type_, qos)
        reader.received, reader.left = received, left
        for each in self.network.endpoints:
            if reader.hears(each) and qos.transient_local and each.last is not None:
                received(each.last, each.endpoint.gid)
        return reader

    def serve(
        self, name: str, type_: ServiceType, respond: Callable[[bytes], bytes]
    ) -> MemoryEndpoint:
        self.network.servers[name] = respond
        return self._add(EndpointKind.SERVER, name, MessageType(type_.name, type_.hash), Qos())

    def call(self, name: str, type_: ServiceType, request: bytes, timeout: float) -> bytes:
        if name not in self.network.servers:
            raise TimeoutError
        return self.network.servers[name](request)

    def graph(self) -> Graph:
        endpoints = tuple(each.endpoint for each in self.network.endpoints)
        named = self.network.nodes or sorted({each.node for each in endpoints})
        return Graph(tuple(named), endpoints)

    def on_failure(self, call: Failed) -> None:
        self.fail = call

    def close(self) -> None:
        for each in self.mine:
            each.close()
