"""Lasers in the robot's node and in a node of their own, over a middleware without ROS."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from math import inf, isinf, radians
from typing import Any

import pytest

from pioneer3 import Robot, connect_async
from pioneer3.geometry import Pose2
from pioneer3.lasers.client import LaserIdentity, ScanSettings
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.ros.messages.diagnostics import device_id
from pioneer3.ros.node.laser_node import LaserNode
from pioneer3.ros.node.node import RobotNode
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.tasks import running
from tests.lasers import LaserUnit
from tests.support import SimulatedRobot, until, wall_at
from tests.unit.ros.fakes import FakeMiddleware

REP_138 = {
    "Serial Port",
    "Vendor Name",
    "Product Name",
    "Firmware Version",
    "Firmware Date",
    "Protocol Version",
    "Device ID",
    "Device Status",
    "Computed Latency",
    "User Time Offset",
    "Scan Thread Lost Count",
}
"""Keys of the diagnostics of a laser at a serial port."""


@pytest.fixture
def middleware(monkeypatch: pytest.MonkeyPatch) -> FakeMiddleware:
    fake = FakeMiddleware()
    monkeypatch.setattr(asyncio, "to_thread", fake.at_once)
    return fake


@asynccontextmanager
async def a_node(
    middleware: FakeMiddleware, robot: Robot, raw: dict[str, object]
) -> AsyncIterator[None]:
    """Run the node of `robot` while the block lasts."""
    ready = asyncio.Event()
    node = RobotNode(robot, read_parameters(raw), middleware)
    async with running(node.run(ready.set)):
        await ready.wait()
        yield


async def messages(middleware: FakeMiddleware, name: str, seconds: float = 1.0) -> list[Any]:
    """Subscribe to a topic for a while; return its messages."""
    publisher = middleware.publishers[name]
    publisher.subscribed = True
    await asyncio.sleep(seconds)
    publisher.subscribed = False
    return publisher.messages


async def scanning(robot: Robot) -> None:
    await until(lambda: all(laser.lost is None for laser in robot.lasers))


async def test_a_scan_is_as_laser_scan_wants_it(middleware: FakeMiddleware) -> None:
    settings = ScanSettings(intensities=True)
    async with (
        SimulatedRobot(wall_at(3.0)) as sim,
        LaserUnit(sim, "utm-30lx", serial=True) as unit,
        connect_async(sim.open, lasers=[unit.spec(settings=settings)]) as robot,
        a_node(middleware, robot, {"profile": "standard"}),
    ):
        await scanning(robot)
        scans = await messages(middleware, "scan", 2.0)
        assert len(scans) == pytest.approx(80, abs=12)  # 40 a second, after a look for subscribers
        scan = scans[-1]
        assert scan.header.frame_id == "laser"
        assert -0.2 < scan.header.stamp < 0.0  # the age of its first reading
        assert scan.angle_min == pytest.approx(radians(-135))
        assert scan.angle_max == pytest.approx(radians(135))
        assert scan.angle_increment == pytest.approx(radians(0.25))
        assert scan.time_increment == pytest.approx(0.025 / 1440)
        assert scan.scan_time == pytest.approx(0.025)
        assert (scan.range_min, scan.range_max) == (pytest.approx(0.023), 60.0)  # as it tells
        assert len(scan.ranges) == len(scan.intensities) == 1081
        assert scan.ranges[540] == pytest.approx(3.0 - robot.laser.sensor_in_robot.x, abs=0.05)
        assert isinf(scan.ranges[0])
        assert scan.ranges[0] == inf  # nothing behind: REP 117
        assert min(scan.intensities) >= 0.0


async def test_several_lasers_have_topics_and_frames_of_their_own(
    middleware: FakeMiddleware,
) -> None:
    rear = Mounting(sensor_in_robot=Pose2(-0.25, 0.1, 3.0), upside_down=True)
    async with (
        SimulatedRobot(wall_at(3.0)) as sim,
        LaserUnit(sim, "utm-30lx", serial=True) as one,
        LaserUnit(sim, "tim551", serial=False, name_in_scans="laser2") as other,
        connect_async(sim.open, lasers=[one.spec(), other.spec(rear)]) as robot,
        a_node(middleware, robot, {"profile": "standard", "frame_prefix": "r1/"}),
    ):
        await scanning(robot)
        first = (await messages(middleware, "scan"))[-1]
        second = (await messages(middleware, "scan2"))[-1]
        assert (first.header.frame_id, second.header.frame_id) == ("r1/laser", "r1/laser2")
        assert len(second.ranges) == 271
        assert second.time_increment < 0 < second.angle_increment
        assert second.scan_time == pytest.approx(1 / 15)
        fixed = middleware.publishers["/tf_static"].messages[-1].transforms
        at = {each.child_frame_id: each.transform for each in fixed}
        assert at["r1/laser2"].translation.x == -0.25
        assert at["r1/laser2"].translation.y == 0.1
        assert "r1/laser" in at


async def test_the_place_of_a_laser_is_the_one_that_was_given(middleware: FakeMiddleware) -> None:
    place = Mounting(sensor_in_robot=Pose2(0.3, -0.1, 0.5))
    async with (
        SimulatedRobot() as sim,
        LaserUnit(sim, "tim551", serial=False) as unit,
        connect_async(sim.open, lasers=[unit.spec(place)]) as robot,
        a_node(middleware, robot, {"profile": "standard"}),
    ):
        await asyncio.sleep(1)
        fixed = middleware.publishers["/tf_static"].messages[-1].transforms
        (at,) = (each.transform for each in fixed if each.child_frame_id == "laser")
        assert (at.translation.x, at.translation.y) == (0.3, -0.1)


@pytest.mark.parametrize("asked", [False, True])
async def test_rosarias_names_have_scans_only_where_a_laser_was_asked_for(
    middleware: FakeMiddleware, *, asked: bool
) -> None:
    async with (
        SimulatedRobot() as sim,
        LaserUnit(sim, "tim551", serial=False) as unit,
        connect_async(sim.open, lasers=[unit.spec()] if asked else []) as robot,
        a_node(middleware, robot, {}),
    ):
        assert ("scan" in middleware.publishers) is asked
        if asked:
            await scanning(robot)
            scan = (await messages(middleware, "scan"))[-1]
            assert scan.header.frame_id == "laser_frame"


async def test_scans_go_on_while_the_robot_is_lost(middleware: FakeMiddleware) -> None:
    async with (
        SimulatedRobot() as sim,
        LaserUnit(sim, "tim551", serial=False) as unit,
        connect_async(sim.open, lasers=[unit.spec()]) as robot,
        a_node(middleware, robot, {"profile": "standard"}),
    ):
        await scanning(robot)
        await sim.unplug()
        await asyncio.sleep(2)
        before = len(middleware.publishers["scan"].messages)
        assert len(await messages(middleware, "scan", 2.0)) - before > 25


async def diagnosed(middleware: FakeMiddleware, part: str) -> Any:
    """Return the newest status of a part."""
    found = (await messages(middleware, "/diagnostics", 2.5))[-1].status
    (status,) = (each for each in found if each.name.endswith(f": {part}"))
    return status


async def test_diagnostics_have_the_keys_of_rep_138(middleware: FakeMiddleware) -> None:
    async with (
        SimulatedRobot() as sim,
        LaserUnit(sim, "utm-30lx", serial=True) as unit,
        connect_async(sim.open, lasers=[unit.spec(time_offset=0.05)]) as robot,
        a_node(middleware, robot, {"profile": "standard"}),
    ):
        await scanning(robot)
        await asyncio.sleep(4)
        status = await diagnosed(middleware, "Laser")
        values = {each.key: each.value for each in status.values}
        assert set(values) >= REP_138
        assert values["Serial Port"] == unit.url
        assert "Hokuyo" in values["Vendor Name"]
        assert values["Device ID"].startswith("H")
        assert values["User Time Offset"] == "0.0500"
        assert 0.0 <= float(values["Computed Latency"]) < 0.05
        assert float(values["Scan Rate"]) == pytest.approx(40, abs=1)
        assert values["Scan Thread Lost Count"] == "0"
        assert (status.level, status.message) == (0, "scans")
        unit.unplug()
        await until(lambda: robot.laser.lost)
        lost = await diagnosed(middleware, "Laser")
        assert lost.level == 2
        assert {each.key: each.value for each in lost.values}["Scan Thread Lost Count"] == "1"


async def test_in_the_network_they_have_its_address(middleware: FakeMiddleware) -> None:
    async with (
        SimulatedRobot() as sim,
        LaserUnit(sim, "tim551", serial=False) as unit,
        connect_async(sim.open, lasers=[unit.spec()]) as robot,
        a_node(middleware, robot, {"profile": "standard"}),
    ):
        await scanning(robot)
        status = await diagnosed(middleware, "Laser")
        values = {each.key: each.value for each in status.values}
        assert (values["IP Address"], values["IP Port"]) == ("laser", "10940")
        assert "Serial Port" not in values


@pytest.mark.parametrize(
    ("serial", "identity"),
    [("H1234567", "H1234567"), ("01234567", "H1234567"), ("1234567", "H1234567"), ("", "")],
)
def test_the_device_id_is_written_as_hokuyo_node_writes_it(serial: str, identity: str) -> None:
    assert device_id(LaserIdentity(serial=serial)) == identity


async def test_a_laser_has_a_node_of_its_own(middleware: FakeMiddleware) -> None:
    async with SimulatedRobot() as sim, LaserUnit(sim, "urg-04lx", serial=True) as unit:
        driver = unit.driver()
        assert isinstance(driver, LaserDriver)
        ready = asyncio.Event()
        node = asyncio.ensure_future(LaserNode(driver, "front", middleware).run(ready.set))
        await ready.wait()
        assert set(middleware.publishers) == {"scan", "/diagnostics"}
        assert middleware.publishers["scan"].type_name == "sensor_msgs/LaserScan"
        await until(lambda: driver.connected)
        scan = (await messages(middleware, "scan", 2.0))[-1]
        assert scan.header.frame_id == "front"
        assert len(scan.ranges) == 682
        told = (await messages(middleware, "/diagnostics", 2.0))[-1]
        (status,) = told.status
        assert status.hardware_id.startswith("H")
        unit.unplug()
        await until(lambda: not driver.connected)
        unit.plug_in()
        await until(lambda: driver.connected)
        await asyncio.sleep(0.1)
        assert [words.split(":")[0] for words in middleware.warnings] == [
            "laser connected",
            "laser lost",
            "laser connected",
        ]
        middleware.shut_down()
        await node
        assert middleware.forgotten
