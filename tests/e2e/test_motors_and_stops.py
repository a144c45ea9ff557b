"""Motors, buttons, stalls, bumpers and the emergency stop: driver against firmware."""

import asyncio
from dataclasses import replace
from math import radians

import pytest
from msgspec import structs

from pioneer3.arcos import commands
from pioneer3.arcos.reports import Sip
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.navigation.connect import connect_async
from tests.support import (
    OUTLINE,
    SLOW,
    First,
    SimulatedRobot,
    bound,
    frame,
    hold,
    is_at,
    lost,
    until,
    wall_at,
)

ON, OFF = frame(commands.Enable(on=True)), frame(commands.Enable(on=False))
PAUSE = 0.6
EXPIRY = 0.5


def now() -> float:
    return asyncio.get_running_loop().time()


async def stands(robot: SimulatedRobot, within: float) -> float:
    """Wait until the robot stands; return how long that took."""
    return await until(lambda: max(map(abs, robot.body.speeds)) < SLOW, within)


async def test_connecting_leaves_the_motors_off_and_everything_still() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await asyncio.sleep(3)
        assert not robot.powered
        assert is_at(robot.body.robot_in_world, Pose2())
        assert ON not in robot.wires[0].data
        assert str(driver.why_not_moving()) == "Nothing is asked of it, and the motors are off."


async def test_the_first_command_switches_the_motors_on() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.drive(0.2)
        await asyncio.sleep(0.3)
        assert robot.powered
        assert robot.speed > 0
        assert driver.why_not_moving() is None


async def test_without_auto_enable_a_command_does_not() -> None:
    async with (
        SimulatedRobot() as robot,
        connect_async(robot.open, auto_enable=False) as driver,
    ):
        await hold(driver, 0.2)
        assert not robot.powered
        await driver.motors(on=True)
        assert robot.powered
        await asyncio.sleep(PAUSE)
        await hold(driver, 0.2)
        assert robot.speed > 0.1


async def test_a_lost_enable_is_sent_again() -> None:
    fault = First(ON, lost, times=2)
    async with SimulatedRobot(to_robot=fault) as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.2, seconds=2)
        assert fault.times == 0
        assert robot.powered
        assert robot.speed > 0.1


async def test_a_lost_disable_is_sent_again() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await driver.motors(on=True)
        robot.to_robot = First(OFF, lost)
        await driver.motors(on=False)
        assert not robot.powered


async def test_motors_that_never_come_on_are_named_by_whoever_needs_them() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        robot.to_robot = lambda data: (data.replace(ON, b""),)
        with pytest.raises(MotionError, match="The motors do not come on"):
            await driver.motors(on=True)
        with pytest.raises(MotionError, match="motors"):
            await driver.move(0.5)
        assert is_at(robot.body.robot_in_world, Pose2())
        robot.to_robot = lambda data: (data,)
        await asyncio.sleep(PAUSE)
        await hold(driver, 0.2)  # what kept them off is mended: a fresh command tries again
        assert robot.speed > 0.1


async def test_a_stop_button_ends_motion_and_releasing_it_starts_nothing() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.3, seconds=2)
        holding = asyncio.ensure_future(hold(driver, 0.3, seconds=6))
        await asyncio.sleep(0.5)
        robot.body.stop_button = True
        await stands(robot, within=0.5)
        await asyncio.sleep(0.5)
        assert "stop button" in str(driver.why_not_moving())
        await asyncio.sleep(1)
        already = robot.wires[0].data.count(ON)
        robot.body.stop_button = False
        stood_at = robot.body.robot_in_world
        assert await holding > 10
        await asyncio.sleep(2)
        assert is_at(robot.body.robot_in_world, stood_at)
        assert robot.wires[0].data.count(ON) == already
        assert not robot.powered
        assert await hold(driver, 0.3) == 0
        assert robot.speed > 0.1


async def test_a_move_says_that_the_stop_button_ended_it() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        moving = asyncio.ensure_future(driver.move(5.0))
        await asyncio.sleep(2)
        robot.body.stop_button = True
        with pytest.raises(MotionError, match="stop button"):
            await moving


