"""How exactly the robot gets where it is told to. Virtual time."""

import asyncio
from dataclasses import replace
from math import degrees, nan, pi

import pytest

from pioneer3.arcos import commands
from pioneer3.errors import CommandError, MotionError
from pioneer3.geometry import Pose2, wrap
from pioneer3.navigation.connect import connect_async
from tests.support import SimulatedRobot, bound, decoded, is_at

MODELS = ["p3at-sh", "p3dx-sh", "amigo-sh"]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("distance", [1.0, -0.5, 0.05, 3.0])
async def test_a_move_ends_within_a_centimetre(model: str, distance: float) -> None:
    async with SimulatedRobot(model=model) as robot, connect_async(robot.open) as driver:
        await driver.move(distance)
        await asyncio.sleep(1)
        here = robot.body.robot_in_world
        assert here.x == pytest.approx(distance, abs=0.010)
        assert here.y == pytest.approx(0, abs=0.010)
        assert abs(degrees(here.theta)) < 1
        assert robot.speed == 0


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("angle", [pi / 2, -pi / 2, 3 * pi, -0.1])
async def test_a_turn_ends_within_a_degree(model: str, angle: float) -> None:
    async with SimulatedRobot(model=model) as robot, connect_async(robot.open) as driver:
        turned, last = 0.0, 0.0
        turning = asyncio.ensure_future(driver.turn(angle))
        while not turning.done() or robot.body.speeds[1]:
            await asyncio.sleep(0.02)
            theta = robot.body.robot_in_world.theta
            turned, last = turned + wrap(theta - last), theta
        await turning
        assert driver.snapshot is not None
        believed = driver.snapshot.odometry.robot_in_odom.theta
        assert abs(degrees(wrap(believed - angle))) < 1.0
        # four wheels slip when they turn
        assert degrees(turned) == pytest.approx(degrees(angle), abs=1.0, rel=0.01)
        assert robot.body.robot_in_world.x == pytest.approx(0, abs=0.001)


async def test_a_square_ends_where_it_began() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        for _ in range(4):
            await driver.move(1.0)
            await driver.turn(pi / 2)
        here = robot.body.robot_in_world
        assert here.x == pytest.approx(0, abs=0.08)
        assert here.y == pytest.approx(0, abs=0.08)


async def test_nothing_to_do_is_done_at_once() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await driver.move(0)
        await driver.turn(0.0)
        assert asyncio.get_running_loop().time() < 1
        assert is_at(robot.body.robot_in_world, Pose2())


async def test_a_move_keeps_to_its_speed() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        moving = asyncio.ensure_future(driver.move(1.0, speed=0.15))
        fastest = 0.0
        while not moving.done():
            await asyncio.sleep(0.02)
            fastest = max(fastest, robot.speed)
        await moving
        assert fastest == pytest.approx(0.15, abs=0.001)


async def test_an_option_bounds_every_speed() -> None:
    async with (
        SimulatedRobot() as robot,
        connect_async(robot.open, max_speed=0.2, max_turn_rate=0.5) as driver,
    ):
        moving = asyncio.ensure_future(driver.move(1.5, speed=1.0))
        fastest = 0.0
        while not moving.done():
            await asyncio.sleep(0.02)
            fastest = max(fastest, robot.speed)
        await moving
        assert fastest == pytest.approx(0.2, abs=0.001)
        turning = asyncio.ensure_future(driver.turn(2.0, rate=3.0))
        while not turning.done():
            await asyncio.sleep(0.02)
            fastest = max(fastest, robot.body.speeds[1])
        await turning
        assert 0.4 < fastest < bound(0.51, 0.53)


async def test_somebody_elses_stop_ends_a_move() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        moving = asyncio.ensure_future(driver.move(5.0))
        await asyncio.sleep(2)
        driver.stop()
        with pytest.raises(MotionError, match="somebody stopped the robot"):
            await moving
        await asyncio.sleep(2)
        assert robot.speed == 0
        assert robot.body.robot_in_world.x < 2


