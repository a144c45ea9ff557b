"""Finds a robot on the network and listens to all of its topics for a while."""

import asyncio
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final

from pioneer3.models import load_model
from pioneer3.ros.checks.check import check
from pioneer3.ros.checks.content import faults_in
from pioneer3.ros.checks.expectations import Expectation, expectations
from pioneer3.ros.checks.facts import CheckReport, RobotFacts, Sample, TopicStream, Transform
from pioneer3.ros.checks.robots import robot_called
from pioneer3.ros.messages.update import nanoseconds
from pioneer3.ros.ros2.backend import (
    Backend,
    Closable,
    EndpointKind,
    Graph,
    NodeName,
    Qos,
    strictest,
)
from pioneer3.ros.ros2.client import DISCOVERY
from pioneer3.ros.ros2.remapping import Remapping
from pioneer3.ros.ros2.start import NodeOptions, on_ros2
from pioneer3.ros.ros2.types import MessageTypes

LOOK: Final = 0.5
"""Pause between two looks at the graph [s]."""
DEPTH: Final = 100
"""Messages that may wait."""
CLOCK: Final = "/clock"
CLOCK_TYPE: Final = "rosgraph_msgs/msg/Clock"
TRANSFORMS: Final = "tf2_msgs/msg/TFMessage"
STRING: Final = "std_msgs/msg/String"


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """A robot to check: its node's name or namespace, or the only one; how long to listen [s].

    Its model tells the number of its sonars, if it is known.
    """

    robot: str | None = None
    seconds: float = 5.0
    model: str | None = None


async def check_robot(
    options: NodeOptions, question: Question, progress: Callable[[str], None]
) -> CheckReport:
    """Join the network, listen to a robot, and return the report.

    Remapping rules among the options of our own node are those of the robot's node.

    Raises:
        ConfigError: an option is wrong, there is no such model, or there are several robots.
        NoRobotError: there is no such robot.
    """
    transducers = None if question.model is None else len(load_model(question.model).sonars)
    progress("Joining the network ...")
    async with on_ros2(options, lambda line: None) as (backend, own, types, arguments):
        progress("Looking for robots ...")
        await asyncio.sleep(DISCOVERY)
        graph = without(backend.graph(), own)
        node = robot_called(graph, question.robot, backend.title)
        listener = TopicListener(
            backend, own, types, node, rules=arguments.rules, transducers=transducers
        )
        await listener.listen(question.seconds, progress)
        return check(listener.facts())


def without(graph: Graph, own: NodeName) -> Graph:
    """Return a graph without one of our own nodes."""
    nodes = list(graph.nodes)
    if own.full in nodes:
        nodes.remove(own.full)
    endpoints = tuple(each for each in graph.endpoints if each.node != own.full)
    return Graph(tuple(nodes), endpoints)


