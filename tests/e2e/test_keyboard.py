"""`pioneer3 drive` in a terminal of its own, with a person at the keyboard, in real time."""

import asyncio
import os
import pty
import signal
import subprocess
import sys
import termios
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Any

import pytest

from pioneer3.runtime.simulation import RunningSimulation, simulator
from tests.e2e.processes import PATIENCE, environment, in_session, until

pytestmark = pytest.mark.realtime

UP, DOWN, RIGHT, LEFT = b"\x1b[A", b"\x1b[B", b"\x1b[C", b"\x1b[D"
CTRL_C = b"\x03"
SHOW_CURSOR = b"\x1b[?25h"
PLAIN = "2D-Map\nNumLines: 1\nLINES\n50000 -1000 50000 1000\n"
IN_TERMINAL = """
import fcntl, os, sys, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
os.execv(sys.executable, [sys.executable, "-m", "pioneer3", *sys.argv[1:]])
"""
SLACK = 0.5
"""How far a busy machine may let the robot go on [m]."""
REPEATING = 0.1
"""Between two repeats of a held key [s]; much shorter than a key acts."""


@dataclass
class Person:
    """Somebody at a terminal in which `pioneer3 drive` runs.

    Attributes:
        screen: Everything the terminal has shown.
        before: Settings of the terminal before the command was started.
    """

    simulation: RunningSimulation
    process: asyncio.subprocess.Process
    keyboard: int
    terminal: int
    before: list[Any]
    screen: bytes = b""

    @property
    def speed(self) -> float:
        return self.simulation.body.drive.linear.velocity

    @property
    def turn_rate(self) -> float:
        return self.simulation.body.drive.angular.velocity

    @property
    def standing(self) -> bool:
        return self.speed == self.turn_rate == 0.0

    @property
    def travelled(self) -> float:
        home, here = self.simulation.body.home, self.simulation.body.robot_in_world
        return hypot(here.x - home.x, here.y - home.y)

    def type(self, keys: bytes) -> None:
        os.write(self.keyboard, keys)

    async def hold(self, key: bytes, seconds: float) -> None:
        """Hold a key for that long at least."""
        for _ in range(round(seconds / REPEATING)):
            self.type(key)
            await asyncio.sleep(REPEATING)

    async def sees(self, text: bytes) -> None:
        """Wait until the screen shows `text`, counted from now."""
        seen = len(self.screen)
        await until(lambda: text in self.screen[seen:])

    async def code(self) -> int:
        """Wait for the end; return the exit code."""
        async with asyncio.timeout(PATIENCE):
            code = await self.process.wait()
        assert in_session(self.process.pid) == []
        return code

    def read(self) -> None:
        try:
            self.screen += os.read(self.keyboard, 65536)
        except OSError:
            asyncio.get_running_loop().remove_reader(self.keyboard)

    def hang_up(self) -> None:
        """Close the window: the terminal is gone."""
        asyncio.get_running_loop().remove_reader(self.keyboard)
        for end in (self.keyboard, self.terminal):
            os.close(end)
        self.keyboard = self.terminal = -1


@asynccontextmanager
async def person(tmp_path: Path, *options: str) -> AsyncIterator[Person]:
    """Start the command in a terminal and wait until it drives."""
    plain = tmp_path / "plain.map"
    plain.write_text(PLAIN)
    keyboard, terminal = pty.openpty()
    async with simulator(map_name=plain, port=0) as running:
        before = termios.tcgetattr(terminal)
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-c", IN_TERMINAL, "drive", "--port", running.url, *options),
            stdin=terminal,
            stdout=terminal,
            stderr=terminal,
            env=environment(),
            start_new_session=True,
        )
        the = Person(running, process, keyboard, terminal, before)
        asyncio.get_running_loop().add_reader(keyboard, the.read)
        try:
            await until(lambda: b"Nothing is asked of it" in the.screen)
            yield the
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
            if the.keyboard >= 0:
                the.hang_up()


async def test_it_says_in_capitals_what_is_driven_and_which_keys_there_are(tmp_path: Path) -> None:
    async with person(tmp_path) as the:
        assert b"SIMULATOR: Pioneer 3-AT" in the.screen
        assert b"q: quit" in the.screen
        the.type(b"q")
        assert await the.code() == 0


@pytest.mark.parametrize(
    ("keys", "sign_v", "sign_w"),
    [(UP, 1, 0), (DOWN, -1, 0), (LEFT, 0, 1), (RIGHT, 0, -1)],
    ids=["up", "down", "left", "right"],
)
async def test_a_held_arrow_moves_and_letting_go_stops(
    tmp_path: Path, keys: bytes, sign_v: int, sign_w: int
) -> None:
    async with person(tmp_path) as the:
        while the.speed * sign_v < 0.2 and the.turn_rate * sign_w < 0.3:
            await the.hold(keys, REPEATING)
        await until(lambda: the.standing)


