"""A bridge between a network of ROS 1 on real sockets and one of ROS 2 in this process."""

import asyncio
import time
from collections.abc import AsyncIterator, Iterable
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field
from math import inf, nan
from struct import pack
from typing import Any, NoReturn

import pytest

from pioneer3.errors import ConfigError
from pioneer3.models import load_model
from pioneer3.ros.bridge.bridge import TopicBridge
from pioneer3.ros.bridge.conversion import Converter, FrameNames
from pioneer3.ros.bridge.rows import (
    BridgedRobot,
    BridgedTopic,
    BridgeWay,
    ServiceRow,
    Side,
    rows_of,
    services_of,
)
from pioneer3.ros.node.names import Profile
from pioneer3.ros.ros2.backend import LATCHED, Graph, NodeName, Qos
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.tcpros.node import Ros1Node, ros1_node
from pioneer3.ros.tcpros.publisher import TopicPublisher
from pioneer3.ros.tcpros.services import ServiceError
from pioneer3.ros.tcpros.subscriber import BRIDGE_FIELD
from pioneer3.ros.tcpros.types import Ros1Types
from pioneer3.tasks import running
from tests.e2e.processes import until
from tests.ros1.little_master import LittleMaster, little_master
from tests.unit.ros.ros2.memory import MemoryBackend, MemoryEndpoint, MemoryNetwork

pytestmark = [pytest.mark.realtime]
ROS1, ROS2 = Ros1Types(), MessageTypes(distro_of("jazzy"))
TWIST, BOOL, ODOMETRY = "geometry_msgs/Twist", "std_msgs/Bool", "nav_msgs/Odometry"
TF = "tf2_msgs/TFMessage"


def table(side: Side) -> BridgedRobot:
    return BridgedRobot(
        side=side,
        model=load_model("p3at-sh"),
        distro=distro_of("jazzy"),
        profile=Profile.STANDARD,
    )


def rows(side: Side, *names: str) -> list[BridgedTopic]:
    return [row for row in rows_of(table(side)) if row.ros1.strip("/") in names]


def services(side: Side, *names: str) -> list[ServiceRow]:
    return [row for row in services_of(table(side)) if row.ros1.strip("/") in names]


@dataclass
class Networks:
    """Both networks, a program on each, and the bridges' words."""

    master: LittleMaster
    old: Ros1Node
    network: MemoryNetwork
    stack: AsyncExitStack
    said: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.new = MemoryBackend(self.network, NodeName("new"))

    @asynccontextmanager
    async def bridge(
        self,
        rows: Iterable[BridgedTopic],
        services: Iterable[ServiceRow] = (),
        *,
        name: str = "bridge",
        robot: Side = Side.ROS2,
        lasting: float = 0.5,
        serves: bool = True,
        prefix: str = "",
    ) -> AsyncIterator[asyncio.Task[None]]:
        """Run a bridge; the block begins when it is ready."""
        backend = MemoryBackend(self.network, NodeName(name), serves=serves)
        extra = {BRIDGE_FIELD: "1"}
        begun = len(self.said)
        async with ros1_node(f"/{name}", self.master.at, self.said.append, extra) as node:
            made = TopicBridge(
                node,
                backend,
                f"/{name}",
                Converter(ROS1, ROS2, FrameNames(prefix)),
                rows=rows,
                services=services,
                robot=robot,
                timeout=lasting,
                tell=self.said.append,
            )
            task = asyncio.create_task(made.run(discovery=0.1, lease=0.3))
            try:
                await until(lambda: task.done() or self.tells("ready;", begun))
                yield task
            finally:
                task.cancel()
                await asyncio.gather(task, return_exceptions=True)
        backend.close()

    def tells(self, words: str, begun: int = 0) -> bool:
        return any(words in line for line in self.said[begun:])

    def hear_new(self, name: str, type_name: str, *, latched: bool = False) -> list[Any]:
        """Return the messages of a topic in ROS 2, which come from now on."""
        heard: list[Any] = []
        type_ = ROS2.message_type(type_name)

        def received(cdr: bytes, gid: bytes) -> None:
            heard.append(ROS2.decode(cdr, type_.name))

        qos = LATCHED if latched else Qos()
        self.new.subscribe(name, type_, qos, received, lambda gid: None)
        return heard

    def hear_old(self, name: str, type_name: str, node: Ros1Node | None = None) -> list[Any]:
        """Return the messages of a topic in ROS 1, which come from now on."""
        heard: list[Any] = []
        (node or self.old).subscribe(
            name,
            ROS1.definition(type_name),
            lambda data, connection, old: heard.append(ROS1.decode(data, type_name)),
            lambda connection: None,
        )
        return heard

    async def node(self, name: str) -> Ros1Node:
        return await self.stack.enter_async_context(ros1_node(name, self.master.at, print))

    def publisher(self, name: str, type_name: str, *, latched: bool = False) -> TopicPublisher:
        return self.old.advertise(name, ROS1.definition(type_name), latched=latched)

    def writer(
        self, name: str, type_name: str, *, latched: bool = False, node: str = "new"
    ) -> MemoryEndpoint:
        backend = MemoryBackend(self.network, NodeName(node))
        qos = LATCHED if latched else Qos()
        return backend.advertise(name, ROS2.message_type(type_name), qos)


