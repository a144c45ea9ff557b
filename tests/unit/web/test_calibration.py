"""A robot that is calibrated on the page. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from pioneer3 import connect_async
from pioneer3.geometry import Pose2, wrap
from pioneer3.models.own import own_path, read_own
from pioneer3.sim.realism import OdometryErrors, Realism
from pioneer3.tasks import running
from pioneer3.web.app import make_app
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from tests.support import SimulatedRobot, disk_of
from tests.unit.web.browser import Browser
from tests.unit.web.test_navigation import at_once

ERRORS = OdometryErrors(mode="constant", wheel_ratio=1.01, base_ratio=0.98, scale=1.02)
SKIPPED = 2
"""Turns against a wall, of which there is none here."""


class Calibrating:
    """A person at the page who measures where the robot is, exactly."""

    def __init__(self, sim: SimulatedRobot, ann: Browser) -> None:
        self.sim, self.ann = sim, ann

    @property
    def state(self) -> dict[str, Any]:
        """What the page was told last."""
        return self.ann.latest("calibration")

    async def ask(self, step: str, **fields: object) -> dict[str, Any]:
        """Press a button, and wait until it is done."""
        self.ann.say("calibrate", step=step, **fields)
        await self.ann.stay(1.0)
        while self.state["waits"]:
            await self.ann.stay(1.0)
        return self.state

    async def begin(self) -> None:
        """Begin by tape, with the first square."""
        begun = await self.ask("begin", by_tape=True)
        assert (begun["number"], begun["title"] != "", begun["needs"] != "") == (1, True, True)
        for _ in range(SKIPPED):
            await self.ask("skip")

    async def measure(self) -> dict[str, Any]:
        """Drive the present step, and answer what it asks."""
        self.sim.body.robot_in_world = Pose2()
        asks = {each["name"] for each in (await self.ask("drive"))["asks"]}
        end = self.sim.body.robot_in_world
        known = {"ahead": end.x, "left": end.y, "turned": wrap(end.theta)}
        known |= {"way": end.x, "aside": end.y}
        return await self.ask("measure", answers={name: known[name] for name in asks})


@asynccontextmanager
async def calibrating(monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Calibrating]:
    monkeypatch.setattr(asyncio, "to_thread", at_once)
    sim = SimulatedRobot(model="p3dx-sh", realism=Realism(odometry=ERRORS), seed=2)
    async with sim, connect_async(sim.open) as robot:
        page = Page()
        async with (
            page.hosting(robot, RobotScene()),
            running(page.run()),
            Browser(make_app(page)) as ann,
        ):
            await ann.stay(1.0)
            yield Calibrating(sim, ann)


@pytest.mark.thorough
async def test_the_steps_are_driven_measured_and_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    async with calibrating(monkeypatch) as here:
        assert here.state["going"] is False
        await here.begin()
        while here.state["title"]:
            measured = await here.measure()
            assert measured["note"] == ""
        assert any("better" in line or "square" in line for line in measured["lines"])
        with disk_of(64):
            full = await here.ask("write")
        assert (full["going"], "cannot be written" in full["note"]) == (True, True)
        written = await here.ask("write")
        assert written["going"] is False
        assert "counts from the next connection on" in written["note"]
        path = own_path("MobileSim")
    assert path is not None
    found = read_own(path).model.odometry
    assert found.scale == pytest.approx(ERRORS.scale, abs=0.004)
    assert found.base_ratio == pytest.approx(ERRORS.base_ratio, abs=0.01)
    assert found.wheel_ratio == pytest.approx(ERRORS.wheel_ratio, abs=0.003)


async def test_the_robot_stops_when_the_page_leaves(monkeypatch: pytest.MonkeyPatch) -> None:
    async with calibrating(monkeypatch) as here:
        await here.begin()
        here.ann.say("calibrate", step="drive")
        await here.ann.stay(3.0)
        assert here.sim.speed > 0.1
        await here.ann.leave()
        await asyncio.sleep(3.0)
        assert here.sim.speed == 0.0


async def test_a_stop_ends_the_step_and_it_is_driven_again(monkeypatch: pytest.MonkeyPatch) -> None:
    async with calibrating(monkeypatch) as here:
        await here.begin()
        here.ann.say("calibrate", step="drive")
        await here.ann.stay(2.0)
        here.ann.say("calibrate", step="skip")
        await here.ann.stay(1.0)
        assert "wait, or stop the robot" in here.ann.latest("refused")["message"]
        here.ann.say("stop")
        await here.ann.stay(3.0)
        assert (here.sim.speed, here.state["waits"], here.state["asks"]) == (0.0, "", [])
        assert here.state["note"]
        assert (await here.measure())["number"] == SKIPPED + 2


async def test_an_answer_that_cannot_be_is_refused_and_undoing_goes_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async with calibrating(monkeypatch) as here:
        await here.begin()
        asked = await here.ask("drive")
        assert {each["name"] for each in asked["asks"]} == {"ahead", "left", "turned"}
        far = {"ahead": 3.0, "left": 0.0}
        assert "measure once more" in (await here.ask("measure", answers=far))["note"]
        assert "a number is missing" in (await here.ask("measure", answers={"left": 0.0}))["note"]
        assert here.state["asks"]
        end = here.sim.body.robot_in_world
        answers = {"ahead": end.x, "left": end.y}
        assert (await here.ask("measure", answers=answers))["number"] == SKIPPED + 2
        assert (await here.ask("undo"))["number"] == SKIPPED + 1
        assert "not better than chance" in (await here.ask("write"))["note"]
        assert (await here.ask("end"))["going"] is False
        here.ann.say("calibrate", step="drive")
        await here.ann.stay(1.0)
        assert here.ann.latest("refused")["message"] == "begin one first"
