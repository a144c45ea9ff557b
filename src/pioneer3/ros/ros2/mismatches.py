"""Finds endpoints of other nodes that cannot talk to ours, which ROS 2 tells nobody. Pure."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isinf
from typing import Final

from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, Graph, MessageType, Qos

TWISTS: Final = {"geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"}
OwnKey = tuple[EndpointKind, str]
"""Kind of an endpoint of ours, and full name of its topic."""
OTHER_SIDE: Final = {
    EndpointKind.PUBLISHER: EndpointKind.SUBSCRIBER,
    EndpointKind.SUBSCRIBER: EndpointKind.PUBLISHER,
}


@dataclass(frozen=True, slots=True)
class Own:
    """A topic of ours: whether we publish or subscribe, its type and quality of service."""

    kind: EndpointKind
    type: MessageType
    qos: Qos


def mismatches(
    own: Mapping[OwnKey, Own], graph: Graph, node: str, *, strict: bool
) -> Iterator[str]:
    """Yield a sentence for each endpoint of others that cannot talk to one of ours.

    Our node has the full name `node`. With `strict` incompatible quality of service counts.
    """
    for endpoint in graph.endpoints:
        side = OTHER_SIDE.get(endpoint.kind)
        ours = side and own.get((side, endpoint.name))
        if not ours or endpoint.node == node:
            continue
        if endpoint.type_name != ours.type.name:
            yield _other_type(endpoint, ours, own)
        elif endpoint.type_hash and ours.type.hash and endpoint.type_hash != ours.type.hash:
            yield (
                f"{_named(endpoint)} has another version of {ours.type.name}: it is of another"
                " distribution of ROS 2; say which with --distro"
            )
        elif strict and (mismatch := incompatible(ours, endpoint)):
            yield f"{_named(endpoint)} and this node do not match: {mismatch.why}"


@dataclass(frozen=True, slots=True)
class Mismatch:
    """The reason that two endpoints do not match: the policy of QoS, and a sentence."""

    policy: str
    why: str


def incompatible(ours: Own, theirs: Endpoint) -> Mismatch | None:
    """Return the reason that two endpoints of one type do not match, or `None` if they do."""
    publisher, subscriber = (
        (ours.qos, theirs.qos) if ours.kind is EndpointKind.PUBLISHER else (theirs.qos, ours.qos)
    )
    if subscriber.reliable and not publisher.reliable:
        why = "the publisher is best effort, the subscriber wants reliable"
        return Mismatch("reliability", why)
    if subscriber.transient_local and not publisher.transient_local:
        why = "the publisher is volatile, the subscriber wants transient local"
        return Mismatch("durability", why)
    if subscriber.deadline < publisher.deadline:
        wants = f"the subscriber wants a deadline of {subscriber.deadline:g} s"
        return Mismatch("deadline", f"{wants}, {_promise(publisher)}")
    if subscriber.manual > publisher.manual or subscriber.lease < publisher.lease:
        why = "the subscriber wants more signs of life than the publisher promises"
        return Mismatch("liveliness", why)
    return None


def _promise(publisher: Qos) -> str:
    promised = "none" if isinf(publisher.deadline) else f"{publisher.deadline:g} s"
    return f"the publisher promises {promised}"


def _other_type(endpoint: Endpoint, ours: Own, own: Mapping[OwnKey, Own]) -> str:
    verb = "sends" if endpoint.kind is EndpointKind.PUBLISHER else "expects"
    hint = ""
    if {endpoint.type_name, ours.type.name} == TWISTS:
        there = {row.type.name: name for (kind, name), row in own.items() if kind is ours.kind}
        fits = there.get(endpoint.type_name, "")
        hint = f"; publish on {fits} instead, or set enable_stamped_cmd_vel" if fits else ""
    return (
        f"{_named(endpoint)} {verb} {endpoint.type_name}, but the type is {ours.type.name} here:"
        f" nothing of it arrives{hint}"
    )


def _named(endpoint: Endpoint) -> str:
    return f"{endpoint.kind} {endpoint.node or 'of an unknown node'} on {endpoint.name}"
