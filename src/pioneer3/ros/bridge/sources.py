"""The topics that messages come from, in ROS 1 and ROS 2, but for our own and those of bridges."""

import asyncio
from collections.abc import Callable
from typing import Final

from pioneer3.ros.bridge.relay import Inbox, TopicRelay
from pioneer3.ros.bridge.rows import BridgedTopic, Side
from pioneer3.ros.ros2.backend import Backend, Closable, EndpointKind, Graph, MessageType, Qos
from pioneer3.ros.tcpros.node import Ros1Node
from pioneer3.ros.tcpros.subscriber import PublisherConnection, TopicSubscription
from pioneer3.ros.tcpros.types import Definition

SEVERAL: Final = 100
"""Latched messages of several publishers."""
NEW: Final = 1.0
"""A publisher of an unknown node may turn out to be our own for so long [s]."""
LOOK: Final = 0.1
"""Pause between two looks for the node of a publisher [s]; some have none."""


class Bridges:
    """The other bridges that are known; `tell` is given a sentence, once."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self.names: dict[Side, set[str]] = {side: set() for side in Side}
        self._tell = tell

    def refuse(self, node: str, side: Side, topic: str, *, marked: bool = False) -> bool:
        """Return whether a node is a bridge, of which nothing is passed on; tell of it."""
        if not marked and node not in self.names[side]:
            return False
        self._tell(f"{side.words} {topic} of {node} is not passed on: that is a bridge, too")
        return True


class Ros1Source:
    """A topic of ROS 1."""

    def __init__(
        self, row: BridgedTopic, type_: Definition, node: Ros1Node, bridges: Bridges
    ) -> None:
        self.relays: list[TopicRelay] = []
        self._row, self._type, self._node, self._bridges = row, type_, node, bridges
        self._subscription: TopicSubscription | None = None

    @property
    def matched(self) -> bool:
        """Whether anybody publishes."""
        return self._subscription is not None and self._subscription.matched

    async def listen(self) -> None:
        """Subscribe, on demand only while somebody subscribes on the other side."""
        wanted = not self._row.on_demand or any(each.sink.matched for each in self.relays)
        if wanted and self._subscription is None:
            name = self._row.ros1
            self._subscription = self._node.subscribe(name, self._type, self._take, self._left)
        elif not wanted and self._subscription is not None:
            subscription, self._subscription = self._subscription, None
            self._node.unsubscribe(subscription)

    def _take(self, data: bytes, connection: PublisherConnection, old: bool) -> None:
        node, marked = connection.node, connection.is_bridge
        if self._bridges.refuse(node, Side.ROS1, self._row.ros1, marked=marked):
            return
        for relay in self.relays:
            relay.take(data, self._sender(connection), node, old=old)

    def _left(self, connection: PublisherConnection) -> None:
        for relay in self.relays:
            relay.left(self._sender(connection), connection.node, last=not self.matched)

    def _sender(self, connection: PublisherConnection) -> tuple[str, str]:
        """Return the identity of a publisher, which it keeps when it connects again."""
        return connection.uri, self._row.ros1


class Ros2Source:
    """A topic of ROS 2; `name` is the full name of our node."""

    def __init__(
        self, row: BridgedTopic, type_: MessageType, backend: Backend, name: str, bridges: Bridges
    ) -> None:
        self.relays: list[TopicRelay] = []
        self.qos = Qos(
            reliable=row.reliable or row.latched,
            transient_local=row.latched,
            depth=SEVERAL if row.latched else Qos().depth,
        )
        self._row, self._type, self._backend = row, type_, backend
        self._name, self._bridges = name, bridges
        self._loop = asyncio.get_running_loop()
        self._inbox = Inbox(self._take, self._loop, self.qos.depth)
        self._leaving = Inbox(self._left, self._loop)
        self._nodes: dict[bytes, str] = {}
        self._since: dict[bytes, float] = {}
        self._again: dict[bytes, float] = {}
        self._reader: Closable | None = None

    @property
    def matched(self) -> bool:
        """Whether anybody but us publishes."""
        return is_published(self._row.ros2, self._backend.graph(), self._name)

    async def listen(self) -> None:
        """Subscribe, on demand only while somebody subscribes on the other side."""
        wanted = not self._row.on_demand or any(each.sink.matched for each in self.relays)
        if wanted and self._reader is None:
            subscribe, put, left = self._backend.subscribe, self._inbox.put, self._leaving.put
            self._reader = await asyncio.to_thread(
                subscribe, self._row.ros2, self._type, self.qos, put, left
            )
        elif not wanted and self._reader is not None:
            reader, self._reader = self._reader, None
            await asyncio.to_thread(reader.close)

    def _take(self, cdr: bytes, gid: bytes) -> None:
        node = self._node_of(gid)
        if self._is_ours(node, gid) or self._bridges.refuse(node, Side.ROS2, self._row.ros2):
            return
        for relay in self.relays:
            relay.take(cdr, gid, node)

    def _left(self, gid: bytes) -> None:
        node, last = self._nodes.pop(gid, ""), not self.matched
        self._since.pop(gid, None)
        self._again.pop(gid, None)
        for relay in self.relays:
            relay.left(gid, node, last=last)

    def _node_of(self, gid: bytes) -> str:
        """Return the node of a publisher; empty if it is not known yet."""
        if gid in self._nodes:
            return self._nodes[gid]
        now = self._loop.time()
        if now < self._again.get(gid, 0.0):
            return ""
        self._again[gid] = now + LOOK
        endpoints = self._backend.graph().endpoints
        if found := next((each.node for each in endpoints if each.gid == gid), ""):
            self._nodes[gid] = found
        return found

    def _is_ours(self, node: str, gid: bytes) -> bool:
        """Return whether a message is our own, or may still turn out to be."""
        if node:
            return node == self._name
        if len(self._row.way.sources) == 1:
            return False
        now = self._loop.time()
        return now - self._since.setdefault(gid, now) < NEW


TopicSource = Ros1Source | Ros2Source
"""A topic that messages come from."""


def is_published(name: str, graph: Graph, but: str) -> bool:
    """Return whether a node of ROS 2 publishes a topic, `but` for one node."""
    return any(
        (each.kind, each.name) == (EndpointKind.PUBLISHER, name) and each.node != but
        for each in graph.endpoints
    )
