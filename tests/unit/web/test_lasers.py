"""Lasers at the computer, as pages are told of them. Virtual time."""

import asyncio
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import cos, pi

import pytest
from starlette.types import ASGIApp

from pioneer3 import Robot, connect_async
from pioneer3.geometry import Pose2
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.tasks import running
from pioneer3.web.app import make_app
from pioneer3.web.broadcast import SWEEP_PERIOD
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from tests.lasers import LaserUnit
from tests.support import SimulatedRobot, until, wall_at
from tests.unit.web.browser import Browser

REAR = Mounting(sensor_in_robot=Pose2(-0.2, 0.1, pi), upside_down=True)


@dataclass(frozen=True)
class Shown:
    """A robot with two lasers, before a wall, and the page of it."""

    robot: Robot
    front: LaserUnit
    app: ASGIApp


@asynccontextmanager
async def shown() -> AsyncIterator[Shown]:
    """Run all of it while the block lasts."""
    async with (
        SimulatedRobot(wall_at(3.0)) as sim,
        LaserUnit(sim, "utm-30lx", serial=True) as front,
        LaserUnit(sim, "tim551", serial=False, name_in_scans="laser2") as rear,
        connect_async(sim.open, lasers=[front.spec(), rear.spec(REAR)]) as robot,
    ):
        page = Page()
        await until(lambda: all(laser.lost is None for laser in robot.lasers))
        async with page.hosting(robot, RobotScene()), running(page.run()):
            yield Shown(robot, front, make_app(page))


async def test_the_hello_says_that_scans_come_by_themselves() -> None:
    async with shown() as the, Browser(the.app) as ann:
        await asyncio.sleep(0.5)
        (robot,) = ann.latest("hello")["robots"]
        assert (robot["laser"], robot["scans"]) == (True, True)


async def test_sweeps_of_several_lasers_are_told_apart() -> None:
    async with shown() as the, Browser(the.app) as ann:
        ann.say("watch_lasers", on=True)
        await asyncio.sleep(3.0)
        sweeps = [sweep for message in ann.all("scans") for sweep in message["scans"]]
        front = [sweep for sweep in sweeps if sweep["laser"] == 0]
        rear = [sweep for sweep in sweeps if sweep["laser"] == 1]
        assert len(front) + len(rear) == len(sweeps)
        for laser, count in ((front, 1081), (rear, 271)):
            assert 10 < len(laser) <= 3.0 / SWEEP_PERIOD + 1
            assert {len(sweep["ranges"]) for sweep in laser} == {count}
        assert rear[-1]["sensor_in_map"] == [-200, 100, round(1000 * pi)]
        before = [r for r in front[-1]["ranges"] if r]
        assert min(before) / 1000 == pytest.approx(
            3.0 - the.robot.laser.sensor_in_robot.x, abs=0.05
        )


async def test_points_lie_on_the_wall() -> None:
    async with shown() as the, Browser(the.app) as ann:
        ann.say("watch_lasers", on=True)
        await asyncio.sleep(2.0)
        sweeps = [sweep for message in ann.all("scans") for sweep in message["scans"]]
        sweep = next(sweep for sweep in reversed(sweeps) if sweep["laser"] == 0)
        x, _, theta = (part / 1000 for part in sweep["sensor_in_map"])
        bearings = [theta + sweep["first"] + i * sweep["step"] for i in range(1081)]
        met = [
            x + r / 1000 * cos(bearing)
            for bearing, r in zip(bearings, sweep["ranges"], strict=True)
            if r
        ]
        assert len(met) > 300
        assert met == pytest.approx([3.0] * len(met), abs=0.05)


async def test_who_no_longer_watches_is_told_nothing_and_the_laser_goes_on() -> None:
    async with shown() as the, Browser(the.app) as ann:
        ann.say("watch_lasers", on=True)
        await asyncio.sleep(1.0)
        ann.say("watch_lasers", on=False)
        await asyncio.sleep(0.5)
        count, laser = len(ann.all("scans")), the.robot.laser
        assert count > 5
        assert isinstance(laser, LaserDriver)
        before = laser.scans
        await asyncio.sleep(1.0)
        assert len(ann.all("scans")) == count
        assert laser.scans > before + 30


async def test_findings_tell_how_each_laser_is() -> None:
    async with shown() as the, Browser(the.app) as ann:
        ann.say("watch_details", on=True)
        await asyncio.sleep(2.0)
        findings = {each["check"]: each for each in ann.latest("details")["findings"]}
        assert findings["laser"]["level"] == "ok"
        # in the second before there are 40, or one less where it begins between two
        found = findings["laser"]["found"]
        assert re.search(r"UTM-30LX at /dev/laser: (39|40) scans/s$", found), found
        assert "TiM551 at tcp://laser2:10940: 1" in findings["laser2"]["found"]
        the.front.unplug()
        await until(lambda: the.robot.laser.lost)
        await asyncio.sleep(0.5)
        findings = {each["check"]: each for each in ann.latest("details")["findings"]}
        assert findings["laser"]["level"] == "fail"
        assert "/dev/laser" in findings["laser"]["found"]
        assert "plugged in" in findings["laser"]["advice"]
        assert findings["laser2"]["level"] == "ok"


async def test_a_laser_that_comes_back_is_shown_again() -> None:
    async with shown() as the, Browser(the.app) as ann:
        ann.say("watch_lasers", on=True)
        await asyncio.sleep(1.0)
        the.front.unplug()
        await until(lambda: the.robot.laser.lost)
        await asyncio.sleep(1.0)
        the.front.plug_in()
        await until(lambda: the.robot.laser.lost is None)
        count = len(ann.all("scans"))
        await asyncio.sleep(1.0)
        again = [sweep for message in ann.all("scans")[count:] for sweep in message["scans"]]
        assert {sweep["laser"] for sweep in again} == {0, 1}
