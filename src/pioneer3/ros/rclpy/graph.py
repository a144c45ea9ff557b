"""The graph of nodes, by the graph functions of a node of rclpy."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Final

from pioneer3.names import printable
from pioneer3.ros.ros2.backend import DEPTH, Endpoint, EndpointKind, Graph, NodeName, Qos, Unread

UNKNOWN: Final = "_NODE_NAME_UNKNOWN_"
"""Name of the node of an endpoint whose participant has told no node."""


def publishers(node: Any, topic: str, unread: Unread) -> frozenset[bytes]:
    """Return the identities of all publishers on a topic.

    There are none where rclpy cannot read a name: in doubt, who drives the robot is gone.
    """
    found = _told(unread, node.get_publishers_info_by_topic, topic)
    return frozenset(bytes(each.endpoint_gid) for each in found)


def graph_of(node: Any, unread: Unread) -> Graph:
    """Return the nodes and endpoints that a node of rclpy knows.

    Where somebody has a name that is no UTF-8, rclpy tells none of those beside it.
    """
    names = _told(unread, node.get_node_names_and_namespaces)
    known = [NodeName(name, space) for name, space in names]
    endpoints = [*_of_topics(node, unread), *_of_services(node, dict.fromkeys(known), unread)]
    return Graph(
        tuple(sorted(printable(each.full) for each in known)),
        tuple(_printable(each) for each in endpoints),
    )


def _printable(endpoint: Endpoint) -> Endpoint:
    return replace(
        endpoint,
        node=printable(endpoint.node),
        name=printable(endpoint.name),
        type_name=printable(endpoint.type_name),
        type_hash=printable(endpoint.type_hash),
    )


def _told(unread: Unread, ask: Callable[..., Any], *about: str) -> Sequence[Any]:
    """Return the answer of rclpy, or nothing where it cannot read a name."""
    try:
        return list(ask(*about))
    except UnicodeDecodeError as error:
        unread.add(error)
        return ()


def _of_topics(node: Any, unread: Unread) -> Iterator[Endpoint]:
    for name, _ in _told(unread, node.get_topic_names_and_types):
        for each in _told(unread, node.get_publishers_info_by_topic, name):
            yield _endpoint(EndpointKind.PUBLISHER, name, each)
        for each in _told(unread, node.get_subscriptions_info_by_topic, name):
            yield _endpoint(EndpointKind.SUBSCRIBER, name, each)


def _of_services(node: Any, known: Iterable[NodeName], unread: Unread) -> Iterator[Endpoint]:
    from rclpy.node import NodeNameNonExistentError

    for each in known:
        for kind, names_and_types in (
            (EndpointKind.SERVER, node.get_service_names_and_types_by_node),
            (EndpointKind.CLIENT, node.get_client_names_and_types_by_node),
        ):
            try:
                found = _told(unread, names_and_types, each.name, each.namespace)
            except NodeNameNonExistentError:  # it has just left
                continue
            for name, type_names in found:
                for type_name in type_names:
                    yield Endpoint(kind=kind, node=each.full, name=name, type_name=type_name)


def _endpoint(kind: EndpointKind, name: str, found: Any) -> Endpoint:
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    profile = found.qos_profile
    hash_ = str(getattr(found, "topic_type_hash", ""))  # Humble has none
    is_known = found.node_name != UNKNOWN
    return Endpoint(
        kind=kind,
        node=NodeName(found.node_name, found.node_namespace).full if is_known else "",
        name=name,
        type_name=found.topic_type,
        type_hash=hash_ if hash_.startswith("RIHS") else "",
        qos=Qos(
            reliable=profile.reliability == ReliabilityPolicy.RELIABLE,
            transient_local=profile.durability == DurabilityPolicy.TRANSIENT_LOCAL,
            depth=profile.depth or DEPTH,  # not every middleware tells it
        ),
        gid=bytes(found.endpoint_gid),
    )
