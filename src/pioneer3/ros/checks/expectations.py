"""The expectations of a robot's topics, made from the table that our own node publishes by."""

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Final

from pioneer3.models.description.tree import Frames
from pioneer3.ros.checks.facts import RobotFacts
from pioneer3.ros.messages.update import PictureUpdate, ScanUpdate, SensorUpdate
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.navigation_topics import NAVIGATION_TOPICS
from pioneer3.ros.node.topic import Direction, Topic, always
from pioneer3.ros.node.topics import (
    COMMANDS,
    DIAGNOSTICS,
    STAMPED_COMMANDS,
    TOPICS,
    command_topics,
    laser_topic,
    transducer_topic,
)
from pioneer3.ros.ros2.backend import EndpointKind
from pioneer3.ros.ros2.remapping import Resource, resolved
from pioneer3.ros.ros2.start import OF_TF
from pioneer3.ros.typestore import full_name

DEVICES: Final = (ScanUpdate, SensorUpdate, PictureUpdate)
"""Updates of devices that speak as soon as somebody listens."""
NUMBERED: Final = re.compile(r"range_(\d+)")
SCANS: Final = re.compile(r"scan(\d*)")


@dataclass(frozen=True, slots=True, kw_only=True)
class Expectation:
    """One topic that a robot should have, by its full name; `row` is its name in the table.

    Messages that come with events have no `rate` [Hz]. The robot may be without an `optional` part,
    unless the topic is `required` all the same. What a `device` publishes is usually best effort.
    If it is `shared` several nodes may publish it; if it is the robot's `own`, messages of other
    nodes do not count.
    """

    name: str
    row: str
    direction: Direction
    type_name: str
    latched: bool = False
    rate: float | None = None
    optional: str = ""
    required: bool = False
    device: bool = False
    may_be_silent: bool = False
    shared: bool = False
    own: bool = False
    frame: Callable[[Frames], str] | None = None

    @property
    def is_published(self) -> bool:
        """Whether the robot publishes it."""
        return self.direction is Direction.PUBLISHED


def expectations(facts: RobotFacts) -> Iterator[Expectation]:
    """Yield the topics that the robot should have, in the order of the table."""
    yield from _commands(facts)
    state = (topic for topic in TOPICS if topic not in {COMMANDS, STAMPED_COMMANDS})
    yield from _all((*state, *_lasers(facts)), facts)
    yield from _transducers(facts)
    yield from _all(NAVIGATION_TOPICS, facts)


def full(name: str, facts: RobotFacts, resource: Resource = Resource.TOPIC) -> str:
    """Return the full name of a topic or service of the robot."""
    return resolved(name, facts.node, facts.rules, resource)


def _commands(facts: RobotFacts) -> Iterator[Expectation]:
    """Yield the topics of commands; `cmd_vel` may have either type."""
    (name,) = COMMANDS.names(Profile.ROS2)
    stamped = any(
        each.name == full(name, facts)
        and each.kind is EndpointKind.SUBSCRIBER
        and each.type_name == full_name(STAMPED_COMMANDS.type_name)
        and each.node == facts.node.full
        for each in facts.graph.endpoints
    )
    commands = command_topics(Profile.ROS2, stamped=stamped)
    for command in sorted(commands, key=lambda each: each.name != name):
        topic = STAMPED_COMMANDS if command.stamped else COMMANDS
        first = command.name == name
        yield replace(
            _expected(topic, command.name, facts),
            optional="" if first else STAMPED_COMMANDS.optional,
            required=first,
        )


def _lasers(facts: RobotFacts) -> Iterator[Topic]:
    """Yield the topic of the first laser, and those of others that are there."""
    found = {match[1] for match in _matching(SCANS, "", facts)}
    for number in sorted(found | {""}, key=lambda text: (len(text), text)):
        yield laser_topic(f"laser{number}")


def _transducers(facts: RobotFacts) -> Iterator[Expectation]:
    """Yield the topics of the transducers: those of the model, else those that are there."""
    found = [int(match[1]) for match in _matching(NUMBERED, "sonar/", facts)]
    count = facts.transducers
    if count is None:
        count = max(found, default=-1) + 1
    topics = (transducer_topic(number) for number in range(max(count, 1)))
    for each in _all(topics, facts):
        yield replace(each, required=count > 0)


def _matching(pattern: re.Pattern[str], below: str, facts: RobotFacts) -> Iterator[re.Match[str]]:
    """Yield the matches of the names of published topics below a name in the robot's namespace."""
    start = full(f"{below}x", facts).removesuffix("x")
    for each in facts.graph.endpoints:
        if each.kind is EndpointKind.PUBLISHER and each.name.startswith(start):
            match = pattern.fullmatch(each.name.removeprefix(start))
            if match:
                yield match


def _all(topics: Iterable[Topic], facts: RobotFacts) -> Iterator[Expectation]:
    for topic in topics:
        for name in topic.names(Profile.ROS2):
            yield _expected(topic, name, facts)


def _expected(topic: Topic, name: str, facts: RobotFacts) -> Expectation:
    device = topic.source in DEVICES
    rate = 1 / topic.period if topic.period else topic.rate
    speaks = topic.has_data is always and (topic.latched or topic.changes is None)
    return Expectation(
        name=_of_tree(name, facts) if name in OF_TF else full(name, facts),
        row=name,
        direction=topic.direction,
        type_name=full_name(topic.type_name),
        latched=topic.latched,
        rate=rate,
        optional=topic.optional,
        required=not topic.optional,
        device=device,
        may_be_silent=rate is None and not device and not speaks,
        shared=name in OF_TF or topic is DIAGNOSTICS,
        own=topic is DIAGNOSTICS or topic.direction is Direction.SUBSCRIBED,
        frame=topic.frame,
    )


def _of_tree(name: str, facts: RobotFacts) -> str:
    """Return the topic of transforms in the robot's namespace, or that of all robots."""
    own, common = full(name, facts), f"/{name}"
    publishers = {
        each.name for each in facts.graph.endpoints if each.kind is EndpointKind.PUBLISHER
    }
    return common if common in publishers and own not in publishers else own
