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
from pioneer3.ros.ros2.backend import Backend, Closable, EndpointKind, Graph, NodeName, Qos
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
    """A robot to check, and how.

    Attributes:
        robot: Name of its node, or its namespace; `None` for the only robot.
        seconds: Time of listening [s].
        model: Of the robot, which tells the number of its sonars; `None` if it is not known.
    """

    robot: str | None = None
    seconds: float = 5.0
    model: str | None = None

    @property
    def transducers(self) -> int | None:
        """Number of the robot's sonars; `None` if it is not known.

        Raises:
            ConfigError: there is no such model.
        """
        return None if self.model is None else len(load_model(self.model).sonars)


async def check_robot(
    options: NodeOptions, question: Question, progress: Callable[[str], None]
) -> CheckReport:
    """Join the network, listen to a robot, and return the report.

    Args:
        options: Of our own node; its remapping rules are those of the robot's node.
        question: Which robot, and how long.
        progress: Given a sentence about each step.

    Raises:
        ConfigError: an option is wrong, or there are several robots.
        NoRobotError: there is no such robot.
    """
    transducers = question.transducers
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


@dataclass(frozen=True, slots=True)
class _Come:
    """A serialized message of a stream, when it came, and its publisher."""

    stream: TopicStream
    type_name: str
    cdr: bytes
    at: float
    now: int | None
    sender: bytes


class TopicListener:
    """Listens to the topics of a robot.

    Args:
        backend: Of our own node.
        own: Name of our own node.
        types: Of the distribution.
        node: Of the robot.
        rules: Remapping rules of the robot's node.
        transducers: Number of the robot's sonars, if it is known.
        wall: Returns the time of this computer [ns].
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
        self._come: deque[_Come] = deque()
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
        return self._facts(self._graph, self._ended)

    def _facts(self, graph: Graph, ended: float) -> RobotFacts:
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
        if not self._simulates and _takes_clock(graph, self._node):
            self._simulates = True
            clock = self._types.message_type(CLOCK_TYPE)
            qos = Qos(reliable=False, depth=1)
            self._open.append(
                self._backend.subscribe(CLOCK, clock, qos, self._take_clock, lambda gid: None)
            )
        for each in expectations(self._facts(graph, self._clock())):
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
        qos = Qos(
            reliable=all(one.reliable for one in offered),
            transient_local=all(one.transient_local for one in offered),
            depth=DEPTH,
        )

        def received(cdr: bytes, gid: bytes) -> None:  # reading it now would hold up the next one
            come = _Come(stream, each.type_name, cdr, self._clock(), self._now(), gid)
            self._come.append(come)

        type_ = self._types.message_type(each.type_name)
        self._open.append(
            self._backend.subscribe(each.name, type_, qos, received, lambda gid: None)
        )

    def _read(self) -> None:
        """Read the messages that have come."""
        while self._come:
            come = self._come.popleft()
            try:
                message = self._types.decode(come.cdr, come.type_name)
            except ValueError:
                come.stream.unreadable += 1
            else:
                come.stream.samples.append(sample_of(message, come.at, come.now, come.sender))

    def _take_clock(self, cdr: bytes, gid: bytes) -> None:
        clock = self._types.decode(cdr, CLOCK_TYPE).clock
        self._simulated = nanoseconds(clock)

    def _now(self) -> int | None:
        return self._simulated if self._simulates else self._wall()

    def _close(self) -> None:
        for each in self._open:
            each.close()


def sample_of(message: Any, at: float, now: int | None, sender: bytes) -> Sample:
    """Return a message as far as it matters.

    Args:
        message: The message.
        at: When it came [s, monotonic].
        now: The same as ROS time [ns].
        sender: Identity of its publisher.
    """
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


def _takes_clock(graph: Graph, node: NodeName) -> bool:
    """Return whether a node takes the time of `/clock`: then it subscribes to it."""
    return any(
        (each.node, each.name, each.kind) == (node.full, CLOCK, EndpointKind.SUBSCRIBER)
        for each in graph.endpoints
    )
