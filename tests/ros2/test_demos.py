"""The demos as processes of their own: they find a robot by its topics and drive it."""

import asyncio
import signal
from contextlib import AsyncExitStack

import pytest

from pioneer3.geometry import STILL, Twist2
from tests.e2e.processes import PATIENCE, running, until
from tests.ros1.terminal import terminal
from tests.ros2.conftest import robot_on
from tests.ros2.networks import Ros2

pytestmark = [pytest.mark.realtime]

UP, DOWN = b"\x1b[A", b"\x1b[B"


async def test_robots_are_listed_by_their_names(ros2: Ros2) -> None:
    async with (
        robot_on(ros2, "--namespace", "robot1"),
        running("ros2", "robots", *ros2.options) as robots,
    ):
        line = await robots.line()
        assert line.split()[0] == "robot1/pioneer3"
        assert "/robot1/cmd_vel" in line


async def test_wander_drives_over_topics_and_stops_in_the_end(ros2: Ros2) -> None:
    async with robot_on(ros2) as robot:
        async with running("ros2", "wander", "--seconds", "60", *ros2.options) as wander:
            await until(lambda: not robot.tap.now.is_zero)
            await wander.end(signal.SIGINT)
        await until(lambda: robot.tap.now.is_zero)


async def test_one_keyboard_drives_several_robots_one_by_one_or_all(ros2: Ros2) -> None:
    ahead, names = Twist2(0.1), ("robot1", "robot2")
    async with AsyncExitStack() as stack:
        robots = [
            await stack.enter_async_context(robot_on(ros2, "--namespace", name)) for name in names
        ]

        def doing() -> tuple[Twist2, ...]:
            return tuple(robot.tap.now for robot in robots)

        chosen = [word for name in names for word in ("--robot", name)]
        async with terminal("ros2", "rob_key_multi", *ros2.options, *chosen) as the:
            await the.shows(b"Ctrl-D: quit")
            assert b"/robot1/pioneer3 is number 0" in the.screen
            the.type(UP)
            await until(lambda: doing() == (ahead, STILL))
            the.type(b"q")
            await until(lambda: doing() == (STILL, STILL))
            the.type(UP)
            await until(lambda: doing() == (STILL, ahead))
            the.type(b"s0y" + DOWN)
            await until(lambda: doing() == (Twist2(-0.1), STILL))
            the.type(b"a" + UP)
            await until(lambda: doing() == (ahead, ahead))
            the.type(b" ")
            await until(lambda: doing() == (STILL, STILL))
            the.type(UP)
            await until(lambda: doing() == (ahead, ahead))
            the.type(b"\x04")
            assert await the.code() == 0
        await until(lambda: doing() == (STILL, STILL))


async def test_keys_for_several_robots_that_are_killed_leave_them_standing(ros2: Ros2) -> None:
    async with robot_on(ros2) as robot, terminal("ros2", "rob_key_multi", *ros2.options) as the:
        await the.shows(b"Ctrl-D: quit")
        the.type(UP)
        await until(lambda: robot.tap.now == Twist2(0.1))
        the.process.kill()
        await until(lambda: robot.tap.now == STILL)


async def test_a_phone_drives_and_when_it_is_gone_the_robot_stands(ros2: Ros2) -> None:
    async with (
        robot_on(ros2) as robot,
        ros2.peer("phone") as phone,
        running("ros2", "android_teleop", *ros2.options) as teleop,
    ):
        await teleop.line()
        publisher = phone.publisher("/android/imu", "sensor_msgs/Imu")
        await until(lambda: publisher.matched)

        async def flick(x: float, y: float, then: Twist2) -> None:
            message = phone.types.make("sensor_msgs/Imu")
            message.angular_velocity.x, message.angular_velocity.y = x, y
            async with asyncio.timeout(PATIENCE):
                while robot.tap.now != then:
                    publisher.write(phone.types.encode(message))
                    await asyncio.sleep(0.02)

        await flick(4.0, 0.0, Twist2(0.2))
        await flick(0.0, 4.0, STILL)
        await flick(-4.0, 0.0, Twist2(-0.2))
        await until(lambda: robot.tap.now == STILL)
        code, _ = await teleop.end(signal.SIGINT)
        assert code == 130
