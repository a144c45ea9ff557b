"""Checks publishers, subscribers and services by the graph: types, quality of service. Pure."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from pioneer3.ros.checks.expectations import Expectation, full
from pioneer3.ros.checks.facts import (
    UNKNOWN,
    CheckFault,
    CheckRow,
    ReportPart,
    RobotFacts,
    fail,
    warn,
)
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.services import NAVIGATION_SERVICES, SERVICES, Service
from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, MessageType
from pioneer3.ros.ros2.mismatches import OTHER_SIDE, TWISTS, Own, incompatible
from pioneer3.ros.ros2.remapping import Resource
from pioneer3.ros.typestore import full_name

OTHER_DISTRO: Final = "it is of another distribution of ROS 2: say which with --distro"


@dataclass(frozen=True, slots=True)
class EndpointSides:
    """The endpoints on a topic: those of the robot, and those that they talk to."""

    robot: tuple[Endpoint, ...]
    others: tuple[Endpoint, ...]


def sides(expected: Expectation, facts: RobotFacts) -> EndpointSides:
    """Return the endpoints on a topic; whoever publishes a robot's topic counts as the robot."""
    kind = EndpointKind.PUBLISHER if expected.is_published else EndpointKind.SUBSCRIBER
    there = [each for each in facts.graph.endpoints if each.name == expected.name]
    robot = (each for each in there if each.kind is kind)
    return EndpointSides(
        tuple(each for each in robot if not expected.own or each.node == facts.node.full),
        tuple(each for each in there if each.kind is OTHER_SIDE[kind]),
    )


def endpoint_faults(
    expected: Expectation, there: EndpointSides, facts: RobotFacts
) -> Iterator[CheckFault]:
    """Yield the faults of the endpoints on a topic that the robot has."""
    type_ = facts.types.message_type(expected.type_name)
    nodes = sorted({each.node or UNKNOWN for each in there.robot})
    if expected.is_published and not expected.shared and len(there.robot) > 1:
        yield fail(
            f"it has {len(there.robot)} publishers: {' and '.join(nodes)}",
            advice="only one may publish it: end or remap the others",
        )
    for each in there.robot:
        who = each.node if each.node != facts.node.full and each.node else ""
        yield from _type_faults(each, type_, who)
        yield from _qos_faults(each, expected, facts)
    right = next((each for each in there.robot if each.type_name == type_.name), None)
    if right is not None:
        for other in there.others:
            yield from _other_faults(other, Own(right.kind, type_, right.qos), facts)


def missing(expected: Expectation, facts: RobotFacts, known: set[str]) -> CheckFault:
    """Return the fault that a topic is missing; topics of the table are `known`, by full names."""
    kind = EndpointKind.PUBLISHER if expected.is_published else EndpointKind.SUBSCRIBER
    similar = sorted(
        each.name
        for each in facts.graph.endpoints
        if each.kind is kind
        and each.node == facts.node.full
        and each.type_name == expected.type_name
        and each.name not in known
    )
    verb = "publishes" if expected.is_published else "subscribes to"
    advice = [f"is it {each}? then --ros-args -r {expected.row}:={each}" for each in similar]
    return fail(f"nobody {verb} it", advice=advice[0] if advice else "")


def service_rows(facts: RobotFacts) -> Iterator[CheckRow]:
    """Yield the services that the robot should have."""
    for service in (*SERVICES, *NAVIGATION_SERVICES):
        for name in service.names(Profile.ROS2):
            yield _service_row(service, full(name, facts, Resource.SERVICE), facts)


def _service_row(service: Service, name: str, facts: RobotFacts) -> CheckRow:
    type_name = full_name(service.type_in(Profile.ROS2), "srv")
    there = [each for each in facts.graph.endpoints if each.name == name]
    servers = [each for each in there if each.kind is EndpointKind.SERVER]
    faults: list[CheckFault] = []
    found, absent = "offered", ""
    if len(servers) > 1:
        nodes = " and ".join(sorted(each.node or UNKNOWN for each in servers))
        faults.append(fail(f"several nodes offer it: {nodes}"))
    for each in servers:
        if each.type_name != type_name:
            found = each.type_name
            faults.append(fail(f"its type is {each.type_name}, not {type_name}"))
    if not servers:
        found = "absent"
        topic = full_name(service.topic_type) if service.topic_type else ""
        listening = [each for each in there if each.kind is EndpointKind.SUBSCRIBER]
        if topic and any(each.type_name == topic for each in listening):
            found = f"topic of {topic}"
        elif listening:
            found = f"topic of {listening[0].type_name}"
            faults.append(fail(f"the topic in its place is of {listening[0].type_name}"))
        elif service.optional:
            absent = service.optional
        else:
            faults.append(fail("nobody offers it"))
    return CheckRow(
        part=ReportPart.SERVICE,
        name=name,
        expected=type_name,
        found=found,
        absent=absent,
        faults=tuple(faults),
    )


def _type_faults(each: Endpoint, type_: MessageType, who: str) -> Iterator[CheckFault]:
    named = f" of {who}" if who else ""
    if each.type_name != type_.name:
        yield fail(f"the type{named} is {each.type_name}, not {type_.name}")
    elif each.type_hash and type_.hash and each.type_hash != type_.hash:
        yield fail(f"the version{named} of {type_.name} is another", advice=OTHER_DISTRO)


def _qos_faults(each: Endpoint, expected: Expectation, facts: RobotFacts) -> Iterator[CheckFault]:
    if not expected.is_published:
        if each.qos.transient_local and facts.strict:
            yield fail(
                "durability: transient local is wanted",
                advice="usual publishers are volatile, and it hears none of them",
            )
        return
    if not each.qos.reliable:
        tell = warn if expected.device or not facts.strict else fail
        yield tell(
            "reliability: best effort, not reliable",
            advice="RViz and others that want reliable messages hear nothing",
        )
    if expected.latched and not each.qos.transient_local:
        yield fail(
            "durability: volatile, not transient local",
            advice="programs that start later never hear it",
        )


def _other_faults(other: Endpoint, robots: Own, facts: RobotFacts) -> Iterator[CheckFault]:
    """Yield why an endpoint of others cannot talk to the robot's; commands matter most."""
    commands = robots.kind is EndpointKind.SUBSCRIBER
    tell = fail if commands else warn
    named = f"{other.kind} {other.node or UNKNOWN}"
    if other.type_name != robots.type.name:
        verb = "sends" if commands else "expects"
        both = {other.type_name, robots.type.name} == TWISTS
        yield tell(
            f"{named} {verb} {other.type_name}: nothing arrives",
            advice="send the other type, or on the other topic" if both else "",
        )
    elif other.type_hash and robots.type.hash and other.type_hash != robots.type.hash:
        yield tell(f"{named} has another version of the type", advice=OTHER_DISTRO)
    elif facts.strict and (mismatch := incompatible(robots, other)):
        yield tell(f"{named} does not match, {mismatch.policy}: {mismatch.why}")
