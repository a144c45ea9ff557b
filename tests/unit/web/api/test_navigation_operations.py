"""Places of the map over the API for scripts. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from math import hypot

import pytest

from pioneer3.geometry import Pose2
from pioneer3.navigation.goals import GoalStatus
from pioneer3.web.access.sessions import Role, SessionKind
from tests.unit.web.asking import Script, stranger
from tests.unit.web.browser import Browser, Playground, playground, product

pytest.importorskip("numba")
pytest.importorskip("scipy")
from tests.unit.web.test_navigation import BEGIN, ROOMS, at_once

ROBOT = "/api/robots/1"


@asynccontextmanager
async def rooms() -> AsyncIterator[tuple[Playground, Script]]:
    async with playground(BEGIN, line_map=ROOMS) as the:
        for view in the.page.robots.values():
            view.navigation.in_thread = at_once
        await asyncio.sleep(1.0)
        yield the, Script(the.app)


def where(the: Playground) -> Pose2:
    return the.simulation.robots[0].body.robot_in_world


async def test_the_places_of_the_map_are_listed() -> None:
    async with rooms() as (_, script):
        places = (await script.ask("GET", f"{ROBOT}/places")).json
        assert places == [{"name": "Kitchen", "x": 2.5, "y": 0.0, "heading": None}]


async def test_a_way_is_told_and_nothing_drives() -> None:
    async with rooms() as (the, script):
        way = (await script.ask("POST", f"{ROBOT}/way", {"name": "kitchen"})).json
        assert (way["robot"], way["x"], way["y"], way["closed"]) == (1, 2.5, 0.0, "")
        assert way["points"][0] == pytest.approx([-2.5, -1.0], abs=0.1)
        assert way["points"][-1] == pytest.approx([2.5, 0.0], abs=0.01)
        assert way["length"] == pytest.approx(6.5, rel=0.1)
        assert way["seconds"] > way["length"] / 0.3
        await asyncio.sleep(2.0)
        assert where(the) == pytest.approx(BEGIN)
        assert (await script.ask("GET", f"{ROBOT}/control")).json["holder"] is None


async def test_the_robot_goes_to_a_place_and_tells_what_is_left() -> None:
    async with rooms() as (the, script):
        place = {"name": "kitchen", "speed": 0.6}
        begun = await script.ask("POST", f"{ROBOT}/goto_place", place)
        assert begun.status == 200
        assert begun.json["length"] == pytest.approx(6.5, rel=0.1)
        await asyncio.sleep(5.0)
        told = (await script.ask("GET", f"{ROBOT}/navigation")).json
        assert told["sure"]
        assert told["place"] == "Kitchen"
        assert 0.5 < told["left"] < 6.5
        assert [told["robot_in_map"][k] for k in "xy"] == pytest.approx(
            [where(the).x, where(the).y], abs=0.1
        )
        await asyncio.sleep(25.0)
        assert hypot(where(the).x - 2.5, where(the).y) < 0.05
        assert (await script.ask("GET", f"{ROBOT}/mode")).json["ended"]["done"]
        assert (await script.ask("GET", f"{ROBOT}/navigation")).json["left"] is None


@pytest.mark.parametrize(
    ("place", "status", "words"),
    [
        ({"name": "canteen"}, 404, "has Kitchen"),
        ({"x": 2.5, "y": 2.95}, 409, "from something"),
        ({"x": 50.0, "y": 0.0}, 409, "outside of the map"),
        ({}, 400, "give the name of a place, or x and y"),
        ({"x": 1.0}, 400, "give the name of a place, or x and y"),
        ({"name": "Kitchen", "x": 1.0, "y": 1.0}, 400, "give the name of a place, or x and y"),
        ({"x": 1.0, "y": 1.0, "speed": 0.0}, 400, "speed"),
    ],
)
async def test_what_cannot_be_reached_is_refused_in_words(
    place: dict[str, object], status: int, words: str
) -> None:
    async with rooms() as (the, script):
        for path in ("way", "goto_place"):
            answer = await script.ask("POST", f"{ROBOT}/{path}", place)
            assert answer.status == status
            assert words in answer.detail
        await asyncio.sleep(1.0)
        assert where(the) == pytest.approx(BEGIN)


async def test_a_stop_while_the_way_is_planned_ends_the_request() -> None:
    async with rooms() as (the, script):
        planned = asyncio.Event()

        async def slowly(function: object, *arguments: object) -> object:
            await planned.wait()
            assert callable(function)
            return function(*arguments)

        the.page.robot(1).navigation.in_thread = slowly
        asked = asyncio.ensure_future(script.ask("POST", f"{ROBOT}/goto_place", {"x": 2.5, "y": 0}))
        await asyncio.sleep(1.0)
        await script.ask("POST", f"{ROBOT}/stop")
        planned.set()
        assert (await asked).status == 409
        await asyncio.sleep(2.0)
        assert where(the) == pytest.approx(BEGIN)


async def test_a_goal_that_a_script_ends_is_canceled_on_its_way() -> None:
    async with rooms() as (the, script):
        await script.ask("POST", f"{ROBOT}/goto_place", {"name": "Kitchen"})
        await asyncio.sleep(1.0)
        goal = the.page.robot(1).navigation.goals.current
        assert goal is not None
        assert (await script.ask("DELETE", f"{ROBOT}/mode")).json["mode"] is None
        await asyncio.sleep(1.0)
        assert (goal.status, goal.text) == (GoalStatus.CANCELED, "this computer ended it")


@pytest.mark.parametrize(("path", "why"), [("mode", "ended it"), ("control", "let go")])
async def test_a_goal_that_a_script_ends_while_its_way_is_planned_never_sets_out(
    path: str, why: str
) -> None:
    async with rooms() as (the, script):
        planned = asyncio.Event()

        async def slowly(function: object, *arguments: object) -> object:
            await planned.wait()
            assert callable(function)
            return function(*arguments)

        the.page.robot(1).navigation.in_thread = slowly
        asked = asyncio.ensure_future(script.ask("POST", f"{ROBOT}/goto_place", {"x": 2.5, "y": 0}))
        await asyncio.sleep(1.0)
        await script.ask("DELETE", f"{ROBOT}/{path}")
        planned.set()
        assert (await asked).detail == f"this computer {why}"
        await asyncio.sleep(2.0)
        assert where(the) == pytest.approx(BEGIN)


async def test_a_script_without_control_does_not_drive_but_may_ask() -> None:
    async with rooms() as (the, script), Browser(the.app, user_agent="Mozilla") as ann:
        ann.say("take_control")
        await asyncio.sleep(0.1)
        refused = await script.ask("POST", f"{ROBOT}/goto_place", {"name": "Kitchen"})
        assert (refused.status, refused.detail) == (409, "laptop has control")
        assert (await script.ask("POST", f"{ROBOT}/way", {"name": "Kitchen"})).status == 200


async def test_viewers_see_where_it_goes_and_ask_for_no_way() -> None:
    async with rooms() as (the, _):
        _, token = the.page.access.sessions.open("survey", Role.VIEWER, SessionKind.SCRIPT)
        viewer = stranger(the.app).with_headers(authorization=f"Bearer {token}")
        told = (await viewer.ask("GET", f"{ROBOT}/navigation")).json
        assert (told["sure"], told["reason"]) == (False, "nobody has asked for a way yet")
        assert (await viewer.ask("POST", f"{ROBOT}/way", {"name": "Kitchen"})).status == 403


@pytest.mark.parametrize("path", ["places", "navigation", "way", "goto_place"])
async def test_without_a_map_there_are_no_places(path: str) -> None:
    async with product() as the:
        method = "GET" if path in ("places", "navigation") else "POST"
        body = None if method == "GET" else {"x": 1.0, "y": 0.0}
        answer = await Script(the.app).ask(method, f"{ROBOT}/{path}", body)
        assert (answer.status, answer.detail) == (409, "there is no map")