@pytest.fixture
async def networks() -> AsyncIterator[Networks]:
    with little_master() as master:
        async with AsyncExitStack() as stack:
            old = await stack.enter_async_context(ros1_node("/old", master.at, print))
            yield Networks(master, old, MemoryNetwork(), stack)


def twist(v: float) -> bytes:
    message = ROS1.make(TWIST)
    message.linear.x = v
    return ROS1.encode(message)


def bool_of(value: bool) -> bytes:
    message = ROS2.make(BOOL)
    message.data = value
    return ROS2.encode(message)


def odometry(x: float) -> Any:
    message = ROS2.make(ODOMETRY)
    message.header.frame_id, message.child_frame_id = "odom", "base_link"
    message.header.stamp.sec, message.header.stamp.nanosec = 12, 34
    message.pose.pose.position.x = x
    message.pose.covariance[0] = 0.5
    return message


def speeds(heard: list[Any]) -> list[float]:
    return [getattr(each, "twist", each).linear.x for each in heard]


async def test_an_old_program_drives_a_robot_in_ros2_and_silence_stops_it(
    networks: Networks,
) -> None:
    heard = networks.hear_new("/cmd_vel", TWIST)
    async with networks.bridge(rows(Side.ROS2, "cmd_vel")):
        publisher = networks.publisher("/cmd_vel", TWIST)
        await until(lambda: publisher.matched)
        began = time.monotonic()
        publisher.write(twist(0.3))
        await until(lambda: len(heard) == 2)
        assert speeds(heard) == [0.3, 0.0]
        assert time.monotonic() - began > 0.45
        assert networks.tells("bridged: ROS 1 /cmd_vel -> ROS 2 /cmd_vel (geometry_msgs/Twist)")


async def test_a_program_that_is_gone_is_followed_by_a_zero_at_once(networks: Networks) -> None:
    heard = networks.hear_new("/cmd_vel", TWIST)
    async with networks.bridge(rows(Side.ROS2, "cmd_vel"), lasting=inf):
        async with ros1_node("/keys", networks.master.at, print) as keys:
            publisher = keys.advertise("/cmd_vel", ROS1.definition(TWIST))
            await until(lambda: publisher.matched)
            publisher.write(twist(0.3))
            await until(lambda: heard)
        await until(lambda: len(heard) == 2)
        assert speeds(heard) == [0.3, 0.0]
        assert networks.tells("/keys, which drove by ROS 1 /cmd_vel, is gone: stops")


async def test_a_bridge_that_ends_stops_the_robot_of_either_side(networks: Networks) -> None:
    heard = networks.hear_new("/cmd_vel", TWIST)
    publisher = networks.publisher("/cmd_vel", TWIST)
    async with networks.bridge(rows(Side.ROS2, "cmd_vel"), lasting=inf):
        await until(lambda: publisher.matched)
        publisher.write(twist(0.3))
        await until(lambda: heard)
    assert speeds(heard) == [0.3, 0.0]
    other = await networks.node("/robot")
    driven = networks.hear_old("/cmd_vel", TWIST, other)
    async with networks.bridge(rows(Side.ROS1, "cmd_vel"), robot=Side.ROS1, lasting=inf):
        writer = networks.writer("/cmd_vel", TWIST)
        message = ROS2.make(TWIST)
        message.linear.x = -0.2

        def arrives() -> bool:
            writer.write(ROS2.encode(message))
            return bool(driven)

        await until(arrives)
    await until(lambda: speeds(driven)[-1] == 0.0)
    assert networks.tells("the bridge ends: a zero is sent on /cmd_vel")


