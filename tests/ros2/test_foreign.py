"""The node beside a program with rclpy: by DDS, and by rclpy itself, in Jazzy and Kilted."""

import asyncio
import signal
import struct
import time
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio

from pioneer3.models import load_model
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.services import NAVIGATION_SERVICES, SERVICES, SET_BOOL, Service
from pioneer3.ros.node.topic import Direction
from pioneer3.ros.node.topics import COMMANDS, STAMPED_COMMANDS, topics_of
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.lifecycle import LifecycleState
from pioneer3.ros.ros2.network import BackendName
from pioneer3.ros.ros2.types import MessageTypes
from pioneer3.ros.typestore import full_name
from tests.e2e.processes import until
from tests.ros2.conftest import robot_on
from tests.ros2.dds_network import CMD_VEL, TWIST, Program, program_on
from tests.ros2.foreign import foreign
from tests.ros2.networks import network_of
from tests.ros2.rclpy_network import ForeignLab, foreign_lab, rclpy_peer
from tests.ros2.test_node import SILENT

pytestmark = [pytest.mark.realtime]
BY_DDS = [(BackendName.DDS, "jazzy"), (BackendName.DDS, "kilted")]
BY_RCLPY = [(BackendName.RCLPY, "jazzy"), (BackendName.RCLPY, "kilted")]
TF = ("/tf", "/tf_static")
"""The wheels have no tf2_msgs: the node publishes these by DDS only."""
LATCHED: dict[str, Any] = {"latched": True, "depth": 1}
NODE = "/pioneer3"
NOBODY = "/".join(["_CREATED_BY_BARE_DDS_APP_"] * 2)
"""Fast DDS 3 does not know the node of an endpoint of Cyclone DDS, though it knows both."""
FORGOTTEN = 35.0
"""Cyclone DDS would announce itself to addresses of nobody for 30 s only [s]."""
LOOPBACK = """<profiles xmlns="http://www.eprosima.com"><transport_descriptors><transport_descriptor>
<transport_id>lo</transport_id><type>UDPv4</type>
<interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>
</transport_descriptor></transport_descriptors>
<participant profile_name="lo" is_default_profile="true"><rtps>
<useBuiltinTransports>false</useBuiltinTransports>
<userTransports><transport_id>lo</transport_id></userTransports></rtps></participant></profiles>"""


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


by_rclpy = pytest.mark.parametrize("lab", BY_RCLPY, indirect=True, ids=["jazzy", "kilted"])
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
    owner = NODE if lab.serves or lab.ros.distro == "jazzy" else NOBODY
    graph = await lab.peer.graph_when(
        lambda graph: (
            NODE in graph.nodes
            and all([e["node"] for e in graph.on(name)] == [owner] for name in wanted)
        )
    )
    for name in wanted:
        topic, (found,) = table[name], graph.on(name)
        assert found["kind"] == full_name(topic.type_name)
        assert found["hash"] == types.message_type(topic.type_name).hash
        assert found["reads"] is (topic.direction is Direction.SUBSCRIBED)
        assert (found["reliable"], found["latched"]) == (True, topic.latched)
    (commands,) = graph.on("/cmd_vel")
    stamped = "Stamped" * distro_of(lab.ros.distro).stamped_commands
    assert commands["kind"] == f"geometry_msgs/msg/Twist{stamped}"
    assert len(graph.on("/parameter_events")) == lab.serves
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
    lab.peer.publish(*other_commands(lab.ros.distro))
    await until(lambda: lab.robot.tap.now.v > 0.2)
    lab.peer.leave(other_commands(lab.ros.distro)[0])
    await until(lambda: lab.robot.tap.now.is_zero)
    await until(lambda: odometry[-1]["twist"]["twist"]["linear"]["x"] == 0)
    assert odometry[-1]["header"]["frame_id"] == "odom"
    assert odometry[-1]["child_frame_id"] == "base_footprint"
    stamps = [seconds(message["header"]["stamp"]) for message in odometry]
    assert stamps == sorted(set(stamps))
    assert began < stamps[-1] < time.time()
    lab.peer.leave("/odom")


def other_commands(distro: str) -> tuple[str, str, object]:
    """Return topic, type and content of a command in the type that `cmd_vel` does not have."""
    twist = {"linear": {"x": 0.3}}
    if distro_of(distro).stamped_commands:
        return "/cmd_vel_unstamped", "geometry_msgs/Twist", twist
    return "/cmd_vel_stamped", "geometry_msgs/TwistStamped", {"twist": twist}


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
    logs = lab.peer.hear("/rosout", "rcl_interfaces/Log", latched=True, depth=100)  # said once
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
    stopped = lab.peer.hear("/emergency_stop", "std_msgs/Bool", **LATCHED)
    await until(lambda: stopped)
    for service in (*SERVICES, SERVICES[0]):  # in the end the motors may be switched on again
        await use(service, lab)
        if service.standard == "e_stop_trigger":
            await until(lambda: stopped[-1]["data"])
    await until(lambda: not stopped[-1]["data"])
    lab.peer.leave("/emergency_stop")


