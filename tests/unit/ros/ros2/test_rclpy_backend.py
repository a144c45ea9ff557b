"""The backend over rclpy, with a strict stand-in for rclpy."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event
from typing import Any

import pytest

from pioneer3.errors import ConfigError
from pioneer3.ros.rclpy.backend import RclpyBackend, installed_distro
from pioneer3.ros.ros2.backend import LATCHED, EndpointKind, Graph, NodeName, Qos
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.middleware import ROSOUT
from pioneer3.ros.ros2.types import MessageTypes
from tests.unit.ros.ros2.fake_rclpy import Flavour, World, installed

pytestmark = pytest.mark.realtime
TYPES = MessageTypes(distro_of("jazzy"))
ROBOT, OTHER = NodeName("pioneer3", "/robot1"), NodeName("other")
STRING = TYPES.message_type("std_msgs/String")
SENSOR_DATA = Qos(reliable=False, depth=5)
TRIGGER = TYPES.service_type("std_srvs/Trigger")
HUMBLE = Flavour(distro="humble")
LYRICAL = Flavour(distro="lyrical", tells_gid=True)
CYCLONE = Flavour(distro="lyrical", tells_gid=True, gid_is_that_of_the_graph=False)


def wait_for(condition: Callable[[], object]) -> None:
    end = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


def text(data: str) -> bytes:
    message = TYPES.make("std_msgs/String")
    message.data = data
    return TYPES.encode(message)


@contextmanager
def two(flavour: Flavour | None = None) -> Iterator[tuple[World, RclpyBackend, RclpyBackend]]:
    """Be two nodes; no callback of theirs may raise."""
    with installed(TYPES, flavour or Flavour()) as world:
        robot, other = RclpyBackend(ROBOT, TYPES, 7), RclpyBackend(OTHER, TYPES, None)
        executors: list[Any] = [each.executor for each in world.nodes]
        try:
            yield world, robot, other
        finally:
            other.close()
            robot.close()
        assert world.nodes == []
        assert not any(each.ok() for each in world.contexts)
        assert [each.errors for each in executors] == [[], []]


@pytest.mark.parametrize("flavour", [HUMBLE, LYRICAL, CYCLONE])
def test_messages_come_with_the_identity_that_the_graph_has(flavour: Flavour) -> None:
    heard: list[tuple[bytes, bytes]] = []
    gone: list[bytes] = []
    with two(flavour) as (_, robot, other):
        writer = other.advertise("/chat", STRING, LATCHED)
        assert not writer.matched
        robot.subscribe("/chat", STRING, Qos(), lambda *each: heard.append(each), gone.append)
        assert writer.matched
        sent = [text(str(number)) for number in range(50)]
        for each in sent:
            writer.write(each)
        wait_for(lambda: len(heard) == 50)
        assert [cdr for cdr, _ in heard] == sent
        (endpoint,) = [e for e in robot.graph().endpoints if e.kind is EndpointKind.PUBLISHER]
        assert {gid for _, gid in heard} == {endpoint.gid}
        assert (endpoint.node, endpoint.name, endpoint.qos) == ("/other", "/chat", LATCHED)
        assert endpoint.type_hash.startswith("RIHS01_") == (flavour.distro != "humble")
        writer.close()
        writer.close()
        wait_for(lambda: gone == [endpoint.gid])
        writer.write(text("nobody hears it"))
        assert not writer.matched


@pytest.mark.parametrize(("flavour", "told"), [(HUMBLE, False), (LYRICAL, True), (CYCLONE, True)])
def test_of_two_publishers_each_has_its_own_identity_if_rclpy_tells_it(
    flavour: Flavour, told: bool
) -> None:
    heard: list[tuple[bytes, bytes]] = []
    with two(flavour) as (_, robot, other):
        first = other.advertise("/chat", STRING, Qos())
        robot.subscribe("/chat", STRING, Qos(), lambda *each: heard.append(each), lambda gid: None)
        first.write(text("alone"))
        wait_for(lambda: len(heard) == 1)
        second = other.advertise("/chat", STRING, Qos())
        first.write(text("first"))
        second.write(text("second"))
        wait_for(lambda: len(heard) == 3)
        alone, again, another = [gid for _, gid in heard]
        assert alone
        assert (again, bool(another)) == ((alone, True) if told else (b"", False))
        assert another != alone


def test_a_service_that_waits_holds_up_nothing() -> None:
    heard, go_on, waits = list[bytes](), Event(), Event()

    def wait(cdr: bytes) -> bytes:
        assert cdr == request
        waits.set()
        assert go_on.wait(30)
        return TYPES.encode(TYPES.make(TRIGGER.response.name))

    with two() as (_, robot, other):
        service = robot.serve("/robot1/wait", TRIGGER, wait)
        robot.subscribe("/chat", STRING, Qos(), lambda cdr, gid: heard.append(cdr), lambda g: None)
        writer = other.advertise("/chat", STRING, Qos())
        request = TYPES.encode(TYPES.make(TRIGGER.request.name))
        with pytest.raises(TimeoutError, match="does not respond"):
            other.call("/robot1/wait", TRIGGER, request, 0.05)
        assert waits.wait(30)
        writer.write(text("heard"))
        wait_for(lambda: heard == [text("heard")])
        go_on.set()
        service.close()
        with pytest.raises(TimeoutError, match="no node offers /robot1/wait"):
            other.call("/robot1/wait", TRIGGER, request, 0.05)


def test_a_callback_that_fails_ends_nothing(caplog: pytest.LogCaptureFixture) -> None:
    heard: list[bytes] = []

    def fail_once(cdr: bytes, gid: bytes) -> None:
        heard.append(cdr)
        if len(heard) == 1:
            raise OSError("once")

    def fail(cdr: bytes) -> bytes:
        raise OSError("always")

    with two() as (_, robot, other):
        robot.subscribe("/chat", STRING, SENSOR_DATA, fail_once, lambda gid: None)
        robot.serve("/fail", TRIGGER, fail)
        writer = other.advertise("/chat", STRING, Qos())
        for word in ("a", "b"):
            writer.write(text(word))
        wait_for(lambda: len(heard) == 2)
        cdr = other.call("/fail", TRIGGER, TYPES.encode(TYPES.make(TRIGGER.request.name)), 30)
        assert not TYPES.decode(cdr, TRIGGER.response.name).success
        assert {"a message is lost", "the service /fail fails"} <= set(caplog.messages)


def test_nothing_is_used_after_the_end() -> None:
    heard: list[bytes] = []
    with two() as (world, robot, other):
        reader = robot.subscribe("/a", STRING, Qos(), lambda cdr, gid: heard.append(cdr), print)
        mine, theirs = robot.advertise("/b", STRING, Qos()), other.advertise("/a", STRING, Qos())
        reach = "this computer only (ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET for all around)"
        assert robot.title == f"rclpy of jazzy (rmw_fastrtps_cpp), domain 7, {reach}"
        assert "domain 0" in other.title
        assert (robot.serves, robot.strict, robot.lacks) == (True, True, "")
        robot.close()
        robot.close()
        theirs.write(text("late"))
        mine.write(text("late"))
        mine.close()
        reader.close()
        assert (heard, mine.matched, robot.graph()) == ([], False, Graph())
        assert [each.name for each in world.nodes] == ["other"]


def test_a_node_that_leaves_meanwhile_is_in_the_graph_without_services() -> None:
    with two() as (_, robot, _):
        leaving = RclpyBackend(NodeName("leaving"), TYPES, 7)
        leaving.serve("/gone", TRIGGER, lambda cdr: cdr)
        assert robot.graph().nodes == ("/leaving", "/other", "/robot1/pioneer3")
        assert robot.graph().endpoints == ()
        leaving.close()


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        ("builtin_interfaces/msg/Time", {"sec": "int64", "nanosec": "uint32"}),
        ("std_msgs/msg/Header", {"frame_id": "string", "stamp": "builtin_interfaces/Time"}),
    ],
)
def test_another_definition_is_refused_each_time(name: str, fields: dict[str, str]) -> None:
    with two() as (_, robot, _):
        package, kind, last = name.split("/")
        generated = getattr(__import__(f"{package}.{kind}", fromlist=[last]), last)
        generated.fields = fields
        for _ in range(2):
            with pytest.raises(ConfigError, match=f"{name} of the ROS installed here is not"):
                robot.advertise("/x", TYPES.message_type("std_msgs/Header"), Qos())


def test_a_ros_that_is_not_there_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    with installed(TYPES, HUMBLE):
        assert installed_distro() == "humble"
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    assert installed_distro() is None
    with pytest.raises(ConfigError, match=r"cannot import rclpy .*source /opt/ros/jazzy/setup"):
        RclpyBackend(ROBOT, TYPES, 0)


def test_old_messages_of_logs_reach_nobody() -> None:
    with two() as (world, robot, _):
        robot.advertise("/rosout", STRING, ROSOUT)
        robot.advertise("/chat", STRING, LATCHED)
        found = {each.name: each.qos for node in world.nodes for each in node.entities}
        assert found["/rosout"].lifespan.nanoseconds == 10_000_000_000
        assert found["/rosout"].depth == 1000
        assert found["/chat"].lifespan.nanoseconds == 0


def test_names_from_the_network_forge_no_lines_of_a_log() -> None:
    with two() as (_, robot, other):
        other.advertise("/x\x1b[2J\nready", STRING, Qos())
        (endpoint,) = robot.graph().endpoints
        assert endpoint.name == r"/x\x1b[2J\nready"