async def test_one_press_moves_a_little_and_ends_by_itself(tmp_path: Path) -> None:
    async with person(tmp_path) as the:
        the.type(UP)
        await until(lambda: the.speed > 0.05)
        await until(lambda: the.standing)
        assert 0.02 < the.travelled < 0.3 + SLACK  # 0.6 s at 0.5 m/s, had it begun with that


async def test_repeats_extend_a_press(tmp_path: Path) -> None:
    async with person(tmp_path) as the:
        while the.speed < 0.3:  # one press reaches 0.18 m/s: 0.6 s at 0.3 m/s2
            await the.hold(UP, REPEATING)
        await until(lambda: the.standing)


async def test_space_stops_although_the_key_would_act_on(tmp_path: Path) -> None:
    async with person(tmp_path, "--latch") as the:
        the.type(UP)
        await until(lambda: the.speed > 0.2)
        the.type(b" ")
        await until(lambda: the.standing)
        await asyncio.sleep(0.5)
        assert the.standing


async def test_latched_one_press_keeps_moving(tmp_path: Path) -> None:
    async with person(tmp_path, "--latch", "--speed", "0.3") as the:
        the.type(UP)
        await until(lambda: the.travelled > 0.6)
        assert the.speed == pytest.approx(0.3)
        the.type(b"q")
        assert await the.code() == 0
        await until(lambda: the.standing)


async def test_plus_and_minus_change_the_speed_shown(tmp_path: Path) -> None:
    async with person(tmp_path, "--speed", "0.4") as the:
        await the.sees(b"[0.40 0.50]")
        the.type(b"+")
        await the.sees(b"[0.44 0.55]")
        the.type(b"--")
        await the.sees(b"[0.36 0.45]")


async def test_q_leaves_with_the_terminal_as_it_was_and_the_robot_without_power(
    tmp_path: Path,
) -> None:
    async with person(tmp_path) as the:
        assert termios.tcgetattr(the.terminal) != the.before
        await the.hold(UP, 0.5)
        the.type(b"q")
        assert await the.code() == 0
        assert termios.tcgetattr(the.terminal) == the.before
        await until(lambda: the.standing)
        assert not the.simulation.body.drive.powered
        await until(lambda: the.screen.rstrip().endswith(SHOW_CURSOR))


@pytest.mark.parametrize(
    ("way", "code"), [("Ctrl-C", 130), ("SIGTERM", 143), ("SIGHUP", 129)], ids=str
)
async def test_every_signal_leaves_the_terminal_as_it_was_and_stops(
    tmp_path: Path, way: str, code: int
) -> None:
    async with person(tmp_path, "--latch") as the:
        the.type(UP)
        await until(lambda: the.speed > 0.2)
        if way == "Ctrl-C":
            the.type(CTRL_C)
        else:
            the.process.send_signal(signal.Signals[way])
        assert await the.code() == code
        assert termios.tcgetattr(the.terminal) == the.before
        assert b"Traceback" not in the.screen
        await until(lambda: the.standing)
        assert not the.simulation.body.drive.powered


async def test_closing_the_window_stops_the_robot(tmp_path: Path) -> None:
    async with person(tmp_path, "--latch") as the:
        the.type(UP)
        await until(lambda: the.speed > 0.2)
        the.hang_up()
        assert await the.code() in {0, 129}
        await until(lambda: the.standing)
        assert not the.simulation.body.drive.powered


async def test_a_driver_that_is_killed_leaves_a_robot_that_stops_by_itself(tmp_path: Path) -> None:
    async with person(tmp_path, "--latch") as the:
        the.type(UP)
        await until(lambda: the.speed > 0.2)
        the.process.kill()
        await until(lambda: the.standing)


async def test_drive_without_a_robot_gives_the_terminal_back(tmp_path: Path) -> None:
    keyboard, terminal = pty.openpty()
    try:
        before = termios.tcgetattr(terminal)
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "pioneer3", "drive", "--port", "tcp://127.0.0.1:1"),
            stdin=terminal,
            stdout=terminal,
            stderr=subprocess.PIPE,
            env=environment(),
            start_new_session=True,
        )
        async with asyncio.timeout(PATIENCE):
            _, stderr = await process.communicate()
        assert process.returncode == 3
        assert stderr.decode().splitlines() == [
            "pioneer3: tcp://127.0.0.1:1: nobody listens there; "
            "a simulator starts with: pioneer3 sim -p 1"
        ]
        assert termios.tcgetattr(terminal) == before
    finally:
        os.close(keyboard)
        os.close(terminal)
