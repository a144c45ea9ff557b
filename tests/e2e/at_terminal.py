"""A person at a terminal of their own in which a command runs, in real time."""

import asyncio
import fcntl
import os
import pty
import struct
import sys
import termios
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Any

from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.start import simulator
from tests.e2e.processes import PATIENCE, environment, in_session, until

PLAIN = "2D-Map\nNumLines: 1\nLINES\n50000 -1000 50000 1000\n"
IN_TERMINAL = """
import fcntl, os, signal, sys, termios
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
if sys.argv[1] == "nohup":
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    del sys.argv[1]
os.execv(sys.executable, [sys.executable, "-m", "pioneer3", *sys.argv[1:]])
"""
REPEATING = 0.1
"""Between two repeats of a held key [s]; much shorter than a key acts."""


@dataclass
class Person:
    """Somebody at a terminal in which a command runs.

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
        return self.simulation.body.speeds[0]

    @property
    def turn_rate(self) -> float:
        return self.simulation.body.speeds[1]

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


def open_terminal() -> tuple[int, int]:
    """Return the two ends of a terminal of 80 x 24: the person's and the command's."""
    keyboard, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    return keyboard, terminal


async def begin(terminal: int, *arguments: str) -> asyncio.subprocess.Process:
    """Start `pioneer3` with `arguments`, after `nohup` or not, at its end of a terminal."""
    return await asyncio.create_subprocess_exec(
        *(sys.executable, "-c", IN_TERMINAL, *arguments),
        stdin=terminal,
        stdout=terminal,
        stderr=terminal,
        env={**environment(), "TERM": "xterm-256color"},
        start_new_session=True,
    )


@asynccontextmanager
async def person(
    tmp_path: Path,
    *options: str,
    command: str = "drive",
    ready: bytes = b"Nothing is asked of it",
    nohup: bool = False,
) -> AsyncIterator[Person]:
    """Start the command in a terminal and wait until it shows that it is `ready`.

    A command of the fleet has a fleet of this robot alone. With `nohup` hang-ups are ignored.
    """
    plain, fleet = tmp_path / "plain.map", tmp_path / "fleet.toml"
    plain.write_text(PLAIN)
    keyboard, terminal = open_terminal()
    async with simulator(map_name=plain, port=0) as running:
        row = f'[[robot]]\nname = "a"\naddress = "127.0.0.1"\nport = "{running.url}"\n'
        fleet.write_text(row)
        robot = ("--fleet", str(fleet)) if command.startswith("fleet") else ("--port", running.url)
        words = [*(["nohup"] if nohup else []), *command.split(), *robot, *options]
        before = termios.tcgetattr(terminal)
        process = await begin(terminal, *words)
        the = Person(running, process, keyboard, terminal, before)
        asyncio.get_running_loop().add_reader(keyboard, the.read)
        try:
            await until(lambda: ready in the.screen)
            yield the
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
            if the.keyboard >= 0:
                the.hang_up()
