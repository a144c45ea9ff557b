"""A bridge between a real ROS 1 and real networks of ROS 2, as a process of its own."""

import asyncio
import json
import os
import signal
import subprocess
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
import pytest_asyncio

from pioneer3.ros.ros2.backend import LATCHED
from pioneer3.ros.ros2.network import BackendName, Network
from tests.e2e.processes import PATIENCE, Command, environment, free_port, running, until
from tests.ros1.conftest import laboratory
from tests.ros1.master import environment_of, ros, roscore, script
from tests.ros1.test_failures import processes_of
from tests.ros2.conftest import robot_on
from tests.ros2.networks import Ros2, network_of

pytestmark = [pytest.mark.realtime]
PUB = ("rostopic", "pub", "-r", "10", "/RosAria/cmd_vel", "geometry_msgs/Twist")
AHEAD = "{linear: {x: 0.2}}"
STANDS = 1.5
"""Bar for a robot whose commands have ended [s]; most of it is for a busy machine."""


@pytest_asyncio.fixture(params=[BackendName.DDS, BackendName.ZENOH])
async def ros2(request: pytest.FixtureRequest, ros1: None) -> AsyncIterator[Ros2]:
    """Return a network of each kind, beside the master."""
    async with network_of(request.param) as network:
        yield network


@asynccontextmanager
async def bridge_on(network: Ros2, *arguments: str) -> AsyncIterator[Command]:
    """Run a bridge; the block begins when it is ready."""
    async with running("ros2", "bridge", *network.options, *arguments) as command:
        await says(command, "ready")
        try:
            yield command
        finally:
            if command.process.returncode is None:
                await command.end(signal.SIGINT)


async def says(command: Command, words: str) -> str:
    """Return the next line of a command with these words."""
    said = []
    while words not in (line := await command.line()):
        said.append(line)
        assert line or command.process.returncode is None, "\n".join(said)
    return line