async def test_a_second_move_does_not_mix_with_the_first() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        first = asyncio.ensure_future(driver.move(1.0))
        await asyncio.sleep(0.5)
        second = asyncio.ensure_future(driver.turn(1.0))
        await asyncio.gather(first, second)
        assert robot.body.robot_in_world.x == pytest.approx(1.0, abs=0.02)


async def test_cancelling_a_move_stops_the_robot() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(2):
                await driver.move(5.0)
        await asyncio.sleep(1.5)
        assert robot.speed == 0
        await driver.move(-0.1)


@pytest.mark.parametrize(
    ("method", "arguments", "says"),
    [
        ("move", (float("nan"),), "distance must be finite"),
        ("move", ("1",), "distance must be a number, not '1'"),
        ("move", (None,), "distance must be a number, not None"),
        ("move", (1.0, 0.0), "speed must be positive, not 0"),
        ("move", (1.0, -0.1), "speed must be positive"),
        ("move", (1.0, True), "speed must be a number, not True"),
        ("turn", (float("inf"),), "angle must be finite"),
        ("turn", ([1],), "angle must be a number"),
        ("turn", (1.0, float("nan")), "rate must be finite"),
        ("turn", (1.0, -1), "rate must be positive"),
    ],
)
async def test_what_is_no_motion_is_refused_by_name(
    method: str, arguments: tuple[object, ...], says: str
) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        with pytest.raises(CommandError, match=says):
            await getattr(driver, method)(*arguments)
        await asyncio.sleep(0.5)
        assert not robot.powered


@pytest.mark.parametrize(
    ("speed", "turn_rate"),
    [
        (float("nan"), 0.0),
        (0.0, float("nan")),
        (float("inf"), 0.0),
        (0.0, float("-inf")),
        ("0.2", 0.0),
        (True, 0.0),
        (None, 0.0),
        (0.2, None),
        (10**400, 0.0),
        (1 + 2j, 0.0),
    ],
)
async def test_what_is_no_velocity_is_refused_and_does_not_keep_the_robot_going(
    speed: float, turn_rate: float
) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.drive(0.2)
        await asyncio.sleep(0.4)
        for _ in range(20):
            with pytest.raises(CommandError):
                driver.drive(speed, turn_rate)
            await asyncio.sleep(0.1)
        assert robot.speed == 0


async def test_huge_velocities_are_cut_to_the_limits() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        end = asyncio.get_running_loop().time() + 12
        while asyncio.get_running_loop().time() < end:
            driver.drive(1e300)
            await asyncio.sleep(0.1)
        assert robot.speed == pytest.approx(driver.info.limits.max_speed, abs=0.002)


async def test_accelerations_that_are_changed_reach_a_standing_robot_at_once() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await asyncio.sleep(1.0)
        before = len(robot.wires[0].data)
        driver.supervisor.change_limits(lambda limits: replace(limits, acceleration=0.4))
        await asyncio.sleep(0.25)
        assert commands.SetA(acceleration=0.4) in decoded(robot.wires[0].data[before:])


async def test_wheels_of_each_side_have_the_speeds_that_they_were_told() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        for _ in range(15):
            driver.drive_wheels(0.3, 0.1)
            await asyncio.sleep(0.1)
        assert driver.snapshot is not None
        moving = driver.snapshot.odometry
        assert (moving.left_speed, moving.right_speed) == pytest.approx((0.3, 0.1), abs=0.02)
        driver.drive_wheels(90.0, 90.0)
        await asyncio.sleep(0.3)
        assert robot.speed <= driver.info.limits.max_speed
        await asyncio.sleep(2.5)
        assert robot.speed == 0.0
        with pytest.raises(CommandError, match="left must be finite"):
            driver.drive_wheels(nan, 0.0)