async def test_nothing_comes_after_the_zero_of_a_bridge_that_ends(networks: Networks) -> None:
    heard = networks.hear_new("/cmd_vel", TWIST)
    publisher = networks.publisher("/cmd_vel", TWIST)

    async def drive() -> None:
        while True:
            publisher.write(twist(0.3))
            await asyncio.sleep(0.005)

    async with running(drive()):
        async with networks.bridge(rows(Side.ROS2, "cmd_vel"), lasting=inf):
            await until(lambda: len(heard) > 10)
        assert speeds(heard)[-1] == 0.0
        assert speeds(heard).count(0.0) == 1


async def test_a_bridge_that_fails_stops_the_robot(
    networks: Networks, monkeypatch: pytest.MonkeyPatch
) -> None:
    heard = networks.hear_new("/cmd_vel", TWIST)
    publisher = networks.publisher("/cmd_vel", TWIST)
    async with networks.bridge(rows(Side.ROS2, "cmd_vel"), lasting=inf) as task:
        await until(lambda: publisher.matched)
        publisher.write(twist(0.3))
        await until(lambda: heard)

        def fail(_: MemoryBackend) -> NoReturn:
            raise RuntimeError("the network is broken")

        monkeypatch.setattr(MemoryBackend, "graph", fail)
        with pytest.raises(RuntimeError, match="the network is broken"):
            await asyncio.wait_for(task, 5)
        assert speeds(heard) == [0.3, 0.0]


async def test_a_writer_of_ros2_that_leaves_stops_a_robot_in_ros1(networks: Networks) -> None:
    heard = networks.hear_old("/cmd_vel", TWIST)
    async with networks.bridge(rows(Side.ROS1, "cmd_vel"), robot=Side.ROS1, lasting=inf):
        writer = networks.writer("/cmd_vel", TWIST)
        message = ROS2.make(TWIST)
        message.linear.x = 0.2
        await until(lambda: "/bridge" in networks.master.publishers["/cmd_vel"])

        def arrives() -> bool:
            writer.write(ROS2.encode(message))
            return bool(heard)

        await until(arrives)
        writer.close()
        await until(lambda: speeds(heard)[-1] == 0.0)


async def test_stamped_commands_that_are_old_are_not_passed_on_as_new(networks: Networks) -> None:
    heard = networks.hear_old("/cmd_vel", TWIST)
    async with networks.bridge(rows(Side.ROS1, "cmd_vel"), robot=Side.ROS1):
        writer = networks.writer("/cmd_vel_stamped", "geometry_msgs/TwistStamped")
        await until(lambda: "/bridge" in networks.master.publishers["/cmd_vel"])
        await asyncio.sleep(0.3)

        def send(v: float, age: float) -> None:
            message = ROS2.make("geometry_msgs/TwistStamped")
            message.twist.linear.x = v
            stamp = message.header.stamp
            stamp.sec, stamp.nanosec = divmod(time.time_ns() - int(age * 1e9), 10**9)
            writer.write(ROS2.encode(message))

        send(0.3, 5.0)
        await until(lambda: networks.tells("its stamp is 5."))
        send(0.2, 0.0)
        await until(lambda: heard)
        assert speeds(heard)[0] == 0.2


async def test_what_is_not_finite_is_not_passed_on(networks: Networks) -> None:
    heard = networks.hear_new("/cmd_vel", TWIST)
    async with networks.bridge(rows(Side.ROS2, "cmd_vel")):
        publisher = networks.publisher("/cmd_vel", TWIST)
        await until(lambda: publisher.matched)
        publisher.write(twist(nan))
        publisher.write(twist(0.1))
        await until(lambda: heard)
        assert speeds(heard)[0] == 0.1
        assert networks.tells("ROS 1 /cmd_vel of /old is not passed on: numbers that are not fin")


async def test_a_latched_command_from_before_the_bridge_does_not_drive(networks: Networks) -> None:
    heard = networks.hear_new("/cmd_vel", TWIST)
    publisher = networks.publisher("/cmd_vel", TWIST, latched=True)
    publisher.write(twist(0.3))
    await until(lambda: "/old" in networks.master.publishers.get("/cmd_vel", {}))
    async with networks.bridge(rows(Side.ROS2, "cmd_vel")):
        await until(lambda: networks.tells("a latched command from before this bridge"))
        publisher.write(twist(0.2))
        await until(lambda: heard)
        assert speeds(heard)[0] == 0.2