@asynccontextmanager
async def driving() -> AsyncIterator[asyncio.subprocess.Process]:
    """Run a program of ROS 1 that drives ten times a second."""
    process = await asyncio.create_subprocess_exec(
        *PUB, AHEAD, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield process
    finally:
        if process.returncode is None:
            process.kill()
        await process.wait()


async def heard(*topics: str) -> Any:
    return await script("listen.py", "15", *topics)


async def test_old_programs_read_all_of_a_robot_in_ros2(ros2: Ros2) -> None:
    async with robot_on(ros2), bridge_on(ros2):
        found = await heard("/odom", "/RosAria/pose", "/tf", "/sonar/range_3", "/emergency_stop")
        assert found["/odom"]["md5sum"] == "cd5e73d190d741a2f92e81eda573aca7"
        assert found["/RosAria/pose"]["bytes"] == found["/odom"]["bytes"] == 718  # base_footprint
        assert found["/tf"]["md5sum"] == "94810edda583a504dfda3829e70d7eec"
        assert found["/sonar/range_3"]["type"] == "sensor_msgs/Range"
        assert found["/emergency_stop"]["latching"] == "1"
        message = await ros("rostopic", "echo", "-n1", "/emergency_stop")
        assert "data: False" in message
        fixed = await ros("rostopic", "echo", "-n1", "/tf_static")
        assert fixed.count("child_frame_id") > 10
        assert 'child_frame_id: "sonar_15"' in fixed


async def test_a_program_that_is_killed_leaves_a_robot_that_stands(ros2: Ros2) -> None:
    async with robot_on(ros2) as robot, bridge_on(ros2), driving() as program:
        await until(lambda: not robot.tap.now.is_zero)
        assert robot.tap.now.v == pytest.approx(0.2)
        os.kill(program.pid, signal.SIGKILL)
        assert await until(lambda: robot.tap.now.is_zero) < STANDS


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
async def test_a_bridge_that_is_told_to_end_stops_the_robot(
    ros1: None, number: signal.Signals
) -> None:
    forever = ("--ros-args", "-p", "cmd_vel_timeout:=0")
    async with (
        network_of(BackendName.DDS) as network,
        robot_on(network, *forever) as robot,
        bridge_on(network) as bridge,
        driving(),
    ):
        await until(lambda: not robot.tap.now.is_zero)
        code, _ = await bridge.end(number)
        assert code == 128 + number
        assert await until(lambda: robot.tap.now.is_zero) < STANDS


async def test_a_bridge_that_is_killed_leaves_a_robot_that_stands(ros2: Ros2) -> None:
    async with robot_on(ros2) as robot, bridge_on(ros2) as bridge, driving():
        await until(lambda: not robot.tap.now.is_zero)
        await bridge.end(signal.SIGKILL)
        assert await until(lambda: robot.tap.now.is_zero) < STANDS


async def test_services_of_the_robot_are_called_from_ros1(ros2: Ros2) -> None:
    async with robot_on(ros2), bridge_on(ros2):
        said = await ros("rosservice", "call", "/e_stop_trigger")
        assert "success: True" in said
        stopped = ""
        async with asyncio.timeout(PATIENCE):
            while "data: True" not in stopped:
                stopped = await ros("rostopic", "echo", "-n1", "/emergency_stop")
        await ros("rosservice", "call", "/RosAria/disable_motors")


async def test_programs_of_ros2_drive_and_read_a_robot_in_ros1(ros2: Ros2) -> None:
    async with (
        laboratory() as lab,
        bridge_on(ros2, "--robot-in", "ros1"),
        ros2.peer() as peer,
    ):
        odometry = peer.hear("/odom", "nav_msgs/Odometry")
        moving = peer.hear("/tf", "tf2_msgs/TFMessage")
        motors = peer.hear("/motors_state", "std_msgs/Bool", LATCHED)
        clouds = peer.hear("/sonar", "sensor_msgs/PointCloud")
        await until(lambda: odometry and moving and motors and clouds)
        frames = odometry[0][1].header.frame_id, odometry[0][1].child_frame_id
        assert frames == ("odom", "base_link")
        assert moving[0][1].transforms[0].header.frame_id == "odom"
        assert len(clouds[0][1].points) == 16
        publisher = peer.publisher("/cmd_vel", "geometry_msgs/Twist")
        await until(lambda: publisher.matched)

        def drives() -> bool:
            publisher.write(peer.twist(0.2))
            return not lab.tap.now.is_zero

        await until(drives)
        await until(lambda: lab.tap.now.is_zero)


async def test_a_master_that_restarts_is_told_of_and_found_again(
    home: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    port = free_port()
    for name, value in environment_of(port, home).items():
        monkeypatch.setenv(name, value)
    async with network_of(BackendName.DDS) as network, robot_on(network) as robot:
        with roscore(port, home):
            bridge = running("ros2", "bridge", *network.options, "--only", "cmd_vel")
            command = await bridge.__aenter__()
            await says(command, "ready")
        try:
            await says(command, "ROS MASTER LOST")
            assert processes_of(f"rosmaster --core -p {port}") == []
            with roscore(port, home):
                await says(command, "the ROS master is back")
                async with driving():
                    await until(lambda: not robot.tap.now.is_zero)
                await until(lambda: robot.tap.now.is_zero)
                await command.end(signal.SIGINT)
        finally:
            await bridge.__aexit__(None, None, None)


async def test_a_router_that_restarts_is_found_again(ros1: None) -> None:
    place = f"tcp/127.0.0.1:{free_port()}"
    route = ("ros2", "router", "--listen", place)
    network = Ros2(Network(backend=BackendName.ZENOH, domain=81, connect=(place,)))
    async with running(*route) as router:
        assert "router" in await router.line()
        async with robot_on(network) as robot, bridge_on(network, "--only", "cmd_vel"):
            async with driving():
                await until(lambda: not robot.tap.now.is_zero)
                await router.end(signal.SIGKILL)
            await until(lambda: robot.tap.now.is_zero)
            async with running(*route) as second:
                assert "router" in await second.line()
                async with driving():
                    await until(lambda: not robot.tap.now.is_zero)
                await until(lambda: robot.tap.now.is_zero)


async def test_a_topic_both_ways_never_echoes(ros2: Ros2, tmp_path: Path) -> None:
    table = tmp_path / "topics.toml"
    table.write_text('[[topic]]\nros1 = "/chatter"\ntype = "std_msgs/String"\nway = "both"\n')
    chatter = ("--topics", str(table), "--only", "chatter")
    async with bridge_on(ros2, *chatter), ros2.peer() as peer:
        heard = peer.hear("/chatter", "std_msgs/String")
        command = ("rostopic", "pub", "-r", "10", "/chatter", "std_msgs/String", "old")
        talking = await asyncio.create_subprocess_exec(*command, env=environment())
        try:
            await until(lambda: len(heard) > 2)
            heard.clear()
            await asyncio.sleep(2.0)
            assert {message.data for _, message in heard} == {"old"}
            assert 10 < len(heard) < 30
        finally:
            talking.kill()
            await talking.wait()
        publisher = peer.publisher("/chatter", "std_msgs/String")
        await until(lambda: publisher.matched)
        message = peer.types.make("std_msgs/String")
        message.data = "new"
        heard.clear()
        listening = asyncio.create_task(ros("rostopic", "echo", "-n3", "/chatter"))
        sent = 0
        while not listening.done():
            publisher.write(peer.types.encode(message))
            sent += 1
            await asyncio.sleep(0.1)
        assert (await listening).count("new") == 3
        await until(lambda: sum(each.data == "new" for _, each in heard) >= sent)
        await asyncio.sleep(1.0)
        assert sum(each.data == "new" for _, each in heard) == sent  # our own, from this process


async def test_a_topic_of_a_node_that_was_killed_is_bridged(ros1: None, tmp_path: Path) -> None:
    command = ("rostopic", "pub", "-r", "10", "/odom", "nav_msgs/Odometry", "{}")
    async with network_of(BackendName.DDS) as network, robot_on(network):
        talking = await asyncio.create_subprocess_exec(*command, env=environment())
        await heard("/odom")
        async with running("ros2", "bridge", *network.options, "--only", "odom") as bridge:
            assert "for /rostopic" in await says(bridge, "RESTS: ROS 1 /odom")
            talking.kill()
            await talking.wait()
            await says(bridge, "bridged: ROS 1 /odom")
            await bridge.end(signal.SIGINT)


async def test_a_second_bridge_of_the_same_name_does_not_start(ros1: None) -> None:
    async with (
        network_of(BackendName.DDS) as network,
        bridge_on(network),
        running("ros2", "bridge", *network.options) as second,
    ):
        code, said = await second.end()
        assert code == 2
        assert "a node /pioneer3_bridge is on the ROS master already" in said


async def test_the_table_is_listed(ros1: None) -> None:
    async with running("ros2", "bridge", "--list", "--json") as listing:
        assert listing.process.stdout is not None
        table = json.loads(await listing.process.stdout.read())
    names = {(row["ros1"], row["ros2"]) for row in table["topics"]}
    assert ("/RosAria/pose", "/odom") in names
    assert {row["ros1"] for row in table["services"]} >= {"/e_stop_trigger"}
