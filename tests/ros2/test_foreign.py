"""The node beside a program with rclpy: by DDS, and by rclpy itself, on real ROS 2 Jazzy and Kilted."""

import asyncio
import signal
import time
from collections.abc import AsyncIterator
from typing import Any

import pytest
import pytest_asyncio

from pioneer3.models import load_model
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.services import SERVICES
from pioneer3.ros.node.topic import Direction
from pioneer3.ros.node.topics import COMMANDS, STAMPED_COMMANDS, topics_of
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.lifecycle import State
from pioneer3.ros.ros2.network import BackendName
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.typestore import full_name
from tests.e2e.processes import until
from tests.ros2.rclpy_network import ForeignLab, Graph, RclpyPeer, foreign_lab, rclpy_peer
from tests.ros2.test_node import SILENT

pytestmark = [pytest.mark.realtime]
BY_DDS = [(BackendName.DDS, "jazzy"), (BackendName.DDS, "kilted")]
BY_RCLPY = [(BackendName.RCLPY, "jazzy"), (BackendName.RCLPY, "kilted")]
TF = ("/tf", "/tf_static")
"""The wheels have no tf2_msgs: the node publishes these by DDS only."""
LATCHED: dict[str, Any] = {"latched": True, "depth": 1}
FORGOTTEN = 35.0
"""Cyclone DDS would announce itself to addresses of nobody for 30 s only [s]."""


@pytest_asyncio.fixture(
    scope="module",
    loop_scope="module",
    params=[*BY_DDS, *BY_RCLPY],
    ids=lambda param: "-".join(reversed(param)),
)
async def lab(request: pytest.FixtureRequest) -> AsyncIterator[ForeignLab]:
    """Run a robot, its node and the program for all tests, which leave the robot standing."""
    async with foreign_lab(*request.param) as made:
        yield made


by_rclpy = pytest.mark.parametrize("lab", BY_RCLPY, indirect=True)
shared = pytest.mark.asyncio(loop_scope="module")


@shared
async def test_the_graph_has_the_node_and_its_topics_with_types_and_hashes(lab: ForeignLab) -> None:
    types = MessageTypes(distro_of(lab.ros.distro))
    table = {
        f"/{name.lstrip('/')}": topic
        for topic in topics_of(load_model("p3at-sh"))
        if topic not in (COMMANDS, STAMPED_COMMANDS)
        for name in topic.names(Profile.ROS2)
    }
    wanted = table.keys() - set(SILENT) - set(TF if lab.serves else ())
    graph = await lab.peer.graph_when(lambda graph: all(map(graph.of, wanted)))
    assert "/pioneer3" in graph.nodes
    for name in wanted:
        topic, (found,) = table[name], graph.of(name)
        assert found["kind"] == full_name(topic.type_name)
        assert found["hash"] == types.message_type(topic.type_name).hash
        assert found["reads"] is (topic.direction is Direction.SUBSCRIBED)
        assert (found["reliable"], found["latched"]) == (True, topic.latched)
    (commands,) = graph.of("/cmd_vel")
    stamped = "Stamped" * distro_of(lab.ros.distro).stamped_commands
    assert commands["kind"] == f"geometry_msgs/msg/Twist{stamped}"
    assert len(graph.of("/parameter_events")) == lab.serves
    assert any("tf2_msgs" in said for said in lab.robot.said) is lab.serves


@shared
async def test_commands_drive_and_silence_stops(lab: ForeignLab) -> None:
    odometry = lab.peer.hear("/odom", "nav_msgs/Odometry")
    await until(lambda: odometry)
    began = time.time()
    lab.drive(lab.peer)
    here = odometry[-1]["pose"]["pose"]["position"]["x"]
    await until(lambda: odometry[-1]["pose"]["pose"]["position"]["x"] > here + 0.1)
    await until(lambda: odometry[-1]["twist"]["twist"]["linear"]["x"] > 0.2)
    lab.peer.leave("/cmd_vel")
    await until(lambda: lab.robot.tap.now.is_zero)
    await until(lambda: odometry[-1]["twist"]["twist"]["linear"]["x"] == 0)
    assert odometry[-1]["header"]["frame_id"] == "odom"
    assert odometry[-1]["child_frame_id"] == "base_link"
    stamps = [seconds(message["header"]["stamp"]) for message in odometry]
    assert stamps == sorted(set(stamps))
    assert began < stamps[-1] < time.time()
    lab.peer.leave("/odom")


