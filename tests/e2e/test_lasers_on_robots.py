"""Robot and lasers, each on its own link: losses of either, poses, recordings. Virtual time."""

import asyncio
from dataclasses import replace
from math import isfinite, isnan, pi, radians, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.arcos import commands
from pioneer3.behaviors.actions import RatioInput
from pioneer3.behaviors.modes import wander
from pioneer3.behaviors.modes.by_hand import teleop
from pioneer3.geometry import Pose2
from pioneer3.lasers.client import ScanSettings
from pioneer3.maps import LineMap
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.lasers.mounting import Mounting, Sector
from pioneer3.robot.supervisor import Connection
from pioneer3.runtime.robot import Robot
from pioneer3.sim.realism import Realism
from pioneer3.state import Scan
from tests.lasers import LaserUnit
from tests.support import SimulatedRobot, hold, until

FAST = 0.6
BY_SONAR = 0.4
"""Speed of a mode whose laser is lost [m/s]."""
TWO_WHEELS = "p3dx-sh"
"""A robot that turns without slip: its odometry tells where its points are."""
HALF = 3.0
"""Half the side of the room [m]."""


def room(half: float = HALF) -> LineMap:
    """Return a square room about the origin."""
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    walls = [(*one, *other) for one, other in zip(corners, corners[1:] + corners[:1], strict=True)]
    return LineMap(name="room", walls=np.array(walls))


def laser_of(robot: Robot, number: int = 0) -> LaserDriver:
    laser = robot.lasers[number]
    assert isinstance(laser, LaserDriver)
    return laser


async def scanning(robot: Robot) -> None:
    """Wait until all lasers scan."""
    await until(lambda: all(laser.lost is None for laser in robot.lasers))


def misses(scan: Scan, half: float = HALF) -> NDArray[np.float64]:
    """Return how far each point is off the walls of the room [m]."""
    points = np.array(scan.points_in_odom())
    assert len(points) > 50
    off: NDArray[np.float64] = np.abs(np.max(np.abs(points), axis=1) - half)
    return off


@pytest.mark.parametrize(
    ("name", "serial"),
    [
        ("utm-30lx", True),
        ("urg-04lx", True),
        ("lms-200", True),
        ("lms-111", False),
        ("tim551", False),
    ],
)
async def test_points_land_on_the_walls_while_the_robot_turns(name: str, *, serial: bool) -> None:
    async with (
        SimulatedRobot(room(), model=TWO_WHEELS) as robot,
        LaserUnit(robot, name, serial=serial) as unit,
        connect_async(robot.open, lasers=[unit.spec()]) as driver,
    ):
        await scanning(driver)
        turning = asyncio.ensure_future(hold(driver, 0.0, radians(60), seconds=4.0))
        await asyncio.sleep(2)
        corrected, bent = [], []
        while not turning.done():
            scan = await driver.laser.reading()
            corrected.append(misses(scan).max())
            bent.append(misses(replace(scan, last_in_odom=None)).max())
        assert robot.body.speeds[1] == pytest.approx(radians(60), rel=0.01)
        assert len(corrected) >= 8
        assert np.mean(corrected) < 0.02
        assert np.mean(bent) > 0.02
        assert np.mean(bent) > 1.4 * np.mean(corrected)


@pytest.mark.parametrize("name", ["utm-30lx", "lms-111", "tim551"])
async def test_with_all_errors_points_are_off_by_those_of_the_laser(name: str) -> None:
    async with (
        SimulatedRobot(room(), realism=Realism(), seed=3) as robot,
        LaserUnit(robot, name, serial=False) as unit,
        connect_async(robot.open, lasers=[unit.spec()]) as driver,
    ):
        await scanning(driver)
        error = next(e for e in unit.laser.model.errors if e.up_to >= HALF)
        off = np.concatenate([misses(await driver.laser.reading()) for _ in range(10)])
        farthest = error.systematic + error.share * HALF * sqrt(2) + 4 * error.sigma
        assert np.mean(off <= farthest) > 0.999
        assert np.mean(off) > 0.3 * error.sigma


async def test_points_land_on_the_walls_while_the_robot_drives() -> None:
    async with (
        SimulatedRobot(room()) as robot,
        LaserUnit(robot, "tim551", serial=False) as unit,
        connect_async(robot.open, lasers=[unit.spec()]) as driver,
    ):
        await scanning(driver)
        driving = asyncio.ensure_future(hold(driver, 0.5, 0.0, seconds=3.0))
        await asyncio.sleep(1)
        while not driving.done():
            assert misses(await driver.laser.reading()).max() < 0.02


