"""The parts of a check: messages as far as they matter, the faults in them, and the report."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Final

from pioneer3.doctor.facts import Level
from pioneer3.names import printable
from pioneer3.ros.node.topic import Direction
from pioneer3.ros.ros2.backend import Graph, NodeName
from pioneer3.ros.ros2.remapping import Remapping
from pioneer3.ros.ros2.types import MessageTypes

ORDER: Final = (Level.OK, Level.WARN, Level.FAIL)
"""From good to bad."""
UNKNOWN: Final = "an unknown node"


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckFault:
    """A fault.

    Attributes:
        level: Its severity.
        reason: For people; the same for each message that has it.
        example: A value that shows it; empty for none.
        advice: For the user; empty where there is nothing to do.
    """

    level: Level
    reason: str
    example: str = field(default="", compare=False)
    advice: str = ""


def fail(reason: str, *, example: str = "", advice: str = "") -> CheckFault:
    """Return a fault that a robot cannot be used with."""
    return _fault(Level.FAIL, reason, example, advice)


def warn(reason: str, *, example: str = "", advice: str = "") -> CheckFault:
    """Return a fault that some programs can live with."""
    return _fault(Level.WARN, reason, example, advice)


def _fault(level: Level, reason: str, example: str, advice: str) -> CheckFault:
    return CheckFault(
        level=level,
        reason=printable(reason),
        example=printable(example),
        advice=printable(advice),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Transform:
    """A transform of a tf2_msgs/TFMessage: `child` in `parent`, stamped [ns]."""

    parent: str
    child: str
    stamp: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """A message that came.

    Attributes:
        at: When it came [s, monotonic].
        now: The same as ROS time [ns]; `None` where nobody tells that.
        sender: Identity of its publisher.
        stamp: Of its header [ns]; `None` without a header.
        frame: Of its header; `None` without a header.
        child: Its child frame; empty for none.
        transforms: That it consists of.
        text: That it consists of.
        faults: In its fields.
    """

    at: float
    now: int | None
    sender: bytes = b""
    stamp: int | None = None
    frame: str | None = None
    child: str = ""
    transforms: tuple[Transform, ...] = ()
    text: str = ""
    faults: tuple[CheckFault, ...] = ()


@dataclass(slots=True)
class TopicStream:
    """The messages of one topic.

    Attributes:
        began: When listening began [s, monotonic].
        samples: In the order in which they came.
        unreadable: Number of messages that are none of the type.
    """

    began: float
    samples: list[Sample] = field(default_factory=list)
    unreadable: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFacts:
    """All that is known of a robot after listening.

    Attributes:
        node: Of the robot.
        graph: Nodes and endpoints, without the listener's own.
        heard: Messages by the full name of their topic.
        ended: When listening ended [s, monotonic].
        types: Of the distribution.
        strict: Whether incompatible quality of service parts publishers from subscribers.
        rules: Remapping rules of the robot's node.
        transducers: Number of the robot's sonars; `None` if it is not known.
        simulated_time: Whether the robot's stamps are those of `/clock`.
    """

    node: NodeName
    graph: Graph
    heard: Mapping[str, TopicStream]
    ended: float
    types: MessageTypes
    strict: bool
    rules: tuple[Remapping, ...] = ()
    transducers: int | None = None
    simulated_time: bool = False

    def sender(self, gid: bytes) -> str:
        """Return the node of a publisher."""
        found = (each.node for each in self.graph.endpoints if each.gid == gid)
        return next(found, "") or UNKNOWN

    def samples(self, name: str) -> Sequence[Sample]:
        """Return the messages of a topic with this full name."""
        stream = self.heard.get(name)
        return stream.samples if stream else ()

    def listened(self, name: str) -> float:
        """Return the time of listening to a topic [s]."""
        stream = self.heard.get(name)
        return self.ended - stream.began if stream else 0.0


class ReportPart(StrEnum):
    """The kinds of rows of a report."""

    NODE = "node"
    PUBLISHED = Direction.PUBLISHED.value
    SUBSCRIBED = Direction.SUBSCRIBED.value
    SERVICE = "service"


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckRow:
    """One thing that a robot should have, and its faults.

    Attributes:
        part: Kind of the row.
        name: Full name of the topic or service.
        expected: For people.
        found: For people.
        absent: Part of a robot that this one is without; empty for none.
        faults: The worst first.
        rate: Messages that came in a second [Hz]; `None` where that is not known.
    """

    part: ReportPart
    name: str
    expected: str
    found: str
    absent: str = ""
    faults: tuple[CheckFault, ...] = ()
    rate: float | None = None

    @property
    def level(self) -> Level:
        """The severity of the worst fault."""
        return max((fault.level for fault in self.faults), key=ORDER.index, default=Level.OK)


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckReport:
    """The outcome of a check.

    Attributes:
        node: Full name of the robot's node.
        seconds: Time of listening [s].
        rows: In the order of the table.
    """

    node: str
    seconds: float
    rows: tuple[CheckRow, ...]

    def count(self, level: Level) -> int:
        """Return the number of rows that are so bad."""
        return sum(row.level is level for row in self.rows if not row.absent)
