"""Maps that are updated on the page, and all ways out of that. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("numba")
pytest.importorskip("scipy")

from pioneer3.maps import LineMap
from pioneer3.maps.line_map import FREE
from pioneer3.navigation.connect import connect_async
from pioneer3.sim.realism import Realism
from pioneer3.tasks import running
from pioneer3.web.app import make_app
from pioneer3.web.page import Page
from pioneer3.web.scene import RemoteWorld, RobotScene
from tests.support import SimulatedRobot
from tests.unit.nav.halls import HALL, ROUND
from tests.unit.nav.test_changes import SHELF
from tests.unit.navigation.test_map_update import Hall, names
from tests.unit.web.browser import Browser, Playground, playground
from tests.unit.web.test_navigation import at_once

NOW = np.concatenate([HALL, SHELF])
"""The walls of the hall today: the box has gone, and the shelf has come [m]."""


@dataclass(frozen=True)
class Today:
    """A robot in the hall, which has a map of the day before."""

    the: Playground
    ann: Browser
    hall: Hall

    async def update(self) -> None:
        """Go on with the map while Ann drives past the place of the box."""
        self.ann.say("make_map", step="update")
        await self.ann.stay(1.0)
        assert self.mapping["updates"] == "hall.map"
        await self.ann.keep_driving(0.5, 8.0)
        await self.ann.keep_driving(0.0, 3.0, w=0.8)
        await self.ann.stay(3.0)

    async def finish(self) -> None:
        self.ann.say("make_map", step="finish")
        await self.ann.stay(2.0)
        assert self.mapping["asks"]

    @property
    def mapping(self) -> dict[str, object]:
        return self.ann.latest("mapping")

    def gone(self) -> list[tuple[float, float]]:
        """Return the middles of what the page shows as gone [m]."""
        changes = self.ann.latest("map")["map"]["changes"]
        return [(change["x"], change["y"]) for change in changes if change["gone"]]


@asynccontextmanager
async def today(folder: Path, *, survey: bool = True) -> AsyncIterator[Today]:
    hall = Hall(folder / "hall.map")
    if not survey:
        (folder / "hall.survey.npz").unlink()
    line_map = LineMap(name="hall", walls=NOW, file=hall.path)
    async with playground(ROUND[0], line_map=line_map) as the, Browser(the.app) as ann:
        for view in the.page.robots.values():
            view.mapping.in_thread = view.navigation.in_thread = at_once
            view.mapping.folder = folder
        await asyncio.sleep(1.0)
        yield Today(the, ann, hall)


async def test_the_page_shows_what_has_changed_and_asks_before_the_map_is_replaced(
    tmp_path: Path,
) -> None:
    async with today(tmp_path) as day:
        assert day.mapping["no_update"] == ""
        await day.update()
        assert day.gone() == [pytest.approx((5.3, 0.5), abs=0.25)]
        day.ann.say("make_map", step="save")
        await day.ann.stay(0.5)
        assert "finish the map first" in day.ann.latest("refused")["message"]
        await day.finish()
        assert day.gone() == [pytest.approx((5.3, 0.5), abs=0.25)]
        (change,) = (each for each in day.ann.latest("map")["map"]["changes"] if each["gone"])
        assert change["text"].startswith("gone: 0.")
        assert len(change["cells"]) > 20
        assert day.hall.is_old(day.hall.path)
        assert names(tmp_path) == {"hall"}
        day.ann.say("make_map", step="explore")
        await day.ann.stay(0.5)
        assert "the map is finished" in day.ann.latest("refused")["message"]
        day.ann.say("make_map", step="save")
        await day.ann.stay(1.0)
        assert day.ann.latest("told")["message"] == (
            "Saved hall.map; the map as it was before is hall-before.map."
        )
        assert (day.mapping["making"], day.mapping["saved"]) == (False, "hall.map")
        assert day.ann.latest("map")["map"]["changes"] == []
    assert day.hall.is_old(tmp_path / "hall-before.map")
    assert names(tmp_path) == {"hall", "hall-before"}
    assert not day.hall.is_old(day.hall.path)


@pytest.mark.parametrize("finished", [False, True])
async def test_the_old_map_is_kept_where_that_is_wanted(tmp_path: Path, *, finished: bool) -> None:
    async with today(tmp_path) as day:
        await day.update()
        if finished:
            await day.finish()
        day.ann.say("make_map", step="discard")
        await day.ann.stay(1.0)
        assert not day.mapping["making"]
        assert day.ann.latest("told")["message"] == "hall.map stays as it is."
    assert day.hall.is_old(day.hall.path)
    assert names(tmp_path) == {"hall"}


@pytest.mark.parametrize("finished", [False, True])
async def test_a_program_that_ends_leaves_the_old_map_and_the_new_one_beside(
    tmp_path: Path, *, finished: bool
) -> None:
    async with today(tmp_path) as day:
        await day.update()
        if finished:
            await day.finish()
    assert day.hall.is_old(day.hall.path)
    assert names(tmp_path) == {"hall", "hall-new"}
    assert not day.hall.is_old(tmp_path / "hall-new.map")


async def test_the_question_waits_for_a_page_that_lost_its_connection(tmp_path: Path) -> None:
    async with today(tmp_path) as day:
        await day.update()
        await day.finish()
        await day.ann.leave()
        await asyncio.sleep(5.0)
        assert day.hall.is_old(day.hall.path)
        async with Browser(day.the.app) as ben:
            await ben.stay(1.0)
            assert ben.latest("mapping")["asks"]
            ben.say("make_map", step="discard")
            await ben.stay(1.0)
            assert not ben.latest("mapping")["making"]
    assert day.hall.is_old(day.hall.path)


async def test_a_robot_that_lost_its_link_leaves_the_old_map(tmp_path: Path) -> None:
    async with today(tmp_path) as day:
        await day.update()
        faults = day.the.simulation.robots[0].port.faults
        faults.unplug()
        await day.ann.stay(5.0)
        assert day.mapping["updates"] == "hall.map"
        assert day.hall.is_old(day.hall.path)
        await day.finish()
        day.ann.say("make_map", step="save")
        await day.ann.stay(1.0)
        assert day.mapping["saved"] == "hall.map"
    assert day.hall.is_old(tmp_path / "hall-before.map")


async def test_only_who_has_control_decides(tmp_path: Path) -> None:
    async with today(tmp_path) as day, Browser(day.the.app) as ben:
        ben.say("take_control")
        await ben.stay(0.5)
        day.ann.say("make_map", step="update")
        await day.ann.stay(0.5)
        assert day.ann.latest("refused")["message"].endswith("has control")
        assert not day.mapping["making"]
        ben.say("make_map", step="update")
        await ben.stay(2.0)
        for step in "finish", "discard":
            day.ann.say("make_map", step=step)
            await ben.stay(1.0)
            assert day.ann.latest("refused")["message"].endswith("has control")
            assert (day.mapping["making"], day.mapping["asks"]) == (True, False)


async def test_a_map_without_a_survey_is_not_updated(tmp_path: Path) -> None:
    async with today(tmp_path, survey=False) as day:
        why = "to go on with a map, hall.survey.npz has to lie beside it"
        assert day.mapping["no_update"] == why
        day.ann.say("make_map", step="update")
        await day.ann.stay(0.5)
        assert day.ann.latest("refused")["message"] == f"the map is not updated: {why}"
        assert not day.mapping["making"]


async def test_a_real_robot_drives_on_the_new_map(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(asyncio, "to_thread", at_once)
    hall = Hall(tmp_path / "hall.map")
    today = LineMap(name="hall", walls=NOW)
    sim = SimulatedRobot(today, home=ROUND[0], seed=1, realism=Realism(), model="p3dx-sh")
    async with sim, connect_async(sim.open) as robot:
        page, told = Page(), list[str]()
        known = LineMap(name="hall", walls=hall.line_map.walls, file=hall.path)
        scene = RobotScene(known, remote=RemoteWorld(robot, known, told.append))
        async with page.hosting(robot, scene) as view, running(page.run()):
            view.mapping.folder = tmp_path
            async with Browser(make_app(page)) as ann:
                await ann.stay(1.0)
                assert "not sure" in str(ann.latest("mapping")["no_update"])
                ann.say("place_robot", x=ROUND[0].x, y=ROUND[0].y, heading=ROUND[0].theta)
                await ann.stay(2.0)
                assert ann.latest("mapping")["no_update"] == ""
                ann.say("make_map", step="update")
                await ann.stay(2.0)
                await ann.keep_driving(0.5, 8.0)
                await ann.stay(3.0)
                ann.say("make_map", step="finish")
                await ann.stay(2.0)
                ann.say("make_map", step="save")
                await ann.stay(1.0)
                assert ann.latest("mapping")["saved"] == "hall.map"
                used = scene.map_now
                assert used is not None
                assert used is not known
                assert (used.name, used.file) == ("hall", hall.path)
                (grid,) = used.grids
                assert grid.states_at(np.array([5.3]), np.array([0.6]))[0] == FREE
                assert page.map.in_use is used