async def use(service: Service, lab: ForeignLab) -> None:
    """Call a service, or have the topic of its name do the work; there is never both."""
    (name,) = service.names(Profile.ROS2)
    type_name = service.type_in(Profile.ROS2)
    fields = {"data": True} if service.type_name == SET_BOOL else {}
    if lab.serves:
        response = await lab.peer.call(f"/{name}", type_name, **fields)
        assert any(response.get(key) for key in ("message", "map", "plan"))
        types = (await lab.peer.graph()).services[f"/{name}"]
        assert types == [full_name(type_name, "srv")]
        return
    assert f"/{name}" not in (await lab.peer.graph()).services
    if service.topic_type is None:
        return
    logs = lab.peer.hear("/rosout", "rcl_interfaces/Log")
    lab.peer.publish(f"/{name}", service.topic_type, fields, 5.0)
    await until(lambda: any(log["msg"].startswith(name) for log in logs))
    lab.peer.leave(f"/{name}", "/rosout")


def seconds(stamp: dict[str, int]) -> float:
    return stamp["sec"] + stamp["nanosec"] / 1e9


@by_rclpy
@shared
async def test_parameters_are_seen_described_and_set(lab: ForeignLab) -> None:
    async def call(name: str, **fields: Any) -> Any:
        kind = "".join(word.title() for word in name.split("_"))
        return await lab.peer.call(f"{NODE}/{name}", f"rcl_interfaces/{kind}", **fields)

    names = (await call("list_parameters"))["result"]["names"]
    assert {"max_linear_acceleration", "cmd_vel_timeout"} <= set(names)
    unset = {"names": ["drift_factor", "max_linear_velocity"]}
    assert [each["type"] for each in (await call("get_parameters", **unset))["values"]] == [0, 0]
    drift, velocity = (await call("describe_parameters", **unset))["descriptors"]
    assert drift["dynamic_typing"]
    assert drift["integer_range"][0]["to_value"] == 32767
    assert velocity["floating_point_range"]
    laser: dict[str, Any] = {"names": ["laser.time_offset", "laser.skip"]}
    offset, skip = (await call("describe_parameters", **laser))["descriptors"]
    assert offset["floating_point_range"][0]["to_value"] == 0.25
    assert (skip["integer_range"][0]["to_value"], skip["read_only"]) == (9, True)
    asked: dict[str, Any] = {"names": ["max_linear_acceleration", "cmd_vel_timeout"]}
    highest, timeout = (await call("describe_parameters", **asked))["descriptors"]
    assert (highest["type"], timeout["read_only"]) == (3, True)
    (range_,) = highest["floating_point_range"]
    value, _ = (await call("get_parameters", **asked))["values"]
    wanted = value["double_value"] / 2
    events = lab.peer.hear("/parameter_events", "rcl_interfaces/ParameterEvent")
    for new, accepted in ((range_["to_value"] * 2, False), (wanted, True)):
        parameter = {"name": "max_linear_acceleration", "value": {"type": 3, "double_value": new}}
        (result,) = (await call("set_parameters", parameters=[parameter]))["results"]
        assert result["successful"] is accepted
        assert bool(result["reason"]) is not accepted
    value, _ = (await call("get_parameters", **asked))["values"]
    assert value["double_value"] == wanted
    await until(lambda: any(event["node"] == NODE for event in events))
    lab.peer.leave("/parameter_events")


@by_rclpy
@shared
async def test_a_manager_changes_the_life_cycle(lab: ForeignLab) -> None:
    async def change(label: str) -> bool:
        response = await lab.peer.call(
            f"{NODE}/change_state", "lifecycle_msgs/ChangeState", transition={"label": label}
        )
        return bool(response["success"])

    async def state() -> LifecycleState:
        response = await lab.peer.call(f"{NODE}/get_state", "lifecycle_msgs/GetState")
        return LifecycleState(response["current_state"]["id"])

    odometry = lab.peer.hear("/odom", "nav_msgs/Odometry")
    lab.drive(lab.peer)
    await until(lambda: lab.robot.tap.now.v > 0.2 and odometry)
    assert await state() is LifecycleState.ACTIVE
    assert not await change("configure")
    assert await change("deactivate")
    assert lab.robot.tap.now.is_zero
    assert await state() is LifecycleState.INACTIVE
    assert await change("cleanup")
    await lab.peer.graph_when(lambda graph: not graph.on("/odom") or graph.on("/odom")[0]["reads"])
    assert await change("configure")
    count = len(odometry)
    assert await change("activate")
    await until(lambda: lab.robot.tap.now.v > 0.2 and len(odometry) > count)
    lab.peer.leave("/cmd_vel", "/odom")
    await until(lambda: lab.robot.tap.now.is_zero)


BY_EACH = pytest.mark.parametrize(("backend", "distro"), [BY_DDS[1], BY_RCLPY[0]], ids=str)


