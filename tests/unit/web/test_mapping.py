"""Maps that are made on the page. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, read_map
from tests.unit.web.browser import Browser, Playground, playground
from tests.unit.web.test_navigation import at_once

pytest.importorskip("numba")
pytest.importorskip("scipy")
SIDES = [[-4, -3, 4, -3], [4, -3, 4, 3], [4, 3, -4, 3], [-4, 3, -4, -3], [0, 3, 0, 1]]
ROOM = LineMap(name="room", walls=np.array(SIDES, dtype=np.float64))
BEGIN = Pose2(-1.0, 0.0, 0.5)


def maps_in(folder: Path) -> set[str]:
    return {path.name for path in folder.glob("*.map")}


@asynccontextmanager
async def room(folder: Path) -> AsyncIterator[tuple[Playground, Browser]]:
    async with playground(BEGIN, line_map=ROOM) as the, Browser(the.app) as ann:
        for view in the.page.robots.values():
            view.mapping.in_thread, view.mapping.folder = at_once, folder
        await asyncio.sleep(1.0)
        yield the, ann


async def test_a_map_grows_on_the_page_and_is_saved(tmp_path: Path) -> None:
    async with room(tmp_path) as (the, ann):
        assert not ann.latest("mapping")["making"]
        assert ann.latest("map")["map"]["name"] == "room"
        ann.say("make_map", step="begin")
        await ann.stay(4.0)
        begun = ann.latest("mapping")
        assert begun["making"]
        assert begun["area"] > 5.0
        assert not begun["exploring"]
        assert ann.latest("map")["map"]["cells"]
        assert the.simulation.robots[0].body.robot_in_world == pytest.approx(BEGIN)
        ann.say("make_map", step="name_place", name="Start")
        ann.say("make_map", step="explore", speed=0.6)
        await ann.stay(4.0)
        assert ann.latest("mapping")["exploring"]
        await ann.stay_until(lambda: not ann.latest("mapping")["exploring"], 40.0)
        done = ann.latest("mapping")
        assert not done["exploring"]
        assert done["area"] == pytest.approx(46.0, rel=0.05)
        ann.say("make_map", step="save", name="lab")
        await ann.stay(2.0)
        after = ann.latest("mapping")
        assert (after["making"], after["saved"]) == (False, "lab.map")
        assert ann.latest("map")["map"]["name"] == "room"
    saved = read_map(tmp_path / "lab.map")
    home, start = saved.objects
    assert (home.kind, start.kind, start.name) == ("RobotHome", "GoalWithHeading", "Start")
    assert (start.pose.x, start.pose.y) == pytest.approx((BEGIN.x, BEGIN.y), abs=0.02)
    assert start.pose.theta == pytest.approx(BEGIN.theta, abs=0.02)
    assert saved.bounds == pytest.approx(ROOM.bounds, abs=0.06)
    assert (tmp_path / "lab.survey.npz").exists()


async def test_a_map_that_was_not_finished_is_saved_when_the_program_ends(tmp_path: Path) -> None:
    async with room(tmp_path) as (_, ann):
        ann.say("make_map", step="begin")
        await ann.stay(2.0)
        ann.say("make_map", step="explore")
        await ann.stay(6.0)
    assert len(read_map(tmp_path / "unfinished map.map").walls) > 10


async def test_a_map_may_be_discarded_and_names_are_not_taken_twice(tmp_path: Path) -> None:
    async with room(tmp_path) as (_, ann):
        for step, count in (("discard", 0), ("save", 1), ("save", 2)):
            ann.say("make_map", step="begin")
            await ann.stay(3.0)
            ann.say("make_map", step=step, name="lab")
            await ann.stay(2.0)
            assert len(maps_in(tmp_path)) == count
    assert maps_in(tmp_path) == {"lab.map", "lab-2.map"}


async def test_what_does_not_go_is_refused(tmp_path: Path) -> None:
    async with room(tmp_path) as (_, ann):
        ann.say("make_map", step="explore")
        await ann.stay(0.5)
        assert ann.latest("refused")["message"] == "begin a map first"
        ann.say("make_map", step="save")
        await ann.stay(0.5)
        assert ann.latest("refused")["message"] == "no map is being made"
        ann.say("make_map", step="save", name="../lab")
        await ann.stay(0.5)
        assert "not understood" in ann.latest("refused")["message"]
    assert maps_in(tmp_path) == set()
