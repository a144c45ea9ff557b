"""Motions that go on beside their program, and the nearest thing around. Virtual time."""

import asyncio
from collections.abc import Callable
from math import degrees, inf, nan, pi, radians

import pytest

from pioneer3 import connect_async
from pioneer3.arcos import commands
from pioneer3.behaviors import Buffer
from pioneer3.behaviors.modes import goto, wander
from pioneer3.errors import CommandError, DeviceError, LinkError, MotionError
from pioneer3.geometry import Pose2
from pioneer3.runtime.robot import Robot
from tests.support import STAYED, SimulatedRobot, wall_at


async def seconds_until_done(driver: Robot) -> float:
    clock = asyncio.get_running_loop().time
    begin = clock()
    async for _ in driver.snapshots():
        if driver.is_move_done():
            break
    return clock() - begin


async def test_a_move_goes_on_while_its_program_does_something_else() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        assert driver.is_move_done()
        driver.start_move(1.0, speed=0.5)
        assert not driver.is_move_done()
        await asyncio.sleep(1.5)
        assert robot.speed > 0.2
        assert 0.5 < await seconds_until_done(driver) < 4
        assert robot.body.robot_in_world.x == pytest.approx(1.0, abs=0.01)
        await asyncio.sleep(1)
        assert driver.is_move_done()
        assert robot.speed == 0


async def test_a_turn_is_by_an_angle_or_to_a_heading_by_the_shorter_way() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.set_delta_heading(radians(120))
        await seconds_until_done(driver)
        assert degrees(robot.body.robot_in_world.theta) == pytest.approx(120, abs=2)
        driver.set_heading(radians(-120))
        assert await seconds_until_done(driver) < 6
        assert degrees(robot.body.robot_in_world.theta) == pytest.approx(-120, abs=3)


@pytest.mark.parametrize(
    "command",
    [
        lambda driver: driver.drive(0.0, 0.0),
        lambda driver: driver.drive_wheels(0.0, 0.0),
        lambda driver: driver.stop(),
        lambda driver: driver.start_move(0.0),
        lambda driver: driver.set_delta_heading(0.0),
        lambda driver: driver.move(0.0),
        lambda driver: driver.turn(0.0),
        lambda driver: driver.run(goto(0.4, 0.0), 0.0),
    ],
    ids=["drive", "drive_wheels", "stop", "start_move", "set_delta_heading", "move", "turn", "run"],
)
async def test_the_next_command_ends_it(command: Callable[[Robot], object]) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.start_move(5.0, speed=0.3)
        await asyncio.sleep(1)
        result = command(driver)
        if asyncio.iscoroutine(result):
            await result
        await asyncio.sleep(2)
        assert robot.speed == 0
        assert robot.body.robot_in_world.x < 0.6
        assert driver.is_move_done()


async def test_one_that_did_not_begin_yet_is_ended_as_well() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.start_move(5.0)
        driver.stop()
        await asyncio.sleep(1)
        assert robot.body.robot_in_world.x == pytest.approx(0, abs=STAYED)


async def test_somebody_elses_stop_ends_it_with_the_reason() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.start_move(5.0)
        await asyncio.sleep(1)
        driver.arbiter.stop()
        await asyncio.sleep(2)
        assert robot.speed == 0
        for _ in range(2):
            with pytest.raises(MotionError, match="move: somebody stopped the robot"):
                driver.is_move_done()


async def test_a_wall_ends_it_with_the_reason_though_nobody_asks() -> None:
    async with SimulatedRobot(wall_at(1.0)) as robot, connect_async(robot.open) as driver:
        driver.start_move(3.0, speed=0.3)
        await asyncio.sleep(12)
        with pytest.raises(MotionError, match="stall"):
            driver.is_move_done()
        assert robot.speed == 0


async def test_a_lost_link_ends_it_and_the_robot_stands_when_it_is_back() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.start_move(5.0, speed=0.3)
        await asyncio.sleep(1)
        robot.silent = True
        await asyncio.sleep(5)
        with pytest.raises(MotionError) as failure:
            driver.is_move_done()
        assert isinstance(failure.value.__cause__, LinkError)
        with pytest.raises(LinkError):
            driver.nearest()
        with pytest.raises(MotionError):
            driver.set_heading(1.0)
        robot.silent = False
        await asyncio.sleep(5)
        assert driver.snapshot is not None
        assert robot.speed == 0


async def test_the_end_of_the_connection_ends_it() -> None:
    async with SimulatedRobot() as robot:
        async with connect_async(robot.open) as driver:
            driver.start_move(5.0)
            await asyncio.sleep(1)
        await asyncio.sleep(2)
        assert robot.speed == 0
        assert driver.is_move_done()


async def test_a_latched_emergency_stop_refuses_it_at_once() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.emergency_stop()
        with pytest.raises(MotionError, match="emergency stop"):
            driver.start_move(1.0)
        assert robot.speed == 0


@pytest.mark.parametrize("number", [nan, inf, "1"])
async def test_what_is_no_number_is_refused_and_ends_nothing(number: float) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.start_move(0.5)
        for refused in (driver.start_move, driver.set_heading, driver.set_delta_heading):
            with pytest.raises(CommandError):
                refused(number)
        with pytest.raises(CommandError, match="start must be"):
            driver.nearest(number)
        await seconds_until_done(driver)
        assert robot.body.robot_in_world.x == pytest.approx(0.5, abs=0.01)


async def test_the_nearest_thing_has_a_distance_and_a_bearing() -> None:
    async with SimulatedRobot(wall_at(2.0)) as robot, connect_async(robot.open) as driver:
        await asyncio.sleep(1.5)
        ahead = driver.nearest(radians(-30), radians(30))
        assert ahead.distance == pytest.approx(2.0, abs=0.1)
        assert abs(ahead.bearing) < radians(16)
        assert driver.nearest() == driver.nearest(-pi, pi, Buffer.CURRENT) == ahead
        assert driver.nearest(radians(150), radians(-150)).distance == inf
        assert robot.body.robot_in_world == Pose2()


async def test_nobody_takes_blindness_for_room() -> None:
    async with SimulatedRobot(wall_at(2.0)) as robot, connect_async(robot.open) as driver:
        driver.send(commands.Sonar(on=False))
        await asyncio.sleep(3)
        with pytest.raises(DeviceError, match="no range sensor works"):
            driver.nearest()
        assert robot.speed == 0


async def test_a_mode_that_another_starts_is_named_by_its_end() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.start_move(5.0)
        await asyncio.sleep(1)
        driver.arbiter.start(wander())
        await asyncio.sleep(1)
        with pytest.raises(MotionError, match="move: the mode wander was started"):
            driver.is_move_done()
