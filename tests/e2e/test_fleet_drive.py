"""One keyboard drives a fleet over cables with faults. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from random import Random

import pytest

from pioneer3 import connect_async
from pioneer3.arcos.commands import Stop
from pioneer3.behaviors.actions import Hold
from pioneer3.errors import ConfigError, PortPermissionError
from pioneer3.fleet.drive import FleetDrive
from pioneer3.fleet.members import PAUSES, Reached
from pioneer3.fleet.spec import FleetRobot
from pioneer3.geometry import Twist2
from pioneer3.links import Link
from pioneer3.links.memory import null_modem
from pioneer3.runtime.arbiter import PROGRAM
from pioneer3.runtime.driven import Driven
from pioneer3.tasks import running
from pioneer3.teleop.keyboard import Manner
from tests.faults import Noise
from tests.fleets import ESCAPE, QUIT, UP, driven, simulated
from tests.support import until


async def test_all_drive_together_and_one_that_is_left_stands() -> None:
    async with simulated() as here, driven(here) as the:
        the.press("a", UP)
        await asyncio.sleep(2)
        assert here.speeds() == [0.2] * 5
        the.press("s", "2", "4", "y")
        await asyncio.sleep(2)
        assert here.speeds() == [0, 0.2, 0, 0.2, 0]
        the.press("3", UP)
        await asyncio.sleep(2)
        assert here.speeds() == [0, 0, 0.2, 0, 0]


async def test_space_stops_all_also_those_not_chosen() -> None:
    async with simulated(2) as here, driven(here) as the:
        the.press(UP)
        await asyncio.sleep(1)
        other, held = here.driven["p3at-2"].arbiter, Hold("program")
        other.add(held, PROGRAM)
        for _ in range(10):
            other.hold(held, Twist2(0.2, 0.0), 0.3)
            await asyncio.sleep(0.1)
        assert here.speeds() == [0.2, 0.2]
        the.press(" ")
        other.hold(held, Twist2(0.2, 0.0), 1.0)  # it began before the stop
        await asyncio.sleep(0.8)
        assert here.speeds() == [0, 0]


async def test_a_press_acts_for_a_moment_without_latch() -> None:
    async with simulated(2) as here, driven(here, Manner(speed=0.2)) as the:
        the.press("a", UP)
        await asyncio.sleep(0.5)
        assert all(speed > 0 for speed in here.speeds())
        await asyncio.sleep(0.6)
        assert here.speeds() == [0, 0]


async def test_what_is_latched_ends_when_nobody_is_there() -> None:
    manner = Manner(speed=0.2, latch=True, patience=3.0)
    async with simulated(2) as here, driven(here, manner) as the:
        the.press("a", UP)
        await asyncio.sleep(2.5)
        assert here.speeds() == [0.2, 0.2]
        await asyncio.sleep(1.5)
        assert here.speeds() == [0, 0]


async def test_one_of_five_is_down_and_the_others_drive() -> None:
    async with simulated() as here:
        here.sims["p3at-3"].plugged = False
        async with driven(here, connected=4) as the:
            the.press("a", UP)
            await asyncio.sleep(2)
            assert here.speeds() == [0.2, 0.2, 0, 0.2, 0.2]
            down = the.member(3)
            assert (down.reached, down.why) == (Reached.WAITS, "memory: no such port")
            assert down.told is None


async def test_the_pauses_between_attempts_grow_and_it_joins_once_it_is_there() -> None:
    async with simulated(2) as here:
        here.sims["p3at-2"].plugged = False
        async with driven(here, connected=1) as the:
            began = asyncio.get_running_loop().time()
            await asyncio.sleep(60)
            assert here.attempts["p3at-2"] == pytest.approx(5 + (60 - sum(PAUSES[:4])) / 8, abs=2)
            the.press("a", UP)
            here.sims["p3at-2"].plugged = True
            await until(lambda: the.member(2).reached is Reached.CONNECTED)
            assert the.member(2).since > began + 60
            await asyncio.sleep(1)
            assert here.speeds() == [0.2, 0]  # the key was pressed before it was there
            the.press(UP)
            await asyncio.sleep(2)
            assert here.speeds() == [0.2, 0.2]


async def test_a_robot_behind_a_silent_link_stands_by_itself_and_the_others_go_on() -> None:
    async with simulated() as here, driven(here) as the:
        the.press("a", UP)
        await asyncio.sleep(2)
        the.sim(4).silent = True
        stood = await until(lambda: the.sim(4).speed == 0)
        assert stood < 2.6  # the robot's own watchdog, 2 s, then it brakes
        assert here.speeds() == [0.2, 0.2, 0.2, 0, 0.2]
        await asyncio.sleep(1)
        lost = the.member(4)
        assert lost.reached is Reached.LOST
        assert "silent" in lost.why or "nothing" in lost.why
        the.sim(4).silent = False
        await until(lambda: the.member(4).reached is Reached.CONNECTED)
        await asyncio.sleep(3)
        assert here.speeds() == [0.2, 0.2, 0.2, 0, 0.2]  # only a fresh key moves it
        the.press(UP)
        await asyncio.sleep(2)
        assert here.speeds() == [0.2] * 5


async def test_a_cable_that_is_pulled_costs_nobody_else_anything() -> None:
    async with simulated() as here, driven(here) as the:
        the.press("a", UP)
        await asyncio.sleep(2)
        await the.sim(1).unplug()
        await asyncio.sleep(4)
        assert here.speeds() == [0, 0.2, 0.2, 0.2, 0.2]
        assert the.member(1).reached is Reached.LOST
        the.press(" ")
        await asyncio.sleep(1)
        assert here.speeds() == [0] * 5


async def test_robots_behind_noisy_and_slow_links_drive_and_stop() -> None:
    async with simulated() as here:
        for number, sim in enumerate(here.sims.values()):
            sim.to_robot = sim.to_host = Noise(Random(number), corrupt=0.002, drop=0.002)
            sim.latency = 0.25
        async with driven(here) as the:
            the.press("a", UP)
            await asyncio.sleep(3)
            assert here.speeds() == [0.2] * 5
            the.press(" ")
            await until(lambda: here.speeds() == [0] * 5, within=1.5)


async def test_the_emergency_stop_is_for_all_and_for_those_who_come_later() -> None:
    async with simulated(3) as here:
        here.sims["p3at-3"].plugged = False
        async with driven(here, connected=2) as the:
            the.press("1", UP)
            await asyncio.sleep(1)
            the.press("k")
            await asyncio.sleep(1)
            assert here.speeds() == [0, 0, 0]
            assert not any(sim.powered for sim in here.sims.values())
            here.sims["p3at-3"].plugged = True
            await until(lambda: the.member(3).reached is Reached.CONNECTED)
            the.press("a", UP)
            await asyncio.sleep(1)
            assert here.speeds() == [0, 0, 0]
            assert "emergency stop" in str(the.told(3).stands)
            the.press("\x12", UP)
            await asyncio.sleep(2)
            assert here.speeds() == [0.2, 0.2, 0.2]


async def test_capitals_stop_as_well() -> None:
    async with simulated(2) as here, driven(here) as the:
        the.press("A", UP)
        await asyncio.sleep(1)
        the.press("K")
        await asyncio.sleep(1)
        assert here.speeds() == [0, 0]
        assert the.drive.board.emergency


async def test_escape_first_leaves_the_choice_and_quits_then() -> None:
    async with simulated(2) as here, driven(here) as the:
        the.press("s", "2", ESCAPE)
        assert not the.drive.over.is_set()
        assert the.drive.board.selection.chosen == ("p3at-1",)
        the.press(ESCAPE)
        assert the.drive.over.is_set()


async def test_quitting_lets_all_stand() -> None:
    async with simulated() as here:
        async with driven(here) as the:
            the.press("a", UP)
            await asyncio.sleep(2)
            the.press(QUIT)
            assert the.drive.over.is_set()
        assert here.speeds() == [0] * 5
        for sim in here.sims.values():
            assert Stop() in sim.wires[-1].commands[-6:]


async def test_a_robot_that_hangs_while_all_leave_holds_nobody_up() -> None:
    async with simulated() as here:
        clock = asyncio.get_running_loop().time
        async with driven(here) as the:
            the.press("a", UP)
            await asyncio.sleep(2)
            the.sim(2).silent = True
            began = clock()
        assert clock() - began < 2.5
        assert [speed for n, speed in enumerate(here.speeds()) if n != 1] == [0] * 4


async def test_a_refusal_is_told_and_so_is_a_failure_of_this_program() -> None:
    async with simulated(3) as here:

        @asynccontextmanager
        async def connect(robot: FleetRobot) -> AsyncIterator[Driven]:
            if robot.name == "p3at-1":
                raise PortPermissionError("this user may not open it")
            if robot.name == "p3at-2":
                raise AttributeError("a mistake")
            async with here.connect(robot) as one:
                yield one

        drive = FleetDrive(here.robots, connect, Manner(speed=0.2, latch=True))
        async with running(drive.run()):
            await until(lambda: drive.look()[2].told)
            refused, failed, _ = drive.look()
            assert (refused.reached, refused.why) == (Reached.REFUSED, "this user may not open it")
            assert (failed.reached, failed.why) == (Reached.LOST, "AttributeError: a mistake")
            drive.press("a")
            drive.press(UP)
            await asyncio.sleep(2)
            assert here.speeds() == [0, 0, 0.2]


async def test_a_robot_that_hangs_up_at_once_refuses_this_program() -> None:
    async def open_link() -> Link:
        near, far = null_modem()
        await far.close()
        return near

    async with simulated(1) as here:
        drive = FleetDrive(
            here.robots, lambda robot: connect_async(open_link), Manner(speed=0.2, latch=True)
        )
        async with running(drive.run()):
            await until(lambda: drive.look()[0].reached is not Reached.WAITS)
            assert drive.look()[0].reached is Reached.REFUSED
            assert "is another one connected to it?" in drive.look()[0].why


async def test_a_fleet_without_robots_is_refused() -> None:
    async with simulated(0) as here:
        with pytest.raises(ConfigError, match="nobody to drive"):
            FleetDrive(here.robots, here.connect, Manner())