async def test_a_laser_that_is_lost_slows_the_mode_down_to_what_sonar_allows() -> None:
    async with (
        SimulatedRobot(room(30.0)) as robot,
        LaserUnit(robot, "utm-30lx", serial=True) as unit,
        connect_async(robot.open, lasers=[unit.spec()]) as driver,
    ):
        await scanning(driver)
        running = asyncio.ensure_future(driver.run(wander(preset="aria", speed=FAST)))
        await until(lambda: robot.speed > BY_SONAR + 0.1)
        unit.unplug()
        await until(lambda: not laser_of(driver).connected)
        await asyncio.sleep(1.5)
        assert 0.1 < robot.speed <= BY_SONAR + 0.01
        assert any("the laser is lost: goes by sonar" in words for words in driver.arbiter.told)
        unit.plug_in()
        await until(lambda: laser_of(driver).connected, within=5)
        await until(lambda: robot.speed > BY_SONAR + 0.1)
        assert not any("lost" in words for words in driver.arbiter.told)
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)


async def test_people_who_drive_are_not_slowed_down_by_a_lost_laser() -> None:
    async with (
        SimulatedRobot(room(30.0)) as robot,
        LaserUnit(robot, "utm-30lx", serial=True) as unit,
        connect_async(robot.open, lasers=[unit.spec()]) as driver,
    ):
        unit.unplug()
        await hold(driver, FAST, seconds=4.0)
        assert robot.speed == pytest.approx(FAST, abs=0.02)


async def test_with_a_laser_that_looks_ahead_alone_a_robot_only_creeps_back() -> None:
    stick = RatioInput(full_backwards=0.4)
    async with (
        SimulatedRobot(room()) as robot,
        LaserUnit(robot, "lms-200") as unit,
        connect_async(robot.open, lasers=[unit.spec()]) as driver,
    ):
        await scanning(driver)
        driver.send(commands.Sonar(on=False))
        await until(lambda: not driver.snapshot.sonar.enabled if driver.snapshot else False)
        await asyncio.sleep(1.5)
        driver.arbiter.start(teleop(stick))
        stick.push(-1.0, 0.0)
        await asyncio.sleep(3)
        assert robot.speed == pytest.approx(-0.04, abs=0.01)
        assert any("nothing looks behind" in words for words in driver.arbiter.told)
        driver.send(commands.Sonar(on=True))
        await asyncio.sleep(2)
        assert robot.speed == pytest.approx(-0.4, abs=0.02)
        assert not any("nothing looks behind" in words for words in driver.arbiter.told)


async def test_a_laser_scans_on_while_the_robot_is_lost() -> None:
    async with (
        SimulatedRobot(room()) as robot,
        LaserUnit(robot, "utm-30lx", serial=True) as unit,
        connect_async(robot.open, lasers=[unit.spec()]) as driver,
    ):
        await scanning(driver)
        await robot.unplug()
        await until(lambda: driver.snapshot is None)
        laser = laser_of(driver)
        before = laser.scans
        await asyncio.sleep(5)
        assert laser.scans - before == pytest.approx(200, abs=3)
        assert laser.losses == 0
        robot.plugged = True
        await until(lambda: driver.snapshot is not None)
        assert laser.losses == 0
        assert misses(await driver.laser.reading()).max() < 0.02


async def test_losing_the_laser_costs_the_robot_nothing() -> None:
    async with (
        SimulatedRobot(room()) as robot,
        LaserUnit(robot, "lms-111", serial=False) as unit,
        connect_async(robot.open, lasers=[unit.spec()]) as driver,
    ):
        await scanning(driver)
        for _ in range(5):
            unit.unplug()
            await asyncio.sleep(1)
            unit.plug_in()
            await asyncio.sleep(2)
        snapshot = driver.snapshot
        assert snapshot is not None
        assert snapshot.link.sessions == 1
        assert snapshot.link.rate == pytest.approx(10, abs=1)
        await driver.move(0.3)