async def test_motors_that_go_off_by_themselves_stay_off_until_asked_for() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        holding = asyncio.ensure_future(hold(driver, 0.3, seconds=5))
        await asyncio.sleep(2)
        robot.body.enable_motors(on=False)
        await holding
        assert not robot.powered
        await asyncio.sleep(PAUSE)
        assert await hold(driver, 0.3) == 0
        assert robot.powered


async def test_driving_into_a_wall_ends_in_a_stall_that_a_held_stick_does_not_repeat() -> None:
    async with (
        SimulatedRobot(wall_at(1.0)) as robot,
        connect_async(robot.open) as driver,
    ):
        await hold(driver, 0.3, seconds=8)
        touching = robot.body.robot_in_world.x
        assert touching == pytest.approx(1.0 - robot.body.model.length_front, abs=OUTLINE)
        assert not robot.body.stalled  # it does not push any more
        assert "stalled" in str(driver.why_not_moving())
        await asyncio.sleep(PAUSE)
        assert await hold(driver, -0.2, seconds=2) == 0
        assert robot.body.robot_in_world.x < touching - 0.1


async def test_who_keeps_asking_leaves_a_wall_by_asking_for_the_other_way() -> None:
    async with (
        SimulatedRobot(wall_at(1.0)) as robot,
        connect_async(robot.open) as driver,
    ):
        await hold(driver, 0.3, seconds=6)
        touching = robot.body.robot_in_world.x
        assert "drive the other way" in str(driver.why_not_moving())
        assert await hold(driver, -0.2, seconds=2) == 0  # without a pause or a zero
        assert robot.body.robot_in_world.x < touching - 0.2
        assert await hold(driver, 0.2, seconds=0.5) == 0
        assert robot.speed > 0.1


async def test_a_move_into_a_wall_says_that_the_wheels_stalled() -> None:
    async with (
        SimulatedRobot(wall_at(1.0)) as robot,
        connect_async(robot.open) as driver,
    ):
        with pytest.raises(MotionError, match="move: the wheels stalled"):
            await driver.move(2.0)
        touching = robot.body.robot_in_world.x
        await driver.move(-0.3)
        assert robot.body.robot_in_world.x == pytest.approx(touching - 0.3, abs=0.01)


def touch_in_front(robot: SimulatedRobot) -> None:
    """Make every report say that the middle front bumper touches."""
    say = robot.firmware.information

    def information(now: float) -> Sip:
        return structs.replace(say(now), right_stall_front_bumpers=1 << 3)

    robot.firmware.information = information  # type: ignore[method-assign]


async def test_a_front_bumper_keeps_the_robot_from_pushing_on_but_not_from_leaving() -> None:
    async with SimulatedRobot() as robot:
        from dataclasses import replace

        model = replace(robot.body.model, front_bumpers=5, rear_bumpers=5)
        async with connect_async(robot.open, model=model) as driver:
            await hold(driver, 0.3)
            touch_in_front(robot)
            await asyncio.sleep(0.2)
            holding = asyncio.ensure_future(hold(driver, 0.3, seconds=2))
            await stands(robot, within=1.5)
            await asyncio.sleep(0.3)
            assert driver.snapshot is not None
            assert driver.snapshot.bumpers.front == (False, False, True, False, False)
            assert "bumper" in str(driver.why_not_moving())
            await holding
            await hold(driver, -0.2)
            assert robot.speed < -0.1
            driver.stop()
            await stands(robot, within=1.5)
            await hold(driver, 0.0, radians(30))
            assert robot.body.speeds[1] > radians(20)


async def test_the_emergency_stop_brakes_hard_switches_off_and_latches() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.6, seconds=3)
        assert robot.speed == pytest.approx(0.6, abs=0.01)
        driver.emergency_stop()
        holding = asyncio.ensure_future(hold(driver, 0.6, seconds=5))
        await stands(robot, within=bound(0.3, 0.5))  # as hard as it can, not at 0.3 m/s^2
        await asyncio.sleep(1)
        assert not robot.powered
        assert "emergency stop is latched" in str(driver.why_not_moving())
        driver.reset_emergency_stop()
        stood_at = robot.body.robot_in_world
        await holding
        assert is_at(robot.body.robot_in_world, stood_at)  # the stick was held through the reset
        assert not robot.powered
        await asyncio.sleep(PAUSE)
        assert await hold(driver, 0.2) == 0
        assert robot.speed > 0.1


