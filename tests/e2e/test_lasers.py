"""Lasers that come, go, fall silent and talk rubbish, through the whole driver. Virtual time."""

import asyncio

import pytest

from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.supervisor import Connection
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.tasks import running
from tests.lasers import LEFT, STARTS, LaserUnit
from tests.support import SimulatedRobot, until, wall_at

UNITS = [
    ("utm-30lx", True),
    ("utm-30lx", False),
    ("urg-04lx", True),
    ("lms-200", True),
    ("lms-111", False),
    ("tim551", False),
]
HOWS = ["unplugged", "silent for 5 s", "garbage", "power cycle"]
FIRST = 5.0
"""To the first scan, with the search for protocol and speed [s]."""
AGAIN = 3.0
"""From the moment that a laser is back to the next scan [s]."""


async def happen(unit: LaserUnit, how: str) -> None:
    """Let it happen to the laser; return when it is over."""
    match how:
        case "unplugged":
            unit.unplug()
            await asyncio.sleep(4)
            unit.plug_in()
        case "silent for 5 s":
            unit.laser.silence(5)
            await asyncio.sleep(5)
        case "garbage":
            unit.laser.faults = LinkFaults(corrupt=1.0)
            await asyncio.sleep(3)
            unit.laser.faults = LinkFaults()
        case "power cycle":
            unit.laser.switch_off()
            await asyncio.sleep(3)
            unit.laser.switch_on()


async def next_scan(driver: LaserDriver, within: float) -> float:
    """Return how long it takes from now until a scan comes [s]."""
    before = driver.scans
    return await until(lambda: driver.scans > before, within)


def is_of_wall(driver: LaserDriver, metres: float) -> bool:
    """Whether the reading straight ahead is of a wall there."""
    scan = driver.latest
    assert scan is not None
    ahead = min(range(len(scan.angles)), key=lambda i: abs(scan.angles[i]))
    return scan.ranges[ahead] == pytest.approx(metres, abs=0.1)


@pytest.mark.parametrize(("name", "serial"), UNITS)
async def test_a_laser_scans_soon_and_at_its_own_rate(name: str, *, serial: bool) -> None:
    async with (
        SimulatedRobot(wall_at(3.0)) as robot,
        LaserUnit(robot, name, serial=serial) as unit,
    ):
        driver = unit.driver()
        async with running(driver.run()):
            assert await next_scan(driver, FIRST) <= FIRST
            await asyncio.sleep(2)
            assert driver.latest is not None
            assert driver.rate == pytest.approx(1 / driver.latest.period, abs=1.0)
            assert 0.0 <= driver.latency < 0.25
            assert driver.lost is None
            assert driver.losses == 0
            assert driver.identity is not None
            assert driver.identity.product
            assert bool(driver.identity.serial) is (name != "lms-200")  # which tells none
            mount = robot.body.model.laser
            assert mount is not None
            assert is_of_wall(driver, 3.0 - mount.x)
        assert driver.status.latest is not None
        assert driver.status.latest.connection is Connection.CLOSED


@pytest.mark.parametrize(
    ("name", "serial", "how"),
    [
        pytest.param(*unit, how, marks=() if first % len(HOWS) == second else pytest.mark.thorough)
        for first, unit in enumerate(UNITS)
        for second, how in enumerate(HOWS)
    ],
)
async def test_a_laser_that_is_back_scans_again(name: str, how: str, *, serial: bool) -> None:
    async with (
        SimulatedRobot(wall_at(3.0)) as robot,
        LaserUnit(robot, name, serial=serial) as unit,
    ):
        driver = unit.driver()
        async with running(driver.run()):
            await next_scan(driver, FIRST)
            await asyncio.sleep(1)
            assert driver.latest is not None
            patience = max(1.0, 10 * driver.latest.period)
            happening = asyncio.ensure_future(happen(unit, how))
            gone = await until(lambda: not driver.connected, 3.0)
            assert gone <= patience + 0.1
            assert driver.lost == "the laser is lost"
            assert driver.presence.there
            assert unit.url in str(driver.presence)
            await happening
            start = STARTS[name] if how == "power cycle" else 0.0
            await next_scan(driver, start + AGAIN)
            assert driver.losses == 1
            await asyncio.sleep(1)
            assert driver.lost is None
            mount = robot.body.model.laser
            assert mount is not None
            assert is_of_wall(driver, 3.0 - mount.x)


@pytest.mark.parametrize("name", LEFT)
async def test_a_laser_left_scanning_at_another_speed_is_found(name: str) -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, name, serial=True) as unit:
        link = await unit.open()
        for baud, data in LEFT[name]:
            await link.set_speed(baud)
            await link.write(data)
            await asyncio.sleep(0.5)
        await link.close()
        assert unit.laser.device.speed == LEFT[name][-1][0]
        driver = unit.driver()
        async with running(driver.run()):
            await next_scan(driver, FIRST)
            await asyncio.sleep(1)
            assert driver.connected
            assert driver.losses == 0


@pytest.mark.parametrize("how", HOWS)
async def test_faults_that_come_again_and_again_are_survived(how: str) -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, "utm-30lx", serial=True) as unit:
        driver = unit.driver()
        async with running(driver.run()):
            await next_scan(driver, FIRST)
            for number in range(5):
                await asyncio.sleep(1)
                await happen(unit, how)
                await next_scan(driver, STARTS["utm-30lx"] + AGAIN)
                assert driver.losses == number + 1


async def test_a_driver_waits_for_a_laser_that_comes_later() -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, "urg-04lx", serial=True) as unit:
        unit.unplug()
        driver = unit.driver()
        async with running(driver.run()):
            await asyncio.sleep(60)
            assert driver.status.latest is not None
            assert driver.losses == 0
            assert "no such port" in str(driver.presence)
            unit.plug_in()
            await next_scan(driver, FIRST)


async def test_a_robot_in_the_place_of_the_laser_is_left_alone() -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, "utm-30lx", serial=True) as unit:
        driver = unit.driver()
        unit.plugged = False
        driver.config = driver.config.__class__(url="/dev/robot", open=robot.open)
        async with running(driver.run()):
            await asyncio.sleep(10)
            assert not driver.connected
            assert not robot.powered


@pytest.mark.parametrize(("name", "serial"), UNITS)
async def test_noise_on_the_cable_costs_scans_but_not_the_laser(name: str, *, serial: bool) -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, name, serial=serial) as unit:
        driver = unit.driver()
        async with running(driver.run()):
            await next_scan(driver, FIRST)
            before = driver.scans
            unit.laser.faults = LinkFaults(corrupt=1e-4, seed=3)
            await asyncio.sleep(10)
            assert driver.scans - before > 10
            unit.laser.faults = LinkFaults()
            await next_scan(driver, AGAIN)


async def test_leaving_ends_the_scans() -> None:
    async with SimulatedRobot() as robot, LaserUnit(robot, "urg-04lx", serial=True) as unit:
        driver = unit.driver()
        async with running(driver.run()):
            await next_scan(driver, FIRST)
            assert unit.laser.device.turn is not None
        await asyncio.sleep(1)
        assert unit.laser.device.turn is None
