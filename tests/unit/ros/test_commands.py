"""What a node does with cmd_vel that goes on and on. Virtual time, no ROS."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import inf
from types import SimpleNamespace

import pytest

from pioneer3 import Robot, connect_async
from pioneer3.ros.ros1.commands import Commands
from tests.support import SimulatedRobot

AHEAD = 0.3
TIMEOUTS = pytest.mark.parametrize("patience", [0.6, inf])
COMMON_CLOCK = SimpleNamespace(age=lambda _message: 0.0)


@dataclass
class Drive:
    """A simulated robot, and what is published to it."""

    sim: SimulatedRobot
    robot: Robot
    commands: Commands

    @property
    def speed(self) -> float:
        return self.sim.body.drive.linear.velocity

    def say(self, speed: float) -> None:
        """Publish a Twist."""
        zero = SimpleNamespace(x=0.0, y=0.0, z=0.0)
        twist = SimpleNamespace(
            linear=SimpleNamespace(x=speed, y=0.0, z=0.0),
            angular=zero,
            _connection_header={"callerid": "/somebody"},
        )
        self.commands._receive(twist, (False, COMMON_CLOCK))  # type: ignore[arg-type]

    async def publish(self, seconds: float, speed: float = AHEAD) -> None:
        """Publish ten times a second."""
        for _ in range(round(seconds * 10)):
            self.say(speed)
            await asyncio.sleep(0.1)


@asynccontextmanager
async def driven(patience: float) -> AsyncIterator[Drive]:
    """Drive a robot by what is published, as a node does."""
    async with SimulatedRobot() as sim, connect_async(sim.open) as robot:
        commands = Commands(robot, (), patience, lambda _why: None)
        commands.begin()

        the = Drive(sim, robot, commands)
        await the.publish(2.0)
        assert the.speed == pytest.approx(AHEAD)
        yield the


async def begins_anew(the: Drive) -> None:
    """Check that what goes on moves nothing, and what begins anew does."""
    await the.publish(3.0)
    assert the.speed == 0.0
    await asyncio.sleep(0.7)
    await the.publish(2.0)
    assert the.speed == pytest.approx(AHEAD)


@TIMEOUTS
async def test_the_stop_button_ends_what_is_published_until_a_pause(patience: float) -> None:
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
        the.robot.helm.stop()
        await the.publish(1.0)
        assert the.speed == 0.0
        await the.publish(0.2, 0.0)
        await the.publish(2.0)
        assert the.speed == pytest.approx(AHEAD)


async def test_one_message_for_ever_is_muted_by_a_stop_and_the_next_one_counts() -> None:
    async with driven(inf) as the:
        assert the.robot.helm.set_motors(on=True) is None
        await asyncio.sleep(2.0)
        assert the.speed == 0.0
        the.say(AHEAD)
        await asyncio.sleep(2.0)
        assert the.speed == pytest.approx(AHEAD)
