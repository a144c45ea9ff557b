"""What a log costs beside the driver, how long it is, and how quickly its facts are there.

The simulator is another process. The processor time is that of the thread that writes, and of all
calls of the driver that are about a log.

    python -m benchmarks log
"""

import asyncio
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import AsyncExitStack, ExitStack, contextmanager
from functools import partial
from math import radians
from pathlib import Path
from random import Random
from statistics import median
from tempfile import TemporaryDirectory
from typing import Any

from benchmarks.bench_latency import PAUSES, TimedLink
from benchmarks.table import Row
from pioneer3 import connect_async
from pioneer3.arcos.commands import RVel, to_payload
from pioneer3.arcos.packet import encode
from pioneer3.clock import Clock
from pioneer3.lasers.line import SerialLine
from pioneer3.links import Link, open_link
from pioneer3.links.tap import WireRecording
from pioneer3.log.cut import CHUNK, HEADER, data_records
from pioneer3.log.folder import create
from pioneer3.log.index import LogIndex
from pioneer3.log.mcap import McapFile
from pioneer3.log.reader import open_log
from pioneer3.log.target import LogTarget, NamedFile
from pioneer3.log.topics import LogTopic
from pioneer3.log.writer import CHUNK_PERIOD, LogWriter
from pioneer3.runtime.recording import RobotLog
from pioneer3.sim.realism import Realism
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import parse_equipment
from pioneer3.sim.worldfile.arguments import WorldOverrides

LASERS = {"lms-200": (0.5, 20.0), "utm-30lx": (2.0, None)}
"""Lasers of 181 beams at 10 Hz and of 1081 at 40 Hz, each with its bars: more of a core [%], and
size in an hour [MB]."""
TURNS = 5
"""Drives with each laser; the median counts."""
WARM_UP = 4
"""Chunks until all is loaded."""
SECONDS = 20.0
"""Length of a drive."""
LINE_SPEED = 38_400
"""At this speed of its line [baud] the laser of 181 beams sends ten scans a second."""
COMMANDS = 200
"""Commands of each robot whose way to the wire is timed."""
INDEXED = 180
"""Bytes in the index for each chunk, about."""
DAY = 86_400
"""Chunks of a log of 24 h."""
SCRUBS = 200
"""Seconds of it that are gone to."""
HOUR = 3600.0


async def serve(laser: str) -> None:
    """Simulate a robot; print its URL and that of its laser, until cancelled."""
    overrides = WorldOverrides(equipment=parse_equipment(f"laser={laser}"), seed=1)
    async with simulator(port=0, overrides=overrides, realism=Realism()) as running:
        (robot,) = running.robots
        assert robot.laser is not None
        device: Any = robot.laser.device
        if laser == "lms-200":
            device._line = SerialLine(LINE_SPEED)
        print(robot.url, f"{laser}@{robot.laser.url}", flush=True)
        await asyncio.get_running_loop().create_future()


@contextmanager
def serving(laser: str) -> Iterator[tuple[str, str]]:
    """Simulate in a process of its own; yield the URLs."""
    command = [sys.executable, "-m", "benchmarks.log", laser]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            robot, scanner = process.stdout.readline().split()
            yield robot, scanner
        finally:
            process.terminate()


class MeasuredCalls:
    """Counts the processor time of calls about a log in the event loop [s], the outermost ones."""

    def __init__(self) -> None:
        self.took = 0.0
        self._inside = False

    def measure(self, owner: type, name: str) -> None:
        """Measure a method from now on; what reading the time takes is not counted."""
        call = getattr(owner, name)

        def measured(*args: Any, **more: Any) -> Any:
            if self._inside:
                return call(*args, **more)
            self._inside, began = True, time.thread_time()
            try:
                return call(*args, **more)
            finally:
                ended = time.thread_time()
                self._inside, self.took = False, self.took + 2 * ended - began - time.thread_time()

        setattr(owner, name, measured)


CALLS = MeasuredCalls()


class MeasuredLog(LogWriter):
    """A log with the time at each chunk, and the processor time of all until then [s]."""

    def __init__(self, target: LogTarget, clock: Clock) -> None:
        self.times: list[tuple[float, float]] = []
        super().__init__(target, clock)

    def _flush(self) -> None:
        super()._flush()
        self.times.append((time.monotonic(), time.thread_time() + CALLS.took))

    @property
    def share(self) -> float:
        """Share of a core, once all is loaded."""
        (first, used_first), (last, used_last) = self.times[WARM_UP], self.times[-1]
        return (used_last - used_first) / (last - first)


async def drive(robot_url: str, laser: str, path: Path) -> tuple[float, float]:
    """Drive in a circle; return the share of a core that the log takes, and the scans a second."""
    log = MeasuredLog(NamedFile(path), asyncio.get_running_loop().time)
    async with connect_async(robot_url, lasers=[laser], record=RobotLog(log)) as robot:
        first = await robot.lasers[0].reading()
        began = time.monotonic()
        async for _ in robot.snapshots(SECONDS):
            robot.drive(0.1, 0.3)
        last = robot.lasers[0].latest
        assert last is not None
        seconds = time.monotonic() - began
    log.close("done")
    return log.share, (last.sequence - first.sequence) / seconds


