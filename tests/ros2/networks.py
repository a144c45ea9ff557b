"""Real networks of ROS 2 on loopback, and a program on them that is not the node."""

import asyncio
import socket
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from itertools import cycle
from typing import Any

from pioneer3.ros.dds.settings import DdsOptions
from pioneer3.ros.ros2.backend import Backend, Endpoint, EndpointKind, NodeName, Qos, Writer
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.network import BackendName, Network, open_backend
from pioneer3.ros.ros2.types import MessageTypes
from tests.e2e.processes import free_port, running

NUMBERS = range(20, 101)
"""Domains whose ports are below those that the system gives to anybody."""
OWN_DOMAINS = 16
RESERVED: list[socket.socket] = []


def _domains() -> Iterator[int]:
    """Yield numbers of domains that no other process on this computer tests in."""
    own = []
    for number in NUMBERS:
        reserved = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            # the last port of the domain, which no participant takes
            reserved.bind(("127.0.0.1", DdsOptions(domain=number).ports[-1]))
        except OSError:
            reserved.close()
            continue
        RESERVED.append(reserved)
        own.append(number)
        yield number
        if len(own) == OWN_DOMAINS:
            break
    yield from cycle(own)


DOMAINS = _domains()
"""Numbers of domains; one that comes again has long been left."""


@dataclass
class Peer:
    """A node that listens, sends and calls, over the same kind of network."""

    backend: Backend
    types: MessageTypes
    heard: dict[str, list[tuple[float, Any]]] = field(default_factory=dict)
    left: list[bytes] = field(default_factory=list)

    def hear(self, name: str, type_name: str, qos: Qos | None = None) -> list[tuple[float, Any]]:
        """Return the messages of a topic with their times [s], which come from now on."""
        messages: list[tuple[float, Any]] = []
        type_ = self.types.message_type(type_name)
        clock = asyncio.get_running_loop().time

        def received(cdr: bytes, gid: bytes) -> None:
            messages.append((clock(), self.types.decode(cdr, type_.name)))

        self.backend.subscribe(name, type_, qos or Qos(), received, self.left.append)
        return messages

    def publisher(self, name: str, type_name: str, qos: Qos | None = None) -> Writer:
        return self.backend.advertise(name, self.types.message_type(type_name), qos or Qos())

    def twist(self, v: float, w: float = 0.0) -> bytes:
        message = self.types.make("geometry_msgs/Twist")
        message.linear.x, message.angular.z = v, w
        return self.types.encode(message)

    def endpoint(self, name: str, kind: EndpointKind = EndpointKind.PUBLISHER) -> Endpoint | None:
        """Return an endpoint that it has found, or `None`."""
        found = (e for e in self.backend.graph().endpoints if (e.name, e.kind) == (name, kind))
        return next(found, None)

    def knows(self, name: str, kind: EndpointKind, node: str) -> bool:
        """Return whether it knows this endpoint, and that it is of this node."""
        found = self.endpoint(name, kind)
        return found is not None and found.node == node

    async def call(self, name: str, type_name: str, **fields: object) -> Any:
        """Call a service."""
        type_ = self.types.service_type(type_name)
        request = self.types.make(type_.request.name)
        for key, value in fields.items():
            setattr(request, key, value)
        cdr = self.types.encode(request)
        response = await asyncio.to_thread(self.backend.call, name, type_, cdr, 10.0)
        return self.types.decode(response, type_.response.name)


@dataclass
class Ros2:
    """A network on loopback that only this test is on.

    Attributes:
        network: Where it is.
        variables: Of the environment of commands that join it.
    """

    network: Network
    variables: Mapping[str, str] = field(default_factory=dict)

    @property
    def options(self) -> tuple[str, ...]:
        """Options of commands that join it."""
        connect = [word for each in self.network.connect for word in ("--connect", each)]
        domain = str(self.network.domain)
        return ("--backend", self.network.backend, "--domain", domain, *connect)

    @asynccontextmanager
    async def peer(self, name: str = "peer", distro: str = "jazzy") -> AsyncIterator[Peer]:
        """Join it in this process."""
        types = MessageTypes(distro_of(distro))
        node = NodeName(name)
        backend = await asyncio.to_thread(open_backend, self.network, node, types)
        try:
            yield Peer(backend, types)
        finally:
            await asyncio.to_thread(backend.close)


@asynccontextmanager
async def network_of(backend: BackendName) -> AsyncIterator[Ros2]:
    """Make a network of this kind; of Zenoh with a router of its own."""
    if backend is BackendName.DDS:
        yield Ros2(Network(backend=backend, domain=next(DOMAINS)))
        return
    place = f"tcp/127.0.0.1:{free_port()}"
    async with running("ros2", "router", "--listen", place) as router:
        assert "router" in await router.line()
        yield Ros2(Network(backend=backend, domain=next(DOMAINS), connect=(place,)))
