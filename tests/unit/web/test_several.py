"""Several robots at one page. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from math import hypot

import pytest
from starlette.types import ASGIApp

from pioneer3 import connect_async
from pioneer3.errors import CommandError
from pioneer3.tasks import running
from pioneer3.web.app import make_app
from pioneer3.web.broadcast import PERIOD
from pioneer3.web.page import Page
from pioneer3.web.robot_view import RobotView
from pioneer3.web.scene import RobotScene
from tests.support import SimulatedRobot
from tests.unit.web.asking import Script
from tests.unit.web.browser import Browser

BRAKING = 0.3


@dataclass(frozen=True)
class Fleet:
    """Robots in worlds of their own, and the page of them all."""

    sims: list[SimulatedRobot]
    views: list[RobotView]
    page: Page
    app: ASGIApp

    @property
    def speeds(self) -> list[float]:
        """True speeds [m/s]."""
        return [round(sim.speed, 6) for sim in self.sims]

    def travelled(self, number: int) -> float:
        """How far a robot is from its start [m]."""
        pose = self.sims[number - 1].body.robot_in_world
        return hypot(pose.x, pose.y)


@asynccontextmanager
async def fleet(count: int, *names: str) -> AsyncIterator[Fleet]:
    """Join worlds, firmwares, drivers and a page, in the loop's time."""
    page = Page()
    async with AsyncExitStack() as stack:
        sims = [await stack.enter_async_context(SimulatedRobot()) for _ in range(count)]
        robots = [await stack.enter_async_context(connect_async(sim.open)) for sim in sims]
        called = [*names, *[""] * (count - len(names))]
        views = [
            await stack.enter_async_context(page.hosting(robot, RobotScene(), name))
            for robot, name in zip(robots, called, strict=True)
        ]
        await stack.enter_async_context(running(page.run()))
        yield Fleet(sims, views, page, make_app(page))


async def keep_driving(who: Browser, robot: int, v: float, seconds: float) -> None:
    """Hold a key, as the page does."""
    for _ in range(round(seconds / 0.066)):
        who.say("drive", v=v, w=0.0, robot=robot)
        await asyncio.sleep(0.066)


async def test_pages_are_told_of_all_robots_by_number_and_by_names_that_differ() -> None:
    async with fleet(3, "left") as the, Browser(the.app) as ann:
        await asyncio.sleep(0.3)
        robots = ann.latest("hello")["robots"]
        assert [(robot["id"], robot["name"]) for robot in robots] == [
            (1, "left"),
            (2, "Pioneer 3-AT"),
            (3, "Pioneer 3-AT 2"),
        ]
        assert {status["robot"] for status in ann.all("status")} == {1, 2, 3}
        assert all(len(ann.snapshots(number)) >= 2 for number in (1, 2, 3))


async def test_a_request_reaches_the_robot_that_it_names() -> None:
    async with fleet(3) as the, Browser(the.app) as ann:
        await keep_driving(ann, 2, 0.3, 2.0)
        assert the.speeds == [0.0, 0.3, 0.0]
        assert (the.travelled(1), the.travelled(3)) == (0.0, 0.0)
        ann.say("stop", robot=3)
        await keep_driving(ann, 2, 0.3, 0.3)
        assert the.speeds == [0.0, 0.3, 0.0]
        ann.say("stop", robot=2)
        await asyncio.sleep(BRAKING)
        assert the.speeds == [0.0, 0.0, 0.0]


async def test_without_a_number_the_first_is_meant() -> None:
    async with fleet(2) as the, Browser(the.app) as ann:
        await ann.keep_driving(0.3, 2.0)
        assert the.speeds == [0.3, 0.0]


@pytest.mark.parametrize("number", [0, -1, 3, 2**70])
async def test_a_robot_that_is_not_there_is_not_driven(number: int) -> None:
    async with fleet(2) as the, Browser(the.app) as ann:
        ann.say("drive", v=0.3, w=0.0, robot=number)
        await asyncio.sleep(1.0)
        assert len(ann.all("refused")) == 1
        assert the.speeds == [0.0, 0.0]


async def test_an_emergency_stop_without_a_number_stops_all() -> None:
    async with fleet(3) as the, Browser(the.app) as ann, Browser(the.app) as bob:
        driving = [asyncio.ensure_future(keep_driving(ann, n, 0.3, 3.0)) for n in (1, 3)]
        await asyncio.sleep(1.5)
        assert the.speeds == [0.3, 0.0, 0.3]
        bob.say("emergency_stop")
        await asyncio.gather(*driving)
        assert the.speeds == [0.0, 0.0, 0.0]
        assert all(bob.snapshots(n)[-1]["emergency_stop"] for n in (1, 2, 3))
        bob.say("reset_emergency_stop", robot=3)
        await asyncio.sleep(0.3)
        assert [bob.snapshots(n)[-1]["emergency_stop"] for n in (1, 2, 3)] == [True, True, False]