async def test_goals_of_earlier_do_not_set_the_robot_off(networks: Networks) -> None:
    pose, place = "geometry_msgs/PoseStamped", "std_msgs/String"
    goals, places = networks.hear_new("/goal_pose", pose), networks.hear_new("/goal_name", place)
    named, goal = ROS1.make(place), ROS1.make(pose)
    publisher = networks.publisher("/goal_name", place, latched=True)

    def name(words: str) -> None:
        named.data = words
        publisher.write(ROS1.encode(named))

    name("Kitchen")
    await until(lambda: "/old" in networks.master.publishers.get("/goal_name", {}))
    async with networks.bridge(rows(Side.ROS2, "goal_name", "move_base_simple/goal")):
        await until(lambda: networks.tells("ROS 1 /goal_name of /old is not passed on: a latched"))
        name("Office")
        await until(lambda: places)
        assert [each.data for each in places] == ["Office"]
        other = networks.publisher("/move_base_simple/goal", pose)
        await until(lambda: other.matched)
        for age in (3600, 0):
            goal.pose.position.x = float(age)
            goal.header.stamp.sec = int(time.time()) - age
            other.write(ROS1.encode(goal))
        await until(lambda: goals)
        assert [each.pose.position.x for each in goals] == [0.0]
        assert networks.tells("/move_base_simple/goal of /old is not passed on: its stamp is 360")


async def test_odometry_arrives_as_it_was_with_numbers_in_its_headers(networks: Networks) -> None:
    heard = networks.hear_old("/odom", ODOMETRY)
    writer = networks.writer("/odom", ODOMETRY, node="robot")
    async with networks.bridge(rows(Side.ROS2, "odom"), prefix="robot1/"):
        await until(lambda: networks.old.state and "/bridge" in networks.master.publishers["/odom"])

        def arrives() -> bool:
            writer.write(ROS2.encode(odometry(1.5)))
            return len(heard) > 2

        await until(arrives)
        first, second = heard[:2]
        assert first.header.seq + 1 == second.header.seq
        assert (first.header.stamp.sec, first.header.stamp.nanosec) == (12, 34)
        assert (first.header.frame_id, first.child_frame_id) == ("robot1/odom", "robot1/base_link")
        assert first.pose.pose.position.x == 1.5
        assert first.pose.covariance[0] == 0.5


async def test_a_latched_stop_arrives_late_and_is_true_without_a_robot(networks: Networks) -> None:
    writer = networks.writer("/emergency_stop", BOOL, latched=True, node="robot")
    writer.write(bool_of(False))
    async with networks.bridge(rows(Side.ROS2, "emergency_stop")):
        late = await networks.node("/late")
        heard = networks.hear_old("/emergency_stop", BOOL, late)
        await until(lambda: heard)
        assert [each.data for each in heard] == [False]
        writer.close()
        await until(lambda: len(heard) == 2)
        assert heard[1].data
        await until(lambda: networks.tells("ROBOT LOST: nobody publishes its topics in ROS 2"))


def transforms(store: Any, *frames: str) -> bytes:
    message = store.make(TF)
    for frame in frames:
        each = store.make("geometry_msgs/TransformStamped")
        each.header.frame_id, each.child_frame_id = "base_link", frame
        message.transforms.append(each)
    return bytes(store.encode(message))


@pytest.mark.parametrize("side", list(Side))
async def test_fixed_transforms_of_several_publishers_are_together_for_late_subscribers(
    networks: Networks, side: Side
) -> None:
    async with networks.bridge(rows(side, "tf_static"), robot=side):
        for number, frames in enumerate((["laser"], ["/sonar_0", "sonar_1"], ["laser", "camera"])):
            if side is Side.ROS1:
                node = await networks.node(f"/static_{number}")
                publisher = node.advertise("/tf_static", ROS1.definition(TF), latched=True)
                publisher.write(transforms(ROS1, *frames))
            else:
                writer = networks.writer("/tf_static", TF, latched=True, node=f"s{number}")
                writer.write(transforms(ROS2, *frames))
        expected = {"laser", "sonar_0" if side is Side.ROS1 else "/sonar_0", "sonar_1", "camera"}

        def complete() -> bool:
            return bool(heard) and {t.child_frame_id for t in heard[-1].transforms} == expected

        if side is Side.ROS1:
            await asyncio.sleep(0.5)
            heard = networks.hear_new("/tf_static", TF, latched=True)
        else:
            heard = networks.hear_old("/tf_static", TF)
        await until(complete)


