"""Sending a robot to a place of the map, and being told where it is going. Virtual time."""

import asyncio
from math import hypot, pi
from typing import Any

import numpy as np
import pytest

from pioneer3.behaviors.action import MODE, Action, Desire, Goal, Situation, Stack
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.web.control import SILENCE
from pioneer3.web.scene import RobotScene
from tests.unit.web.asking import Script
from tests.unit.web.browser import Browser, playground, product

WALLS = np.array([[-9, -9, 9, -9], [9, -9, 9, 9], [9, 9, -9, 9], [-9, 9, -9, -9], [-3, -2, -3, 2]])
ROOM = LineMap(name="room", walls=WALLS.astype(float))
SOON = 0.25


@pytest.fixture(autouse=True)
def _straight(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a map, robots drive straight."""
    monkeypatch.setattr(RobotScene, "map_now", property(lambda _: None, lambda _, known: None))


def newest(page: Browser) -> dict[str, Any]:
    """Return the newest snapshot."""
    return page.snapshot


async def test_the_robot_goes_where_it_is_sent_and_says_so() -> None:
    async with playground(Pose2(-1.0, 0.5, pi / 2), line_map=ROOM) as the, Browser(the.app) as ann:
        ann.say("goto", x=0.5, y=-1.0, heading=0.0, speed=0.4)
        await asyncio.sleep(1.0)
        assert newest(ann)["mode"] == "goto"
        target = newest(ann)["target"]
        assert (target["x"], target["y"]) == pytest.approx((0.5, -1.0), abs=0.05)
        assert target["heading"] == pytest.approx(0.0, abs=0.05)
        assert not target["person"]
        await ann.stay(15.0)
        here = the.simulation.robots[0].body.robot_in_world
        assert hypot(here.x - 0.5, here.y + 1.0) < 0.2
        assert abs(here.theta) < 0.15
        assert (newest(ann)["mode"], newest(ann)["target"]) == (None, None)


async def test_a_page_that_falls_silent_sends_the_robot_no_further() -> None:
    async with playground(line_map=ROOM) as the, Browser(the.app) as ann, Browser(the.app) as bob:
        body = the.simulation.robots[0].body
        ann.say("goto", x=8.0, y=0.0)
        await asyncio.sleep(SILENCE - 0.1)
        before = body.robot_in_world.x
        assert body.speeds[0] > 0.2
        await bob.stay(2.0)
        assert body.speeds[0] == 0.0
        assert body.robot_in_world.x - before < 0.4
        assert "nothing was heard of" in bob.snapshot["ended"]["why"]
        ann.say("ping", t=0)  # it wakes up
        await bob.stay(2.0)
        assert body.speeds[0] == 0.0


async def test_a_way_that_is_blocked_is_given_up_with_the_reason() -> None:
    async with playground(Pose2(-1.0, 0.0, pi), line_map=ROOM) as the, Browser(the.app) as ann:
        ann.say("goto", x=-6.0, y=0.0)
        await ann.stay(10.0)
        assert newest(ann)["mode"] == "goto"  # somebody may step aside
        await ann.stay_until(lambda: newest(ann)["mode"] is None, 30.0)
        assert newest(ann)["ended"]["why"].startswith("something is in the way: ")
        assert not newest(ann)["ended"]["done"]
        assert not the.simulation.body.speeds[0]


async def test_a_script_is_told_that_the_way_is_blocked() -> None:
    async with playground(Pose2(-1.0, 0.0, pi), line_map=ROOM) as the:
        script = Script(the.app)
        wish = {"x": 5.0, "y": 0.0, "seconds": 600}
        assert (await script.ask("POST", "/api/robots/1/goto", wish)).status == 200
        await asyncio.sleep(40.0)
        ended = (await script.ask("GET", "/api/robots/1/mode")).json
        assert ended["mode"] is None
        assert ended["ended"]["why"].startswith("something is in the way")


async def test_a_real_robot_is_sent_by_where_odometry_began() -> None:
    async with (
        product(RobotScene(odom_in_map=Pose2(5.0, 0.0, pi / 2))) as the,
        Browser(the.app) as ann,
    ):
        await asyncio.sleep(SOON)
        ann.say("goto", x=5.0, y=1.0)
        await asyncio.sleep(SOON)
        goal = the.robot.arbiter.mode.goal if the.robot.arbiter.mode else None
        assert goal is not None
        assert (goal.x, goal.y) == pytest.approx((1.0, 0.0))
        assert goal.heading is None
        target = newest(ann)["target"]
        assert (target["x"], target["y"], target["heading"]) == (5.0, 1.0, None)


class Shadow(Action):
    """An action that follows somebody who stands still."""

    name = "shadow"
    goal = Goal(x=1.0, y=0.5, person=True)

    def decide(self, situation: Situation) -> Desire | None:
        """Want nothing."""
        return None


async def test_whom_a_mode_follows_is_told_where_the_map_has_them() -> None:
    async with (
        product(RobotScene(odom_in_map=Pose2(5.0, 0.0, pi / 2))) as the,
        Browser(the.app) as ann,
    ):
        await asyncio.sleep(SOON)
        the.robot.arbiter.start(Stack.alone(Shadow(), MODE))
        await asyncio.sleep(SOON)
        assert newest(ann)["target"] == {"x": 4.5, "y": 1.0, "heading": None, "person": True}


async def test_on_a_map_nothing_drives_straight(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    monkeypatch.setattr("pioneer3.web.navigation.installed", lambda: False)
    async with playground(line_map=ROOM) as the, Browser(the.app) as ann:
        await asyncio.sleep(SOON)
        forbids = ann.latest("hello")["robots"][0]["forbids"]
        assert forbids.startswith("navigation is not installed: the extra `nav` is missing; run: ")
        ann.say("goto", x=6, y=0)
        await asyncio.sleep(3.0)
        assert ann.latest("refused")["message"] == forbids
        assert newest(ann)["mode"] is None
        assert the.simulation.body.speeds[0] == 0.0


async def test_it_can_be_ended_and_ends_with_who_started_it() -> None:
    async with playground(line_map=ROOM) as the, Browser(the.app) as bob:
        body = the.simulation.robots[0].body
        bob.say("goto", x=6, y=0)
        await bob.stay(3.0)
        assert body.speeds[0] > 0.2
        bob.say("end_mode")
        await asyncio.sleep(1.0)
        assert body.speeds[0] == 0.0
        assert newest(bob)["mode"] is None
        async with Browser(the.app) as ann:
            bob.say("release_control")
            await asyncio.sleep(SOON)
            ann.say("goto", x=6, y=0)
            await ann.stay(3.0)
            assert body.speeds[0] > 0.2
            bob.say("end_mode")
            await asyncio.sleep(SOON)
            assert bob.latest("refused")["message"].endswith("has control")
        await asyncio.sleep(1.0)
        assert body.speeds[0] == 0.0


async def test_who_has_not_control_sends_it_nowhere() -> None:
    async with playground(line_map=ROOM) as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("take_control")
        await asyncio.sleep(SOON)
        bob.say("goto", x=6, y=0)
        await asyncio.sleep(SOON)
        assert bob.latest("refused")["message"].endswith("has control")
        assert newest(bob)["mode"] is None


@pytest.mark.parametrize("fields", [{"x": 1e9, "y": 0}, {"x": 1}, {"x": 1, "y": 0, "speed": 0}])
async def test_nonsense_is_not_understood(fields: dict[str, float]) -> None:
    async with playground() as the, Browser(the.app) as ann:
        ann.say("goto", **fields)
        await asyncio.sleep(SOON)
        assert ann.latest("refused")["message"].startswith("not understood")
