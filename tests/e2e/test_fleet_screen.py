"""The screen of `fleet drive`, with few robots and many, by textual's Pilot. Real time."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass

import pytest
from textual.pilot import Pilot

from pioneer3.errors import PortNotFoundError
from pioneer3.fleet.drive import FleetDrive
from pioneer3.fleet.screen import FleetApp
from pioneer3.fleet.spec import FleetRobot
from pioneer3.runtime.driven import Driven
from pioneer3.tasks import running
from pioneer3.teleop.keyboard import Manner
from tests.fleets import Simulated, robot, simulated

pytestmark = pytest.mark.realtime


@dataclass
class Screen:
    """The screen as a person sees it."""

    app: FleetApp
    drive: FleetDrive
    pilot: Pilot[None]

    @property
    def lines(self) -> list[str]:
        strips = self.app.screen._compositor.render_strips()
        return ["".join(segment.text for segment in strip) for strip in strips]

    def row(self, name: str) -> str:
        return next((line for line in self.lines[2:] if f" {name} " in line), "")

    @property
    def chosen(self) -> list[str]:
        return list(self.drive.board.selection.chosen)

    async def sees(self, text: str, where: str | None = None) -> None:
        await self.until(
            lambda: text in (self.row(where) if where is not None else "\n".join(self.lines))
        )

    async def until(self, holds: Callable[[], object]) -> None:
        async with asyncio.timeout(30):
            while not holds():  # noqa: ASYNC110  nobody tells when
                await asyncio.sleep(0.02)

    async def click(self, name: str) -> None:
        line = next(at for at, text in enumerate(self.lines) if f" {name} " in text and at > 1)
        assert await self.pilot.click(offset=(20, line))


@asynccontextmanager
async def screen(
    here: Simulated, columns: int = 80, rows: int = 24, *, latch: bool = False
) -> AsyncIterator[Screen]:
    drive = FleetDrive(here.robots, here.connect, Manner(speed=0.2, latch=latch))
    app = FleetApp(drive)
    async with running(drive.run()), app.run_test(size=(columns, rows)) as pilot:
        yield Screen(app, drive, pilot)


async def test_five_robots_one_of_them_down() -> None:
    async with simulated() as here:
        here.sims["p3at-3"].plugged = False
        async with screen(here) as the:
            await the.sees("4 connected")
            assert the.lines[0].startswith("5 robots: 1 waits, 4 connected; 0 move")
            assert len(the.lines) == 24
            await the.sees("connected", "p3at-5")
            await the.sees("no such port", "p3at-3")
            assert the.row("p3at-1").startswith("drives 1")
            assert "emergency stop of all" in "\n".join(the.lines[-4:])
            assert "Ctrl-D: quit" in "\n".join(the.lines[-2:])


async def test_keys_choose_drive_and_stop() -> None:
    async with simulated(3) as here, screen(here, latch=True) as the:
        await the.sees("3 connected")
        await the.pilot.press("s", "2")
        await the.sees("marked", "p3at-2")
        await the.sees("Which ones?")
        await the.pilot.press("q", "y")
        assert the.chosen == ["p3at-2", "p3at-3"]
        await the.pilot.press("up")
        await the.until(lambda: here.speeds() == [0, 0.2, 0.2])
        await the.sees("0.20", "p3at-2")
        await the.sees("2 move")
        await the.pilot.press("tab")
        assert the.chosen == ["p3at-1"]
        await the.pilot.press("a", "up")
        await the.until(lambda: here.speeds() == [0.2] * 3)
        await the.pilot.press("space")
        await the.until(lambda: here.speeds() == [0] * 3)
        await the.pilot.press("k")
        await the.sees("EMERGENCY STOP is latched")
        await the.sees("off", "p3at-3")
        await the.pilot.press("ctrl+r")
        await the.until(lambda: "EMERGENCY" not in the.lines[0])


async def test_a_click_lets_a_robot_drive_too_or_not() -> None:
    async with simulated(3) as here, screen(here) as the:
        await the.sees("3 connected")
        await the.click("p3at-3")
        assert the.chosen == ["p3at-1", "p3at-3"]
        await the.sees("drives", "p3at-3")
        await the.click("p3at-1")
        assert the.chosen == ["p3at-3"]
        await the.pilot.press("s")
        await the.click("p3at-2")
        await the.sees("marked", "p3at-2")
        await the.pilot.press("escape")
        assert the.chosen == ["p3at-3"]
        assert not the.drive.over.is_set()


async def test_a_terminal_that_loses_the_focus_lets_go() -> None:
    async with simulated(2) as here, screen(here, latch=True) as the:
        await the.sees("2 connected")
        await the.pilot.press("a", "up")
        await the.until(lambda: here.speeds() == [0.2] * 2)
        the.app.on_app_blur()
        await the.until(lambda: here.speeds() == [0] * 2)


async def test_the_terminal_obeys_nothing_that_robots_say() -> None:
    async with simulated(1) as here, screen(here) as the:
        await the.sees("1 connected")
        the.app.say("its name is \x1b[2J\x9b2J")
        await the.sees(r"its name is \x1b[2J\x9b2J")


@pytest.mark.parametrize("key", ["ctrl+d", "ctrl+c", "escape"])
async def test_the_screen_ends(key: str) -> None:
    async with simulated(1) as here, screen(here) as the:
        await the.sees("1 connected")
        await the.pilot.press(key)
        await the.until(lambda: not the.app.is_running)


async def test_a_hundred_robots_scroll_and_the_one_chosen_is_seen() -> None:
    @asynccontextmanager
    async def nobody(robot: FleetRobot) -> AsyncIterator[Driven]:
        raise PortNotFoundError(f"{robot.port}: nobody listens there")
        yield

    robots = [robot(number) for number in range(1, 101)]
    drive = FleetDrive(robots, nobody, Manner())
    app = FleetApp(drive)
    async with running(drive.run()), app.run_test(size=(80, 24)) as pilot:
        the = Screen(app, drive, pilot)
        await the.sees("100 waits")
        assert the.row("p3at-2")
        assert not the.row("p3at-70")
        await the.pilot.press("0", "7")
        await the.sees("number: 07_")
        await the.pilot.press("0")
        assert the.chosen == ["p3at-70"]
        await the.until(lambda: the.row("p3at-70"))
        assert the.row("p3at-70").startswith("drives 070")
        await the.click("p3at-68")
        assert the.chosen == ["p3at-68", "p3at-70"]
        await the.pilot.press("home")
        await the.until(lambda: the.row("p3at-2"))
        await the.pilot.press("end")
        await the.until(lambda: the.row("p3at-100"))
        await the.pilot.press("pageup", "a")
        await the.sees("Keys drive ALL ROBOTS")


async def test_what_does_not_fit_is_cut_and_nothing_breaks_when_it_is_narrow() -> None:
    async with simulated(2) as here, screen(here, 40, 12) as the:
        await the.sees("2 connected")
        assert all(len(line) <= 40 for line in the.lines)
        await the.pilot.press("a")
        assert the.chosen == ["p3at-1", "p3at-2"]