async def test_a_topic_both_ways_never_echoes(networks: Networks) -> None:
    both = BridgedTopic(ros1="/a", ros2="/a", ros1_type=BOOL, ros2_type=BOOL, way=BridgeWay.BOTH)
    async with networks.bridge([both]):
        publisher, writer = networks.publisher("/a", BOOL), networks.writer("/a", BOOL)
        old, new = networks.hear_old("/a", BOOL), networks.hear_new("/a", BOOL)
        await until(lambda: publisher.matched and "/old" in networks.master.subscribers["/a"])
        other = await networks.node("/other")
        heard = networks.hear_old("/a", BOOL, other)

        def arrives() -> bool:
            writer.write(bool_of(False))
            return bool(old and heard)

        await until(arrives)
        await asyncio.sleep(0.2)
        before, new[:] = len(old), []
        publisher.write(b"\x01")
        await until(lambda: new)
        await asyncio.sleep(0.3)
        assert [each.data for each in new] == [True]
        assert len(old) == before
        assert all(not each.data for each in old)


async def test_a_second_bridge_rests_where_the_first_publishes_and_says_so(
    networks: Networks,
) -> None:
    writer = networks.writer("/odom", ODOMETRY, node="robot")
    heard = networks.hear_old("/odom", ODOMETRY)
    async with networks.bridge(rows(Side.ROS2, "odom", "cmd_vel")):
        await until(lambda: "/bridge" in networks.master.publishers["/odom"])
        async with networks.bridge(rows(Side.ROS2, "odom", "cmd_vel"), name="second"):
            assert networks.tells("ANOTHER BRIDGE is here: /bridge in ROS 1")
            assert networks.tells("ANOTHER BRIDGE is here: /bridge in ROS 2")
            assert networks.tells("RESTS: ROS 1 /odom <- ROS 2 /odom (nav_msgs/Odometry), for /br")
            await until(lambda: networks.tells("ANOTHER BRIDGE is here: /second in ROS 2"))

            def arrives() -> bool:
                writer.write(ROS2.encode(odometry(1.0)))
                return bool(heard)

            await until(arrives)
            assert "/second" not in networks.master.publishers["/odom"]
        await asyncio.sleep(0)


