"""Several robots of one page in one world: they keep apart, whoever drives them. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from math import pi

from starlette.types import ASGIApp

from pioneer3.behaviors.modes.group import Spread
from pioneer3.geometry import Pose2
from pioneer3.tasks import running
from pioneer3.web import requests
from pioneer3.web.app import make_app
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from tests.robots_together import Together, together
from tests.unit.web.browser import Browser


@dataclass
class Hall:
    """Robots in one world, and their page."""

    here: Together
    page: Page
    app: ASGIApp


@asynccontextmanager
async def hall(*poses: Pose2) -> AsyncIterator[Hall]:
    async with together(*poses) as here, AsyncExitStack() as stack:
        page = Page()
        for robot, one in zip(here.robots, here.simulation.robots, strict=True):
            scene = RobotScene.of(here.simulation, one)
            await stack.enter_async_context(page.hosting(robot, scene, one.name))
        await stack.enter_async_context(running(page.run()))
        yield Hall(here, page, make_app(page))


async def drive(browser: Browser, robot: int, v: float, seconds: float, w: float = 0.0) -> None:
    """Hold a key for one robot."""
    end = asyncio.get_running_loop().time() + seconds
    while asyncio.get_running_loop().time() < end:
        browser.say("drive", robot=robot, v=v, w=w)
        await asyncio.sleep(0.066)


async def test_one_message_drives_several_and_each_by_its_own_control() -> None:
    async with (
        hall(*(Pose2(0.0, 2.0 * n) for n in range(3))) as the,
        Browser(the.app) as ann,
        Browser(the.app) as bob,
    ):
        bob.say("take_control", robot=2)
        await asyncio.sleep(0.1)
        for _ in range(30):
            ann.say("drive", robot=1, v=0.3, w=0.0, also=[2, 3, 9])
            bob.say("ping", t=0)
            await asyncio.sleep(0.066)
        assert [speed > 0.2 for speed in the.here.speeds] == [True, False, True]
        refused = ann.latest("refused")["message"]
        assert refused.startswith("robot-2: ")
        assert refused.endswith(" has control")
        await ann.leave()
        await asyncio.sleep(0.5)
        assert the.here.speeds == [0.0] * 3


def test_a_student_drives_no_other_robot_and_starts_no_group() -> None:
    alone = requests.VelocityRequest(robot=1, v=0.1, w=0.0)
    more = requests.VelocityRequest(robot=1, v=0.1, w=0.0, also=(2,))
    group = requests.StartGroupMode(robots=(1, 2), mode=Spread())
    assert requests.refusal_for_student(alone, 1) is None
    assert str(requests.refusal_for_student(more, 1)) == requests.NOT_YOURS
    assert str(requests.refusal_for_student(group, 1)) == requests.ONLY_TEACHERS


async def test_a_group_begins_with_all_of_its_followers_or_with_none() -> None:
    async with (
        hall(*(Pose2(0.0, 1.5 * n) for n in range(3))) as the,
        Browser(the.app) as ann,
        Browser(the.app) as bob,
    ):
        form = {"mode": "form", "formation": "line", "spacing": 1.5}

        def modes() -> list[str | None]:
            running = [robot.arbiter.mode for robot in the.here.robots]
            return [mode.name if mode else None for mode in running]

        bob.say("take_control", robot=3)
        await asyncio.sleep(0.1)
        ann.say("start_group_mode", robots=[1, 2, 3], leader=1, mode=form)
        await asyncio.sleep(0.1)
        assert modes() == [None] * 3
        assert ann.latest("refused")["message"].startswith("robot-3: ")
        ann.say("start_group_mode", robots=[1, 2, 3], leader=3, mode=form)  # whom bob drives
        await asyncio.sleep(0.1)
        assert modes() == ["form", "form", None]
        ann.say("start_group_mode", robots=[1, 2], leader=1, mode={**form, "spacing": 0.6})
        await asyncio.sleep(0.1)
        assert "0.6 m from robot to robot is too near" in ann.latest("refused")["message"]
        assert modes() == ["form", "form", None]
        await ann.leave()
        assert modes() == [None] * 3


async def test_two_people_who_drive_at_each_other_stop_apart_and_are_told_why() -> None:
    async with (
        hall(Pose2(0.0, 0.0), Pose2(4.0, 0.1, pi)) as the,
        Browser(the.app) as ann,
        Browser(the.app) as bob,
    ):
        await asyncio.gather(drive(ann, 1, 0.7, 9.0), drive(bob, 2, 0.7, 9.0))
        assert the.here.speeds == [0.0, 0.0]
        assert 0.2 < the.here.gap < 0.7
        why = ann.snapshots(1)[-1]["why"]
        assert why.startswith("It stands because of limiter peers, robot-2 is 0.1")
        assert "robot-1 is 0.1" in bob.snapshots(2)[-1]["why"]
        await drive(ann, 1, -0.3, 2.0)  # away from it is free
        assert the.here.pose(0).x < 1.2
