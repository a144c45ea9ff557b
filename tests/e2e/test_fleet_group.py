"""One keyboard leads robots of a fleet that form up, in one simulated world. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import hypot
from typing import Any

import pytest

from pioneer3.behaviors.modes.group import FollowLeader, Form, GroupMode, Spread
from pioneer3.fleet.drive import FleetDrive
from pioneer3.fleet.group import GroupKey as Doing
from pioneer3.fleet.spec import FleetRobot
from pioneer3.geometry import Pose2
from pioneer3.runtime.driven import Driven
from pioneer3.tasks import running
from pioneer3.teleop.keyboard import Manner
from tests.fleets import UP, robot
from tests.robots_together import Together, together
from tests.support import until

LINED_UP = [Pose2(0.0, 0.0), Pose2(0.0, -1.2), Pose2(0.0, -2.4)]


@dataclass
class Led:
    """Robots, and the keys that drive the leader."""

    here: Together
    drive: FleetDrive

    async def hold(self, token: str, seconds: float) -> None:
        for _ in range(round(seconds / 0.3)):
            self.drive.press(token)
            await asyncio.sleep(0.3)

    def modes(self) -> list[str | None]:
        modes = [driven.arbiter.mode for driven in self.here.robots]
        return [mode.name if mode else None for mode in modes]


@asynccontextmanager
async def led(
    mode: GroupMode | None,
    *poses: Pose2,
    leader: str | None = "p3at-2",
    **options: Any,
) -> AsyncIterator[Led]:
    async with together(*poses) as here:
        robots = [robot(number) for number in range(1, len(poses) + 1)]

        @asynccontextmanager
        async def connect(one: FleetRobot) -> AsyncIterator[Driven]:
            yield here.robots[robots.index(one)]

        doing = Doing(mode=mode, leader=leader) if mode else None
        drive = FleetDrive(robots, connect, Manner(speed=0.3), together=doing, **options)
        async with running(drive.run()):
            await until(lambda: all(member.told for member in drive.look()))
            await asyncio.sleep(1.0)
            yield Led(here, drive)


async def test_the_key_lets_them_form_up_and_the_arrows_lead() -> None:
    async with led(Form(formation="wedge", spacing=1.3), *LINED_UP) as the:
        assert the.modes() == [None] * 3  # nobody moves before the key
        the.drive.press("g")
        await asyncio.sleep(15.0)
        assert the.modes() == ["form", None, "form"]
        await the.hold(UP, 6.0)
        assert min(the.here.speeds) > 0.2
        leader = the.here.pose(1)
        for number, place in ((0, (-1.3, 1.3)), (2, (-1.3, -1.3))):
            there, pose = leader @ Pose2(*place), the.here.pose(number)
            assert hypot(there.x - pose.x, there.y - pose.y) < 0.2
        assert the.here.gap > 0.2


async def test_space_ends_the_mode_of_all_and_the_key_starts_it_again() -> None:
    async with led(FollowLeader(distance=1.2), *LINED_UP, leader="p3at-1") as the:
        the.drive.press("g")
        await the.hold(UP, 5.0)
        the.drive.press(" ")
        assert the.modes() == [None] * 3
        await asyncio.sleep(1.0)
        assert max(the.here.speeds) == 0.0
        the.drive.press("G")
        assert the.modes() == [None, "follow-leader", "follow-leader"]


async def test_a_terminal_without_the_focus_ends_it() -> None:
    async with led(Spread(apart=3.0), *LINED_UP, leader=None) as the:
        the.drive.press("g")
        await asyncio.sleep(4.0)
        assert max(the.here.speeds) > 0.1
        the.drive.let_go()
        assert the.modes() == [None] * 3
        await asyncio.sleep(1.5)
        assert max(the.here.speeds) == 0.0


async def test_its_time_is_over() -> None:
    async with led(Form(seconds=5.0), *LINED_UP) as the:
        the.drive.press("g")
        await asyncio.sleep(6.0)
        assert the.modes() == [None] * 3


class Real:
    """Says that no robot is simulated, as real ones do."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("pioneer3.navigation.simulator.is_simulator", lambda info: False)


async def test_real_robots_have_to_be_lined_up(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    Real(monkeypatch)
    async with led(Form(spacing=1.2), *LINED_UP) as the:
        the.drive.press("g")
        assert the.modes() == [None] * 3
        assert "it is not known where p3at-1 is: no simulator tells it; line" in caplog.text


async def test_real_robots_that_were_lined_up_form_by_their_wheels(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    Real(monkeypatch)
    async with led(Form(formation="line", spacing=1.3), *LINED_UP, lined_up=1.2) as the:
        the.drive.press("g")
        await asyncio.sleep(10.0)
        await the.hold(UP, 6.0)
        ys = [the.here.pose(number).y for number in range(3)]
        assert ys == [
            pytest.approx(0.1, abs=0.1),
            pytest.approx(-1.2, abs=0.1),
            pytest.approx(-2.5, abs=0.1),
        ]


async def test_a_robot_whose_link_was_lost_may_have_moved(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    Real(monkeypatch)
    async with led(Form(spacing=1.2), *LINED_UP, lined_up=1.2) as the:
        await the.here.cables[0].close()
        await asyncio.sleep(8.0)
        the.drive.press("g")
        assert the.modes() == [None] * 3
        assert "its link was lost since the robots were lined up" in caplog.text


async def test_keys_alone_keep_robots_apart_that_know_of_each_other() -> None:
    async with led(None, Pose2(0.0, 0.0), Pose2(2.5, 0.0)) as the:
        await the.hold(UP, 9.0)
        assert the.here.speeds == [0.0, 0.0]
        assert 0.2 < the.here.gap < 0.6
        told = the.drive.look()[0].told
        assert told is not None
        assert "p3at-2 is 0.1" in str(told.stands)