async def test_a_bridge_whose_name_a_node_of_ros2_has_does_not_start(
    networks: Networks, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, twins = MemoryBackend.graph, ["/bridge"]
    monkeypatch.setattr(
        MemoryBackend,
        "graph",
        lambda self: Graph((*real(self).nodes, *twins), real(self).endpoints),
    )
    async with networks.bridge([]) as task:
        with pytest.raises(ConfigError, match="a node /bridge is in ROS 2 already"):
            await task
    assert not networks.tells("ready;")
    asyncio.get_running_loop().call_later(0.2, twins.clear)  # it was killed, and is forgotten
    async with networks.bridge([]):
        assert networks.tells("ready;")


async def test_two_bridges_of_opposite_ways_make_no_circle(networks: Networks) -> None:
    heard = networks.hear_new("/cmd_vel", TWIST)
    async with (
        networks.bridge(rows(Side.ROS2, "cmd_vel"), lasting=inf),
        networks.bridge(rows(Side.ROS1, "cmd_vel"), name="back", robot=Side.ROS1, lasting=inf),
    ):
        publisher = networks.publisher("/cmd_vel", TWIST)
        await until(lambda: publisher.matched and "/back" in networks.master.publishers["/cmd_vel"])
        publisher.write(twist(0.3))
        await until(lambda: heard)
        await asyncio.sleep(0.5)
        assert speeds(heard) == [0.3]
        assert networks.tells("of /bridge is not passed on: that is a bridge, too")


async def test_a_row_rests_while_another_node_publishes_it(networks: Networks) -> None:
    writer = networks.writer("/odom", ODOMETRY, node="robot")
    async with networks.bridge(rows(Side.ROS1, "odom"), robot=Side.ROS1):
        assert networks.tells("RESTS: ROS 1 /odom -> ROS 2 /odom (nav_msgs/Odometry), for /robot")
        assert not networks.tells("bridged: ")
        writer.close()
        await until(lambda: networks.tells("bridged: ROS 1 /odom"))


async def test_pictures_are_asked_for_only_while_somebody_looks(networks: Networks) -> None:
    writer = networks.writer("/camera/image_raw", "sensor_msgs/Image", node="robot")
    async with networks.bridge(rows(Side.ROS2, "camera/image_raw")):
        assert not writer.matched
        other = await networks.node("/other")
        type_ = ROS1.definition("sensor_msgs/Image")
        looking = other.subscribe(
            "/camera/image_raw", type_, lambda *heard: None, lambda connection: None
        )
        await until(lambda: writer.matched)
        other.unsubscribe(looking)
        await until(lambda: not writer.matched)


@pytest.mark.parametrize("serves", [True, False])
async def test_services_of_a_robot_in_ros2_are_called_from_ros1(
    networks: Networks, serves: bool
) -> None:
    trigger, set_bool = (
        ROS1.service_definition(f"std_srvs/{name}") for name in ("Trigger", "SetBool")
    )
    switched: list[bool] = []

    def respond(cdr: bytes) -> bytes:
        switched.append(bool(ROS2.decode(cdr, "std_srvs/srv/SetBool_Request").data))
        response = ROS2.make("std_srvs/srv/SetBool_Response")
        response.success, response.message = True, "done"
        return ROS2.encode(response)

    def received(cdr: bytes, gid: bytes) -> None:
        switched.append(bool(ROS2.decode(cdr, BOOL).data))

    if serves:
        type_ = ROS2.service_type("std_srvs/SetBool")
        networks.new.serve("/sonar/enable", type_, respond)
    else:
        type2 = ROS2.message_type(BOOL)
        networks.new.subscribe("/sonar/enable", type2, Qos(), received, lambda gid: None)
    offered = services(Side.ROS2, "sonar/enable", "e_stop_reset", "enable_motors")
    async with networks.bridge([], offered, serves=serves):
        await until(lambda: "/enable_motors" in networks.master.services)
        response = await networks.old.call("/sonar/enable", set_bool, b"\x01")
        assert response[:1] == b"\x01"
        assert switched == [True]
        response = await networks.old.call("/e_stop_reset", trigger, b"")
        assert response[:1] == b"\x00"
        assert b"nobody" in response
        with pytest.raises(ServiceError, match="nobody"):
            await networks.old.call(
                "/enable_motors", ROS1.service_definition("std_srvs/Empty"), b""
            )


@pytest.mark.parametrize("serves", [True, False])
async def test_services_of_a_robot_in_ros1_are_called_from_ros2(
    networks: Networks, serves: bool
) -> None:
    called: list[bytes] = []

    async def handle(request: bytes) -> bytes:
        called.append(request)
        return pack("<?I", True, 4) + b"done"

    networks.old.serve("/e_stop_trigger", ROS1.service_definition("std_srvs/Trigger"), handle)
    await until(lambda: "/e_stop_trigger" in networks.master.services)
    offered = services(Side.ROS1, "e_stop_trigger", "enable_motors")
    async with networks.bridge([], offered, robot=Side.ROS1, serves=serves):
        if serves:
            type_ = ROS2.service_type("std_srvs/Trigger")
            request = ROS2.encode(ROS2.make(type_.request.name))

            async def call(name: str) -> Any:
                cdr = await asyncio.to_thread(networks.new.call, name, type_, request, 5.0)
                return ROS2.decode(cdr, type_.response.name)

            response = await call("/e_stop_trigger")
            assert (response.success, response.message) == (True, "done")
            response = await call("/enable_motors")
            assert not response.success
            assert "cannot be called in ROS 1" in response.message
        else:
            empty = ROS2.encode(ROS2.make("std_msgs/Empty"))
            networks.writer("/e_stop_trigger", "std_msgs/Empty").write(empty)
            networks.writer("/enable_motors", "std_msgs/Empty").write(empty)
            await until(lambda: networks.tells("/enable_motors has FAILED"))
        await until(lambda: called == [b""])


async def test_a_node_that_is_shut_down_by_name_ends_its_bridge(networks: Networks) -> None:
    async with networks.bridge(rows(Side.ROS2, "cmd_vel")) as task:
        await networks.node("/bridge_2")
        from pioneer3.ros.tcpros.master import Api

        api = Api(networks.master.nodes["/bridge"], "/rosnode")
        await api.call("shutdown", "because")
        await asyncio.wait_for(task, 5)
