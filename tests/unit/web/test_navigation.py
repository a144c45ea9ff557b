"""Planned ways on the page. Virtual time."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from itertools import pairwise
from math import hypot
from typing import Any

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject
from pioneer3.navigation.connect import connect_async, prepare_navigation
from pioneer3.navigation.localization import InThread
from pioneer3.sim.worldfile import Box
from pioneer3.tasks import running
from pioneer3.web.app import make_app
from pioneer3.web.control import SILENCE
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from tests.support import SimulatedRobot
from tests.unit.web.browser import Browser, Playground, playground

pytest.importorskip("numba")
pytest.importorskip("scipy")
KITCHEN = MapObject(kind="Goal", name="Kitchen", pose=Pose2(2.5, 0.0))
SIDES = [[-4, -3, 4, -3], [4, -3, 4, 3], [4, 3, -4, 3], [-4, 3, -4, -3]]
BETWEEN = [[0, -3, 0, 1], [0, 2, 0, 3]]
"""A wall with a door at (0, 1.5)."""
ROOMS = LineMap(
    name="rooms", walls=np.array([*SIDES, *BETWEEN], dtype=np.float64), objects=(KITCHEN,)
)
BEGIN = Pose2(-2.5, -1.0, 0.0)


async def at_once(function: Callable[..., Any], *arguments: Any) -> Any:
    return function(*arguments)


@pytest.fixture(autouse=True)
def _chances(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let localizers draw the same numbers in each run."""
    drawn = np.random.default_rng
    monkeypatch.setattr(np.random, "default_rng", lambda seed=1: drawn(seed))


@asynccontextmanager
async def rooms() -> AsyncIterator[tuple[Playground, Browser]]:
    async with playground(BEGIN, line_map=ROOMS) as the, Browser(the.app) as ann:
        for view in the.page.robots.values():
            view.navigation.in_thread = at_once
        await asyncio.sleep(1.0)
        yield the, ann


def news(page: Browser) -> tuple[str, str]:
    """Return the status of the goal, and the reason of it."""
    told = page.latest("goal")
    return told["status"], told["text"]


async def arrived(page: Browser, longest: float) -> None:
    """Look at the page until the goal has been reached."""
    await page.stay_until(lambda: page.latest("goal")["status"] == "succeeded", longest)


async def ended(page: Browser, longest: float) -> None:
    """Look at the page until the mode that runs has ended."""
    await page.stay_until(lambda: page.snapshot["mode"] is None, longest)


def where(the: Playground) -> Pose2:
    return the.simulation.robots[0].body.robot_in_world


async def test_the_page_is_told_that_ways_are_planned() -> None:
    async with rooms() as (_, ann):
        assert ann.latest("hello")["robots"][0]["plans"]


async def test_a_way_is_shown_before_anything_drives() -> None:
    async with rooms() as (the, ann):
        ann.say("plan_way", x=2.5, y=0.0)
        await asyncio.sleep(2.0)
        way = ann.latest("way")
        assert way["points"][0] == pytest.approx([-2.5, -1.0], abs=0.1)
        assert way["points"][-1] == pytest.approx([2.5, 0.0], abs=0.01)
        assert way["length"] == pytest.approx(6.5, rel=0.1)
        assert way["seconds"] > way["length"] / 0.3
        assert where(the) == pytest.approx(BEGIN)
        assert ann.snapshot["mode"] is None


async def test_the_robot_goes_through_the_door_and_tells_its_way() -> None:
    async with rooms() as (the, ann):
        ann.say("goto", x=2.5, y=0.0, heading=0.0, name="Kitchen", speed=0.6)
        await ann.stay(5.0)
        assert ann.latest("goal")["status"] == "executing"
        told = ann.latest("navigation")
        assert told["sure"]
        assert told["place"] == "Kitchen"
        assert told["left"] < 6.5
        await arrived(ann, 25.0)
        assert hypot(where(the).x - 2.5, where(the).y) < 0.05
        assert abs(where(the).theta) < 0.05
        assert ann.snapshot["mode"] is None
        assert ann.latest("navigation")["way"] == []
        assert ann.latest("goal")["status"] == "succeeded"


