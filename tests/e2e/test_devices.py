"""Devices through the driver, over a cable to a simulated robot, in virtual time."""

import asyncio
from collections.abc import Callable
from contextlib import AsyncExitStack, aclosing
from dataclasses import replace
from math import degrees, inf, isinf, pi, radians
from typing import Literal

import pytest
from msgspec import structs

from pioneer3.arcos import commands, reports
from pioneer3.arcos.commands import Command, GripperAction, RequestMode, SimLaserMode, Tcm2Mode
from pioneer3.arcos.packet import PacketReader, encode
from pioneer3.errors import CommandError, DeviceError
from pioneer3.geometry import Pose2
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.devices import Presence
from pioneer3.robot.devices.gripper import PaddlePosition
from pioneer3.runtime.robot import Robot
from pioneer3.sim.accessories import HeldObject
from pioneer3.sim.equipment import Equipment
from tests.support import First, SimulatedRobot, frame, lost, until, wall_at

IO_ON, IO_OFF = commands.IoRequest(RequestMode.STREAM), commands.IoRequest(RequestMode.STOP)
LASER_OFF = commands.SimLrfEnable(SimLaserMode.OFF)
EVERYTHING = Equipment(gripper=True, compass=True, gyro_type=1, camera="vcc4", camera_port=2)


def now() -> float:
    return asyncio.get_running_loop().time()


def sent(robot: SimulatedRobot, command: Command) -> int:
    """Return how often `command` came over the last cable."""
    return robot.wires[-1].data.count(frame(command))


async def new_session(driver: Robot, robot: SimulatedRobot) -> None:
    """Pull the cable out and in; return in the next session."""
    sessions = driver.supervisor.assembler.sessions
    await robot.unplug()
    await asyncio.sleep(1)
    robot.plugged = True
    await until(lambda: driver.snapshot and driver.supervisor.assembler.sessions > sessions)


