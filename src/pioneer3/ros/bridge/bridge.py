"""The bridge: its rows, the other bridges and publishers beside it, and its end."""

import asyncio
from collections.abc import Callable, Iterable
from typing import Final

from pioneer3.errors import ConfigError
from pioneer3.ros.bridge.conversion import Converter
from pioneer3.ros.bridge.guard import CommandGuard
from pioneer3.ros.bridge.relay import Sink, TopicRelay
from pioneer3.ros.bridge.rows import BridgedTopic, ServiceRow, Side
from pioneer3.ros.bridge.services import ServiceBridge
from pioneer3.ros.bridge.sources import Bridges, Ros1Source, Ros2Source, TopicSource
from pioneer3.ros.ros2.backend import LATCHED, Backend, Closable, EndpointKind, Graph, Qos
from pioneer3.ros.ros2.client import DISCOVERY
from pioneer3.ros.ros2.mismatches import Own, OwnKey, mismatches
from pioneer3.ros.tcpros.answers import SystemState
from pioneer3.ros.tcpros.node import Ros1Node

MARK: Final = "bridged"
"""Topic below the name of a bridge's node on both sides: by it bridges know each other."""
ROS_BRIDGE: Final = "/ros_bridge"
"""Name of ROS's own bridge."""
STRING: Final = "std_msgs/String"
LEASE: Final = 12.0
"""A node of ROS 2 that was killed is forgotten after this time [s]."""
LOOK: Final = 1.0
"""Pause between two looks at the graphs [s]."""
FAREWELL: Final = 0.1
"""Messages of ROS 2 are on their way after this time [s]."""


