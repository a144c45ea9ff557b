"""What a node does with cmd_vel that goes on and on. Virtual time, no ROS."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import inf, nan
from types import SimpleNamespace

import pytest

from pioneer3 import Robot, connect_async
from pioneer3.maps import LineMap
from pioneer3.ros.node.commands import Commands
from pioneer3.ros.node.middleware import Sender
from pioneer3.ros.node.names import CommandName
from tests.support import SimulatedRobot, wall_at

AHEAD = 0.3
TIMEOUTS = pytest.mark.parametrize("patience", [0.6, inf])
SOMEBODY, SOMEBODY_ELSE = Sender("/somebody", object()), Sender("/somebody_else", object())


@dataclass
class Drive:
    """A simulated robot, and what is published to it."""

    sim: SimulatedRobot
    robot: Robot
    commands: Commands
    warnings: list[str]

    @property
    def speed(self) -> float:
        return self.sim.body.speeds[0]

    def say(self, speed: float, sender: Sender = SOMEBODY) -> None:
        """Publish a Twist."""
        zero = SimpleNamespace(x=0.0, y=0.0, z=0.0)
        linear = SimpleNamespace(x=speed, y=0.0, z=0.0)
        self.commands.receive(
            CommandName("cmd_vel"), SimpleNamespace(linear=linear, angular=zero), sender
        )

    async def publish(
        self, seconds: float, speed: float = AHEAD, sender: Sender = SOMEBODY
    ) -> None:
        """Publish ten times a second."""
        await self.stream(seconds, speed, sender, rate=10)

    async def stream(
        self, seconds: float, speed: float = AHEAD, sender: Sender = SOMEBODY, *, rate: float
    ) -> None:
        """Publish `rate` times a second."""
        for _ in range(round(seconds * rate)):
            self.say(speed, sender)
            await asyncio.sleep(1 / rate)


@asynccontextmanager
async def driven(
    patience: float, line_map: LineMap | None = None, *, resumes: bool = True
) -> AsyncIterator[Drive]:
    """Drive a robot by what is published, as a node does."""
    async with SimulatedRobot(line_map) as sim, connect_async(sim.open) as robot:
        warnings: list[str] = []
        commands = Commands(robot, patience, resumes=resumes, warn=warnings.append)
        commands.begin()
        the = Drive(sim, robot, commands, warnings)
        await the.publish(2.0)
        assert the.speed == pytest.approx(AHEAD)
        yield the


async def begins_anew(the: Drive) -> None:
    """Check that what goes on moves nothing, and what begins anew does."""
    await the.publish(3.0)
    assert the.speed == 0.0
    the.say(0.0)
    await the.publish(2.0)
    assert the.speed == pytest.approx(AHEAD)


async def test_a_command_that_expires_is_told_of_once_for_each_sender() -> None:
    async with driven(0.6) as the:
        for _ in range(3):
            await asyncio.sleep(1.0)
            the.say(0.0)
            the.say(AHEAD)
        await asyncio.sleep(1.0)
        the.say(AHEAD, SOMEBODY_ELSE)
        await asyncio.sleep(1.0)
        assert [warning.split(":")[0] for warning in the.warnings] == [
            "cmd_vel of /somebody has expired",
            "cmd_vel of /somebody_else has expired",
        ]
        assert "nothing came for 0.6 s" in the.warnings[0]
        assert "a longer cmd_vel_timeout, such as 1.5" in the.warnings[0]


async def test_good_and_bad_commands_in_turn_are_told_of_few_times() -> None:
    async with driven(0.6) as the:
        for _ in range(50):
            await the.publish(0.1, nan)
            await the.publish(0.1)
        assert 1 <= len(the.warnings) <= 5
        await asyncio.sleep(10.0)
        before = len(the.warnings)
        await the.publish(0.1, nan)
        assert len(the.warnings) == before + 1


@pytest.mark.parametrize("ends", ["zero", "emergency stop", "lost robot", "no timeout"])
async def test_what_ends_otherwise_is_not_said_to_expire(ends: str) -> None:
    async with driven(inf if ends == "no timeout" else 0.6) as the:
        match ends:
            case "zero":
                the.say(0.0)
            case "emergency stop":
                the.robot.emergency_stop()
            case "lost robot":
                the.sim.silent = True
                await the.publish(3.0)
        await asyncio.sleep(1.0)
        assert not [warning for warning in the.warnings if "expired" in warning]


@TIMEOUTS
async def test_the_stop_button_ends_what_is_published_until_a_zero(patience: float) -> None:
    async with driven(patience) as the:
        the.sim.body.stop_button = True
        await the.publish(2.0)
        the.sim.body.stop_button = False
        await begins_anew(the)


@TIMEOUTS
async def test_so_does_an_emergency_stop_that_is_reset(patience: float) -> None:
    async with driven(patience) as the:
        the.robot.emergency_stop()
        await the.publish(2.0)
        the.robot.reset_emergency_stop()
        await begins_anew(the)


@TIMEOUTS
async def test_so_does_a_lost_link(patience: float) -> None:
    async with driven(patience) as the:
        the.sim.silent = True
        await the.publish(15.0)
        the.sim.silent = False
        await the.publish(8.0)
        assert the.robot.snapshot is not None
        await begins_anew(the)


@TIMEOUTS
async def test_a_zero_lets_go_as_well(patience: float) -> None:
    async with driven(patience) as the:
        the.robot.arbiter.stop()
        await the.publish(1.0)
        assert the.speed == 0.0
        await the.publish(0.2, 0.0)
        await the.publish(2.0)
        assert the.speed == pytest.approx(AHEAD)


async def test_one_message_for_ever_is_muted_by_a_stop_and_the_next_one_counts() -> None:
    async with driven(inf) as the:
        assert the.robot.arbiter.set_motors(on=True) is None
        await asyncio.sleep(2.0)
        assert the.speed == 0.0
        the.say(AHEAD)
        await asyncio.sleep(2.0)
        assert the.speed == pytest.approx(AHEAD)


@TIMEOUTS
async def test_the_true_reason_is_told_once_and_stays(patience: float) -> None:
    async with driven(patience) as the:
        await the.sim.unplug()
        await the.publish(5.0)
        the.sim.plugged = True
        await the.publish(10.0)
        assert the.robot.snapshot is not None
        assert the.warnings
        assert all("the link was lost" in warning for warning in the.warnings)


@pytest.mark.parametrize("pause", [0.7, 1.5])
@pytest.mark.parametrize("rate", [6, 10, 20, 50])
async def test_a_stream_that_pauses_goes_on_after_it_has_come_steadily(
    rate: float, pause: float
) -> None:
    async with driven(0.6) as the:
        for _ in range(2):
            await the.stream(2.0, rate=rate)
            assert the.speed == pytest.approx(AHEAD)
            await asyncio.sleep(pause + 0.4)
            assert the.speed == 0.0
            await the.stream(0.25, rate=rate)
            assert the.speed == 0.0
        await the.stream(2.0, rate=rate)
        assert the.speed == pytest.approx(AHEAD)
        assert [warning.split(":")[0] for warning in the.warnings] == [
            "cmd_vel of /somebody has expired",
            "cmd_vel of /somebody comes steadily again",
        ]


async def test_a_stream_that_comes_in_clumps_goes_on_too() -> None:
    async with driven(0.6) as the:
        await asyncio.sleep(1.5)
        for _ in range(10):
            the.say(AHEAD)
            the.say(AHEAD)
            await asyncio.sleep(0.2)
        assert the.speed == pytest.approx(AHEAD)


@pytest.mark.parametrize(("count", "rate"), [(10, 1000), (100, 1000), (60, 100), (30, 30)])
async def test_old_commands_that_are_delivered_at_once_do_not_drive(
    count: int, rate: float
) -> None:
    async with driven(0.6) as the:
        await asyncio.sleep(3.0)
        for _ in range(count):
            the.say(AHEAD)
            await asyncio.sleep(1 / rate)
            assert the.speed == 0.0
        await asyncio.sleep(1.0)
        assert the.speed == 0.0


@pytest.mark.parametrize("stopped", ["stop", "emergency stop", "stop button", "lost link"])
async def test_a_stream_that_pauses_does_not_go_on_after_another_stop(stopped: str) -> None:
    async with driven(0.6) as the:
        await asyncio.sleep(1.0)
        match stopped:
            case "stop":
                the.robot.arbiter.stop()
            case "emergency stop":
                the.robot.emergency_stop()
                the.robot.reset_emergency_stop()
            case "stop button":
                the.sim.body.stop_button = True
                await asyncio.sleep(1.0)
                the.sim.body.stop_button = False
            case "lost link":
                the.sim.silent = True
                await asyncio.sleep(15.0)
                the.sim.silent = False
                await asyncio.sleep(5.0)
        await begins_anew(the)
        assert "cmd_vel is ignored" in the.warnings[-1]


async def test_a_stream_that_pauses_goes_on_after_another_one_that_took_over() -> None:
    async with driven(0.6) as the:
        await asyncio.sleep(1.0)
        for _ in range(20):
            the.say(-0.1, SOMEBODY_ELSE)
            await the.publish(0.1)
        assert the.speed == pytest.approx(-0.1, abs=0.01)
        the.say(0.0, SOMEBODY_ELSE)
        await the.publish(0.2)
        assert the.speed == pytest.approx(0.0, abs=0.01)
        await the.publish(2.0)
        assert the.speed == pytest.approx(AHEAD)


async def test_a_publisher_that_was_frozen_does_not_drive_on_by_the_strict_rule() -> None:
    async with driven(0.6, resumes=False) as the:
        await asyncio.sleep(4.0)
        await the.publish(5.0)
        assert the.speed == 0.0
        assert the.warnings[0].startswith("cmd_vel of /somebody has expired")
        assert the.warnings[1:] == [
            "cmd_vel is ignored: /somebody fell silent while it drove; let go, then ask again"
            " (a zero lets go)"
        ]
        the.say(0.0)
        await the.publish(2.0)
        assert the.speed == pytest.approx(AHEAD)


async def test_a_publisher_that_was_frozen_may_lead_away() -> None:
    async with driven(0.6) as the:
        await asyncio.sleep(4.0)
        await the.publish(1.0)
        await the.publish(2.0, -0.2)
        assert the.speed == pytest.approx(-0.2, abs=0.01)


async def test_a_new_publisher_is_not_the_old_one() -> None:
    async with driven(0.6) as the:
        await asyncio.sleep(4.0)
        await the.publish(2.0, sender=SOMEBODY_ELSE)
        assert the.speed == pytest.approx(AHEAD)
        await the.publish(1.0)  # the frozen one goes on, and disturbs nobody
        assert the.warnings


async def press_a_key(the: Drive, seconds: float) -> None:
    """Publish as terminals repeat a key that is held: once, and after a while quickly."""
    the.say(AHEAD)
    await asyncio.sleep(0.4)
    for _ in range(round((seconds - 0.4) * 30)):
        the.say(AHEAD)
        await asyncio.sleep(1 / 30)


async def test_a_key_that_is_pressed_again_drives_again() -> None:
    async with driven(0.6) as the:
        the.say(0.0)
        for _ in range(5):
            await press_a_key(the, 2.0)
            assert the.speed == pytest.approx(AHEAD)
            await asyncio.sleep(3.0)
            assert the.speed == 0.0
        assert [warning[:33] for warning in the.warnings] == ["cmd_vel of /somebody has expired:"]


async def test_single_presses_drive_each_time() -> None:
    async with driven(0.6) as the:
        the.say(0.0)
        for _ in range(5):
            the.say(AHEAD)
            await asyncio.sleep(0.5)
            assert the.speed > 0.05
            await asyncio.sleep(1.5)
            assert the.speed == 0.0


async def test_who_goes_on_publishing_leaves_a_wall() -> None:
    async with driven(0.6, wall_at(1.2)) as the:
        await the.publish(6.0)
        assert the.speed == 0.0
        touching = the.sim.body.robot_in_world.x
        await the.publish(2.0, -0.2)
        assert the.sim.body.robot_in_world.x < touching - 0.2
        assert len(the.warnings) == 1
        assert "drive the other way" in the.warnings[0]
