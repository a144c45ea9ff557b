"""What lasers see, on its way to the pages that want to know. Virtual time."""

import asyncio
from math import cos, inf, radians, sin

import pytest

from pioneer3.geometry import Pose2
from pioneer3.state import Scan
from pioneer3.web.broadcast import sweep
from pioneer3.web.messages import encode
from tests.support import wall_at
from tests.unit.web.browser import Browser, playground, strict

SOON = 0.5


def test_a_sweep_is_told_in_whole_numbers() -> None:
    scan = Scan(
        stamp=0.0,
        sequence=1,
        robot_in_odom=Pose2(),
        sensor_in_robot=Pose2(),
        angles=(-0.1, 0.0, 0.1),
        ranges=(1.2344, inf, 0.5),
    )
    assert strict(encode(sweep(7, scan, Pose2(1.0, -2.0, 0.5)))) == {
        "robot": 7,
        "laser": 0,
        "sensor_in_map": [1000, -2000, 500],
        "first": -0.1,
        "step": 0.1,
        "ranges": [1234, 0, 500],
    }


async def test_the_laser_is_on_while_a_page_wants_it() -> None:
    async with playground(line_map=wall_at(3.0)) as the, Browser(the.app) as ann:
        laser = the.robot.devices.laser
        await asyncio.sleep(SOON)
        assert ann.latest("hello")["robots"][0]["laser"] is True
        assert ann.all("scans") == []
        assert laser.latest is None
        ann.say("watch_lasers", on=True)
        await asyncio.sleep(2.0)
        assert 8 <= len(ann.all("scans")) <= 21
        ann.say("watch_lasers", on=False)
        await asyncio.sleep(SOON)
        count, last = len(ann.all("scans")), laser.latest
        await asyncio.sleep(2.0)
        assert len(ann.all("scans")) == count
        assert laser.latest is last


async def test_points_lie_on_the_wall_wherever_the_robot_was_lifted() -> None:
    async with playground(line_map=wall_at(3.0)) as the, Browser(the.app) as ann:
        the.simulation.robots[0].body.robot_in_world = Pose2(0.5, 1.0, 0.3)
        ann.say("watch_lasers", on=True)
        await asyncio.sleep(2.0)
        (scan,) = ann.latest("scans")["scans"]
        assert scan["robot"] == 1
        assert len(scan["ranges"]) == 181
        x, _, theta = (part / 1000 for part in scan["sensor_in_map"])
        bearings = [theta + scan["first"] + n * scan["step"] for n in range(181)]
        met = [
            x + r / 1000 * cos(bearing)
            for bearing, r in zip(bearings, scan["ranges"], strict=True)
            if r and abs(sin(bearing)) < sin(radians(45))
        ]
        assert len(met) > 60
        assert met == pytest.approx([3.0] * len(met), abs=0.1)


async def test_only_who_wants_it_is_told_and_it_goes_off_with_the_last() -> None:
    async with playground(line_map=wall_at(3.0)) as the, Browser(the.app) as ann:
        async with Browser(the.app) as bob:
            bob.say("watch_lasers", on=True)
            await asyncio.sleep(2.0)
            assert bob.all("scans")
        assert ann.all("scans") == []
        await asyncio.sleep(SOON)
        last = the.robot.devices.laser.latest
        await asyncio.sleep(1.0)
        assert the.robot.devices.laser.latest is last