class TestWhatIsAskedFor:
    async def test_it_comes_while_wanted_and_ends_with_the_last_who_wants_it(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            lines = driver.devices.lines
            with lines.wanted():
                with lines.wanted():
                    await asyncio.sleep(1.05)
                assert sent(robot, IO_OFF) == 0
                assert lines.rate == pytest.approx(10, abs=1)
            await asyncio.sleep(0.1)
            assert (sent(robot, IO_ON), sent(robot, IO_OFF)) == (1, 1)
            await asyncio.sleep(2)
            assert lines.rate == 0

    async def test_it_is_asked_for_again_after_a_reconnection(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            with driver.devices.lines.wanted():
                await asyncio.sleep(1)
                await new_session(driver, robot)
                resumed = now()
                await asyncio.sleep(1)
                latest = driver.devices.lines.latest
                assert latest is not None
                assert latest.stamp > resumed
                assert sent(robot, IO_ON) == 1

    async def test_what_was_let_go_while_the_link_was_lost_is_not_asked_for(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            with driver.devices.lines.wanted():
                await asyncio.sleep(0.5)
                await robot.unplug()
                await asyncio.sleep(1)
            robot.plugged = True
            await until(lambda: driver.snapshot)
            await asyncio.sleep(1)
            assert sent(robot, IO_ON) == 0

    async def test_a_lost_request_is_asked_again(self) -> None:
        fault = First(frame(IO_ON), lost)
        async with (
            SimulatedRobot(to_robot=fault) as robot,
            connect_async(robot.open) as driver,
        ):
            began = now()
            await driver.devices.lines.reading()
            assert 1.5 < now() - began < 2.5

    async def test_leaving_ends_it_after_a_stop(self) -> None:
        async with SimulatedRobot() as robot, AsyncExitStack() as stack:
            driver = await stack.enter_async_context(connect_async(robot.open))
            wanted = driver.devices.lines.wanted()
            wanted.__enter__()  # as by a program that is killed in the middle
            await asyncio.sleep(0.5)
            at = len(robot.wires[-1].data)
            await stack.aclose()
            await asyncio.sleep(0.1)
            farewell = robot.wires[-1].data[at:]
        ways = (commands.Stop(), IO_OFF, commands.Close())
        stop, ends, close = (farewell.find(frame(command)) for command in ways)
        assert 0 <= stop < ends < close

    async def test_a_slow_reader_gets_the_newest_and_a_subscriber_gets_all(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            with driver.supervisor.reports.subscribe(reports.Io) as heard:
                async with aclosing(driver.devices.lines.values()) as values:
                    await anext(values)
                    await asyncio.sleep(3)
                    assert now() - (await anext(values)).stamp <= 0.2
                count = 0
                async with aclosing(heard.__aiter__()) as all_of_them:
                    async for _ in all_of_them:
                        count += 1
                        if count == 30:
                            break
                assert heard.missed == 0

    async def test_readers_end_with_the_connection(self) -> None:
        async with SimulatedRobot() as robot:
            async with connect_async(robot.open) as driver:
                values = driver.devices.lines.values()
                await anext(values)
            assert [value async for value in values] == []


class TestLines:
    async def test_levels_and_voltages_are_the_robots(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            digital = robot.firmware.accessories.digital
            digital.set_input(9, high=False)
            digital.set_analog(3, 2.5)
            reading = await driver.devices.lines.reading()
            assert [line for line, high in enumerate(reading.digital_in) if not high] == [9]
            assert reading.analog[3] == pytest.approx(2.5, abs=0.005)

    async def test_one_output_is_set_and_the_others_stay(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            driver.devices.lines.set_output(2, high=False)
            driver.devices.lines.set_output(5, high=False)
            driver.devices.lines.set_output(2, high=True)
            await asyncio.sleep(0.3)
            assert robot.firmware.accessories.digital.outputs == 0xFF & ~(1 << 5)
            assert driver.snapshot is not None
            assert driver.snapshot.inputs.digital_out == 0xFF & ~(1 << 5)

    async def test_a_simulators_laser_is_not_switched_by_choosing_a_port(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            with pytest.raises(CommandError, match="laser"):
                driver.devices.lines.select_analog(2)
            driver.devices.lines.select_analog(4)
            await asyncio.sleep(0.3)
            assert driver.snapshot is not None
            assert driver.snapshot.inputs.analog_port == 4

    async def test_an_output_that_does_not_exist_is_refused(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            with pytest.raises(CommandError, match="0 to 7"):
                driver.devices.lines.set_output(8, high=True)


class TestGripper:
    async def test_it_closes_on_a_thing_and_says_so(self) -> None:
        async with (
            SimulatedRobot(equipment=EVERYTHING) as robot,
            connect_async(robot.open) as driver,
        ):
            gripper = driver.devices.gripper
            assert (await gripper.reading()).paddles is PaddlePosition.OPEN
            simulated = robot.firmware.accessories.gripper
            assert simulated is not None
            simulated.put(HeldObject(width=0.05))
            gripper.close()
            with gripper.wanted():
                await until(
                    lambda: gripper.latest and gripper.latest.paddles is PaddlePosition.CLOSED
                )
            assert gripper.latest is not None
            assert gripper.latest.inner_beam_broken
            assert simulated.opening == pytest.approx(0.05)
            assert gripper.presence == Presence(True, "The gripper answers: on the general I/O.")

    async def test_a_robot_without_one_says_how_one_knows(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            gripper = driver.devices.gripper
            assert gripper.presence.there is False
            with pytest.raises(DeviceError, match="CONFIG says HasGripper 0"):
                gripper.open()
            with gripper.wanted():
                await asyncio.sleep(0.3)
            assert "GRIPPER packet" in str(gripper.presence)
            with pytest.raises(DeviceError, match="no gripper"):
                await gripper.reading()

    async def test_where_the_standard_report_ends_early_packets_are_asked_for(self) -> None:
        async with SimulatedRobot(equipment=EVERYTHING) as robot:
            robot.edit = shorten
            async with connect_async(robot.open) as driver:
                gripper = driver.devices.gripper
                with gripper.wanted():
                    await asyncio.sleep(0.5)
                    gripper.close()
                    await until(
                        lambda: gripper.latest and gripper.latest.paddles is PaddlePosition.CLOSED,
                        5,
                    )
                assert sent(robot, commands.GripperPacRequest(RequestMode.STREAM)) == 1
                await asyncio.sleep(0.1)
                assert sent(robot, commands.GripperPacRequest(RequestMode.STOP)) == 1

    async def test_the_exercise_goes_round_until_a_key_halts_it(self) -> None:
        async with (
            SimulatedRobot(equipment=EVERYTHING) as robot,
            connect_async(robot.open) as driver,
        ):
            gripper = driver.devices.gripper
            exercise = asyncio.ensure_future(gripper.exercise())
            await asyncio.sleep(20)
            assert gripper.exercising
            gripper.lift_up()
            await asyncio.wait_for(exercise, 1)
            actions = [
                command.action
                for command in robot.wires[-1].commands
                if isinstance(command, commands.Gripper)
            ]
            up, down = GripperAction.LIFT_UP, GripperAction.LIFT_DOWN
            opened, closed = GripperAction.OPEN, GripperAction.CLOSE
            assert actions[:7] == [up, opened, closed, down, opened, up, closed]
            assert actions[-2:] == [GripperAction.HALT, up]

    async def test_a_cancelled_exercise_halts_it(self) -> None:
        async with (
            SimulatedRobot(equipment=EVERYTHING) as robot,
            connect_async(robot.open) as driver,
        ):
            exercise = asyncio.ensure_future(driver.devices.gripper.exercise())
            await asyncio.sleep(2)
            exercise.cancel()
            await asyncio.gather(exercise, return_exceptions=True)
            await asyncio.sleep(0.1)
            assert sent(robot, commands.Gripper(GripperAction.HALT)) == 1
            assert not driver.devices.gripper.exercising


class TestCompass:
    async def test_its_heading_is_clockwise_from_north(self) -> None:
        home = Pose2(0, 0, radians(30))
        async with (
            SimulatedRobot(equipment=EVERYTHING, home=home) as robot,
            connect_async(robot.open) as driver,
        ):
            reading = await driver.devices.compass.reading()
            assert degrees(reading.heading) == pytest.approx(60, abs=0.1)
            assert driver.devices.compass.presence.there

    async def test_packets_per_second_and_the_mode_left_behind(self) -> None:
        async with (
            SimulatedRobot(equipment=EVERYTHING) as robot,
            connect_async(robot.open) as driver,
        ):
            compass = driver.devices.compass
            with compass.wanted():
                await asyncio.sleep(1.5)
                assert compass.rate == pytest.approx(10, abs=1)
            await asyncio.sleep(0.1)
            assert sent(robot, commands.Tcm2(Tcm2Mode.SIP_ONLY)) == 1

    async def test_a_mode_that_somebody_chose_is_not_undone(self) -> None:
        async with (
            SimulatedRobot(equipment=EVERYTHING) as robot,
            connect_async(robot.open) as driver,
        ):
            compass = driver.devices.compass
            with compass.wanted():
                await asyncio.sleep(1)
                compass.set_mode(Tcm2Mode.OFF)
                await asyncio.sleep(5)
                assert compass.rate == 0
                assert sent(robot, commands.Tcm2(Tcm2Mode.STREAM)) == 1

    async def test_a_robot_without_one_is_silent_in_words(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            with pytest.raises(DeviceError, match="No answer from the TCM2 compass for 3 s"):
                await driver.devices.compass.reading()
            assert driver.devices.compass.presence.there is None


class TestGyro:
    async def test_its_heading_follows_a_turn(self) -> None:
        async with (
            SimulatedRobot(equipment=EVERYTHING) as robot,
            connect_async(robot.open) as driver,
        ):
            gyro = driver.devices.gyro
            with gyro.wanted():
                await asyncio.sleep(2)
                await driver.turn(pi / 2)
                await asyncio.sleep(0.5)
                assert gyro.latest is not None
                assert degrees(gyro.latest.heading) == pytest.approx(90, abs=3)

    @pytest.mark.parametrize(("kind", "words"), [(0, "no gyro"), (2, "itself")])
    async def test_others_say_why_there_are_no_samples(self, kind: int, words: str) -> None:
        async with (
            SimulatedRobot(equipment=Equipment(gyro_type=kind)) as robot,
            connect_async(robot.open) as driver,
        ):
            assert driver.devices.gyro.presence.there is False
            assert words in str(driver.devices.gyro.presence)


class TestLaser:
    async def test_a_scan_sees_the_wall_where_it_is(self) -> None:
        async with (
            SimulatedRobot(wall_at(3.0), model="p3dx-sh") as robot,
            connect_async(robot.open) as driver,
        ):
            scan = await driver.devices.laser.reading()
            assert len(scan.angles) == len(scan.ranges) == len(scan.reflectances) == 181
            assert (scan.angles[0], scan.angles[180]) == pytest.approx((-pi / 2, pi / 2))
            ahead = Pose2(scan.ranges[90], 0, 0)
            assert (scan.sensor_in_odom @ ahead).x == pytest.approx(3.0, abs=0.05)
            assert isinf(scan.ranges[0])

    async def test_it_is_off_when_nobody_wants_it_and_on_again_after_a_loss(self) -> None:
        async with SimulatedRobot(wall_at(3.0)) as robot, connect_async(robot.open) as driver:
            laser = driver.devices.laser
            with laser.wanted():
                await asyncio.sleep(1)
                await new_session(driver, robot)
                await asyncio.sleep(1.2)
                assert laser.rate == pytest.approx(10, abs=1)
            await asyncio.sleep(0.1)
            assert sent(robot, LASER_OFF) == 1
            await asyncio.sleep(1)
            assert laser.rate == 0

    async def test_its_field_of_view_can_be_chosen(self) -> None:
        async with SimulatedRobot(wall_at(3.0)) as robot, connect_async(robot.open) as driver:
            driver.devices.laser.set_up(radians(-45), radians(45), radians(0.5))
            scan = await driver.devices.laser.reading()
            assert len(scan.ranges) == 181
            assert scan.angles[90] == pytest.approx(0.0)
            assert all(r < inf for r in scan.ranges)

    async def test_that_of_a_real_robot_is_at_the_computer(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            info = driver.info
            assert info.config is not None
            driver.supervisor.info = replace(
                info,
                identity=replace(info.identity, name="lab 3"),
                config=structs.replace(info.config, serial_number="1234"),
            )
            with pytest.raises(DeviceError, match="name that port with --laser"):
                await driver.devices.laser.reading()


class TestCamera:
    @pytest.mark.parametrize("name", ["vcc4", "sony"])
    async def test_it_looks_where_it_is_told(self, name: Literal["vcc4", "sony"]) -> None:
        fitted = replace(EVERYTHING, camera=name)
        async with (
            SimulatedRobot(equipment=fitted) as robot,
            connect_async(robot.open) as driver,
        ):
            camera = driver.devices.camera(name, 2)
            await camera.connect()
            assert camera.presence.there
            camera.look(radians(40), radians(20))
            camera.zoom(0.5)
            await asyncio.sleep(4)
            assert robot.firmware.accessories.camera is not None
            at = robot.firmware.accessories.camera.position(now())
            assert (degrees(at.pan), degrees(at.tilt)) == pytest.approx((40, 20), abs=0.2)
            assert at.zoom == pytest.approx(0.5, abs=0.01)
            where = await camera.where()
            assert (degrees(where.pan), degrees(where.tilt)) == pytest.approx((40, 20), abs=0.2)

    async def test_one_upside_down_is_told_the_opposite(self) -> None:
        async with (
            SimulatedRobot(equipment=EVERYTHING) as robot,
            connect_async(robot.open) as driver,
        ):
            camera = driver.devices.camera("vcc4-inverted", 2)
            await camera.connect()
            camera.look(radians(10), radians(20))
            await asyncio.sleep(2)
            assert robot.firmware.accessories.camera is not None
            at = robot.firmware.accessories.camera.position(now())
            assert (degrees(at.pan), degrees(at.tilt)) == pytest.approx((-10, -20), abs=0.2)
            assert degrees((await camera.where()).tilt) == pytest.approx(20, abs=0.2)

    async def test_on_the_wrong_port_it_is_silent_in_words(self) -> None:
        async with (
            SimulatedRobot(equipment=EVERYTHING) as robot,
            connect_async(robot.open) as driver,
        ):
            camera = driver.devices.camera("vcc4", 1)
            assert camera.presence.there is None
            with pytest.raises(DeviceError, match="Canon VC-C4 on AUX1"):
                await camera.connect()
            assert camera.presence.there is False

    async def test_its_exercise_goes_clockwise_round_the_corners(self) -> None:
        async with (
            SimulatedRobot(equipment=EVERYTHING) as robot,
            connect_async(robot.open) as driver,
        ):
            camera = driver.devices.camera("vcc4", 2)
            await camera.connect()
            exercise = asyncio.ensure_future(camera.exercise())
            places = []
            for _ in range(6):
                await asyncio.sleep(6.9)
                simulated = robot.firmware.accessories.camera
                assert simulated is not None
                at = simulated.position(now())
                places.append((round(degrees(at.pan)), round(degrees(at.tilt)), at.zoom))
                await asyncio.sleep(0.1)
            exercise.cancel()
            assert places[:5] == [
                (98, 88, 0.0),
                (-98, 88, 0.0),
                (-98, -30, 0.0),
                (98, -30, 0.0),
                (0, 0, 0.0),
            ]
            assert places[5] == (98, 88, 1.0)


class TestConfigurationAndSafety:
    async def test_the_configuration_can_be_asked_for_again(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            driver.send(commands.SetV(speed=0.25))
            config = await driver.devices.configuration()
            assert config.speed_max_mm_s == 250
            assert driver.info.config == config

    async def test_a_robot_that_answers_no_more_is_silent_in_words(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            robot.to_robot = drop(commands.RequestConfig())
            with pytest.raises(DeviceError, match="No answer from CONFIG for 3 s"):
                await driver.devices.configuration()

    async def test_a_pioneer_does_not_tell_a_safety_state(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            with pytest.raises(DeviceError, match="only MTX"):
                await driver.devices.safety.ask()

    async def test_what_the_firmware_says_by_itself_is_kept(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            safety = driver.devices.safety
            robot.firmware.tell(reports.FirmwareText("hot"))
            robot.firmware.tell(reports.SafetyWarning())
            robot.firmware.tell(reports.SafetyState(1, 0x40, 0x10))
            await asyncio.sleep(0.2)
            assert (list(safety.texts), safety.warnings) == (["hot"], 1)
            assert safety.latest is not None
            assert safety.latest.estop_system == "commissioned"
            assert safety.latest.laser_system == "failure"


class TestBuiltIn:
    async def test_bumpers_and_sonars_are_in_config(self) -> None:
        robot = SimulatedRobot(model="peoplebot-sh")
        async with robot, connect_async(robot.open) as driver:
            assert "5 segments in front, 5 behind" in str(driver.devices.bumpers)
            assert driver.devices.sonars == Presence(
                True, "The robot has sonars: front and rear, says its CONFIG."
            )
            info = driver.info
            assert info.config is not None
            none = structs.replace(info.config, front_bumpers=0, rear_bumpers=0, has_front_sonar=0)
            bare = replace(info.model, front_bumpers=0, rear_bumpers=0)
            config = structs.replace(none, has_rear_sonar=0)
            driver.supervisor.info = replace(info, config=config, model=bare)
            assert driver.devices.bumpers.there is False
            assert driver.devices.sonars.there is False
            driver.supervisor.info = replace(info, config=None, model=bare)
            assert driver.devices.bumpers.there is None
            assert driver.devices.sonars.there


class TestRawCommands:
    @pytest.mark.parametrize(
        "command",
        [
            commands.Vel(speed=0.2),
            commands.Enable(on=True),
            commands.Unknown(11, bytes.fromhex("3bc800")),
        ],
    )
    async def test_motion_goes_not_past_the_limits_by_mistake(self, command: Command) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            with pytest.raises(CommandError, match="unsafe"):
                driver.send(command)

    async def test_an_unsafe_command_drives_until_a_stop(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            driver.send_unsafe(commands.Enable(on=True))
            driver.send_unsafe(commands.Vel(speed=0.2))
            await asyncio.sleep(5)
            assert robot.speed == pytest.approx(0.2, abs=0.01)
            assert driver.supervisor.pilot.blocked
            driver.stop()
            await asyncio.sleep(2)
            assert robot.speed == 0

    async def test_a_fresh_request_takes_over(self) -> None:
        async with SimulatedRobot() as robot, connect_async(robot.open) as driver:
            driver.send_unsafe(commands.Enable(on=True))
            driver.send_unsafe(commands.Vel(speed=0.2))
            await asyncio.sleep(2)
            driver.drive(0.1)
            await asyncio.sleep(0.4)
            driver.drive(0.1)
            await asyncio.sleep(0.4)
            assert robot.speed == pytest.approx(0.1, abs=0.02)
            await asyncio.sleep(3)
            assert robot.speed == 0

    @pytest.mark.parametrize("how", ["emergency", "lost", "leave"])
    async def test_every_way_out_stops_it(self, how: str) -> None:
        async with SimulatedRobot() as robot:
            async with connect_async(robot.open) as driver:
                driver.send_unsafe(commands.Enable(on=True))
                driver.send_unsafe(commands.Vel(speed=0.2))
                await asyncio.sleep(2)
                assert robot.speed == pytest.approx(0.2, abs=0.01)
                if how == "emergency":
                    driver.emergency_stop()
                elif how == "lost":
                    await new_session(driver, robot)
                if how != "leave":
                    await asyncio.sleep(2)
                    assert robot.speed == 0
            await asyncio.sleep(2)
            assert robot.speed == 0


def shorten(data: bytes) -> bytes:
    """Cut every standard report off after the sonars, as old firmware does."""
    return b"".join(
        encode(payload[: 20 + 3 * payload[19]] if is_standard(payload) else payload)
        for payload in PacketReader().feed(data, 0.0)
    )


def is_standard(payload: bytes) -> bool:
    return isinstance(reports.from_payload(payload), reports.Sip)


def drop(command: Command) -> Callable[[bytes], tuple[bytes, ...]]:
    """Return a cable that loses `command`."""
    return lambda data: (data.replace(frame(command), b""),)
