"""The demo's screen at 80 x 24 and larger, driven by textual's Pilot, in real time."""

import asyncio
import re
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial

import pytest
from textual.pilot import Pilot

from pioneer3.demo.app import DemoApp
from pioneer3.demo.program import Program
from pioneer3.navigation.connect import connect_async
from pioneer3.sim.equipment import Equipment
from tests.support import SimulatedRobot, wall_at

pytestmark = pytest.mark.realtime

EVERYTHING = Equipment(gripper=True, compass=True, gyro_type=1, camera="vcc4", camera_port=2)
LETTERS = "tuwlbspcdofimag"
KEYS = ("up", "down", "left", "right", "space", "pageup", "pagedown", "enter", "backspace", "tab")
"""Keys with names; the others are pressed in `test_demo_modes.py`."""
RATE = re.compile(r"connected +[1-9]\d*/s")
"""Reports that come: ten a second, or fewer on a busy machine."""


@dataclass
class Screen:
    """The demo as a person sees it."""

    app: DemoApp
    pilot: Pilot[None]
    sim: SimulatedRobot
    program: Program

    @property
    def lines(self) -> list[str]:
        """All rows of the screen, as text."""
        strips = self.app.screen._compositor.render_strips()
        return ["".join(segment.text for segment in strip) for strip in strips]

    @property
    def text(self) -> str:
        return "\n".join(self.lines)

    async def press(self, *keys: str) -> None:
        await self.pilot.press(*keys)

    async def sees(self, text: str) -> None:
        await self.until(lambda: text in self.text)

    async def until(self, holds: Callable[[], object]) -> None:
        async with asyncio.timeout(30):
            while not holds():  # noqa: ASYNC110  nobody tells when
                await asyncio.sleep(0.1)


@asynccontextmanager
async def screen(
    columns: int = 80, rows: int = 24, *, equipment: Equipment | None = None, wall: float = 3.0
) -> AsyncIterator[Screen]:
    made: list[Program] = []
    async with (
        SimulatedRobot(wall_at(wall), equipment=equipment) as sim,
        connect_async(sim.open) as robot,
    ):

        def make(app: DemoApp) -> Program:
            made.append(partial(Program, robot)(app))
            return made[0]

        app = DemoApp(make)
        async with app.run_test(size=(columns, rows)) as pilot:
            shown = Screen(app, pilot, sim, made[0])
            await shown.sees("motors enabled")
            yield shown
        app.raise_failure()


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (160, 50), (100, 30)])
async def test_what_matters_is_on_the_screen_at_any_size(columns: int, rows: int) -> None:
    async with screen(columns, rows) as the:
        await the.until(lambda: RATE.search(the.text))
        assert len(the.lines) == rows
        first, last = the.lines[0], the.lines[-1]
        assert first.startswith(" SIMULATOR  MobileSim, Pioneer 3-AT  memory:host connected")
        assert "EMERGENCY STOP" in last
        assert "Ctrl-R: release it" in last
        assert "Esc: quit" in last
        for key in LETTERS:
            await the.until(lambda: any(line.startswith(f" {key} ") for line in the.lines))  # noqa: B023
        assert "  transVel    rotVel         x         y        th     volts" in the.text
        assert any("\u2801" <= letter <= "\u28ff" for letter in the.text)  # dots of the ring
        assert "Nothing is asked" in the.text or "It stands because" in the.text


@pytest.mark.parametrize("key", LETTERS)
async def test_every_mode_is_entered_and_every_key_pressed_at_80_x_24(key: str) -> None:
    async with screen(equipment=EVERYTHING) as the:
        await the.press("b" if key != "b" else "s", key)
        assert the.program.active.about.key == key
        await the.sees(the.program.active.about.name.upper())
        await the.press(*KEYS)
        await the.pilot.pause(0.3)
        assert the.program.active.about.key == key
        assert len(the.lines) == 24
        assert "failed" not in the.text
        await the.press("space")


async def test_a_speed_is_shown_big_and_driven() -> None:
    async with screen() as the:
        await the.press(*["up"] * 6)
        await the.until(lambda: the.sim.speed > 0.2)
        await the.sees("ratio input, by keys")
        await the.sees("┗━┛%")
        digits = next(number for number, line in enumerate(the.lines) if "┗━┛%" in line)
        assert "╺╋╸ ━┫┃ ┃" in the.lines[digits - 1]  # +30
        await the.sees("moving")
        await the.press("space")
        await the.until(lambda: the.sim.speed == 0)


async def test_help_covers_the_panel_until_the_next_key() -> None:
    async with screen(100, 40) as the:
        await the.press("question_mark")
        await the.sees("detailed status/error flags mode: 'f' or 'F'")
        await the.press("s")
        await the.until(lambda: "mode: 'f'" not in the.text)


async def test_the_emergency_stop_is_shown_until_it_is_released() -> None:
    async with screen() as the:
        await the.press("k")
        await the.sees("E-STOP LATCHED")
        await the.sees("motors off")
        await the.press("ctrl+r")
        await the.until(lambda: "E-STOP LATCHED" not in the.text)


async def test_a_lost_robot_is_shown_and_its_return_too() -> None:
    async with screen() as the:
        await the.press("w")
        await the.until(lambda: the.sim.speed > 0.1)
        await the.sim.unplug()
        await the.sees("NO READINGS")
        await the.sees("LOST")
        await the.press("s", "up", "w")
        the.sim.plugged = True
        await the.until(lambda: RATE.search(the.text))
        assert the.sim.speed == 0
        await the.press("s", "w")
        await the.until(lambda: the.sim.speed > 0.1)


async def test_a_missing_device_is_marked_and_explained() -> None:
    async with screen() as the:
        await the.sees("g gripper ✗")
        await the.press("g")
        await the.sees("HasGripper 0")


async def test_long_reports_scroll() -> None:
    async with screen() as the:
        await the.press("o")
        await the.sees("serial_number")
        await the.press(*["pagedown"] * 9)
        await the.sees("of the model p3at-sh")
        await the.press(*["pageup"] * 9)
        await the.sees("serial_number")


async def test_the_ring_shows_the_wall_and_the_laser_its_points() -> None:
    async with screen(wall=1.0) as the:
        await the.press("l")
        await the.sees("Close: 1000mm")


@pytest.mark.parametrize("key", ["escape", "ctrl+c", "ctrl+d", "ctrl+q"])
async def test_every_key_to_leave_stops_the_robot(key: str) -> None:
    async with screen() as the:
        await the.press(*["up"] * 8)
        await the.until(lambda: the.sim.speed > 0.1)
        await the.press(key)
        await the.until(lambda: the.sim.speed == 0)


async def test_a_tiny_terminal_does_not_fail() -> None:
    async with screen(80, 24) as the:
        for columns, rows in ((20, 6), (10, 3), (1, 1), (300, 100), (80, 24)):
            await the.pilot.resize_terminal(columns, rows)
            await the.press("s", "o", "t")
            await the.pilot.pause(0.2)
        await the.sees("EMERGENCY STOP")
