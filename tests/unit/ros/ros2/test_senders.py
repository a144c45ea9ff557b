"""The publishers of messages: who they are, and the cost of finding out."""

from dataclasses import dataclass, field

from pioneer3.ros.ros2.backend import Endpoint, EndpointKind, Graph
from pioneer3.ros.ros2.senders import REMEMBERED, UNKNOWN, Senders

TOPIC = "/cmd_vel"


def publisher(node: str, gid: bytes, name: str = TOPIC) -> Endpoint:
    return Endpoint(
        kind=EndpointKind.PUBLISHER,
        node=node,
        name=name,
        type_name="geometry_msgs/msg/Twist",
        gid=gid,
    )


@dataclass
class Looked:
    """A graph, the number of looks at it, and a clock."""

    endpoints: list[Endpoint] = field(default_factory=list)
    looks: int = 0
    time: float = 0.0

    def graph(self) -> Graph:
        self.looks += 1
        return Graph((), tuple(self.endpoints))

    def senders(self) -> Senders:
        return Senders(self.graph, lambda: self.time)


def test_messages_of_an_unknown_publisher_cost_one_look_in_a_second() -> None:
    the = Looked()
    senders = the.senders()
    for number in range(5_000):
        the.time = number / 1000
        assert senders.of(TOPIC, b"plain").node == UNKNOWN
    assert the.looks == 5


def test_many_unknown_publishers_share_a_look() -> None:
    the = Looked()
    senders = the.senders()
    for number in range(1_000):
        the.time = number / 1000
        senders.of(TOPIC, number.to_bytes(16, "big"))
    assert the.looks <= 10


def test_a_publisher_that_is_found_later_keeps_its_connection() -> None:
    the = Looked()
    senders = the.senders()
    first = senders.of(TOPIC, b"1")
    the.endpoints.append(publisher("/keys", b"1"))
    the.time = 1.0
    second = senders.of(TOPIC, b"1")
    assert (first.node, second.node) == (UNKNOWN, "/keys")
    assert first.connection is second.connection
    the.time = 10.0
    assert senders.of(TOPIC, b"1") is second
    assert the.looks == 2


def test_only_publishers_of_the_topic_send_on_it() -> None:
    the = Looked()
    the.endpoints = [
        Endpoint(kind=EndpointKind.SERVER, node="/state", name="/state/get", type_name="x"),
        Endpoint(kind=EndpointKind.SUBSCRIBER, node="/me", name=TOPIC, type_name="x", gid=b"1"),
        publisher("/elsewhere", b"1", "/odom"),
    ]
    senders = the.senders()
    assert senders.of(TOPIC, b"").node == UNKNOWN
    assert senders.of(TOPIC, b"1").node == UNKNOWN


def test_publishers_without_an_identity_are_one_for_each_topic() -> None:
    senders = Looked().senders()
    one, same = senders.of(TOPIC, b""), senders.of(TOPIC, b"")
    assert one.connection is same.connection
    assert one.connection is not senders.of("/cmd_vel_stamped", b"").connection


def test_a_publisher_that_sends_is_not_forgotten_for_others() -> None:
    senders = Looked().senders()
    driver, silent = senders.of(TOPIC, b"driver"), senders.of(TOPIC, b"silent")
    for number in range(REMEMBERED):
        senders.of(TOPIC, number.to_bytes(16, "big"))
        assert senders.of(TOPIC, b"driver").connection is driver.connection
    assert senders.of(TOPIC, b"silent").connection is not silent.connection


def test_a_publisher_that_leaves_is_told_once() -> None:
    senders = Looked().senders()
    sender = senders.of(TOPIC, b"1")
    assert senders.lose(TOPIC, b"1") == sender
    assert senders.lose(TOPIC, b"1") is None