async def test_places_without_a_way_are_refused_with_the_reason() -> None:
    async with rooms() as (the, ann):
        ann.say("plan_way", x=3.9, y=0.0)
        await asyncio.sleep(2.0)
        assert "m from something" in ann.latest("way")["refusal"]
        ann.say("goto", x=30.0, y=0.0)
        await asyncio.sleep(1.0)
        assert news(ann) == ("aborted", "the goal is outside of the map")
        assert where(the) == pytest.approx(BEGIN)


async def _plan_slowly(the: Playground, page: Browser, seconds: float) -> None:
    """Let planning a way take so long [s]."""
    page.say("plan_way", x=2.5, y=0.0)
    await asyncio.sleep(2.0)

    async def slowly(function: Callable[..., Any], *arguments: Any) -> Any:
        await asyncio.sleep(seconds)
        return function(*arguments)

    navigator = the.page.robots[1].navigation._navigator
    assert navigator is not None
    navigator._drives.ways._in_thread = slowly


async def test_a_stop_that_comes_before_the_way_is_found_ends_the_request() -> None:
    async with rooms() as (the, ann):
        await _plan_slowly(the, ann, 1.0)
        ann.say("goto", x=2.5, y=0.0)
        await asyncio.sleep(0.5)
        ann.say("stop")
        await asyncio.sleep(3.0)
        assert ann.snapshot["mode"] is None
        assert where(the) == pytest.approx(BEGIN)
        assert news(ann) == ("aborted", "script stopped the robot")


@pytest.mark.parametrize("how", ["leaves", "falls silent"])
async def test_a_page_that_is_gone_before_the_way_is_found_sends_no_robot(how: str) -> None:
    async with rooms() as (the, ann):
        await _plan_slowly(the, ann, SILENCE + 0.5 if how == "falls silent" else 1.0)
        ann.say("goto", x=2.5, y=0.0)
        await asyncio.sleep(0.5)
        if how == "leaves":
            await ann.leave()
        await asyncio.sleep(SILENCE + 1.0)
        assert the.page.robots[1].robot.arbiter.mode is None
        assert where(the) == pytest.approx(BEGIN)


async def test_a_patrol_ends_when_its_page_falls_silent() -> None:
    async with rooms() as (the, ann), Browser(the.app) as bob:
        places = [{"x": -1.0, "y": -1.0}, {"x": -2.5, "y": -1.0}]
        ann.say("patrol", places=places)
        await ann.stay(6.0)
        assert ann.snapshot["mode"] == "patrol"
        await bob.stay(SILENCE + 0.5)
        assert bob.snapshot["mode"] is None
        assert "nothing was heard of" in bob.snapshot["ended"]["why"]


def close_the_door(the: Playground) -> None:
    the.simulation.world.add_obstacle(Box(pose=Pose2(0.0, 1.5), size=(0.2, 1.0)))


async def test_a_robot_sets_out_to_a_door_that_is_closed_and_waits_until_it_opens() -> None:
    async with rooms() as (the, ann):
        close_the_door(the)
        ann.say("plan_way", x=2.5, y=0.0, name="Kitchen")
        await ann.stay(3.0)
        way = ann.latest("way")
        assert way["points"]
        assert way["refusal"] == ""
        assert way["closed"].startswith("the way to Kitchen is closed")
        ann.say("goto", x=2.5, y=0.0, name="Kitchen", speed=0.5)
        await ann.stay(3.0)
        status, text = news(ann)
        assert status == "executing"
        assert text.startswith("the way to Kitchen is closed")
        assert text.endswith("seen 0 s ago; it waits before it")
        await ann.stay(7.0)
        assert ann.snapshot["mode"] == "goto"
        assert ann.latest("navigation")["problem"].startswith("the way to Kitchen is closed")
        assert where(the).x < 0.0
        (door,) = the.simulation.world.obstacles
        the.simulation.world.remove_obstacle(door)
        await ended(ann, 25.0)
        assert ann.snapshot["ended"]["done"]
        assert (where(the).x, where(the).y) == pytest.approx((2.5, 0.0), abs=0.1)


async def test_a_robot_gives_up_where_the_door_is_closed_before_it() -> None:
    async with rooms() as (the, ann):
        ann.say("goto", x=2.5, y=0.0, name="Kitchen", speed=0.5)
        await ann.stay(4.0)
        close_the_door(the)
        await ended(ann, 40.0)
        assert ann.snapshot["ended"]["why"].startswith("the way to Kitchen is closed")
        assert where(the).x < 0.0
        assert not the.simulation.robots[0].body.speeds[0]


