"""The parts of a check: messages as far as they matter, the faults in them, and the report."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import partial
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
    """A fault, and advice if anything can be done; the reason is the same for each message."""

    level: Level
    reason: str
    example: str = field(default="", compare=False)
    advice: str = ""


def _fault(level: Level, reason: str, *, example: str = "", advice: str = "") -> CheckFault:
    return CheckFault(
        level=level, reason=printable(reason), example=printable(example), advice=printable(advice)
    )


fail = partial(_fault, Level.FAIL)
"""Returns a fault that a robot cannot be used with."""
warn = partial(_fault, Level.WARN)
"""Returns a fault that some programs can live with."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Transform:
    """A transform of a tf2_msgs/TFMessage: `child` in `parent`, stamped [ns]."""

    parent: str
    child: str
    stamp: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """A message that came: transforms or text that it consists of, and the faults in its fields.

    It came `at` a time [s, monotonic], which was `now` as ROS time [ns], `None` where nobody tells
    that. Its header's `stamp` is in [ns]; a message without one has neither that nor a `frame`.
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
    """The messages of one topic, in their order; others that are none of its type are unreadable.

    Listening began at `began` [s, monotonic].
    """

    began: float
    samples: list[Sample] = field(default_factory=list)
    unreadable: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotFacts:
    """All that is known of a robot after listening, which `ended` then [s, monotonic].

    The listener's own node is not in the `graph`; `heard` is by full names of topics. If it is
    `strict`, incompatible quality of service parts publishers from subscribers. The number of the
    robot's sonars may not be known; its stamps may be those of `/clock`, a simulated time.
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
    """One thing that a robot should have, and its faults, the worst first.

    This robot is without the part `absent`, unless that is empty; `rate` may not be known [Hz].
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
    """The outcome of a check of a node after listening for `seconds` [s], row by row."""

    node: str
    seconds: float
    rows: tuple[CheckRow, ...]

    def count(self, level: Level) -> int:
        """Return the number of rows that are so bad."""
        return sum(row.level is level for row in self.rows if not row.absent)
