"""Publishers that die, robots and routers that go and come back, on networks of both kinds."""

import asyncio
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import replace
from pathlib import Path
from urllib.parse import urlsplit

import pytest
import pytest_asyncio

from pioneer3.ros.ros2.backend import LATCHED
from pioneer3.ros.ros2.network import BackendName, Network
from pioneer3.ros.zenoh.presence import PERIOD
from tests.e2e.processes import Command, environment, free_port, running, until
from tests.ros1.tap import tapped
from tests.ros2.conftest import Robot, robot_on
from tests.ros2.networks import DOMAINS, Ros2

pytestmark = [pytest.mark.realtime]
COMMANDER = Path(__file__).with_name("commander.py")
STANDS_WITHIN = 0.7
"""After its publisher was killed [s]: `cmd_vel_timeout` and the time that a command takes."""
FOREVER = ("--ros-args", "-p", "cmd_vel_timeout:=0")


@asynccontextmanager
async def commander(
    network: Ros2, topic: str = "/cmd_vel", rate: float = 20.0
) -> AsyncIterator[asyncio.subprocess.Process]:
    """Run a program that commands; it ends, in order, with its input."""
    about = network.network
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, str(COMMANDER), about.backend, str(about.domain), topic, str(rate)),
        *about.connect,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=environment(),
    )
    try:
        yield process
    finally:
        if process.returncode is None:
            process.kill()
        await process.communicate()


async def test_a_killed_publisher_that_was_driving_leaves_a_robot_that_stands(ros2: Ros2) -> None:
    """At most 0.7 s after, at the wire; no network tells of a killed program by then."""
    async with robot_on(ros2) as robot, commander(ros2) as program:
        await until(lambda: robot.tap.now.v > 0.25)
        killed = time.monotonic()
        program.kill()
        await until(lambda: robot.tap.now.is_zero)
        stood = robot.tap.velocities[-1][0]
        assert stood - killed < STANDS_WITHIN
        await asyncio.sleep(0.5)
        assert robot.tap.velocities[-1] == (stood, robot.tap.now)


async def test_a_publisher_that_leaves_stops_the_robot_at_once(ros2: Ros2) -> None:
    """Though its last command would last for ever."""
    async with robot_on(ros2, *FOREVER) as robot, commander(ros2, rate=0.0) as program:
        await until(lambda: robot.tap.now.v > 0.25)
        assert program.stdin is not None
        left = time.monotonic()
        program.stdin.close()
        await until(lambda: robot.tap.now.is_zero)
        assert robot.tap.velocities[-1][0] - left < STANDS_WITHIN


@asynccontextmanager
async def unpluggable(network: Ros2, *arguments: str) -> AsyncIterator[tuple[Robot, str]]:
    """Run a robot and its node; the robot may be killed. Yield its port, too."""
    async with simulated("0") as simulator:
        url = (await simulator.line()).split()[-1]
        async with (
            tapped(url) as tap,
            running("ros2", "--port", tap.url, *network.options, *arguments) as node,
        ):
            said = ""
            while "ready" not in said:
                said = await node.line()
                assert said, await node.end()
            yield Robot(node, simulator, tap), str(urlsplit(url).port)


def simulated(port: str) -> AbstractAsyncContextManager[Command]:
    return running("sim", "--ideal", "--nomap", "--fit", "bumpers", "--port", port)


STALE = {
    "/odom": "nav_msgs/Odometry",
    "/tf": "tf2_msgs/TFMessage",
    "/joint_states": "sensor_msgs/JointState",
    "/sonar/points": "sensor_msgs/PointCloud2",
    "/scan": "sensor_msgs/LaserScan",
    "/battery_state": "sensor_msgs/BatteryState",
}
"""Topics that must be silent while the robot is away."""