@BY_EACH
async def test_simulated_time_comes_from_the_clock_and_the_end_stops_the_robot(
    backend: BackendName, distro: str
) -> None:
    arguments = ("--ros-args", "-p", "use_sim_time:=true", "-p", "cmd_vel_timeout:=0")
    async with foreign_lab(backend, distro, *arguments) as lab:
        lab.peer.publish("/clock", "rosgraph_msgs/Clock", {"clock": {"sec": 1234}})
        odometry = lab.peer.hear("/odom", "nav_msgs/Odometry")
        await until(lambda: odometry and odometry[-1]["header"]["stamp"]["sec"] in {1233, 1234})
        lab.drive(lab.peer)
        await until(lambda: lab.robot.tap.now.v > 0.2)
        code, said = await lab.robot.node.end(signal.SIGINT)
        assert code == 130, said
        assert lab.robot.tap.now.is_zero
        await lab.peer.graph_when(lambda graph: NODE not in graph.nodes)


@BY_EACH
async def test_a_start_and_goals_by_pose_and_by_name_are_taken(
    backend: BackendName, distro: str
) -> None:
    async with foreign_lab(backend, distro, "--map", "office", world=()) as lab:
        places = lab.peer.hear("/amcl_pose", "geometry_msgs/PoseWithCovarianceStamped", **LATCHED)
        goals = lab.peer.hear("/current_goal", "geometry_msgs/PoseStamped", **LATCHED)
        await until(lambda: places)
        there = places[-1]["pose"]["pose"]
        placed = {"header": {"frame_id": "map"}, "pose": {"pose": there}}
        count = len(places)
        lab.peer.publish("/initialpose", "geometry_msgs/PoseWithCovarianceStamped", placed)
        await until(lambda: len(places) > count)
        lab.peer.leave("/initialpose")
        for topic, type_name, goal in (
            ("/goal_name", "std_msgs/String", {"data": "Kitchen"}),
            ("/goal_pose", "geometry_msgs/PoseStamped", {**placed, "pose": there}),
        ):
            count = len(goals)
            lab.peer.publish(topic, type_name, goal, 1.0)
            await until(lambda: len(goals) > count)  # noqa: B023
            lab.peer.leave(topic)
            if topic == "/goal_name":
                await until(lambda: lab.robot.tap.now.v > 0.1)
        for service in NAVIGATION_SERVICES:
            await use(service, lab)


def with_no_text_as_name(program: Program) -> str:
    """Return a message of the graph: the program is a node whose name is no UTF-8 [hex]."""
    guid, writer = bytes.fromhex(program.guid), bytes.fromhex(program.guids[CMD_VEL])
    one, none = struct.pack("<I", 1), struct.pack("<I", 0)
    names = struct.pack("<I", 2) + b"/\0\0\0" + struct.pack("<I", 3) + b"\xff\xfe\0\0"
    return (b"\0\1\0\0" + guid + one + names + none + one + writer).hex()


@pytest.mark.parametrize("distro", ["jazzy"])
async def test_a_name_that_is_no_text_hides_nobody_from_the_robot_and_is_told_once(
    distro: str,
) -> None:
    """The program is on DDS, for no program with rclpy has such a name."""
    info = "rmw_dds_common/msg/ParticipantEntitiesInfo"
    async with foreign_lab(BackendName.RCLPY, distro) as lab, program_on(lab.network) as program:
        await program.writer("ros_discovery_info", info, latched=True, depth=1)
        await program.writer(CMD_VEL, TWIST)
        cdr = with_no_text_as_name(program)
        program.do("send_raw", key="ros_discovery_info", cdr=cdr)
        slow = {"linear": {"x": 0.2}}
        for again in (True, False):  # each new sender is looked for
            await program.send_until(lambda: lab.robot.tap.now.v > 0.1, fields=slow)
            await program.close(CMD_VEL)
            await until(lambda: lab.robot.tap.now.is_zero)
            if again:
                await program.writer(CMD_VEL, TWIST)
        _, errors = await lab.robot.node.end(signal.SIGINT)
    assert errors.count("cannot be read") == 1
    assert "names of other nodes or topics could not be read" in errors  # there were more
    assert "Traceback" not in errors


@pytest.mark.thorough
@pytest.mark.parametrize("distro", ["jazzy", "kilted"])
async def test_a_program_that_starts_late_and_asks_nobody_finds_the_node(
    distro: str, tmp_path: Path
) -> None:
    """As on a computer whose loopback has no multicast; it is kept on loopback."""
    profiles = tmp_path / "profiles.xml"
    profiles.write_text(LOOPBACK)
    alone = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
    alone |= {f"{fast}_DEFAULT_PROFILES_FILE": str(profiles) for fast in ("FASTDDS", "FASTRTPS")}
    ros = foreign(distro)
    async with network_of(BackendName.DDS) as network, robot_on(network, "--distro", distro):
        await asyncio.sleep(FORGOTTEN)
        async with rclpy_peer(ros, network, **alone) as late:
            odometry = late.hear("/odom", "nav_msgs/Odometry")
            await until(lambda: odometry)
