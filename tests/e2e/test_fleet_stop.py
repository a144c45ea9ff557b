"""Stopping a whole fleet. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from math import inf

import pytest

from pioneer3.fleet.run import exit_code
from pioneer3.fleet.spec import FleetRobot
from pioneer3.fleet.stop import stop_all
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.driven import Driven
from pioneer3.runtime.robot import Robot as Driver
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec
from pioneer3.sim.worldfile.arguments import WorldOverrides
from pioneer3.tasks import running
from tests.fleets import robot, simulated
from tests.support import hold


@pytest.mark.parametrize("emergency", [False, True])
async def test_all_stand_and_confirm_it(emergency: bool) -> None:
    async with simulated() as here:
        answers = await stop_all(here.robots, here.connect, emergency=emergency)
        assert [answer.robot for answer in answers] == [each.name for each in here.robots]
        assert all(answer.ok and answer.reached and not answer.why for answer in answers)
        assert exit_code(answers) == 0
        assert not any(sim.powered for sim in here.sims.values())


async def test_robots_that_roll_on_without_their_program_are_stopped() -> None:
    async with simulated(2) as here:
        for sim in here.sims.values():
            async with connect_async(sim.open) as alone:
                await hold(alone, 0.3, seconds=1)
                sim.silent = True  # its program dies, and nothing tells the robot
            sim.silent = False
        assert here.speeds() != [0, 0]
        answers = await stop_all(here.robots, here.connect)
        assert here.speeds() == [0, 0]
        assert exit_code(answers) == 0


async def test_who_does_not_answer_is_named_and_delays_nobody() -> None:
    async with simulated(4) as here:
        here.sims["p3at-1"].plugged = False
        here.sims["p3at-2"].silent = True
        clock = asyncio.get_running_loop().time
        began = clock()
        missing, silent, *well = await stop_all(here.robots, here.connect, patience=3.0)
        assert clock() - began < 4.5
        assert (missing.ok, missing.reached, missing.why) == (False, False, "memory: no such port")
        assert not silent.ok
        assert silent.why
        assert all(answer.ok and answer.seconds < 2 for answer in well)
        assert exit_code([missing, silent, *well]) == 1
        assert exit_code([missing, silent]) == 3


async def test_a_robot_that_is_told_and_falls_silent_has_not_confirmed() -> None:
    async with simulated(2) as here:

        @asynccontextmanager
        async def connect(robot: FleetRobot) -> AsyncIterator[Driven]:
            async with here.connect(robot) as one:
                here.sims[robot.name].silent = robot.name == "p3at-1"
                yield one

        told, stands = await stop_all(here.robots, connect, patience=2.0)
        assert (told.ok, told.reached) == (False, True)
        assert told.why == "it was told to stop, and has not confirmed it within 2 s"
        assert stands.ok
        assert exit_code([told]) == exit_code([told, stands]) == 1


@pytest.mark.realtime
async def test_a_port_that_another_program_has_is_told_and_the_others_stop() -> None:
    words = WorldOverrides(robots=(RobotSpec(model="p3at"), RobotSpec(model="p3at")))
    async with simulator(port=0, overrides=words) as here:
        urls = dict(zip(("p3at-1", "p3at-2"), [one.url for one in here.robots], strict=True))

        def connect(robot: FleetRobot) -> AbstractAsyncContextManager[Driven]:
            return connect_async(urls[robot.name])

        async with connect_async(urls["p3at-1"]):
            busy, free = await stop_all([robot(1), robot(2)], connect)
    assert (busy.ok, busy.reached) == (False, False)
    assert "is another one connected to it?" in busy.why
    assert free.ok


async def test_a_robot_that_another_program_drives_on_does_not_stand() -> None:
    async with simulated(1) as here:

        @asynccontextmanager
        async def connect(each: FleetRobot) -> AsyncIterator[Driven]:
            async with connect_async(here.sims[each.name].open) as one:
                await hold(one, 0.3, seconds=1)
                async with running(_drives_on(one)):
                    yield one

        (moves,) = await stop_all(here.robots, connect, patience=2.5)
    assert (moves.ok, moves.reached) == (False, True)
    assert "does another program drive it?" in moves.why


async def _drives_on(robot: Driver) -> None:
    await hold(robot, 0.3, seconds=inf)