async def test_an_unplugged_robot_is_told_and_stands_when_it_is_back(ros2: Ros2) -> None:
    """Its last command would last for ever, and its publisher is there all the time."""
    async with (
        unpluggable(ros2, *FOREVER) as (robot, port),
        ros2.peer() as peer,
        commander(ros2, rate=0.0),
    ):
        heard = {name: peer.hear(name, type_name) for name, type_name in STALE.items()}
        stopped = peer.hear("/emergency_stop", "std_msgs/Bool")
        motors = peer.hear("/motors_state", "std_msgs/Bool", LATCHED)
        reports = peer.hear("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        logs = peer.hear("/rosout", "rcl_interfaces/Log")
        await until(lambda: robot.tap.now.v > 0.25)
        await until(lambda: all(heard.values()) and stopped and reports)
        await until(lambda: motors and motors[-1][1].data)
        assert not stopped[-1][1].data

        robot.simulator.process.kill()
        await until(lambda: stopped[-1][1].data and not motors[-1][1].data)
        counts = {name: len(messages) for name, messages in heard.items()}
        said, sent = len(stopped), len(robot.tap.heard)
        await until(lambda: len(stopped) > said + 10)  # nobody who joins late misses it
        assert all(message.data for _, message in stopped[said:])
        await until(lambda: any("Link" in s.name and s.level == 2 for s in reports[-1][1].status))
        assert any("LOST THE ROBOT" in message.msg for _, message in logs)
        assert {name: len(messages) for name, messages in heard.items()} == counts

        async with simulated(port):
            await until(lambda: not stopped[-1][1].data)
            await until(lambda: len(heard["/odom"]) > counts["/odom"] + 10)
            await until(lambda: any("connected again" in m.msg for _, m in logs))
            began = robot.tap.heard[sent][0]
            assert all(twist.is_zero for when, twist in robot.tap.velocities if when >= began)


@pytest_asyncio.fixture
async def zenoh() -> AsyncIterator[tuple[Ros2, Command]]:
    """Return a network of Zenoh and its router, which may be killed."""
    place = f"tcp/127.0.0.1:{free_port()}"
    async with running("ros2", "router", "--listen", place) as router:
        assert "router" in await router.line()
        about = Network(backend=BackendName.ZENOH, domain=next(DOMAINS), connect=(place,))
        yield Ros2(about), router


async def test_a_node_finds_its_router_again_and_says_so(zenoh: tuple[Ros2, Command]) -> None:
    network, router = zenoh
    async with robot_on(network) as robot:
        async with network.peer("before") as peer:
            odometry = peer.hear("/odom", "nav_msgs/Odometry")
            await until(lambda: odometry)
        router.process.kill()
        await router.process.wait()
        await asyncio.sleep(3.0)
        (place,) = network.network.connect
        async with running("ros2", "router", "--listen", place) as again:
            assert "router" in await again.line()
            async with network.peer("after") as peer:
                odometry = peer.hear("/odom", "nav_msgs/Odometry")
                await until(lambda: odometry and "/pioneer3" in peer.backend.graph().nodes)
                async with commander(network):
                    await until(lambda: robot.tap.now.v > 0.25)
                await until(lambda: robot.tap.now.is_zero)
            await asyncio.sleep(2 * PERIOD)
            _, errors = await robot.node.end(signal.SIGINT)
            assert "no router of Zenoh" in errors
            assert "a router of Zenoh is there now" in errors


async def test_a_node_that_changes_its_domain_leaves_the_first(ros2: Ros2) -> None:
    other = Ros2(replace(ros2.network, domain=next(DOMAINS)))
    async with ros2.peer("here") as here, other.peer("there") as there:
        odometry = here.hear("/odom", "nav_msgs/Odometry")
        async with robot_on(ros2) as robot:
            await until(lambda: odometry and "/pioneer3" in here.backend.graph().nodes)
            assert there.backend.graph().nodes == ("/there",)
            await robot.node.end(signal.SIGINT)
        await until(lambda: here.backend.graph().nodes == ("/here",))
        count = len(odometry)
        async with robot_on(other):
            beyond = there.hear("/odom", "nav_msgs/Odometry")
            await until(lambda: len(beyond) > 5 and "/pioneer3" in there.backend.graph().nodes)
            assert here.backend.graph().nodes == ("/here",)
            assert len(odometry) == count
