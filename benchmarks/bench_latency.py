"""From `drive()` to the wire, from the wire to a snapshot, and what a connected robot costs."""

import asyncio
import time
from collections.abc import Awaitable, Callable
from contextlib import AbstractContextManager, nullcontext
from math import inf, radians
from random import Random

from benchmarks.simulator import simulator_process
from benchmarks.table import Row, rows_of_latency
from pioneer3 import BlockingRobot, connect, connect_async
from pioneer3.arcos.commands import RVel, to_payload
from pioneer3.arcos.packet import encode
from pioneer3.links import Link, open_link
from pioneer3.links.base import HandingLink

COMMANDS = 120
PAUSES = (0.02, 0.2)
"""Between two commands, drawn at random [s]: the repetition of one must not delay the next."""
SNAPSHOTS = 50
COST_SECONDS = 10.0


class TimedLink:
    """A link that notes when bytes leave and arrive; same contract as the link inside."""

    def __init__(self, link: Link) -> None:
        self.url, self.speeds, self.round_trip = link.url, link.speeds, link.round_trip
        self.written: list[tuple[float, bytes]] = []
        self.read_at = 0.0
        self._link = link

    async def read(self) -> bytes:
        """Read, and note when."""
        data = await self._link.read()
        self.read_at = time.perf_counter()
        return data

    def handing(self, take: Callable[[bytes], None]) -> AbstractContextManager[None]:
        """Note when bytes come that are handed over."""

        def timed(data: bytes) -> None:
            self.read_at = time.perf_counter()
            take(data)

        link = self._link
        return link.handing(timed) if isinstance(link, HandingLink) else nullcontext()

    def write(self, data: bytes) -> Awaitable[None]:
        """Note when the bytes are in the hands of the operating system, if that takes them."""
        written = self._link.write(data)
        self.written.append((time.perf_counter(), data))
        return written

    async def set_speed(self, baud: int) -> None:
        """Change the speed of the link inside."""
        await self._link.set_speed(baud)

    async def close(self) -> None:
        """Close the link inside."""
        await self._link.close()


async def asynchronous(url: str) -> list[Row]:
    """Measure the asynchronous interface."""
    links: list[TimedLink] = []

    async def opener() -> Link:
        links.append(TimedLink(await open_link(url)))
        return links[-1]

    began = time.perf_counter()
    async with connect_async(opener) as robot:
        first = time.perf_counter() - began
        to_wire, random = [], Random(0)
        for number in range(COMMANDS):
            rate, asked = _rate(number), time.perf_counter()
            robot.drive(0.0, rate)
            await asyncio.sleep(random.uniform(*PAUSES))
            frame = encode(to_payload(RVel(rate=rate)))
            sent = (when for when, data in links[0].written if when > asked and frame in data)
            to_wire.append(next(sent, inf) - asked)
        robot.stop()
        to_snapshot = [
            time.perf_counter() - links[0].read_at async for _ in robot.snapshots(SNAPSHOTS / 10)
        ]
        cpu = time.process_time()
        async for _ in robot.snapshots(COST_SECONDS):
            robot.drive(0.1)
        share = (time.process_time() - cpu) / COST_SECONDS
    return [
        Row("connect to first snapshot", first, "s", 0.5),
        *rows_of_latency("drive() to bytes on the wire", to_wire, bar_ms=1),
        rows_of_latency("information packet to Snapshot", to_snapshot, bar_ms=1)[0],
        Row("one core per connected robot at 10 Hz, driving", share * 100, "%", 1),
    ]


def blocking(url: str) -> list[Row]:
    """Measure the same through the blocking facade: until drive() returns, the bytes are sent."""
    with connect(url) as robot:
        seconds = [_timed(robot, number) for number in range(COMMANDS)]
    return rows_of_latency("blocking drive(), until it returns", seconds, bar_ms=1)


def _timed(robot: BlockingRobot, number: int) -> float:
    asked = time.perf_counter()
    robot.drive(0.0, _rate(number))
    took = time.perf_counter() - asked
    time.sleep(PAUSES[1])
    return took


def _rate(number: int) -> float:
    """Return another turn rate for each command, which leave the robot where it is [rad/s]."""
    return radians(10 + number % 50) * (1 if number % 2 else -1)


def rows() -> list[Row]:
    """Measure everything of this file."""
    with simulator_process() as url:
        return [*asyncio.run(asynchronous(url)), *blocking(url)]