async def test_a_real_robot_began_at_home_and_is_drawn_where_it_finds_itself(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(asyncio, "to_thread", at_once)
    known = replace(ROOMS, homes=(BEGIN,))
    begun = BEGIN @ Pose2(0.15, -0.1, 0.05)  # nobody puts it there exactly
    async with SimulatedRobot(ROOMS, home=begun) as sim, connect_async(sim.open) as robot:
        page = Page()
        async with (
            page.hosting(robot, RobotScene(known)),
            running(page.run()),
            Browser(make_app(page)) as ann,
        ):
            await asyncio.sleep(1.0)
            ann.say("goto", x=2.5, y=0.0, speed=0.6)
            await ann.stay(1.0)
            await arrived(ann, 30.0)
            there = sim.body.robot_in_world
            assert hypot(there.x - 2.5, there.y) < 0.05
            drawn = ann.snapshot["robot_in_map"]
            assert (drawn["x"], drawn["y"]) == pytest.approx((there.x, there.y), abs=0.05)
            assert drawn["theta"] == pytest.approx(there.theta, abs=0.03)


async def test_a_patrol_goes_on_until_it_is_ended() -> None:
    async with rooms() as (the, ann):
        places = [{"x": -1.7, "y": -1.0}, {"x": -2.5, "y": -1.0, "heading": 0.0}]
        ann.say("patrol", places=places, speed=0.7)
        near: list[list[bool]] = [[], []]

        def all_seen_twice() -> bool:
            for place, times in zip(places, near, strict=True):
                times.append(hypot(where(the).x - place["x"], where(the).y - place["y"]) < 0.1)
            visits = [sum(now > before for before, now in pairwise(times)) for times in near]
            return min(visits) >= 2

        await ann.stay_until(all_seen_twice, 60.0)
        assert ann.snapshot["mode"] == "patrol"
        ann.say("end_mode")
        await ann.stay(1.0)
        assert ann.snapshot["mode"] is None


async def test_the_page_is_told_how_sure_a_robot_is() -> None:
    async with rooms() as (_, ann):
        ann.say("plan_way", x=2.5, y=0.0)
        await asyncio.sleep(3.0)
        told = ann.latest("navigation")
        assert told["robot_in_map"] == pytest.approx({"x": -2.5, "y": -1.0, "theta": 0.0}, abs=0.02)
        longer, shorter, _angle = told["ellipse"]
        assert 0.0 < shorter <= longer < 0.2


async def test_somebody_may_tell_a_robot_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(asyncio, "to_thread", at_once)
    known = replace(ROOMS, homes=(BEGIN,))
    begun = Pose2(2.5, 1.0, 2.0)  # far from home
    async with SimulatedRobot(ROOMS, home=begun) as sim, connect_async(sim.open) as robot:
        page = Page()
        async with (
            page.hosting(robot, RobotScene(known)),
            running(page.run()),
            Browser(make_app(page)) as ann,
        ):
            await asyncio.sleep(6.0)
            assert not ann.latest("navigation")["sure"]
            ann.say("place_robot", x=2.4, y=1.1, heading=2.1)
            await ann.stay(3.0)
            assert ann.latest("navigation")["sure"]
            assert ann.snapshot["robot_in_map"]["x"] == pytest.approx(2.5, abs=0.05)


async def test_a_lost_robot_looks_around_until_it_knows() -> None:
    async with rooms() as (the, ann):
        ann.say("plan_way", x=2.5, y=0.0)
        await asyncio.sleep(3.0)
        ann.say("place_robot", x=2.5, y=-2.0, heading=-1.0)  # it is not there
        await ann.stay(8.0)
        told = ann.latest("navigation")
        assert not told["sure"]
        assert told["reason"]
        ann.say("goto", x=2.5, y=0.0)
        await ann.stay(5.0)
        assert "not sure" in news(ann)[1]
        assert where(the) == pytest.approx(BEGIN)
        ann.say("look_around")
        await ann.stay_until(lambda: ann.latest("navigation")["sure"], 60.0)
        assert ann.snapshot["ended"]["done"]


async def test_without_a_map_nothing_navigates() -> None:
    async with playground(BEGIN) as the, Browser(the.app) as ann:
        await asyncio.sleep(1.0)
        ann.say("look_around")
        await asyncio.sleep(0.5)
        assert ann.latest("refused")["message"] == "there is no map"


async def test_a_goal_waits_for_navigation_and_tells_the_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    compiled = asyncio.Event()

    async def prepare(in_thread: InThread, tell: Callable[[str], None]) -> None:
        tell("compiling navigation, once")
        await compiled.wait()
        await prepare_navigation(in_thread)

    monkeypatch.setattr("pioneer3.web.navigation.prepare_navigation", prepare)
    async with rooms() as (the, ann):
        ann.say("plan_way", x=2.5, y=0.0)
        ann.say("goto", x=2.5, y=0.0, name="Kitchen", speed=0.6)
        await ann.stay(5.0)
        assert news(ann) == ("accepted", "")
        told = ann.latest("navigation")
        assert (told["reason"], told["problem"]) == ("", "compiling navigation, once")
        assert where(the) == pytest.approx(BEGIN)
        compiled.set()
        await arrived(ann, 30.0)
        assert ann.latest("way")["length"] == pytest.approx(6.5, rel=0.1)
        assert news(ann) == ("succeeded", "arrived")
        assert hypot(where(the).x - 2.5, where(the).y) < 0.05


@pytest.mark.parametrize(
    ("request_", "end"),
    [
        ("stop", ("aborted", "somebody stopped the robot")),
        ("end_mode", ("canceled", "laptop ended it")),
    ],
)
async def test_a_goal_that_waits_ends_at_once_when_it_is_called_back(
    monkeypatch: pytest.MonkeyPatch, request_: str, end: tuple[str, str]
) -> None:
    async def prepare(in_thread: InThread, tell: Callable[[str], None]) -> None:
        await asyncio.sleep(10.0)
        await prepare_navigation(in_thread)

    monkeypatch.setattr("pioneer3.web.navigation.prepare_navigation", prepare)
    async with rooms() as (the, ann):
        ann.say("goto", x=2.5, y=0.0)
        await ann.stay(3.0)
        ann.say(request_)
        await ann.stay(0.5)
        assert (news(ann)[0], news(ann)[1].split()[-2:]) == (end[0], end[1].split()[-2:])
        await ann.stay(12.0)
        assert the.page.robots[1].robot.arbiter.mode is None
        assert where(the) == pytest.approx(BEGIN)


async def test_a_page_that_lets_go_of_control_before_the_way_is_found_sends_no_robot() -> None:
    async with rooms() as (the, ann), Browser(the.app) as bob:
        await _plan_slowly(the, ann, 1.0)
        ann.say("goto", x=2.5, y=0.0)
        await asyncio.sleep(0.1)
        bob.say("release_control")
        await asyncio.sleep(0.1)
        assert news(ann) == ("accepted", "")
        ann.say("release_control")
        await ann.stay(3.0)
        assert (news(ann)[0], news(ann)[1].split()[-2:]) == ("aborted", ["let", "go"])
        assert where(the) == pytest.approx(BEGIN)


async def test_a_later_goal_takes_the_place_of_one_that_waits() -> None:
    async with rooms() as (the, ann), Browser(the.app) as bob:
        await _plan_slowly(the, ann, 1.0)
        ann.say("goto", x=2.5, y=0.0)
        await ann.stay(2.5)
        ann.say("goto", x=-2.5, y=1.0)
        await ann.stay(0.5)
        statuses = [each["status"] for each in ann.heard if each["type"] == "goal"]
        assert statuses == ["accepted", "executing", "canceled", "accepted"]
        assert not [each for each in bob.heard if each["type"] == "goal"]
        await arrived(ann, 20.0)
        assert news(ann) == ("succeeded", "arrived")
        assert hypot(where(the).x + 2.5, where(the).y - 1.0) < 0.05


async def test_every_question_gets_an_answer() -> None:
    async with rooms() as (_, ann), Browser(_.app) as bob:
        ann.say("goto", x=-2.5, y=1.0)
        ann.say("plan_way", x=2.5, y=0.0)
        bob.say("plan_way", x=30.0, y=0.0)
        await ann.stay(3.0)
        assert ann.latest("way")["points"]
        assert bob.latest("way")["refusal"] == "the goal is outside of the map"
