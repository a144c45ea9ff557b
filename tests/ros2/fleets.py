"""Fleets with robots on networks of ROS 2: their files, and one keyboard that drives them."""

import asyncio
import fcntl
import json
import os
import pty
import struct
import sys
import termios
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pioneer3.cli.fleet_ros import connecting
from pioneer3.fleet.drive import FleetDrive
from pioneer3.fleet.inventory import read_fleet, to_toml
from pioneer3.fleet.members import Member
from pioneer3.fleet.network import FleetNetwork
from pioneer3.fleet.spec import Fleet, FleetRobot, usual_node
from pioneer3.tasks import running as in_background
from pioneer3.teleop.keyboard import Manner
from tests.e2e.at_terminal import IN_TERMINAL
from tests.e2e.processes import environment, running, until
from tests.ros2.conftest import Robot as SimulatedRobot
from tests.ros2.networks import Ros2

UP, EMERGENCY, RESET = "\x1b[A", "k", "\x12"


def table_of(network: Ros2, name: str = "here") -> FleetNetwork:
    """Return a network as a fleet file has it."""
    given = network.network
    return FleetNetwork(
        name=name, backend=given.backend, domain=given.domain, connect=given.connect
    )


def row(number: int, *, port: str = "", network: str = "") -> FleetRobot:
    """Return a robot of a fleet file; without a port it is on a network of ROS 2."""
    name, ros = f"r{number}", "" if port else "2"
    return FleetRobot(
        name=name,
        host=name,
        address=f"127.0.0.{number}",
        port=port or "/dev/ttyUSB0",
        ros=ros,
        network=network,
        node=usual_node(name, ros),
    )


def write_fleet(path: Path, networks: tuple[FleetNetwork, ...], *robots: FleetRobot) -> Path:
    """Write a fleet file."""
    path.write_text(to_toml(Fleet(path=path, networks=networks, robots=robots)))
    return path


async def answers_of(*words: str) -> tuple[int, dict[str, Any]]:
    """Return the exit code of a command, and its JSON answers by robot."""
    async with running(*words, "--json") as command:
        text = ""
        while line := await command.line():
            text += line
        code, stderr = await command.end()
    assert text, stderr
    return code, {_name(each): each for each in json.loads(text)}


def _name(answer: dict[str, Any]) -> str:
    robot = answer["robot"]
    return str(robot if isinstance(robot, str) else robot["name"])


@dataclass
class Driving:
    """One keyboard and the robots of a fleet."""

    drive: FleetDrive

    def member(self, number: int) -> Member:
        return next(each for each in self.drive.look() if each.name == f"r{number}")

    def press(self, *tokens: str) -> None:
        for token in tokens:
            self.drive.press(token)

    async def drives(self, robot: SimulatedRobot) -> None:
        """Press the key, and let it go and press it again until a robot drives."""
        while robot.tap.now.is_zero:
            self.press(" ", UP)
            await asyncio.sleep(0.5)

    async def connected(self, *numbers: int) -> None:
        await until(lambda: all(self.member(number).told for number in numbers))


@asynccontextmanager
async def driving(path: Path) -> AsyncIterator[Driving]:
    """Drive the robots of a fleet file with latched keys, in this process; then all stand."""
    fleet = read_fleet(path)
    async with connecting(fleet, "fleet_drive", None) as connect:
        drive = FleetDrive(fleet.robots, connect, Manner(speed=0.2, latch=True))
        async with in_background(drive.run()):
            yield Driving(drive)


@dataclass
class Terminal:
    """A command at a terminal of its own.

    Attributes:
        screen: Everything it has shown.
    """

    process: asyncio.subprocess.Process
    keyboard: int
    screen: bytes = b""

    def type(self, keys: str) -> None:
        os.write(self.keyboard, keys.encode())

    async def sees(self, text: bytes) -> None:
        await until(lambda: text in self.screen)


@asynccontextmanager
async def at_terminal(*words: str) -> AsyncIterator[Terminal]:
    """Run a command at a terminal; kill it in the end if it still runs."""
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-c", IN_TERMINAL, *words),
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env={**environment(), "TERM": "xterm"},
        start_new_session=True,
    )
    os.close(theirs)
    shown = Terminal(process, ours)

    def read() -> None:
        try:
            shown.screen += os.read(ours, 65536)
        except OSError:  # the command has ended
            loop.remove_reader(ours)

    loop = asyncio.get_running_loop()
    loop.add_reader(ours, read)
    try:
        yield shown
    finally:
        loop.remove_reader(ours)
        if process.returncode is None:
            process.kill()
        await process.wait()
        os.close(ours)