async def test_several_lasers_look_from_their_own_places() -> None:
    front = Mounting(sensor_in_robot=Pose2(0.2, 0.0, 0.0), masked=(Sector(-pi, -2.0),))
    rear = Mounting(sensor_in_robot=Pose2(-0.25, 0.1, pi), upside_down=True)
    async with SimulatedRobot(room()) as robot:
        mount = robot.body.model.laser
        assert mount is not None
        place = Mounting(sensor_in_robot=Pose2(mount.x, mount.y, mount.theta))
        async with (
            LaserUnit(robot, "utm-30lx", serial=True) as one,
            LaserUnit(robot, "tim551", serial=False, name_in_scans="laser2") as other,
            connect_async(
                robot.open, lasers=[one.spec(replace(place, masked=front.masked)), other.spec(rear)]
            ) as driver,
        ):
            await scanning(driver)
            assert [laser.name for laser in driver.lasers] == ["laser", "laser2"]
            first = await driver.lasers[0].reading()
            second = await driver.lasers[1].reading()
            assert misses(first).max() < 0.02
            masked = [r for a, r in zip(first.angles, first.ranges, strict=True) if a <= -2.0]
            assert masked
            assert all(isnan(metres) for metres in masked)
            assert second.sensor_in_robot == rear.sensor_in_robot
            assert second.laser == "laser2"
            assert second.beam_time < 0  # upside down
            await asyncio.sleep(0.1)  # the next snapshot
            situation = driver.arbiter.situation()
            assert situation is not None
            assert situation.scan is not None
            assert situation.scan.laser == "laser"
            other.unplug()
            await until(lambda: not laser_of(driver, 1).connected)
            situation = driver.arbiter.situation()
            assert situation is not None
            assert situation.lost_lasers == ("the laser2 is lost",)
            assert laser_of(driver).connected


async def test_settings_reach_the_laser() -> None:
    settings = ScanSettings(first=-1.0, last=0.5, skip=1, intensities=True)
    async with (
        SimulatedRobot(room()) as robot,
        LaserUnit(robot, "utm-30lx", serial=True) as unit,
        connect_async(robot.open, lasers=[unit.spec(settings=settings)]) as driver,
    ):
        await scanning(driver)
        await asyncio.sleep(2)
        scan = await driver.laser.reading()
        assert scan.angles[0] == pytest.approx(-1.0, abs=0.005)
        assert scan.angles[-1] == pytest.approx(0.5, abs=0.005)
        assert len(scan.reflectances) == len(scan.ranges)
        assert min(scan.reflectances) > 0
        assert driver.laser.rate == pytest.approx(20, abs=1)


@pytest.mark.parametrize("late", [{"time_offset": 0.2}, {"mounting": Mounting(delay=-0.2)}])
async def test_a_time_offset_or_delay_moves_stamps_and_not_the_latency(
    late: dict[str, Any],
) -> None:
    async with (
        SimulatedRobot(room()) as robot,
        LaserUnit(robot, "utm-30lx", serial=True) as unit,
        connect_async(robot.open, lasers=[unit.spec(**late)]) as driver,
    ):
        await scanning(driver)
        scan = await driver.laser.reading()
        now = asyncio.get_running_loop().time()
        assert 0.1 < scan.stamp - now < 0.2
        assert 0.0 <= laser_of(driver).latency < 0.05


@pytest.mark.parametrize(
    ("name", "serial"), [("utm-30lx", True), ("lms-200", True), ("lms-111", False)]
)
async def test_a_recorded_drive_is_played_with_its_scans(
    name: str, tmp_path: Path, *, serial: bool
) -> None:
    path = tmp_path / "drive.mcap"
    async with (
        SimulatedRobot(room()) as robot,
        LaserUnit(robot, name, serial=serial) as unit,
        connect_async(robot.open, record=path, lasers=[unit.spec()]) as driver,
    ):
        await scanning(driver)
        await driver.move(1.0)
        recorded = laser_of(driver).scans
        last = laser_of(driver).latest
        assert last is not None
    async with connect_async(f"replay:{path}", lasers=[f"replay:{path}#laser"]) as driver:
        laser = laser_of(driver)
        await until(lambda: laser.connected, within=15)
        await until(lambda: not laser.connected, within=60)
        status = laser.status.latest
        assert status is not None
        assert status.connection is Connection.CLOSED
        assert status.message.endswith("drive.mcap#laser: the recording is over")
        assert laser.scans == pytest.approx(recorded, rel=0.1, abs=3)
        assert laser.latest is not None
        seen = [r for r in laser.latest.ranges if isfinite(r)]
        assert len(seen) == len([r for r in last.ranges if isfinite(r)])
        assert min(seen) == pytest.approx(min(r for r in last.ranges if isfinite(r)), abs=0.02)