async def test_while_the_emergency_stop_is_latched_nothing_moves_the_robot() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        driver.emergency_stop()
        for _ in range(20):
            with pytest.raises(MotionError, match="emergency stop is latched"):
                driver.drive(0.1)
            with pytest.raises(MotionError, match="emergency stop is latched"):
                await driver.motors(on=True)
            with pytest.raises(MotionError, match="emergency stop is latched"):
                await driver.move(0.1)
            await asyncio.sleep(0.3)
        assert not robot.powered
        assert ON not in robot.wires[0].data
        driver.reset_emergency_stop()
        await asyncio.sleep(2)
        assert not robot.powered


async def test_the_emergency_stop_stays_latched_over_a_lost_link() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.2)
        await robot.unplug()
        await asyncio.sleep(1)
        driver.emergency_stop()
        robot.plugged = True
        await asyncio.sleep(5)
        assert driver.snapshot is not None
        with pytest.raises(MotionError, match="emergency stop is latched"):
            driver.drive(0.1)
        assert not robot.powered


async def test_an_emergency_stop_ends_a_move() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        moving = asyncio.ensure_future(driver.move(5.0))
        await asyncio.sleep(2)
        driver.emergency_stop()
        with pytest.raises(MotionError, match="emergency stop"):
            await moving


async def test_a_command_that_is_not_renewed_ends_in_a_stop() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.3, seconds=2)
        braking = 0.3 / driver.info.limits.deceleration
        assert await stands(robot, within=EXPIRY + braking + 0.1) > EXPIRY - 0.1 - 0.02
        await asyncio.sleep(0.5)
        assert "expired after 0.5 s" in str(driver.why_not_moving())


async def test_stop_stops_at_once() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.3, seconds=2)
        driver.stop()
        await stands(robot, within=0.3 / driver.info.limits.deceleration + 0.05)


@pytest.mark.parametrize("command", [commands.Stop(), commands.Vel(0.0)])
async def test_a_lost_stop_is_made_good_by_the_next_repetition(command: commands.Command) -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.3, seconds=2)
        fault = robot.to_robot = First(frame(command), lost)
        driver.stop() if isinstance(command, commands.Stop) else driver.drive(0.0)
        await stands(robot, within=0.3 + 0.3 / driver.info.limits.deceleration)
        assert fault.times == 0


async def test_the_watchdog_stops_a_robot_whose_host_is_gone_and_any_packet_revives_it() -> None:
    """Faithful to the firmware, and why a STOP comes first on every connection."""
    async with SimulatedRobot() as robot:
        link = await robot.open()
        for sync in ("fafb03000000", "fafb03010001", "fafb03020002"):
            await link.write(bytes.fromhex(sync))
        for command in (commands.Open(), commands.Enable(on=True), commands.Vel(0.3)):
            await link.write(frame(command))
        await asyncio.sleep(1.9)
        assert robot.speed == pytest.approx(0.3, abs=0.01)
        await asyncio.sleep(0.2 + 0.3 / 0.3)
        assert robot.speed == 0
        assert robot.body.drive.held
        await asyncio.sleep(20)
        assert robot.speed == 0
        await link.write(frame(commands.Pulse()))
        await asyncio.sleep(1.5)
        assert robot.speed == pytest.approx(0.3, abs=0.01)
        await link.write(frame(commands.Stop()))
        await stands(robot, within=1.1)


async def test_a_silent_host_lets_the_robot_brake_within_2_1_seconds() -> None:
    async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
        await hold(driver, 0.3, seconds=2)
        robot.to_robot = lambda data: ()
        await asyncio.sleep(2.1)
        assert robot.body.drive.held
        assert robot.speed < 0.3


async def test_changed_limits_hold_at_once_and_after_a_reconnection() -> None:
    async with SimulatedRobot() as simulated, connect_async(simulated.open) as robot:
        robot.supervisor.change_limits(lambda limits: replace(limits, acceleration=0.1))
        await hold(robot, 0.5, seconds=1.0)
        assert commands.SetA(acceleration=0.1) in simulated.wires[-1].commands
        assert 0 < simulated.speed < 0.2
        await simulated.unplug()
        simulated.plugged = True
        await until(lambda: robot.snapshot is not None and len(simulated.wires) == 2)
        assert robot.info.limits.acceleration == 0.1
        assert commands.SetA(acceleration=0.1) in simulated.wires[-1].commands
