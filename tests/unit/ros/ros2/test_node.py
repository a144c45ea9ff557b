"""A node of ROS 2 over a network in this process: a simulated robot below it. Virtual time."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from math import isnan, nan
from threading import Thread
from typing import Any

import pytest

from pioneer3 import Robot, connect_async
from pioneer3.ros.messages.update import NANO
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.ros.ros2.arguments import parse
from pioneer3.ros.ros2.backend import LATCHED, EndpointKind, NodeName, Qos
from pioneer3.ros.ros2.distros import distro_of, distros
from pioneer3.ros.ros2.middleware import LONGEST, Ros2Middleware
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.tasks import running
from tests.support import SimulatedRobot
from tests.unit.ros.ros2.memory import MemoryBackend, MemoryEndpoint, MemoryNetwork

NODE = NodeName("pioneer3")
OTHER = NodeName("other")


@dataclass
class Running:
    """A node, its robot, and the network that it is on."""

    sim: SimulatedRobot
    robot: Robot
    types: MessageTypes
    network: MemoryNetwork
    warnings: list[str]
    now: Callable[[], int]
    peer: MemoryBackend = field(init=False)

    def __post_init__(self) -> None:
        self.peer = MemoryBackend(self.network, OTHER)

    def hear(self, name: str, type_name: str, qos: Qos | None = None) -> list[Any]:
        """Return the messages on a topic, which come from now on."""
        heard: list[Any] = []
        type_ = self.types.message_type(type_name)

        def received(cdr: bytes, gid: bytes) -> None:
            heard.append(self.types.decode(cdr, type_.name))

        self.peer.subscribe(name, type_, qos or Qos(), received, lambda gid: None)
        return heard

    def publisher(self, name: str, type_name: str) -> MemoryEndpoint:
        return self.peer.advertise(name, self.types.message_type(type_name), Qos())

    def drive(self, publisher: MemoryEndpoint, speed: float, age: float | None = None) -> None:
        """Send a Twist, or a TwistStamped of this age."""
        message = self.types.make(publisher.endpoint.type_name)
        twist = message
        if age is not None:
            twist, stamp = message.twist, message.header.stamp
            stamp.sec, stamp.nanosec = divmod(self.now() - round(age * NANO), NANO)
        twist.linear.x = speed
        publisher.write(self.types.encode(message))

    async def call(self, name: str, type_name: str, **fields: object) -> Any:
        type_ = self.types.service_type(type_name)
        request = self.types.make(type_.request.name)
        for key, value in fields.items():
            setattr(request, key, value)
        respond, cdr = self.network.servers[name], self.types.encode(request)
        responses: list[bytes] = []
        thread = Thread(target=lambda: responses.append(respond(cdr)))
        thread.start()
        while thread.is_alive():
            thread.join(0.001)
            await asyncio.sleep(0.001)
        return self.types.decode(responses[0], type_.response.name)


START = 1_700_000_000 * NANO


@asynccontextmanager
async def a_node(
    *words: str, node: NodeName = NODE, distro: str = "jazzy", serves: bool = True
) -> AsyncIterator[Running]:
    """Run a node with these arguments of ROS 2."""
    network, types, warnings = MemoryNetwork(), MessageTypes(distro_of(distro)), list[str]()
    arguments = parse(words, node)
    backend = MemoryBackend(network, node, serves=serves)
    middleware = Ros2Middleware(backend, node, types, arguments, warnings.append)
    clock = asyncio.get_running_loop().time

    def now() -> int:
        return START + round(clock() * NANO)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(asyncio, "to_thread", at_once)
        patch.setattr(middleware.clock, "now", now)
        async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
            ready = asyncio.Event()
            parameters = read_parameters(arguments.raw, Profile.ROS2)
            if parameters.enable_stamped_cmd_vel is None:
                stamped = types.distro.stamped_commands
                parameters = replace(parameters, enable_stamped_cmd_vel=stamped)
            the = RobotNode(robot, parameters, middleware)
            async with running(the.run(ready.set)):
                await ready.wait()
                yield Running(sim, robot, types, network, warnings, now)


async def at_once(function: Callable[..., Any], *arguments: Any) -> Any:
    """Stand in for `asyncio.to_thread`: virtual time does not wait for other threads."""
    return function(*arguments)


async def test_every_topic_has_the_type_and_the_qos_of_its_kind() -> None:
    async with a_node() as the:
        mine = {each.endpoint.name: each.endpoint for each in the.network.endpoints}
        assert mine["/odom"].type_name == "nav_msgs/msg/Odometry"
        assert mine["/odom"].qos == Qos()
        for name in ("/tf_static", "/robot_description", "/motors_state", "/emergency_stop"):
            assert mine[name].qos == LATCHED
        assert mine["/cmd_vel"].type_name == "geometry_msgs/msg/Twist"
        assert mine["/cmd_vel_stamped"].type_name == "geometry_msgs/msg/TwistStamped"
        assert mine["/bumper_state"].type_name == "std_msgs/msg/UInt8MultiArray"
        assert mine["/sonar/range_15"].type_name == "sensor_msgs/msg/Range"
        assert not any("~" in name or "move_base" in name for name in mine)


async def test_the_state_comes_ten_times_a_second() -> None:
    async with a_node() as the:
        odometry = the.hear("/odom", "nav_msgs/Odometry")
        trees = the.hear("/tf", "tf2_msgs/TFMessage")
        ranges = the.hear("/sonar/range_3", "sensor_msgs/Range")
        bumpers = the.hear("/bumper_state", "std_msgs/UInt8MultiArray")
        stopped = the.hear("/emergency_stop", "std_msgs/Bool")
        battery = the.hear("/battery_state", "sensor_msgs/BatteryState")
        await asyncio.sleep(2.0)
        for heard in (odometry, trees, bumpers, stopped):
            assert 19 <= len(heard) <= 21
        assert odometry[0].header.frame_id == "odom"
        assert odometry[0].child_frame_id == "base_footprint"
        assert odometry[0].pose.covariance[35] > 0
        children = {each.child_frame_id for each in trees[0].transforms}
        assert {"base_footprint", "front_left_wheel"} <= children | {"front_left_wheel"}
        assert ranges
        assert not any(isnan(each.range) for each in ranges)
        assert [each.size for each in bumpers[0].layout.dim] == [2, len(bumpers[0].data) // 2]
        assert isnan(battery[0].current)
        assert battery[0].power_supply_technology == 8


async def test_who_comes_late_gets_what_is_latched() -> None:
    async with a_node() as the:
        await asyncio.sleep(1.0)
        description = the.hear("/robot_description", "std_msgs/String", LATCHED)
        frames = the.hear("/tf_static", "tf2_msgs/TFMessage", LATCHED)
        assert description[0].data.startswith("<?xml")
        assert {"sonar_0", "laser"} <= {each.child_frame_id for each in frames[0].transforms}


@pytest.mark.parametrize("distro", distros())
async def test_both_types_of_commands_drive_in_every_distribution(distro: str) -> None:
    stamped = distro_of(distro).stamped_commands
    names = ("/cmd_vel_unstamped", "/cmd_vel") if stamped else ("/cmd_vel", "/cmd_vel_stamped")
    async with a_node(distro=distro) as the:
        for name, kind, age in zip(names, ("Twist", "TwistStamped"), (None, 0.0), strict=True):
            publisher = the.publisher(name, f"geometry_msgs/{kind}")
            for _ in range(20):
                the.drive(publisher, 0.2, age)
                await asyncio.sleep(0.1)
            assert the.sim.body.speeds[0] == pytest.approx(0.2, abs=0.01)
            await asyncio.sleep(2.0)
            assert the.sim.body.speeds[0] == 0.0


async def test_a_stale_command_does_not_drive() -> None:
    async with a_node() as the:
        publisher = the.publisher("/cmd_vel_stamped", "geometry_msgs/TwistStamped")
        for _ in range(10):
            the.drive(publisher, 0.3, age=1.0)
            await asyncio.sleep(0.1)
        assert the.sim.body.speeds[0] == 0.0
        assert any("its stamp is 1.0 s old" in each for each in the.warnings)
        message = the.types.make("geometry_msgs/TwistStamped")
        message.twist.linear.x = 0.3  # a stamp of 0 is now
        publisher.write(the.types.encode(message))
        await asyncio.sleep(0.4)
        assert the.sim.body.speeds[0] > 0.0


async def test_what_is_not_finite_or_no_message_is_refused() -> None:
    async with a_node() as the:
        publisher = the.publisher("/cmd_vel", "geometry_msgs/Twist")
        the.drive(publisher, nan)
        for garbage in (b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + b"x" * 90):
            publisher.write(garbage)
        await asyncio.sleep(0.5)
        assert the.sim.body.speeds[0] == 0.0
        assert any("cmd_vel is ignored" in each for each in the.warnings)
        assert sum("that are no geometry_msgs/msg/Twist" in each for each in the.warnings) == 1


def test_a_message_that_takes_long_to_read_is_refused() -> None:
    network, types = MemoryNetwork(), MessageTypes(distro_of("jazzy"))
    told: list[str] = []
    heard: list[int] = []
    kind = "std_msgs/UInt8MultiArray"
    middleware = Ros2Middleware(MemoryBackend(network, NODE), NODE, types, tell=told.append)
    middleware.subscribe("/x", kind, lambda message, _: heard.append(len(message.data)), queue=1)
    publisher = MemoryBackend(network, OTHER).advertise("/x", types.message_type(kind), Qos())
    message = types.make(kind)
    for size in (LONGEST, LONGEST - 100):
        message.data = bytes(size)
        publisher.write(types.encode(message))
    assert heard == [LONGEST - 100]
    assert [f"of {LONGEST} at most" in each for each in told] == [True]


async def test_a_publisher_that_leaves_stops_the_robot_at_once() -> None:
    async with a_node("-p", "cmd_vel_timeout:=0") as the:
        publisher = the.publisher("/cmd_vel", "geometry_msgs/Twist")
        the.drive(publisher, 0.3)
        await asyncio.sleep(2.0)
        assert the.sim.body.speeds[0] == pytest.approx(0.3, abs=0.01)
        bystander = the.publisher("/cmd_vel", "geometry_msgs/Twist")
        bystander.close()
        await asyncio.sleep(1.0)
        assert the.sim.body.speeds[0] == pytest.approx(0.3, abs=0.01)
        publisher.close()
        await asyncio.sleep(1.5)
        assert the.sim.body.speeds[0] == 0.0
        assert any("/other, which drove the robot by cmd_vel, is gone" in w for w in the.warnings)


async def test_a_publisher_of_the_wrong_type_is_named() -> None:
    async with a_node() as the:
        diagnostics = the.hear("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        the.publisher("/cmd_vel", "geometry_msgs/TwistStamped")
        await asyncio.sleep(3.0)
        (warning,) = [each for each in the.warnings if "/other" in each]
        assert "publisher /other on /cmd_vel sends geometry_msgs/msg/TwistStamped" in warning
        assert "publish on /cmd_vel_stamped instead" in warning
        topics = [each for each in diagnostics[-1].status if each.name.endswith("Topics")]
        assert topics[0].message == warning


async def test_services_respond() -> None:
    async with a_node() as the:
        response = await the.call("/enable_motors", "std_srvs/Trigger")
        assert (response.success, response.message) == (True, "the motors go on")
        assert (await the.call("/e_stop_trigger", "std_srvs/Trigger")).success
        refused = await the.call("/enable_motors", "std_srvs/Trigger")
        assert (refused.success, "latched" in refused.message) == (False, True)
        assert (await the.call("/e_stop_reset", "std_srvs/Trigger")).success
        assert (await the.call("/sonar/enable", "std_srvs/SetBool", data=False)).success


async def test_without_services_topics_of_their_names_do_the_same() -> None:
    async with a_node(serves=False) as the:
        assert the.network.servers == {}
        stop = the.publisher("/e_stop_trigger", "std_msgs/Empty")
        stop.write(the.types.encode(the.types.make("std_msgs/Empty")))
        await asyncio.sleep(0.5)
        assert the.robot.supervisor.pilot.emergency
        sonar = the.publisher("/sonar/enable", "std_msgs/Bool")
        sonar.write(the.types.encode(the.types.make("std_msgs/Bool")))
        await asyncio.sleep(1.0)
        assert the.robot.snapshot is not None
        assert not the.robot.snapshot.sonar.enabled


async def test_namespaces_and_remapping_move_everything() -> None:
    robot1 = NodeName("pioneer3", "/robot1")
    async with a_node("-r", "cmd_vel:=teleop/cmd_vel", node=robot1) as the:
        names = {each.endpoint.name for each in the.network.endpoints}
        assert {"/robot1/odom", "/robot1/tf", "/robot1/teleop/cmd_vel", "/diagnostics"} <= names
        assert "/robot1/cmd_vel" not in names


async def test_quality_of_service_can_be_overridden() -> None:
    name = "qos_overrides./odom.publisher.reliability"
    async with a_node("-p", f"{name}:=best_effort") as the:
        (odometry,) = [
            each.endpoint for each in the.network.endpoints if each.endpoint.name == "/odom"
        ]
        assert odometry.kind is EndpointKind.PUBLISHER
        assert not odometry.qos.reliable


async def test_warnings_are_on_rosout() -> None:
    async with a_node() as the:
        logs = the.hear("/rosout", "rcl_interfaces/Log")
        publisher = the.publisher("/cmd_vel", "geometry_msgs/Twist")
        the.drive(publisher, nan)
        await asyncio.sleep(0.2)
        assert (logs[0].name, logs[0].level) == ("pioneer3", 30)
        assert "cmd_vel is ignored" in logs[0].msg


async def test_parameters_are_described_and_those_of_driving_can_be_set() -> None:
    async with a_node("-p", "max_linear_acceleration:=0.5") as the:
        await asyncio.sleep(0.1)
        assert the.robot.info.limits.acceleration == 0.5
        names = (
            await the.call("/pioneer3/list_parameters", "rcl_interfaces/ListParameters")
        ).result
        assert {"port", "sonar_no_echo", "max_linear_acceleration"} <= set(names.names)
        value = the.types.make("rcl_interfaces/ParameterValue")
        value.type, value.double_value = 3, 0.2
        parameter = the.types.make("rcl_interfaces/Parameter")
        parameter.name, parameter.value = "max_linear_acceleration", value
        response = await the.call(
            "/pioneer3/set_parameters", "rcl_interfaces/SetParameters", parameters=[parameter]
        )
        assert response.results[0].successful, response.results[0].reason
        await asyncio.sleep(0.1)
        assert the.robot.info.limits.acceleration == 0.2
        parameter.name = "sonar_fov_rad"
        response = await the.call(
            "/pioneer3/set_parameters", "rcl_interfaces/SetParameters", parameters=[parameter]
        )
        assert not response.results[0].successful


def test_simulated_time_comes_from_publishers_of_the_clock_that_are_best_effort() -> None:
    network, types = MemoryNetwork(), MessageTypes(distro_of("jazzy"))
    middleware = Ros2Middleware(MemoryBackend(network, NODE), NODE, types)
    middleware.use_sim_time()
    player = MemoryBackend(network, OTHER)
    type_ = types.message_type("rosgraph_msgs/Clock")
    clock = player.advertise("/clock", type_, Qos(reliable=False, depth=1))
    message = types.make("rosgraph_msgs/Clock")
    message.clock.sec = 123
    clock.write(types.encode(message))
    assert middleware.clock.now() == 123 * NANO


def test_one_topic_may_be_published_and_subscribed() -> None:
    network, types = MemoryNetwork(), MessageTypes(distro_of("jazzy"))
    middleware = Ros2Middleware(MemoryBackend(network, NODE), NODE, types)
    middleware.subscribe("goal", "std_msgs/Empty", lambda message, sender: None, queue=1)
    middleware.advertise("goal", "std_msgs/Empty")
    peer, empty = MemoryBackend(network, OTHER), types.message_type("std_msgs/Empty")
    peer.advertise("/goal", empty, Qos(reliable=False))
    (told,) = middleware.mismatches()
    assert "publisher /other on /goal" in told
