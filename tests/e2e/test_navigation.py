"""Robots that find themselves on a map and go to its places: the whole stack, in virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from math import hypot

import numpy as np
import pytest

from pioneer3.errors import CommandError, ConfigError, MotionError
from pioneer3.geometry import Pose2
from pioneer3.maps import shipped_map
from pioneer3.nav.places import Destination, find_place, home
from pioneer3.runtime.connect import connect_async
from pioneer3.runtime.navigator import Navigator
from pioneer3.runtime.robot import Robot
from pioneer3.sim.realism import Realism
from pioneer3.tasks import running
from tests.support import SimulatedRobot
from tests.unit.web.test_navigation import at_once

pytest.importorskip("numba")
pytest.importorskip("scipy")
OFFICE = shipped_map("office")
HOME = home(OFFICE)
assert HOME is not None


@asynccontextmanager
async def in_the_office(
    start: Pose2 | None = HOME, *, seed: int = 1, model: str = "p3at-sh"
) -> AsyncIterator[tuple[SimulatedRobot, Robot, Navigator]]:
    sim = SimulatedRobot(OFFICE, home=HOME or Pose2(), seed=seed, realism=Realism(), model=model)
    async with sim, connect_async(sim.open) as robot:
        rng = np.random.default_rng(seed)
        navigator = await Navigator.on(robot, OFFICE, start=start, rng=rng, in_thread=at_once)
        robot.navigator = navigator
        async with running(navigator.run()):
            yield sim, robot, navigator


@pytest.mark.parametrize("model", ["p3at-sh", "p3dx-sh"])
async def test_it_drives_to_the_kitchen_by_name(model: str) -> None:
    async with in_the_office(model=model) as (sim, robot, _):
        await robot.goto("kitchen", speed=0.7)
        goal, there = find_place(OFFICE, "Kitchen"), sim.body.robot_in_world
        assert hypot(there.x - goal.x, there.y - goal.y) < 0.05
        assert sim.body.drive.linear.velocity == 0.0


async def test_it_ends_at_the_heading() -> None:
    async with in_the_office() as (sim, _, navigator):
        await navigator.goto(Destination(x=5.0, y=4.0, heading=1.0))
        there = sim.body.robot_in_world
        assert hypot(there.x - 5.0, there.y - 4.0) < 0.05
        assert there.theta == pytest.approx(1.0, abs=0.05)


async def test_a_robot_that_is_not_sure_where_it_is_does_not_go() -> None:
    async with in_the_office(Pose2(12.0, 9.0, 0.0)) as (sim, robot, _):
        with pytest.raises(MotionError, match="not sure where the robot is"):
            await robot.goto("kitchen")
        assert sim.body.robot_in_world == HOME


async def test_a_robot_that_was_carried_away_stops() -> None:
    async with in_the_office() as (sim, robot, navigator):
        going = asyncio.ensure_future(robot.goto("Lobby", speed=0.5))
        await asyncio.sleep(6.0)
        assert navigator.estimate.sure
        carried = sim.body.robot_in_world = Pose2(13.0, 2.0, 2.0)
        with pytest.raises(MotionError):
            await going
        now = sim.body.robot_in_world
        assert hypot(now.x - carried.x, now.y - carried.y) < 1.0


async def test_a_stop_ends_the_drive() -> None:
    async with in_the_office() as (sim, robot, _):
        going = asyncio.ensure_future(robot.goto("kitchen"))
        await asyncio.sleep(5.0)
        robot.stop()
        with pytest.raises(MotionError):
            await going
        await asyncio.sleep(2.0)
        assert sim.body.drive.linear.velocity == 0.0


async def test_hands_on_the_stick_come_first() -> None:
    async with in_the_office() as (sim, robot, _):
        going = asyncio.ensure_future(robot.goto("kitchen"))
        await asyncio.sleep(5.0)
        for _ in range(20):
            robot.drive(0.0, 0.4)
            await asyncio.sleep(0.1)
        assert sim.body.drive.linear.velocity == pytest.approx(0.0, abs=0.01)
        await going  # it goes on where the hands left it


async def test_names_are_checked() -> None:
    async with in_the_office() as (_, robot, _nav):
        with pytest.raises(ConfigError, match="has Corridor, Dock"):
            await robot.goto("canteen")
        robot.navigator = None
        with pytest.raises(CommandError, match="there is no map"):
            await robot.goto("kitchen")
        with pytest.raises(CommandError, match="give x and y"):
            await robot.goto(1.0)