def rows_of_cost(laser: str, most: float, most_mb: float | None) -> Iterator[Row]:
    """Yield what a log costs, and its size."""
    shares, sizes = [], []
    with serving(laser) as (robot, scanner), TemporaryDirectory() as folder:
        for turn in range(TURNS):
            path = Path(folder) / f"{turn}.mcap"
            share, rate = asyncio.run(drive(robot, scanner, path))
            shares.append(100 * share)
            sizes.append(bytes_of_a_second(path) * HOUR / 1e6)
    yield Row(f"log, {laser} at {rate:.0f} scans/s, of a core", median(shares), "%", most)
    yield Row(f"log, {laser}, of a core, the dearest drive", max(shares), "%", None)
    yield Row(f"log, {laser}, size in an hour", median(sizes), "MB", most_mb)


def bytes_of_a_second(path: Path) -> float:
    """Return how fast a log grows [bytes/s], after its first chunk, which has the schemas."""
    with path.open("rb") as file:
        sizes = [(kind, length) for kind, _, length, _ in data_records(file)]
    chunks = [number for number, (kind, _) in enumerate(sizes) if kind == CHUNK]
    grown = sum(length + HEADER for _, length in sizes[chunks[1] : chunks[-1]])
    return (grown / (len(chunks) - 2) + INDEXED) / CHUNK_PERIOD


async def to_wire(urls: Sequence[str], records: Sequence[Path | bool]) -> list[list[float]]:
    """Return how long `drive()` takes until the bytes are with the operating system [s].

    Robots are driven by turns: what else the computer does at the time holds up each as much.
    """
    links: list[TimedLink] = []
    took: list[list[float]] = [[] for _ in urls]

    async def opened(url: str) -> Link:
        links.append(TimedLink(await open_link(url)))
        return links[-1]

    async with AsyncExitStack() as stack:
        robots = []
        for url, record in zip(urls, records, strict=True):
            connection = connect_async(partial(opened, url), record=record)
            robots.append(await stack.enter_async_context(connection))
        random = Random(0)
        for number in range(COMMANDS):
            rate = radians(10 + number % 50) * (1 if number % 2 else -1)
            frame = encode(to_payload(RVel(rate=rate)))
            for each in random.sample(range(len(robots)), len(robots)):
                asked = time.perf_counter()
                robots[each].drive(0.0, rate)
                await asyncio.sleep(random.uniform(*PAUSES))
                written = links[each].written
                took[each] += [w - asked for w, data in written if w > asked and frame in data][:1]
    return took


def rows_of_latency() -> Iterator[Row]:
    """Yield how much later bytes are on the wire with a log, and how much that figure is off."""
    with ExitStack() as stack:
        urls = [stack.enter_context(serving("lms-200"))[0] for _ in range(3)]
        record = Path(stack.enter_context(TemporaryDirectory())) / "log.mcap"
        without, again, logged = map(median, asyncio.run(to_wire(urls, (False, False, record))))
    what = "drive() to the wire"
    yield Row(f"{what} without a log, median", without * 1e3, "ms", None)
    yield Row(f"{what}, later with another robot, median", 100 * (again / without - 1), "%", None)
    yield Row(f"{what}, later with a log, median", 100 * (logged / without - 1), "%", 5.0)


def rows_of_reading() -> Iterator[Row]:
    """Yield how long the facts of a log of 24 h take, and going to one of its seconds."""
    topics = [LogTopic(f"topic/{number}", bytes) for number in range(9)]
    with TemporaryDirectory() as folder:
        path = Path(folder) / "day.mcap"
        file = McapFile(create(path))
        for second in range(DAY):
            for topic in topics:
                file.add(topic, [(second * 10**9, b"%d" % second)])
            file.flush()
        file.finish()
        took = []
        for _ in range(5):
            began = time.perf_counter()
            open_log(path).info()
            took.append(time.perf_counter() - began)
        sought, random, index = [], Random(1), LogIndex(path)
        for _ in range(SCRUBS):
            began = time.perf_counter()
            for topic in topics:
                index.newest(topic.name, random.randrange(DAY * 10**9))
            sought.append(time.perf_counter() - began)
    yield Row("log of 24 h, its facts", median(took), "s", 0.5)
    yield Row("log of 24 h, the slowest of 200 seconds", max(sought), "s", 0.2)


def rows() -> list[Row]:
    """Measure everything of this file."""
    found = [*rows_of_latency(), *rows_of_reading()]  # first: to measure calls takes time, too
    CALLS.measure(WireRecording, "note")
    for name in ("snapshot", "scan", "decided", "asked", "stands"):
        CALLS.measure(RobotLog, name)
    return found + [row for laser, bars in LASERS.items() for row in rows_of_cost(laser, *bars)]


if __name__ == "__main__":
    asyncio.run(serve(sys.argv[1]))
