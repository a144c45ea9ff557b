"""The robot's node as a process of its own, on real networks of both kinds."""

import asyncio
import signal
from functools import partial
from math import nan

import pytest

from pioneer3.models import load_model
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.topic import Direction
from pioneer3.ros.node.topics import topics_of
from pioneer3.ros.ros2.backend import LATCHED, EndpointKind, Qos
from pioneer3.ros.ros2.network import BackendName
from pioneer3.ros.typestore import full_name
from tests.e2e.processes import until
from tests.ros2.conftest import robot_on
from tests.ros2.networks import Peer, Ros2

pytestmark = [pytest.mark.realtime]
PERIOD = 0.05
SILENT = ("/imu/data_raw", "/compass", "/camera/image_raw", "/camera/camera_info")
"""Topics of devices that this robot does not have."""


async def drive(peer: Peer, speed: float, seconds: float, name: str = "/cmd_vel") -> None:
    """Send a command 20 times a second, then close the publisher."""
    publisher = peer.publisher(name, "geometry_msgs/Twist")
    await until(lambda: publisher.matched)
    for _ in range(round(seconds / PERIOD)):
        publisher.write(peer.twist(speed))
        await asyncio.sleep(PERIOD)
    publisher.close()


async def test_every_topic_of_the_table_comes_with_its_type_and_qos(ros2: Ros2) -> None:
    async with robot_on(ros2), ros2.peer() as peer:
        table = [
            (f"/{name.lstrip('/')}", topic)
            for topic in topics_of(load_model("p3at-sh"))
            for name in topic.names(Profile.ROS2)
        ]
        heard = {}
        for name, topic in table:
            kind = (
                EndpointKind.PUBLISHER
                if topic.direction is Direction.PUBLISHED
                else EndpointKind.SUBSCRIBER
            )
            if name in SILENT:
                continue
            await until(partial(peer.knows, name, kind, "/pioneer3"))
            found = peer.endpoint(name, kind)
            assert found is not None
            assert found.type_name == full_name(topic.type_name)
            assert found.type_hash == peer.types.message_type(topic.type_name).hash
            assert found.qos.transient_local is topic.latched
            if kind is EndpointKind.PUBLISHER:
                heard[name] = peer.hear(name, topic.type_name, LATCHED if topic.latched else None)
        for messages in heard.values():
            await until(partial(len, messages))


async def test_commands_drive_and_silence_stops(ros2: Ros2) -> None:
    async with robot_on(ros2) as robot, ros2.peer() as peer:
        odometry = peer.hear("/odom", "nav_msgs/Odometry")
        await drive(peer, 0.3, 1.0)
        await until(lambda: robot.tap.now.is_zero)
        assert any(message.twist.twist.linear.x > 0.2 for _, message in odometry)
        assert odometry[-1][1].pose.pose.position.x > 0.1


async def test_what_is_not_finite_does_not_drive(ros2: Ros2) -> None:
    async with robot_on(ros2) as robot, ros2.peer() as peer:
        logs = peer.hear("/rosout", "rcl_interfaces/Log")
        await drive(peer, nan, 0.5)
        await until(lambda: any("cmd_vel is ignored" in message.msg for _, message in logs))
        assert all(twist.is_zero for _, twist in robot.tap.velocities)


async def test_a_killed_publisher_stops_the_robot(ros2: Ros2) -> None:
    async with robot_on(ros2, "--ros-args", "-p", "cmd_vel_timeout:=0") as robot:
        async with ros2.peer() as peer:
            publisher = peer.publisher("/cmd_vel", "geometry_msgs/Twist")
            await until(lambda: publisher.matched)
            publisher.write(peer.twist(0.3))
            await until(lambda: not robot.tap.now.is_zero)
        await until(lambda: robot.tap.now.is_zero)