class TopicListener:
    """Listens to the topics of the robot of a node, which has remapping rules of its own.

    Backend and name are those of our own node; `wall` returns the time of this computer [ns].
    """

    def __init__(
        self,
        backend: Backend,
        own: NodeName,
        types: MessageTypes,
        node: NodeName,
        *,
        rules: tuple[Remapping, ...] = (),
        transducers: int | None = None,
        wall: Callable[[], int] = time.time_ns,
    ) -> None:
        self._backend, self._own, self._types, self._wall = backend, own, types, wall
        self._node, self._rules, self._transducers = node, rules, transducers
        self._clock = asyncio.get_running_loop().time
        self._heard: dict[str, TopicStream] = {}
        self._open: list[Closable] = []
        self._unread: deque[Callable[[], None]] = deque()
        self._simulated: int | None = None
        self._simulates = False

    async def listen(self, seconds: float, progress: Callable[[str], None]) -> None:
        """Listen for `seconds` [s], also to topics that appear meanwhile."""
        try:
            await asyncio.to_thread(self._subscribe)
            began = self._clock()
            while True:
                passed = self._clock() - began
                progress(
                    f"Listening to {len(self._heard)} topics of {self._node.full},"
                    f" {passed:.0f} of {seconds:g} s ..."
                )
                if passed >= seconds:
                    break
                await asyncio.sleep(min(LOOK, seconds - passed))
                await asyncio.to_thread(self._subscribe)
                await asyncio.to_thread(self._read)
        finally:
            self._ended = self._clock()
            self._graph = without(self._backend.graph(), self._own)
            await asyncio.to_thread(self._close)
        await asyncio.to_thread(self._read)

    def facts(self) -> RobotFacts:
        """Return all that is known, after listening."""
        return self._facts_at(self._ended, self._graph)

    def _facts_at(self, ended: float, graph: Graph) -> RobotFacts:
        return RobotFacts(
            node=self._node,
            graph=graph,
            heard=self._heard,
            ended=ended,
            types=self._types,
            strict=self._backend.strict,
            rules=self._rules,
            transducers=self._transducers,
            simulated_time=self._simulates,
        )

    def _subscribe(self) -> None:
        """Subscribe to all topics that somebody publishes and that we do not hear yet."""
        graph = without(self._backend.graph(), self._own)
        takes_clock = (self._node.full, CLOCK, EndpointKind.SUBSCRIBER)
        if not self._simulates and any(
            (each.node, each.name, each.kind) == takes_clock for each in graph.endpoints
        ):
            self._simulates = True
            clock = self._types.message_type(CLOCK_TYPE)
            qos = Qos(reliable=False, depth=1)
            self._open.append(
                self._backend.subscribe(CLOCK, clock, qos, self._take_clock, lambda gid: None)
            )
        for each in expectations(self._facts_at(self._clock(), graph)):
            offered = [
                endpoint.qos
                for endpoint in graph.endpoints
                if endpoint.name == each.name
                and endpoint.kind is EndpointKind.PUBLISHER
                and endpoint.type_name == each.type_name
            ]
            if each.is_published and offered and each.name not in self._heard:
                self._listen_to(each, offered)

    def _listen_to(self, each: Expectation, offered: list[Qos]) -> None:
        """Subscribe with the strictest quality of service that all publishers offer."""
        stream = self._heard[each.name] = TopicStream(self._clock())

        def received(cdr: bytes, gid: bytes) -> None:  # reading it now would hold up the next one
            at = self._clock()
            now = self._simulated if self._simulates else self._wall()

            def read() -> None:
                try:
                    message = self._types.decode(cdr, each.type_name)
                except ValueError:
                    stream.unreadable += 1
                else:
                    stream.samples.append(sample_of(message, at, now, gid))

            self._unread.append(read)

        type_ = self._types.message_type(each.type_name)
        self._open.append(
            self._backend.subscribe(
                each.name, type_, strictest(offered, DEPTH), received, lambda gid: None
            )
        )

    def _read(self) -> None:
        """Read the messages that have come."""
        while self._unread:
            self._unread.popleft()()

    def _take_clock(self, cdr: bytes, gid: bytes) -> None:
        self._simulated = nanoseconds(self._types.decode(cdr, CLOCK_TYPE).clock)

    def _close(self) -> None:
        for each in self._open:
            each.close()


def sample_of(message: Any, at: float, now: int | None, sender: bytes) -> Sample:
    """Return a message as far as it matters; it came at `at` [s, monotonic], `now` of ROS [ns]."""
    header, type_name = getattr(message, "header", None), message.__msgtype__
    sample = Sample(at=at, now=now, sender=sender, faults=faults_in(message))
    if header is not None:
        child = getattr(message, "child_frame_id", "")
        sample = replace(
            sample, stamp=nanoseconds(header.stamp), frame=header.frame_id, child=child
        )
    if type_name == TRANSFORMS:
        found = (
            Transform(
                parent=each.header.frame_id,
                child=each.child_frame_id,
                stamp=nanoseconds(each.header.stamp),
            )
            for each in message.transforms
        )
        sample = replace(sample, transforms=tuple(found))
    if type_name == STRING:
        sample = replace(sample, text=message.data)
    return sample