class TopicBridge:
    """Passes on messages between two networks; the robot's node is on the side `robot`.

    `name` is the full name of our node in ROS 2. A velocity command lasts for the timeout [s],
    `inf` until the next one; with `resumes` a stream that fell silent goes on by itself. `tell` is
    given lines for a person.
    """

    def __init__(
        self,
        node: Ros1Node,
        backend: Backend,
        name: str,
        converter: Converter,
        *,
        rows: Iterable[BridgedTopic],
        services: Iterable[ServiceRow] = (),
        robot: Side = Side.ROS2,
        timeout: float = 0.5,
        resumes: bool = True,
        tell: Callable[[str], None],
    ) -> None:
        self._node, self._backend, self._name, self._converter = node, backend, name, converter
        self._rows, self._services = tuple(rows), tuple(services)
        self._robot, self._timeout, self._tell = robot, timeout, tell
        self._resumes = resumes
        self._loop = asyncio.get_running_loop()
        self._sinks: dict[tuple[Side, str], Sink] = {}
        self._sources: dict[tuple[Side, str], TopicSource] = {}
        self._started: set[BridgedTopic] = set()
        self._own: dict[OwnKey, Own] = {}
        self._open: list[Closable] = []  # the backend closes them
        self._told: set[str] = set()
        self._bridges = Bridges(self._tell_once)
        self._alive: bool | None = None

    async def run(self, *, discovery: float = DISCOVERY, lease: float = LEASE) -> None:
        """Pass on messages until the node is shut down, or this is cancelled.

        Robots that are driven by messages that were passed on stand in the end. ConfigError if
        another node of ROS 2 has our name.
        """
        try:
            await asyncio.to_thread(self._mark)
            await asyncio.sleep(discovery)
            await self._refuse_double(lease)
            bridge = ServiceBridge(self._node, self._backend, self._converter, self._tell)
            for service in self._services:
                offered = await asyncio.to_thread(bridge.offer, service, self._robot)
                self._open += [offered] if offered is not None else []
            await self._node.settle()
            await self._look()
            await self._node.settle()
            self._tell("ready; Ctrl-C ends it, and stops robots that are driven over it")
            while not self._node.ended.is_set():
                try:
                    async with asyncio.timeout(LOOK):
                        await self._node.ended.wait()
                except TimeoutError:
                    await self._look()
        finally:
            driven = [sink.name for sink in self._sinks.values() if sink.end()]
            if driven:
                self._tell(f"the bridge ends: a zero is sent on {', '.join(driven)}")
                await asyncio.sleep(FAREWELL)

    async def _refuse_double(self, lease: float) -> None:
        """Raise ConfigError if another node has our name: its messages would count as our own.

        One that was killed is forgotten within `lease` [s].
        """
        until = self._loop.time() + lease
        while (await asyncio.to_thread(self._backend.graph)).nodes.count(self._name) > 1:
            if self._loop.time() >= until:
                raise ConfigError(
                    f"a node {self._name} is in ROS 2 already, perhaps a bridge of another master:"
                    " end it, or take another --name"
                )
            self._tell_once(f"a node {self._name} is in ROS 2 already: waits whether it is alive")
            await asyncio.sleep(min(LOOK, lease))

    def _mark(self) -> None:
        """Let other bridges know of this one; in a thread."""
        types = self._converter.ros2
        mark = types.make(STRING)
        mark.data = "\n".join(map(str, self._rows))
        writer = self._backend.advertise(
            f"{self._name}/{MARK}", types.message_type(STRING), LATCHED
        )
        writer.write(types.encode(mark))
        self._open.append(writer)
        self._loop.call_soon_threadsafe(self._mark_in_ros1, mark.data)

    def _mark_in_ros1(self, text: str) -> None:
        types = self._converter.ros1
        type_ = types.definition(STRING)
        mark = types.make(STRING)
        mark.data = text
        name = f"{self._node.name}/{MARK}"
        self._node.advertise(name, type_, latched=True).write(types.encode(mark))

    async def _look(self) -> None:
        """Look at both graphs: start rows, and tell of all that is odd."""
        graph = await asyncio.to_thread(self._backend.graph)
        state = self._node.state or SystemState()
        self._find_bridges(graph, state)
        beside = {n for row in self._rows for n in state.publishers.get(row.ros1, ())}
        alive = await self._node.alive_among(beside - {self._node.name})
        for row in self._rows:
            others = self._publishers_beside(row, graph, state, alive)
            if row in self._started:
                for name in others:
                    self._tell_once(f"{name} too: programs get messages of both")
            elif others:
                self._tell_once(f"RESTS: {row}, for {others[0]} already")
            else:
                await self._start(row)
        for source in self._sources.values():
            await source.listen()
        for sentence in mismatches(self._own, graph, self._name, strict=self._backend.strict):
            self._tell_once(sentence)
        self._look_for_robot()

    def _find_bridges(self, graph: Graph, state: SystemState) -> None:
        """Find other bridges, of which nothing is passed on."""
        marks = [e.name for e in graph.endpoints if e.kind is EndpointKind.PUBLISHER]
        nodes = {Side.ROS1: list(state.publishers), Side.ROS2: marks}
        own = {Side.ROS1: self._node.name, Side.ROS2: self._name}
        known = {Side.ROS1: {n for of in state.publishers.values() for n in of}}
        known[Side.ROS2] = set(graph.nodes)
        for side in Side:
            found = {
                name.removesuffix(f"/{MARK}") for name in nodes[side] if name.endswith(f"/{MARK}")
            }
            found |= {ROS_BRIDGE} & known[side]
            self._bridges.names[side] = found - {own[side]}
            for name in sorted(found - {own[side]}):
                self._tell_once(
                    f"ANOTHER BRIDGE is here: {name} in {side.words}; nothing that it sends is"
                    " passed on, and programs may get messages twice"
                )

    def _publishers_beside(
        self, row: BridgedTopic, graph: Graph, state: SystemState, alive: set[str]
    ) -> list[str]:
        """Return words for each publisher on the side that a row sends to, but ours."""
        if len(row.way.sources) > 1:
            return []
        side = row.way.sources[0].other
        if side is Side.ROS1:
            nodes = set(state.publishers.get(row.ros1, ())) & alive
        else:
            nodes = {
                each.node
                for each in graph.endpoints
                if (each.kind, each.name) == (EndpointKind.PUBLISHER, row.ros2)
                and each.node != self._name
            } - {""}
        if row.of_many:
            nodes &= set() if row.to_robot or row.commands else self._bridges.names[side]
        where = f"{side.words} {row.name(side)}"
        return [f"{name} publishes {where}" for name in sorted(nodes)]

    async def _start(self, row: BridgedTopic) -> None:
        """Begin to pass on messages of a topic."""
        self._started.add(row)
        for source in row.way.sources:
            relay = await self._relay(row, source)
            topic = self._source(row, source)
            topic.relays.append(relay)
            await topic.listen()
        self._tell(f"bridged: {row}")

    def _source(self, row: BridgedTopic, side: Side) -> TopicSource:
        """Return the topic that a row takes messages from; rows share it."""
        key = (side, row.name(side))
        if key not in self._sources:
            if side is Side.ROS1:
                definition = self._converter.ros1.definition(row.ros1_type)
                self._sources[key] = Ros1Source(row, definition, self._node, self._bridges)
            else:
                type_ = self._converter.ros2.message_type(row.ros2_type)
                made = Ros2Source(row, type_, self._backend, self._name, self._bridges)
                own = Own(EndpointKind.SUBSCRIBER, type_, made.qos)
                self._own.setdefault((EndpointKind.SUBSCRIBER, row.ros2), own)
                self._sources[key] = made
        return self._sources[key]

    async def _relay(self, row: BridgedTopic, source: Side) -> TopicRelay:
        convert = self._converter
        make = convert.to_ros2 if source is Side.ROS1 else convert.to_ros1
        relay = TopicRelay(
            row,
            source,
            convert.ros1 if source is Side.ROS1 else convert.ros2,
            make(row.ros1_type, row.ros2_type),
            await self._sink(row, source.other),
            timeout=self._timeout,
            tell=self._tell,
        )
        await asyncio.to_thread(relay.warm_up)
        return relay

    async def _sink(self, row: BridgedTopic, side: Side) -> Sink:
        """Return the topic that a row sends to; rows share it."""
        key = (side, row.name(side))
        if key not in self._sinks:
            guard = CommandGuard(self._timeout, resumes=self._resumes) if row.commands else None
            if side is Side.ROS1:
                type_ = self._converter.ros1.definition(row.ros1_type)
                output = self._node.advertise(row.ros1, type_, latched=row.latched)
                ros1 = self._converter.ros1
                self._sinks[key] = Sink(row.ros1, row.ros1_type, output, ros1, guard)
            else:
                type2 = self._converter.ros2.message_type(row.ros2_type)
                qos = LATCHED if row.latched else Qos()
                writer = await asyncio.to_thread(self._backend.advertise, row.ros2, type2, qos)
                self._own[EndpointKind.PUBLISHER, row.ros2] = Own(
                    EndpointKind.PUBLISHER, type2, qos
                )
                self._open.append(writer)
                ros2 = self._converter.ros2
                self._sinks[key] = Sink(row.ros2, row.ros2_type, writer, ros2, guard)
        return self._sinks[key]

    def _look_for_robot(self) -> None:
        """Tell when the robot's topics vanish, and when they are back."""
        rows = [
            row for row in self._started if row.way.sources == (self._robot,) and not row.of_many
        ]
        side = self._robot
        alive = any(self._sources[side, row.name(side)].matched for row in rows)
        if alive is self._alive or not rows:
            return
        title = self._robot.words
        if not alive:
            first = self._alive is None
            self._tell(
                f"{'no robot yet' if first else 'ROBOT LOST'}: nobody publishes its topics in"
                f" {title}; they are bridged as soon as it is there"
            )
        elif self._alive is not None:
            self._tell(f"the robot's topics are there in {title}")
        self._alive = alive

    def _tell_once(self, sentence: str) -> None:
        if sentence not in self._told:
            self._told.add(sentence)
            self._tell(sentence)
