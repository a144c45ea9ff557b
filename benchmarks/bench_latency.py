"""From `drive()` to the wire, from the wire to a snapshot, and what a connected robot costs."""

import asyncio
import time

from benchmarks.simulator import simulator_process
from benchmarks.table import Row, rows_of_latency
from pioneer3 import BlockingRobot, connect, connect_async
from pioneer3.links import Link, open_link

COMMANDS = 120
PAUSE = 0.06
"""Between two commands [s]; the driver sends a velocity every 0.05 s at most."""
SNAPSHOTS = 50
COST_SECONDS = 10.0


class TimedLink:
    """A link that notes when bytes leave and arrive; same contract as the link inside."""

    def __init__(self, link: Link) -> None:
        self.url, self.speeds = link.url, link.speeds
        self.wrote_at = self.read_at = 0.0
        self._link = link

    async def read(self) -> bytes:
        """Read, and note when."""
        data = await self._link.read()
        self.read_at = time.perf_counter()
        return data

    async def write(self, data: bytes) -> None:
        """Note when the bytes are in the hands of the operating system."""
        await self._link.write(data)
        self.wrote_at = time.perf_counter()

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
        to_wire = []
        for number in range(COMMANDS):
            asked = time.perf_counter()
            robot.drive(0.1 + number % 2 * 0.1)
            await asyncio.sleep(PAUSE)
            if links[0].wrote_at > asked:
                to_wire.append(links[0].wrote_at - asked)
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
    robot.drive(0.1 + number % 2 * 0.1)
    took = time.perf_counter() - asked
    time.sleep(PAUSE)
    return took


def rows() -> list[Row]:
    """Measure everything of this file."""
    with simulator_process() as url:
        return [*asyncio.run(asynchronous(url)), *blocking(url)]
