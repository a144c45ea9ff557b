"""What happens to a robot and its driver when the link fails in mid-session. Virtual time."""

import asyncio
from math import hypot
from random import Random

import pytest

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.supervisor import Connection
from pioneer3.runtime.robot import Robot
from tests.faults import Noise
from tests.support import SimulatedRobot, frame, hold, is_at, moves, until

STOP = bytes.fromhex("fafb031d001d")
FRESH = 0.6  # a pause longer than the expiry of 0.5 s
ON = commands.Enable(on=True)


def now() -> float:
    return asyncio.get_running_loop().time()


def velocities(sent: list[Command]) -> set[float]:
    return {command.speed for command in sent if isinstance(command, commands.Vel)}


async def reconnected(driver: Robot, sessions: int = 2) -> None:
    async for snapshot in driver.snapshots(30, patience=30):
        if snapshot.link.sessions == sessions:
            return
    raise AssertionError("did not reconnect")


async def lose(robot: SimulatedRobot, how: str) -> float:
    """Spoil the link for a while; return when the robot is back [s]."""
    match how:
        case "silent for 10 s":
            robot.silent = True
            await asyncio.sleep(10)
            robot.silent = False
        case "unplugged":
            await robot.unplug()
            await asyncio.sleep(5)
            robot.plugged = True
        case "power cycle":
            robot.silent = True
            await asyncio.sleep(3)
            robot.power_cycle()
            robot.silent = False
    return now()


HOWS = ["silent for 10 s", "unplugged", "power cycle"]


@pytest.mark.parametrize("how", HOWS)
async def test_after_a_loss_a_stick_that_was_held_all_through_moves_nothing(how: str) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.3, seconds=2)
        assert robot.speed == pytest.approx(0.3, abs=0.01)
        holding = asyncio.ensure_future(hold(driver, 0.3, seconds=30))
        back = await lose(robot, how)
        await reconnected(driver)
        await asyncio.sleep(1.5)
        stood_at = robot.body.robot_in_world
        await holding
        assert is_at(robot.body.robot_in_world, stood_at)
        assert not robot.powered
        last = robot.wires[-1]
        if how != "power cycle":  # it still streams reports
            assert b"".join(data for when, data in last.chunks if when >= back).startswith(STOP)
        assert ON not in last.commands
        assert velocities(last.commands) <= {0.0}
        assert "let go, then ask again" in str(driver.why_not_moving())


@pytest.mark.parametrize("how", HOWS)
async def test_after_a_loss_a_fresh_command_drives_again(how: str) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.3, seconds=2)
        await lose(robot, how)
        await reconnected(driver)
        await asyncio.sleep(FRESH)
        assert robot.speed == 0
        assert not robot.powered
        assert await hold(driver, 0.3, seconds=2) == 0
        assert robot.speed == pytest.approx(0.3, abs=0.01)
        assert driver.snapshot is not None
        assert driver.snapshot.link.sessions == 2


@pytest.mark.parametrize("how", HOWS)
async def test_a_move_that_loses_the_link_fails_and_does_not_go_on_later(how: str) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        moving = asyncio.ensure_future(driver.move(5.0))
        await asyncio.sleep(2)
        await lose(robot, how)
        await reconnected(driver)
        with pytest.raises(MotionError):
            await moving
        await asyncio.sleep(1.0)
        stood_at = robot.body.robot_in_world
        await asyncio.sleep(5.0)
        assert is_at(robot.body.robot_in_world, stood_at)
        await driver.move(0.2)
        assert robot.body.robot_in_world.x == pytest.approx(stood_at.x + 0.2, abs=0.01)


async def test_a_move_whose_link_is_back_at_once_does_not_go_on_either() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        moving = asyncio.ensure_future(driver.move(5.0))
        await asyncio.sleep(2)
        await robot.unplug()
        robot.plugged = True
        with pytest.raises(MotionError, match="the link was lost"):
            await moving
        assert now() < 2 + 1.5
        await asyncio.sleep(3)
        assert robot.speed == 0
        assert ON not in robot.wires[-1].commands


