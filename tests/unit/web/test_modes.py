"""Modes that a page starts: what runs, who may end it, and what ends it. Virtual time."""

import asyncio
from math import hypot, pi

import pytest

from pioneer3.geometry import Pose2
from pioneer3.web.access.sessions import Role
from pioneer3.web.control import SILENCE
from tests.support import STAYED
from tests.unit.web.browser import Browser, playground, product
from tests.unit.web.test_roles import arrive

WANDER = {"mode": "wander", "preset": "lab", "seconds": 120}
BRAKING = 0.4


@pytest.mark.parametrize(
    ("wish", "name"),
    [
        (WANDER, "wander"),
        ({"mode": "wander", "preset": "explore", "speed": 0.2}, "wander"),
        ({"mode": "follow", "rule": "lab", "keep": 0.5}, "follow"),
        ({"mode": "follow"}, "follow"),
        ({"mode": "turn", "angle": 3}, "turn"),
    ],
)
async def test_a_page_starts_a_mode_and_ends_it(wish: dict[str, object], name: str) -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("start_mode", mode=wish)
        await ann.stay(1.0)
        assert ann.all("refused") == []
        assert ann.snapshot["mode"] == name
        assert ann.driver in {"you", None}  # lab's rule has nobody to follow
        assert ann.latest("people")["control"][0]["name"] == "script"
        ann.say("end_mode")
        await ann.stay(1.0)
        now = ann.snapshot
        assert now["mode"] is None
        assert now["ended"] == {
            "mode": name,
            "done": False,
            "why": "script ended it",
            "place": "",
        }
        assert the.speed == 0.0


async def test_a_mode_goes_on_while_its_page_is_heard_of() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("start_mode", mode=WANDER)
        await ann.stay(30.0)
        assert ann.snapshot["mode"] == "wander"
        assert the.travelled > 2.0


async def test_a_mode_ends_with_its_time() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("start_mode", mode=WANDER | {"seconds": 5})
        await ann.stay(6.0)
        assert ann.snapshot["ended"]["why"] == "its time was over"
        assert the.speed == 0.0


async def test_a_mode_ends_when_its_page_is_closed() -> None:
    async with product() as the, Browser(the.app) as bob:
        async with Browser(the.app) as ann:
            ann.say("start_mode", mode=WANDER)
            await ann.stay(3.0)
            assert the.speed > 0.1
        await asyncio.sleep(BRAKING)
        assert the.speed == 0.0
        assert "let go" in bob.snapshot["ended"]["why"]


async def test_a_mode_ends_when_nothing_is_heard_of_its_page() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("start_mode", mode=WANDER)
        await ann.stay(3.0)
        await bob.stay(SILENCE - 1.1)  # who else is there does not count
        assert the.speed > 0.1
        await asyncio.sleep(0.1 + BRAKING)
        assert the.speed == 0.0
        assert "nothing was heard of" in bob.snapshot["ended"]["why"]


async def test_a_stop_by_anybody_ends_a_mode() -> None:
    async with product() as the, Browser(the.app) as ann, arrive(the, Role.VIEWER) as vera:
        ann.say("start_mode", mode=WANDER)
        await ann.stay(3.0)
        vera.say("stop")
        await ann.stay(1.0)
        assert the.speed == 0.0
        assert ann.snapshot["ended"]["why"] == "Vera stopped the robot"
        assert ann.latest("told")["message"].startswith("Vera stopped the robot")


async def test_only_who_has_control_starts_and_ends_modes() -> None:
    async with product() as the, Browser(the.app) as ann, Browser(the.app) as bob:
        ann.say("start_mode", mode=WANDER)
        await ann.stay(2.0)
        bob.say("start_mode", mode={"mode": "follow"})
        bob.say("end_mode")
        bob.say("goto", x=1, y=1)
        await ann.stay(1.0)
        assert [m["message"] for m in bob.all("refused")] == ["script has control"] * 3
        assert ann.snapshot["mode"] == "wander"
        assert the.speed > 0.1


async def test_a_latched_robot_starts_no_mode_and_says_why() -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("emergency_stop")
        ann.say("start_mode", mode=WANDER)
        await ann.stay(2.0)
        assert ann.latest("refused")["message"] == "the emergency stop is latched"
        assert ann.snapshot["mode"] is None
        assert the.travelled < STAYED


@pytest.mark.parametrize(
    "mode",
    [
        {"mode": "dance"},
        {"mode": "wander", "preset": "wild"},
        {"mode": "wander", "speed": -1},
        {"mode": "follow", "keep": 0},
        {"mode": "wander", "seconds": 1e9},
        {"mode": "goto", "x": 1e300, "y": 0},
        {},
    ],
)
async def test_modes_that_are_none_are_refused(mode: dict[str, object]) -> None:
    async with product() as the, Browser(the.app) as ann:
        ann.say("start_mode", mode=mode)
        await ann.stay(1.0)
        assert "not understood" in ann.latest("refused")["message"]
        assert the.travelled < STAYED


async def test_goto_takes_a_place_of_the_map_not_of_odometry() -> None:
    start = Pose2(3.0, 2.0, pi / 2)  # odometry's origin lies here
    async with playground(start) as the, Browser(the.app) as ann:
        await asyncio.sleep(0.5)
        ann.say("goto", x=3.0, y=3.5, heading=0.0)
        await ann.stay(25.0)
        end = the.simulation.body.robot_in_world
        assert ann.snapshot["ended"]["done"], ann.snapshot["ended"]
        assert hypot(end.x - 3.0, end.y - 3.5) < 0.2
        assert abs(end.theta) < 0.2