async def test_an_emergency_stop_of_one_leaves_the_others_alone() -> None:
    async with fleet(2) as the, Browser(the.app) as ann:
        driving = asyncio.ensure_future(keep_driving(ann, 1, 0.3, 3.0))
        await asyncio.sleep(1.5)
        ann.say("emergency_stop", robot=2)
        await driving
        assert the.speeds == [0.3, 0.0]


async def test_each_robot_has_an_operator_of_its_own() -> None:
    async with fleet(2) as the, Browser(the.app) as ann, Browser(the.app) as bob:
        both = keep_driving(ann, 1, 0.3, 2.0), keep_driving(bob, 2, -0.2, 2.0)
        driving = [asyncio.ensure_future(one) for one in both]
        await asyncio.sleep(1.8)
        assert the.speeds == [0.3, -0.2]
        holders = ann.latest("people")["control"]
        ids = [page.latest("people")["id"] for page in (ann, bob)]
        assert [(holder["robot"], holder["id"]) for holder in holders] == [(1, ids[0]), (2, ids[1])]
        await asyncio.gather(*driving)
        assert ann.all("refused") == bob.all("refused") == []


async def test_a_client_that_leaves_releases_control_of_every_robot() -> None:
    async with fleet(2) as the, Browser(the.app) as ann:
        both = [asyncio.ensure_future(keep_driving(ann, n, 0.3, 2.0)) for n in (1, 2)]
        await asyncio.gather(*both)
        assert the.speeds == [0.3, 0.3]
        await ann.leave()
        await asyncio.sleep(BRAKING)
        assert the.speeds == [0.0, 0.0]
        assert [view.control.holder for view in the.views] == [None, None]


async def test_news_of_control_names_the_robot() -> None:
    async with fleet(2, "left", "right") as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("take_control", robot=2)
        await asyncio.sleep(0.2)
        bob.say("take_over", robot=2)
        await asyncio.sleep(0.2)
        assert ann.latest("told")["message"] == "right: script 2 took over; you watch now"


async def test_a_lost_robot_is_told_and_the_others_go_on() -> None:
    async with fleet(2) as the, Browser(the.app) as ann:
        driving = asyncio.ensure_future(keep_driving(ann, 2, 0.3, 4.0))
        await asyncio.sleep(1.0)
        await the.sims[0].unplug()
        await asyncio.sleep(2.5)
        states = {status["robot"]: status["state"] for status in ann.all("status")}
        assert (states[1] in {"lost", "connecting"}, states[2]) == (True, "connected")
        assert the.sims[1].speed == pytest.approx(0.3, abs=0.01)
        await driving


async def test_a_robot_that_comes_and_goes_is_told() -> None:
    async with (
        fleet(1) as the,
        Browser(the.app) as ann,
        SimulatedRobot() as sim,
        connect_async(sim.open) as robot,
    ):
        async with the.page.hosting(robot, RobotScene(), "guest"):
            await asyncio.sleep(0.3)
            assert [robot["name"] for robot in ann.latest("hello")["robots"]][1:] == ["guest"]
            assert len(ann.snapshots(2)) >= 2
        await asyncio.sleep(0.1)
        assert [robot["id"] for robot in ann.latest("hello")["robots"]] == [1]
        heard = len(ann.snapshots(2))
        await asyncio.sleep(0.5)
        assert len(ann.snapshots(2)) == heard
        with pytest.raises(CommandError):
            the.page.robot(2)


async def test_frames_come_at_most_every_40_ms_and_lose_no_report() -> None:
    async with fleet(8) as the, Browser(the.app) as ann:
        await asyncio.sleep(5.0)
        frames = ann.all("robots")
        assert 10 * 5 - 5 <= len(frames) <= 5 / PERIOD + 1
        for number in range(1, 9):
            sequences = [snapshot["sequence"] for snapshot in ann.snapshots(number)]
            assert sequences == list(range(sequences[0], sequences[0] + len(sequences)))
            assert len(sequences) >= 48


async def test_the_api_knows_all_robots() -> None:
    async with fleet(3) as the:
        script = Script(the.app)
        listed = (await script.ask("GET", "/api/robots")).json
        assert [robot["id"] for robot in listed] == [1, 2, 3]
        await script.ask("POST", "/api/robots/2/drive", {"v": 0.2})
        await asyncio.sleep(0.4)
        assert [sim.speed > 0.05 for sim in the.sims] == [False, True, False]
        for wrong in ("0", "4", "01", "1.0", "all", "%31x"):
            assert (await script.ask("GET", f"/api/robots/{wrong}/snapshot")).status == 404
        assert (await script.ask("POST", "/api/emergency_stop")).status == 204
        await asyncio.sleep(0.3)
        told = [(await script.ask("GET", f"/api/robots/{n}/snapshot")).json for n in (1, 2, 3)]
        assert all(snapshot["emergency_stop"] for snapshot in told)