@shared
async def test_a_killed_program_leaves_a_robot_that_stands_and_may_come_back(
    lab: ForeignLab,
) -> None:
    for _ in range(2):
        async with rclpy_peer(lab.ros, lab.network) as peer:
            lab.drive(peer)
            await until(lambda: lab.robot.tap.now.v > 0.2)
            await peer.kill()
            await until(lambda: lab.robot.tap.now.is_zero)


@shared
async def test_a_late_subscriber_gets_what_is_latched(lab: ForeignLab) -> None:
    described = lab.peer.hear("/robot_description", "std_msgs/String", **LATCHED)
    motors = lab.peer.hear("/motors_state", "std_msgs/Bool", **LATCHED)
    stopped = lab.peer.hear("/emergency_stop", "std_msgs/Bool", **LATCHED)
    await until(lambda: described and motors and stopped)
    assert described[0]["data"].rstrip().endswith("</robot>")
    assert not stopped[0]["data"]
    lab.peer.leave("/robot_description", "/motors_state", "/emergency_stop")


@shared
async def test_quality_of_service_that_does_not_match_is_told_on_both_sides(
    lab: ForeignLab,
) -> None:
    logs = lab.peer.hear("/rosout", "rcl_interfaces/Log")
    lossy = lab.peer.hear("/joint_states", "sensor_msgs/JointState", reliable=False)
    lab.peer.hear("/odom", "nav_msgs/Odometry", **LATCHED)
    lab.drive(lab.peer, reliable=False)
    await until(lambda: any("best effort" in log["msg"] for log in logs))
    await until(lambda: {topic for topic, _ in lab.peer.mismatches} == {"/odom", "/cmd_vel"})
    await until(lambda: lossy)
    assert not lab.peer.heard["/odom"]
    assert lab.robot.tap.now.is_zero
    lab.peer.leave("/rosout", "/joint_states", "/odom", "/cmd_vel")


@shared
async def test_every_service_does_its_work_or_a_topic_of_its_name(lab: ForeignLab) -> None:
    logs = lab.peer.hear("/rosout", "rcl_interfaces/Log")
    stopped = lab.peer.hear("/emergency_stop", "std_msgs/Bool", **LATCHED)
    offered = [name for service in SERVICES for name in service.names(Profile.ROS2)]
    graph = await lab.peer.graph_when(
        lambda graph: graph.of("/emergency_stop") and logs is not None
    )
    if lab.serves:
        graph = await lab.peer.graph_when(lambda g: {f"/{n}" for n in offered} <= g.services.keys())
    assert {f"/{name}" for name in offered} <= graph.services.keys() or not lab.serves
    for service in (*SERVICES, SERVICES[0]):  # in the end the motors may be switched on again
        (name,) = service.names(Profile.ROS2)
        type_name = service.type_in(Profile.ROS2)
        fields = {"data": True} if type_name.endswith("SetBool") else {}
        if lab.serves:
            assert graph.services[f"/{name}"] == [full_name(type_name, "srv")]
            assert (await lab.peer.call(f"/{name}", type_name, **fields))["message"]
        else:
            assert f"/{name}" not in graph.services
            assert service.topic_type is not None
            said = len(logs)
            lab.peer.publish(f"/{name}", service.topic_type, 5.0, **fields)
            await until(lambda: any(log["msg"].startswith(name) for log in logs[said:]))  # noqa: B023
            lab.peer.leave(f"/{name}")
        if name == "e_stop_trigger":
            await until(lambda: stopped and stopped[-1]["data"])
    await until(lambda: not stopped[-1]["data"])
    lab.peer.leave("/rosout", "/emergency_stop")


def seconds(stamp: dict[str, int]) -> float:
    return stamp["sec"] + stamp["nanosec"] / 1e9
