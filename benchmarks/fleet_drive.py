"""What one operator costs who drives a crowd of robots, and how soon a stop reaches all.

The simulator is a process of its own, and so is the operator: `rows` starts it on a pseudo
terminal as `fleet_drive operator`.
"""

import asyncio
import json
import os
import pty
import subprocess
import sys
import threading
import time
from collections.abc import AsyncIterator, Iterator, Sequence
from contextlib import asynccontextmanager, suppress
from dataclasses import asdict, dataclass
from statistics import median

from benchmarks.bench_fleet import simulator
from benchmarks.table import Row
from pioneer3.arcos import commands
from pioneer3.arcos.packet import encode
from pioneer3.fleet.drive import FleetDrive
from pioneer3.fleet.screen import FleetApp
from pioneer3.fleet.spec import FleetRobot
from pioneer3.links import Link, opener
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.driven import Driven
from pioneer3.tasks import running
from pioneer3.teleop.keyboard import Manner

ROBOTS = 100
STOPS = 10
SECONDS = 10.0
"""During which the operator's share of a core is taken."""
STOP = encode(commands.to_payload(commands.Stop()))
UP, SPACE = "\x1b[A", " "
COLUMNS, LINES = "100", "40"


@dataclass(frozen=True, slots=True)
class Measured:
    """What the operator measured.

    Attributes:
        connected: Until all robots were [s].
        standing: Share of a core while all stand.
        driving: Share of a core while all drive.
        sent: Until the stop was in all sockets, for each stop [s].
        stood: Until all robots had reported that they stand, for each stop [s].
    """

    connected: float
    standing: float
    driving: float
    sent: list[float]
    stood: list[float]


class Noting:
    """A link that notes when a stop was written."""

    def __init__(self, link: Link, sent: list[float]) -> None:
        self._link = link
        self._sent = sent
        self.url, self.speeds = link.url, link.speeds
        self.round_trip = link.round_trip
        self.read, self.close, self.set_speed = link.read, link.close, link.set_speed

    async def write(self, data: bytes) -> None:
        """Send, then note."""
        await self._link.write(data)
        if STOP in data:
            self._sent.append(time.perf_counter())


async def operate(ports: Sequence[int]) -> Measured:
    """Drive and stop all robots with the real screen."""
    sent: list[float] = []

    @asynccontextmanager
    async def connect(robot: FleetRobot) -> AsyncIterator[Driven]:
        open_link = opener(robot.port)

        async def noting() -> Link:
            return Noting(await open_link(), sent)

        async with connect_async(noting) as driven:
            yield driven

    robots = [
        FleetRobot(
            name=f"p3at-{number}",
            host="",
            address="127.0.0.1",
            port=f"tcp://127.0.0.1:{port}",
            node="",
        )
        for number, port in enumerate(ports)
    ]
    drive = FleetDrive(robots, connect, Manner(speed=0.2, latch=True))
    app = FleetApp(drive)
    began = time.perf_counter()
    async with running(drive.run()):
        screen = asyncio.ensure_future(app.run_async())
        while not all(member.told for member in drive.look()):
            await asyncio.sleep(0.1)
        connected = time.perf_counter() - began
        await asyncio.sleep(3.0)
        standing = await _share()
        drive.press("a")
        drive.press(UP)
        await asyncio.sleep(2.0)
        await asyncio.gather(share := asyncio.ensure_future(_share()), _keep_on(drive))
        reached, stood = [], []
        for _ in range(STOPS):
            drive.press(UP)
            await asyncio.sleep(3.0)
            sent.clear()
            pressed = time.perf_counter()
            drive.press(SPACE)
            while len(sent) < len(robots):
                await asyncio.sleep(0.001)
            reached.append(sent[len(robots) - 1] - pressed)
            while not all(member.told and member.told.speed == 0 for member in drive.look()):
                await asyncio.sleep(0.02)
            stood.append(time.perf_counter() - pressed)
        app.exit()
        await screen
    return Measured(connected, standing, share.result(), reached, stood)


async def _keep_on(drive: FleetDrive) -> None:
    """Press the key again before it runs out."""
    end = time.perf_counter() + SECONDS
    while time.perf_counter() < end:
        drive.press(UP)
        await asyncio.sleep(0.5)


async def _share() -> float:
    """Return this process's share of a core."""
    began, used = time.perf_counter(), time.process_time()
    await asyncio.sleep(SECONDS)
    return (time.process_time() - used) / (time.perf_counter() - began)


def measured(count: int) -> Measured:
    """Start simulator and operator; return what the operator measured."""
    ours, theirs = pty.openpty()

    def drain() -> None:
        with suppress(OSError):
            while os.read(ours, 65536):
                pass

    threading.Thread(target=drain, daemon=True).start()
    with simulator(count) as (_, ports):
        command = [sys.executable, "-m", "benchmarks.fleet_drive", "operator", json.dumps(ports)]
        done = subprocess.run(
            command,
            stdin=theirs,
            stdout=subprocess.PIPE,
            stderr=theirs,  # textual draws there
            text=True,
            check=True,
            env=os.environ | {"COLUMNS": COLUMNS, "LINES": LINES, "TERM": "xterm-256color"},
        )
    os.close(theirs)
    return Measured(**json.loads(done.stdout.splitlines()[-1]))


def rows(robots: int = ROBOTS) -> Iterator[Row]:
    """Measure everything of this file."""
    told = measured(robots)
    who = f"one operator, {robots} robots"
    yield Row(f"{who}: all connected", told.connected * 1e3, "ms", 10_000)
    yield Row(f"{who}: operator while all stand", told.standing * 100, "%", 50)
    yield Row(f"{who}: operator while all drive", told.driving * 100, "%", 50)
    yield Row(f"{who}: stop sent to all, median", median(told.sent) * 1e3, "ms", 250)
    yield Row(f"{who}: stop sent to all, worst", max(told.sent) * 1e3, "ms", 250)
    yield Row(f"{who}: all stand from 0.2 m/s, worst", max(told.stood) * 1e3, "ms", 800)


if __name__ == "__main__":
    print(json.dumps(asdict(asyncio.run(operate(json.loads(sys.argv[2]))))))