async def test_another_type_on_cmd_vel_is_named(ros2: Ros2) -> None:
    async with robot_on(ros2), ros2.peer() as peer:
        diagnostics = peer.hear("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        peer.publisher("/cmd_vel", "geometry_msgs/TwistStamped")

        def named() -> bool:
            return any(
                status.name.endswith("Topics") and "/peer" in status.message
                for _, message in diagnostics
                for status in message.status
            )

        await until(named)


async def test_a_lost_robot_is_told_and_nothing_stale_is_published(ros2: Ros2) -> None:
    async with robot_on(ros2) as robot, ros2.peer() as peer:
        odometry = peer.hear("/odom", "nav_msgs/Odometry")
        stopped = peer.hear("/emergency_stop", "std_msgs/Bool", LATCHED)
        diagnostics = peer.hear("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        await until(lambda: odometry and stopped)
        robot.simulator.process.send_signal(signal.SIGSTOP)
        await until(lambda: stopped[-1][1].data)
        count = len(odometry)

        def lost() -> bool:
            return any("Link" in s.name and s.level == 2 for s in diagnostics[-1][1].status)

        await until(lost)
        assert len(odometry) == count
        robot.simulator.process.send_signal(signal.SIGCONT)
        await until(lambda: len(odometry) > count + 10)
        assert not stopped[-1][1].data


async def test_the_end_of_the_node_stops_the_robot_and_leaves_the_graph(ros2: Ros2) -> None:
    forever = ("--ros-args", "-p", "cmd_vel_timeout:=0")
    async with robot_on(ros2, *forever) as robot, ros2.peer() as peer:
        publisher = peer.publisher("/cmd_vel", "geometry_msgs/Twist")
        await until(lambda: publisher.matched)
        publisher.write(peer.twist(0.3))
        await until(lambda: not robot.tap.now.is_zero)
        code, _ = await robot.node.end(signal.SIGINT)
        assert code == 130
        assert robot.tap.now.is_zero
        await until(lambda: "/pioneer3" not in peer.backend.graph().nodes)


async def test_two_robots_in_namespaces_do_not_hear_each_other(ros2: Ros2) -> None:
    async with (
        robot_on(ros2, "--namespace", "robot1") as one,
        robot_on(ros2, "--namespace", "robot2", "--ros-args", "-p", "frame_prefix:=robot2/") as two,
        ros2.peer() as peer,
    ):
        own = peer.hear("/robot1/tf", "tf2_msgs/TFMessage")
        shared = peer.hear("/tf", "tf2_msgs/TFMessage")
        await until(lambda: own and shared)
        assert own[0][1].transforms[0].header.frame_id == "odom"
        assert shared[0][1].transforms[0].header.frame_id == "robot2/odom"
        await drive(peer, 0.2, 1.0, "/robot1/cmd_vel")
        assert any(not twist.is_zero for _, twist in one.tap.velocities)
        assert all(twist.is_zero for _, twist in two.tap.velocities)


async def test_services_respond_where_they_can_be_called(ros2: Ros2) -> None:
    async with robot_on(ros2) as robot, ros2.peer() as peer:
        if ros2.network.backend is BackendName.ZENOH:
            await until(lambda: peer.endpoint("/e_stop_trigger", EndpointKind.SERVER))
            response = await peer.call("/e_stop_trigger", "std_srvs/Trigger")
            assert response.success
        else:
            assert not any(e.kind is EndpointKind.SERVER for e in peer.backend.graph().endpoints)
            publisher = peer.publisher("/e_stop_trigger", "std_msgs/Empty")
            await until(lambda: publisher.matched)
            publisher.write(peer.types.encode(peer.types.make("std_msgs/Empty")))
        stopped = peer.hear("/emergency_stop", "std_msgs/Bool", LATCHED)
        await until(lambda: stopped and stopped[-1][1].data)
        await drive(peer, 0.3, 0.5)
        assert all(twist.is_zero for _, twist in robot.tap.velocities)


async def test_a_best_effort_publisher_of_commands_is_named_over_dds(ros2: Ros2) -> None:
    if ros2.network.backend is not BackendName.DDS:
        pytest.skip("in Zenoh no quality of service keeps endpoints apart")
    async with robot_on(ros2), ros2.peer() as peer:
        logs = peer.hear("/rosout", "rcl_interfaces/Log")
        peer.publisher("/cmd_vel", "geometry_msgs/Twist", Qos(reliable=False))
        await until(lambda: any("best effort" in message.msg for _, message in logs))


async def test_a_node_of_the_same_name_is_told_of(ros2: Ros2) -> None:
    async with robot_on(ros2) as robot, ros2.peer("pioneer3") as twin:
        logs = twin.hear("/rosout", "rcl_interfaces/Log")
        assert robot.node.process.returncode is None
        await until(lambda: any("2 nodes are called /pioneer3" in log.msg for _, log in logs))


async def test_a_goal_by_name_is_taken(ros2: Ros2) -> None:
    pytest.importorskip("scipy")
    async with robot_on(ros2, "--map", "office", world=()), ros2.peer() as peer:
        place = peer.types.make("std_msgs/String")
        place.data = "Kitchen"
        goals = peer.hear("/current_goal", "geometry_msgs/PoseStamped", LATCHED)
        publisher = peer.publisher("/goal_name", "std_msgs/String")
        await until(lambda: publisher.matched)
        publisher.write(peer.types.encode(place))
        await until(lambda: goals)
