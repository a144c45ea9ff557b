"""Several networks at once: one that hangs, and missing robots, delay nobody. Real time."""

import asyncio
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf

import pytest

from pioneer3.errors import ConfigError, NoRobotError
from pioneer3.fleet.members import Connect
from pioneer3.fleet.spec import FleetRobot
from pioneer3.fleet.stop import stop_all
from pioneer3.ros.ros2 import sessions as module
from pioneer3.ros.ros2.backend import NodeName, Qos
from pioneer3.ros.ros2.distros import distro_of
from pioneer3.ros.ros2.network import Network
from pioneer3.ros.ros2.sessions import SETTLED, sessions
from pioneer3.ros.ros2.types import MessageTypes
from tests.unit.ros.ros2.memory import MemoryBackend, MemoryNetwork

pytestmark = pytest.mark.realtime
WELL, HANGS, WRONG = Network(domain=1), Network(domain=2), Network(domain=3)
STAMP = 1_800_000_000
SOON = 0.3


class Left(MemoryBackend):
    """A backend that tells when it is closed."""

    def __init__(self, network: MemoryNetwork, node: NodeName) -> None:
        super().__init__(network, node)
        self.closed = threading.Event()

    def close(self) -> None:
        super().close()
        self.closed.set()


@dataclass
class Networks:
    """A network for each domain; one is joined only when `free` is set."""

    memory: MemoryNetwork = field(default_factory=MemoryNetwork)
    free: threading.Event = field(default_factory=threading.Event)
    opened: list[Left] = field(default_factory=list)

    def open(self, network: Network, node: NodeName, types: MessageTypes) -> Left:
        if network is HANGS:
            self.free.wait()
        if network is WRONG:
            raise ConfigError("laptop.key holds a secret")
        self.opened.append(Left(self.memory, node))
        return self.opened[-1]


@pytest.fixture
def networks(monkeypatch: pytest.MonkeyPatch) -> Iterator[Networks]:
    made = Networks()
    monkeypatch.setattr(module, "open_backend", made.open)
    yield made
    made.free.set()


def robot_on(memory: MemoryNetwork, *, silent: bool = False, stamped: bool = False) -> list[float]:
    """Put the node of a robot on a network; it tells its state once. Return its commands [m/s]."""
    commands: list[float] = []
    types = MessageTypes(distro_of("jazzy"))
    node = MemoryBackend(memory, NodeName("pioneer3", "/r1"))
    latched = Qos(transient_local=True, depth=1)
    for name, kind in (
        ("odom", "nav_msgs/Odometry"),
        ("battery_state", "sensor_msgs/BatteryState"),
        ("motors_state", "std_msgs/Bool"),
        ("emergency_stop", "std_msgs/Bool"),
    ):
        writer = node.advertise(f"/r1/{name}", types.message_type(kind), latched)
        message = types.make(kind)
        match name:
            case "odom":
                message.header.stamp.sec = STAMP
            case "battery_state":
                message.voltage = 12.5
            case "motors_state":
                message.data = True
        if not (silent and name == "odom"):
            writer.write(types.encode(message))

    def received(cdr: bytes, gid: bytes) -> None:
        message = types.decode(cdr, twist.name)
        commands.append((message.twist if stamped else message).linear.x)

    twist = types.message_type(f"geometry_msgs/Twist{'Stamped' if stamped else ''}")
    node.subscribe("/r1/cmd_vel", twist, Qos(), received, lambda gid: None)
    return commands


async def test_the_state_of_a_robot_is_read_and_a_missing_one_is_named(networks: Networks) -> None:
    robot_on(networks.memory)
    clock = asyncio.get_running_loop().time
    async with sessions("fleet_list") as made:
        session = await made.on(WELL)
        told = await session.state("r1/pioneer3", inf)
        assert (told.battery, told.motors, told.emergency_stop) == (12.5, True, False)
        assert told.age is not None
        assert told.age == pytest.approx(time.time() - STAMP, abs=5)
        with pytest.raises(NoRobotError, match=r"no node /r2/pioneer3 .* there are /r1/pioneer3"):
            await session.state("/r2/pioneer3", clock() + SOON)


async def test_a_silent_robot_has_no_age(networks: Networks) -> None:
    robot_on(networks.memory, silent=True)
    async with sessions("fleet_list") as made:
        session = await made.on(WELL)
        told = await session.state("r1/pioneer3", asyncio.get_running_loop().time() + SOON)
    assert (told.battery, told.age) == (12.5, None)