async def test_a_move_does_not_wait_for_ever_for_a_robot_that_stays_away() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        moving = asyncio.ensure_future(driver.move(5.0))
        await asyncio.sleep(2)
        await robot.unplug()
        with pytest.raises(MotionError, match="No robot is connected"):
            await moving
        assert now() < 2 + 3


async def test_while_the_link_is_lost_the_driver_says_so() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await robot.unplug()
        await asyncio.sleep(1)
        assert driver.snapshot is None
        assert driver.supervisor.status.latest is not None
        assert driver.supervisor.status.latest.connection in {
            Connection.LOST,
            Connection.CONNECTING,
        }
        with pytest.raises(MotionError, match="the link was lost"):
            driver.drive(0.1)
        assert "No robot is connected" in str(driver.why_not_moving())


async def test_odometry_goes_on_where_it_was_after_a_power_cycle() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await driver.move(0.5)
        await driver.turn(1.0)
        before = driver.snapshot
        assert before is not None
        robot.silent = True
        await asyncio.sleep(3)
        robot.power_cycle()
        robot.silent = False
        await reconnected(driver)
        after = driver.snapshot
        assert after is not None
        assert is_at(robot.body.robot_in_odom, Pose2())
        assert is_at(after.odometry.robot_in_odom, before.odometry.robot_in_odom)
        assert not after.motors.enabled
        await driver.move(0.3)
        end = driver.snapshot
        assert end is not None
        here, there = before.odometry.robot_in_odom, end.odometry.robot_in_odom
        assert hypot(there.x - here.x, there.y - here.y) == pytest.approx(0.3, abs=0.01)


async def test_the_robot_stands_by_itself_when_nothing_reaches_it() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.2, seconds=2)
        robot.silent = True
        stopping = await until(lambda: robot.speed == 0)
        assert stopping <= 2.0 + 0.2 / driver.info.limits.deceleration + 0.1


async def test_reconnecting_is_tried_for_as_long_as_it_takes() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await robot.unplug()
        await asyncio.sleep(300)
        robot.plugged = True
        await reconnected(driver)
        assert await hold(driver, 0.2) == 0  # nobody has asked for long: fresh at once


async def test_losing_a_session_before_its_first_report_is_one_more_attempt() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        robot.to_robot = lambda data: ()
        await robot.unplug()
        robot.plugged = True
        await asyncio.sleep(30)
        robot.to_robot = lambda data: (data,)
        await reconnected(driver)


async def test_one_byte_in_a_hundred_spoilt_for_a_minute_is_survived() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        robot.to_robot = Noise(Random(1), corrupt=0.01)
        robot.to_host = Noise(Random(2), corrupt=0.01)
        fastest, waited = 0.0, []
        while now() < 60:
            await hold(driver, 0.2, 0.3, seconds=1.5)
            fastest = max(fastest, robot.speed)
            driver.stop()
            waited.append(await until(lambda: not moves(robot.body.drive)))
            await asyncio.sleep(FRESH)
        assert max(waited) <= 1.5
        assert 0.15 < fastest < 0.21
        quality = driver.snapshot.link if driver.snapshot else None
        assert quality is not None
        assert quality.bad_checksums > 50


async def test_bytes_lost_now_and_then_are_survived_too() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        robot.to_robot = Noise(Random(3), drop=0.01)
        robot.to_host = Noise(Random(4), drop=0.01)
        await hold(driver, 0.2, seconds=30)
        assert await until(lambda: robot.speed == 0) <= 1.5


async def test_a_program_that_slept_finds_that_its_command_is_stale() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.2, seconds=1.0)
        loop = asyncio.get_running_loop()
        loop._autojump.now += 1.9  # type: ignore[attr-defined]  # as SIGSTOP, short of a lost link
        await asyncio.sleep(0.3)
        await hold(driver, 0.2, seconds=1.0)
        assert robot.speed > 0.1


async def test_a_command_on_the_wire_when_the_link_fails_is_not_sent_again() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.3, seconds=1)
        driver.send(commands.named("SOUNDTOG", False))
        await robot.unplug()
        robot.plugged = True
        await reconnected(driver)
        assert frame(commands.named("SOUNDTOG", False)) not in robot.wires[-1].data
