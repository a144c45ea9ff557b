"""Lasers that are unplugged, power-cycled, silent, left scanning or at another speed.

    python -m benchmarks laser_recovery

The simulator is another process, which does to its laser what it is told. Measured are the time
from the moment that the laser is back until the next scan, and what the robot beside it feels: how
much later than usual its reports come, and its velocity commands leave.
"""

import asyncio
import sys
import time
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

from benchmarks.table import Row, percentile_99
from pioneer3.links import open_link
from pioneer3.navigation.connect import connect_async
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.runtime.robot import Robot
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import parse_equipment
from pioneer3.sim.worldfile.arguments import WorldOverrides
from pioneer3.tasks import running
from tests.lasers import LEFT

QUIET = 8.0
FIRST = 3.0
"""From the start of the driver to the first scan, with the search for the protocol [s]."""
AWAY = 2.0
SILENCE = 5.0
PATIENCE = 60.0
"""An LMS-200 may take 30 s after it was switched on."""
BAR = 3.0
DISTURBED = 5.0


async def serve(model: str) -> None:
    """Simulate a robot with a laser; obey the words on stdin, and answer each with a line."""
    overrides = WorldOverrides(equipment=parse_equipment(f"laser={model}"), seed=1)
    async with simulator(port=0, overrides=overrides) as simulation:
        robot = simulation.robots[0]
        laser = robot.laser
        assert laser is not None
        print(robot.url, laser.url, laser.pty or "-", flush=True)
        while word := (await asyncio.to_thread(sys.stdin.readline)).strip():
            obey(laser, word)
            print(word, flush=True)


def obey(laser: SimulatedLaser, word: str) -> None:
    """Do to the laser what `word` says."""
    match word:
        case "unplug":
            laser.unplug()
        case "plug_in":
            laser.plug_in()
        case "switch_off":
            laser.switch_off()
        case "switch_on":
            laser.switch_on()
        case "garbage":
            laser.faults = LinkFaults(corrupt=1.0)
        case "clean":
            laser.faults = LinkFaults()
        case "silence":
            laser.silence(SILENCE)


class Simulator:
    """The other process."""

    def __init__(self, process: Process, robot: str, laser: str, pty: str) -> None:
        self._process = process
        self.robot, self.laser, self.pty = robot, laser, pty

    async def tell(self, word: str) -> None:
        """Let it do to its laser what `word` says; return when that is done."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(f"{word}\n".encode())
        await self._process.stdout.readline()


@asynccontextmanager
async def simulator_with(model: str) -> AsyncIterator[Simulator]:
    """Run the other process during the block."""
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "benchmarks.laser_recovery", model, stdin=PIPE, stdout=PIPE
    )
    try:
        assert process.stdout is not None
        words = (await process.stdout.readline()).decode().split()
        yield Simulator(process, *words)
    finally:
        process.terminate()
        await process.wait()


async def unplugged(simulator: Simulator) -> None:
    """Take the plug out for a while."""
    await simulator.tell("unplug")
    await asyncio.sleep(AWAY)
    await simulator.tell("plug_in")


async def power_cycled(simulator: Simulator) -> None:
    """Switch it off for a while."""
    await simulator.tell("switch_off")
    await asyncio.sleep(AWAY)
    await simulator.tell("switch_on")


async def spoilt(simulator: Simulator) -> None:
    """Spoil all bytes for a while."""
    await simulator.tell("garbage")
    await asyncio.sleep(AWAY)
    await simulator.tell("clean")


async def silent(simulator: Simulator) -> None:
    """Let it be silent for 5 s."""
    await simulator.tell("silence")
    await asyncio.sleep(SILENCE)


@dataclass(frozen=True, slots=True)
class Fault:
    """Something that happens to a laser that scans."""

    name: str
    happen: Callable[[Simulator], Awaitable[None]]


FAULTS = (
    Fault("unplugged", unplugged),
    Fault("garbage for 2 s", spoilt),
    Fault("silent for 5 s", silent),
    Fault("switched off and on", power_cycled),
)
STARTS = {"utm-30lx": 1.0, "urg-04lx": 1.0, "lms-200": 30.0, "lms-111": 15.0}
"""Models, and the time that each needs from power to its first answer or scan [s]."""


async def first_scan(driver: LaserDriver) -> float:
    """Return how long it takes from now until a scan comes [s]."""
    began = time.monotonic()
    await driver.reading(PATIENCE)
    return time.monotonic() - began


class Heartbeat:
    """Measures how late the event loop comes to a callback that is due every millisecond.

    Attributes:
        late: By how much [s, real]; other programs on the machine make it late, too.
        work: Work of this thread between two of them [s of the processor].
    """

    PERIOD = 0.001

    def __init__(self) -> None:
        self.late: list[float] = []
        self.work: list[float] = []

    async def run(self) -> None:
        """Beat until cancelled."""
        loop = asyncio.get_running_loop()
        due, worked = loop.time(), time.thread_time()
        while True:
            due += self.PERIOD
            await asyncio.sleep(max(0.0, due - loop.time()))
            now, work = loop.time(), time.thread_time()
            self.late.append(now - due)
            self.work.append(work - worked)
            due, worked = now, work


async def faults_of(model: str) -> list[Row]:
    """Measure all faults of one model beside a robot that drives."""
    rows: list[Row] = []
    async with simulator_with(model) as simulator:
        port = simulator.pty if simulator.pty != "-" else simulator.laser
        if LEFT.get(model):
            await left_behind(simulator, model)
        quiet, loud = Heartbeat(), Heartbeat()
        async with connect_async(simulator.robot) as robot, running(quiet.run(), drive(robot)):
            await asyncio.sleep(QUIET)
        async with (
            connect_async(simulator.robot, lasers=[port]) as robot,
            running(loud.run(), drive(robot)),
        ):
            driver = robot.laser
            assert isinstance(driver, LaserDriver)
            rows.append(Row(f"{model}: first scan", await first_scan(driver), "s", FIRST))
            for fault in FAULTS:
                await fault.happen(simulator)
                taken = await first_scan(driver)
                if fault.happen is power_cycled:
                    taken = max(0.0, taken - STARTS[model])
                rows.append(Row(f"{model}: {fault.name}, back until a scan", taken, "s", BAR))
                await asyncio.sleep(1)
    more = 1000 * (percentile_99(loud.late) - percentile_99(quiet.late))
    return [
        *rows,
        Row(f"{model}: the loop works in one go, without it", 1000 * max(quiet.work), "ms", None),
        Row(f"{model}: the same with it", 1000 * max(loud.work), "ms", DISTURBED),
        Row(f"{model}: later than without it, 99th percentile", more, "ms", DISTURBED),
    ]


async def drive(robot: Robot) -> None:
    """Command a turn again and again, as somebody who drives does."""
    while True:
        robot.drive(0.0, 0.3)
        await asyncio.sleep(0.1)


async def left_behind(simulator: Simulator, model: str) -> None:
    """Leave the laser as a program does that crashed: at another speed, and scanning."""
    link = await open_link(simulator.pty)
    for baud, data in LEFT[model]:
        await link.set_speed(baud)
        await link.write(data)
        await asyncio.sleep(0.5)
    await link.close()


def rows() -> Iterator[Row]:
    """Measure all models."""
    for model in STARTS:
        yield from asyncio.run(faults_of(model))


if __name__ == "__main__":
    if sys.argv[1:]:
        asyncio.run(serve(sys.argv[1]))
    else:
        for row in rows():
            print(row, flush=True)