async def test_a_silent_robot_is_told_to_stop_all_the_same(networks: Networks) -> None:
    commands = robot_on(networks.memory, silent=True)
    robots = [FleetRobot(name="r1", host="r1", address="127.0.0.1", node="r1/pioneer3")]
    async with sessions("fleet_stop", SOON, at_once=True) as made:
        connect: Connect = lambda robot: made.robot(WELL, robot.node, None)  # noqa: E731
        (told,) = await stop_all(robots, connect, emergency=True, patience=1.0)
    assert (told.ok, told.reached) == (False, True)
    assert "/r1/pioneer3 has not reported: has it lost its robot?" in told.why
    assert commands
    assert not any(commands)
    async with sessions("fleet_drive", SOON) as made:
        with pytest.raises(NoRobotError, match="publishes nothing on /r1/odom"):
            async with made.robot(WELL, "r1/pioneer3", None):
                pass


async def test_a_robot_that_takes_stamped_velocities_is_driven(networks: Networks) -> None:
    commands = robot_on(networks.memory, stamped=True)
    async with sessions("fleet_stop", SOON, at_once=True) as made:
        async with made.robot(WELL, "r1/pioneer3", None) as robot:
            robot.stop()
        assert commands == [0.0]


async def test_robots_of_one_name_are_all_stopped_and_none_is_driven(networks: Networks) -> None:
    both = [robot_on(networks.memory) for _ in range(2)]
    networks.memory.nodes = ["/r1/pioneer3"] * 2
    robots = [FleetRobot(name="r1", host="r1", address="127.0.0.1", node="r1/pioneer3")]
    async with sessions("fleet_stop", SOON, at_once=True) as made:
        connect: Connect = lambda robot: made.robot(WELL, robot.node, None)  # noqa: E731
        (told,) = await stop_all(robots, connect, patience=1.0)
    assert (told.ok, told.reached) == (False, True)
    assert "2 nodes are called /r1/pioneer3" in told.why
    assert all(commands and not any(commands) for commands in both)
    async with sessions("fleet_list") as made:
        assert (await (await made.on(WELL)).state("r1/pioneer3", inf)).nodes == 2
    async with sessions("fleet_drive", SOON) as made:
        with pytest.raises(ConfigError, match="2 nodes are called /r1/pioneer3"):
            async with made.robot(WELL, "r1/pioneer3", None):
                pass


async def test_the_topics_of_a_robot_may_be_discovered_one_after_the_other(
    networks: Networks,
) -> None:
    robot_on(networks.memory)
    late = [networks.memory.endpoints.pop(2), networks.memory.endpoints.pop(2)]
    async with sessions("fleet_list") as made:
        asked = asyncio.create_task((await made.on(WELL)).state("r1/pioneer3", inf))
        for each in late:
            await asyncio.sleep(SETTLED / 2)
            networks.memory.endpoints.append(each)
        told = await asked
    assert (told.motors, told.emergency_stop) == (True, False)


async def test_a_network_that_hangs_delays_no_other_and_is_left_when_it_comes(
    networks: Networks,
) -> None:
    async with sessions("fleet_stop", SOON) as made:
        hung = asyncio.create_task(made.on(HANGS))
        with pytest.raises(ConfigError, match="holds a secret"):
            await made.on(WRONG)
        with pytest.raises(NoRobotError, match="no node /r1/pioneer3"):
            async with made.robot(WELL, "r1/pioneer3", None):
                pass
        assert not hung.done()
        hung.cancel()
    (joined,) = networks.opened
    assert joined.closed.is_set()
    networks.free.set()
    async with asyncio.timeout(5):
        while len(networks.opened) < 2:  # noqa: ASYNC110  a thread opens it
            await asyncio.sleep(0.01)
    assert await asyncio.to_thread(networks.opened[1].closed.wait, 5)


async def test_a_network_is_joined_once_and_again_after_a_failure(
    networks: Networks, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with sessions("fleet_drive") as made:
        assert await made.on(WELL) is await made.on(Network(domain=1))
        with pytest.raises(ConfigError):
            await made.on(WRONG)
        monkeypatch.setattr(module, "open_backend", lambda *_: Left(networks.memory, NodeName("a")))
        assert await made.on(WRONG)
    assert len(networks.opened) == 1
