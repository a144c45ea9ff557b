import pytest

from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, Graph, MessageType, Qos
from pioneer3.ros.ros2.mismatches import Mismatch, Own, incompatible, mismatches

TWIST = MessageType("geometry_msgs/msg/Twist", "RIHS01_1")
OLDER = MessageType(TWIST.name, "RIHS01_0")
STAMPED = MessageType("geometry_msgs/msg/TwistStamped", "RIHS01_2")


def endpoint(
    kind: EndpointKind,
    name: str,
    qos: Qos | None = None,
    *,
    type_: MessageType = TWIST,
    node: str = "/other",
) -> Endpoint:
    return Endpoint(
        kind=kind,
        name=name,
        qos=qos or Qos(),
        node=node,
        type_name=type_.name,
        type_hash=type_.hash,
    )


@pytest.mark.parametrize(
    ("publisher", "subscriber", "why"),
    [
        (Qos(), Qos(), ""),
        (Qos(), Qos(reliable=False), ""),
        (Qos(reliable=False), Qos(), "best effort"),
        (Qos(transient_local=True), Qos(), ""),
        (Qos(), Qos(transient_local=True), "volatile"),
        (Qos(deadline=0.1), Qos(), ""),
        (Qos(deadline=0.1), Qos(deadline=0.1), ""),
        (Qos(), Qos(deadline=0.1), "wants a deadline of 0.1 s, the publisher promises none"),
        (Qos(deadline=1.0), Qos(deadline=0.1), "the publisher promises 1 s"),
        (Qos(lease=1.0), Qos(), ""),
        (Qos(), Qos(lease=1.0), "signs of life"),
        (Qos(manual=True), Qos(), ""),
        (Qos(), Qos(manual=True), "signs of life"),
        (Qos(manual=True, lease=2.0), Qos(manual=False, lease=1.0), "signs of life"),
        (Qos(), Qos(depth=1), ""),
    ],
)
def test_a_subscriber_may_not_want_more_than_is_offered(
    publisher: Qos, subscriber: Qos, why: str
) -> None:
    ours, theirs = (
        Own(EndpointKind.PUBLISHER, TWIST, publisher),
        endpoint(EndpointKind.SUBSCRIBER, "/x", subscriber),
    )
    assert _agrees(incompatible(ours, theirs), why)
    ours, theirs = (
        Own(EndpointKind.SUBSCRIBER, TWIST, subscriber),
        endpoint(EndpointKind.PUBLISHER, "/x", publisher),
    )
    assert _agrees(incompatible(ours, theirs), why)


def _agrees(found: Mismatch | None, why: str) -> bool:
    return found is None if not why else found is not None and why in found.why


def test_other_types_versions_and_qualities_are_told_with_node_and_topic() -> None:
    own = {
        (EndpointKind.SUBSCRIBER, "/cmd_vel"): Own(EndpointKind.SUBSCRIBER, TWIST, Qos()),
        (EndpointKind.SUBSCRIBER, "/cmd_vel_stamped"): Own(EndpointKind.SUBSCRIBER, STAMPED, Qos()),
    }
    graph = Graph(
        ("/me", "/other"),
        (
            endpoint(EndpointKind.PUBLISHER, "/cmd_vel", type_=STAMPED),
            endpoint(EndpointKind.PUBLISHER, "/cmd_vel", type_=OLDER),
            endpoint(EndpointKind.PUBLISHER, "/cmd_vel", Qos(reliable=False), node=""),
            endpoint(EndpointKind.PUBLISHER, "/cmd_vel", Qos(reliable=False), node="/me"),
            endpoint(EndpointKind.SUBSCRIBER, "/cmd_vel", type_=STAMPED),
            endpoint(EndpointKind.PUBLISHER, "/elsewhere", type_=STAMPED),
            endpoint(EndpointKind.PUBLISHER, "/cmd_vel"),
        ),
    )
    told = list(mismatches(own, graph, "/me", strict=True))
    starts = ["publisher /other on /cmd_vel sends", "publisher /other on /cmd_vel has another"]
    starts.append("publisher of an unknown node on /cmd_vel and this node do not match")
    assert [line.startswith(start) for line, start in zip(told, starts, strict=True)] == [True] * 3
    assert "publish on /cmd_vel_stamped instead" in told[0]
    assert len(list(mismatches(own, graph, "/me", strict=False))) == 2


def test_a_topic_that_is_published_and_subscribed_is_looked_at_from_both_sides() -> None:
    own = {
        (EndpointKind.SUBSCRIBER, "/goal"): Own(EndpointKind.SUBSCRIBER, TWIST, Qos()),
        (EndpointKind.PUBLISHER, "/goal"): Own(EndpointKind.PUBLISHER, TWIST, Qos()),
    }
    others = (
        endpoint(EndpointKind.PUBLISHER, "/goal", Qos(reliable=False)),
        endpoint(EndpointKind.SUBSCRIBER, "/goal", Qos(transient_local=True)),
        endpoint(EndpointKind.SERVER, "/goal", type_=STAMPED),
    )
    told = list(mismatches(own, Graph(("/other",), others), "/me", strict=True))
    assert ["best effort" in told[0], "volatile" in told[1]] == [True, True]
    assert len(told) == 2
