"""Robots on one map that keep out of each other's ways: the whole stack, in virtual time."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from math import hypot, inf, pi
from typing import Any

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.links import Link
from pioneer3.links.memory import null_modem
from pioneer3.maps import LineMap, shipped_map
from pioneer3.nav.places import Destination
from pioneer3.navigation.connect import connect_async
from pioneer3.navigation.localization import InThread
from pioneer3.navigation.navigator import Navigator
from pioneer3.navigation.traffic import Traffic
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.tasks import running
from tests.unit.web.browser import simulated
from tests.unit.web.test_navigation import ROOMS, at_once

pytest.importorskip("numba")
pytest.importorskip("scipy")


@dataclass
class Several:
    """Robots in one world.

    Attributes:
        simulation: Of all.
        navigators: Theirs, in their order.
        nearest: Least distance between the middles of two of them so far [m].
    """

    simulation: RunningSimulation
    navigators: list[Navigator]
    nearest: float = inf

    def pose(self, number: int) -> Pose2:
        return self.simulation.robots[number].body.robot_in_world

    async def watch(self) -> None:
        while True:
            poses = [robot.body.robot_in_world for robot in self.simulation.robots]
            for at, one in enumerate(poses):
                for other in poses[:at]:
                    self.nearest = min(self.nearest, hypot(one.x - other.x, one.y - other.y))
            await asyncio.sleep(0.05)


@asynccontextmanager
async def several(
    line_map: LineMap, *poses: Pose2, in_thread: InThread = at_once
) -> AsyncIterator[Several]:
    here = simulated(*poses, line_map=line_map)
    serving: list[asyncio.Task[None]] = []
    traffic = Traffic()
    async with running(here._simulation.run()), AsyncExitStack() as stack:
        navigators = []
        for number, simulated_robot in enumerate(here.robots):

            async def plug_in(port=simulated_robot.port) -> Link:  # type: ignore[no-untyped-def]
                ours, theirs = null_modem()
                serving.append(asyncio.ensure_future(port.serve(theirs)))
                return ours

            robot = await stack.enter_async_context(connect_async(plug_in))
            navigator = await Navigator.on(
                robot,
                line_map,
                start=poses[number],
                rng=np.random.default_rng(number),
                in_thread=in_thread,
                traffic=traffic,
                name=f"robot {number + 1}",
            )
            await stack.enter_async_context(running(navigator.run()))
            navigators.append(navigator)
        all_ = Several(here, navigators)
        async with running(all_.watch()):
            yield all_
    await asyncio.gather(*serving)


def off(at: Pose2, goal: Destination) -> float:
    return hypot(at.x - goal.x, at.y - goal.y)


LEFT, RIGHT = Destination(x=-2.5, y=-1.5), Destination(x=2.5, y=-1.5)


async def test_two_robots_that_meet_in_a_door_let_each_other_pass() -> None:
    async with several(ROOMS, Pose2(-2.5, 0.5, 0.0), Pose2(2.5, 0.5, pi)) as the:
        one, two = the.navigators
        async with asyncio.timeout(120):
            await asyncio.gather(one.goto(RIGHT, 0.5), two.goto(LEFT, 0.5))
        assert off(the.pose(0), RIGHT) < 0.05
        assert off(the.pose(1), LEFT) < 0.05
        assert the.nearest > 0.7


async def test_planning_that_takes_a_while_does_not_send_a_robot_into_the_way() -> None:
    async def slowly(function: Callable[..., Any], *arguments: Any) -> Any:
        await asyncio.sleep(0.5)
        return function(*arguments)

    begin = Pose2(-2.5, 0.5, 0.0), Pose2(2.5, 0.5, pi)
    async with several(ROOMS, *begin, in_thread=slowly) as the:
        one, two = the.navigators
        async with asyncio.timeout(180):
            await asyncio.gather(one.goto(RIGHT, 0.5), two.goto(LEFT, 0.5))
        assert the.nearest > 0.7


async def test_the_one_that_waits_says_for_whom() -> None:
    async with several(ROOMS, Pose2(-2.5, 0.5, 0.0), Pose2(1.5, 1.5, pi)) as the:
        one, two = the.navigators
        told: set[str] = set()

        async def listen() -> None:
            async for state in two.state.values():
                told.add(state.problem)

        async with running(listen()), asyncio.timeout(120):
            first = asyncio.ensure_future(one.goto(RIGHT, 0.5))
            await asyncio.sleep(1.0)
            await asyncio.gather(first, two.goto(LEFT, 0.5))
        assert told & {"lets robot 1 pass", "makes room for another robot"}


async def test_a_robot_follows_another_through_the_door() -> None:
    async with several(ROOMS, Pose2(-1.5, 1.5, 0.0), Pose2(-3.0, 1.5, 0.0)) as the:
        one, two = the.navigators
        async with asyncio.timeout(120):
            await asyncio.gather(one.goto(RIGHT, 0.3), two.goto(Destination(x=2.5, y=2.0), 0.7))
        assert the.nearest > 0.7


@pytest.mark.timeout(600)  # half a minute of work, which other work on the machine makes longer
async def test_four_robots_change_places_in_an_office() -> None:
    office = shipped_map("office")
    starts = [
        Pose2(3.0, 3.1, 0.0),
        Pose2(10.0, 7.0, 0.0),
        Pose2(3.7, 11.0, 0.0),
        Pose2(12.5, 9.4, 0.0),
    ]
    goals = [Destination(x=p.x, y=p.y) for p in (*starts[1:], starts[0])]
    async with several(office, *starts) as the:
        async with asyncio.timeout(300):
            await asyncio.gather(
                *(each.goto(goal, 0.6) for each, goal in zip(the.navigators, goals, strict=True))
            )
        for number, goal in enumerate(goals):
            assert off(the.pose(number), goal) < 0.06
        assert the.nearest > 0.55  # side by side they are 0.5 m wide
