"""What one robot costs: shares of a core, and memory, of whole programs, each in its own process.

`python -m benchmarks cost` measures this checkout. With `--beside FOLDER` the programs of another
checkout, such as a worktree of the commit before, run at the same time: a busy machine is as busy
for both. The programs of nodes are measured where `scripts/test` has installed what they need.
"""

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from benchmarks.ros1 import resident
from benchmarks.table import Row
from tests.e2e.processes import free_port
from tests.ros1.master import PYTHON, environment_of, has_ros, roscore

SECONDS = 6.0
"""Length of a measurement."""
TIMES = 5
"""Measurements of each program; the median counts."""
SETTLED = 4.0
"""Time after which a program has begun all that it goes on with [s]."""
DOMAIN = 87
"""Domain of the first checkout's node in ROS 2; that of the second has the next one."""
HERE = Path(__file__).parent
HOST = """
import asyncio, sys
from pioneer3 import connect_async

async def main():
    robot_url, what, *lasers = sys.argv[1:]
    async with connect_async(robot_url, lasers=lasers, record=False) as robot:
        print("connected", flush=True)
        async for _ in robot.snapshots():
            if what == "driving":
                robot.drive(0.15, 0.5)

asyncio.run(main())
"""
"""A program that stands, or drives in a circle."""


@dataclass(frozen=True, slots=True)
class Running:
    """A program that has begun, and its bars [% of a core that does nothing else, MiB].

    With `more_than` its share is counted from that of another program.
    """

    what: str
    pid: int
    bar: float | None = None
    memory_bar: float | None = None
    more_than: str = ""


def processor_time(pid: int) -> float:
    """Return what all threads of a process have used [s]."""
    threads = Path(f"/proc/{pid}/task").glob("*/schedstat")
    return sum(int(each.read_text().split()[0]) for each in threads) / 1e9


def shares(pids: list[int]) -> list[float]:
    """Return the share of a core that each process takes, measured at the same time [%]."""
    time.sleep(SETTLED)
    found = []
    for _ in range(TIMES):
        began, used = time.monotonic(), [processor_time(pid) for pid in pids]
        time.sleep(SECONDS)
        passed = time.monotonic() - began
        found.append(
            [
                100 * (processor_time(pid) - before) / passed
                for pid, before in zip(pids, used, strict=True)
            ]
        )
    return [median(each) for each in zip(*found, strict=True)]


@dataclass(frozen=True, slots=True)
class Checkout:
    """A copy of the project, whose programs are run."""

    folder: Path
    number: int

    @contextmanager
    def program(
        self,
        *arguments: str,
        lines: int = 1,
        python: str = sys.executable,
        variables: Mapping[str, str] | None = None,
    ) -> Iterator[tuple[int, list[str]]]:
        """Run a Python program; yield its number, and the URLs in its first lines."""
        environment = os.environ | {"PIONEER3_RECORD": "0"} | dict(variables or {})
        if python == sys.executable:
            environment["PYTHONPATH"] = f"{self.folder / 'src'}:{HERE.parent}"
        with subprocess.Popen(
            [python, *arguments], stdout=subprocess.PIPE, text=True, env=environment
        ) as process:
            try:
                assert process.stdout is not None
                told = "".join(process.stdout.readline() for _ in range(lines))
                yield process.pid, re.findall(r"\w+://[\d.:]+", told)
            finally:
                process.terminate()

    @contextmanager
    def simulator(self, *options: str, lines: int = 1) -> Iterator[tuple[int, list[str]]]:
        """Run a simulator."""
        with self.program("-m", "pioneer3", "sim", "-p", "0", *options, lines=lines) as started:
            yield started

    def running(self) -> Iterator[Running]:
        """Yield its programs, one after the other."""
        yield from self._programs()
        yield from self._ros1()
        yield from self._ros2()

    def _programs(self) -> Iterator[Running]:
        with self.simulator() as (pid, (url,)):
            yield Running("simulator, no host", pid, 0.8)
            with self.program("-c", HOST, url, "standing") as (host, _):
                yield Running("simulator, a host, standing", pid, 0.8)
                yield Running("driver, standing", host)
            with self.program("-c", HOST, url, "driving"):
                yield Running("simulator, driving", pid, 1.4)
            arguments = "-m", "pioneer3", "run", "--port", url, "--web-port", "0"
            with self.program(*arguments) as (page, _):
                yield Running("page, a robot without a laser", page, 1.4)
        with (
            self.simulator("--fit", "laser=utm-30lx", lines=2) as (pid, (url, laser)),
            self.program("-c", HOST, url, "standing", f"utm-30lx@{laser}") as (host, _),
        ):
            yield Running("simulator, a UTM-30LX at 40 Hz", pid, 3.5, 150)
            what = "driver with a UTM-30LX, more than without"
            yield Running(what, host, 1.8, 150, more_than="driver, standing")
        with self.simulator("-n", "5") as (pid, _):
            yield Running("simulator, five robots, no host", pid, None, 150)

    def _ros1(self) -> Iterator[Running]:
        if not has_ros():
            print("ROS 1 is not installed; scripts/test installs it", file=sys.stderr)
            return
        port = free_port()
        client = str(HERE / "ros1_client.py")
        with TemporaryDirectory() as home, roscore(port, Path(home)), ExitStack() as stack:
            variables = environment_of(port, Path(home))
            _, (url,) = stack.enter_context(self.simulator())
            node, _ = stack.enter_context(
                self.program("-m", "pioneer3", "ros1", "--port", url, lines=2, variables=variables)
            )
            yield Running("ROS 1 node, nobody subscribes", node, 0.7)
            for what, words, bar in (
                ("three topics", "follow", 0.8),
                ("three topics, driving", "circle", 1.1),
            ):
                with self.program(client, words, python=PYTHON, variables=variables):
                    yield Running(f"ROS 1 node, {what}", node, bar)

    def _ros2(self) -> Iterator[Running]:
        domain = str(DOMAIN + self.number)
        client = "benchmarks.ros2_client"
        for backend in ("dds", "zenoh"):
            network = ["--backend", backend, "--domain", domain]
            with ExitStack() as stack:
                if backend == "zenoh":
                    place = f"tcp/127.0.0.1:{free_port()}"
                    router = "-m", "pioneer3", "ros2", "router", "--listen", place
                    stack.enter_context(self.program(*router))
                    network += ["--connect", place]
                _, (url,) = stack.enter_context(self.simulator())
                arguments = "-m", "pioneer3", "ros2", "--port", url, *network
                node, _ = stack.enter_context(self.program(*arguments, lines=2))
                yield Running(f"ROS 2 node, {backend}, nobody subscribes", node, 1.5)
                for what, words in (
                    ("three topics", "follow"),
                    ("three topics, driving", "circle"),
                ):
                    with self.program("-m", client, words, *network):
                        yield Running(f"ROS 2 node, {backend}, {what}", node, 1.5)


def rows(beside: str | None = None) -> Iterator[Row]:
    """Yield what each program takes, and beside it that of another checkout in a folder."""
    folders = [HERE.parent, *([Path(beside).resolve()] if beside else [])]
    checkouts = [Checkout(folder, number) for number, folder in enumerate(folders)]
    known: dict[tuple[str, int], float] = {}
    for several in zip(*(each.running() for each in checkouts), strict=True):
        found = shares([each.pid for each in several])
        for number, (each, share) in enumerate(zip(several, found, strict=True)):
            known[each.what, number] = share
            percent = share - known.get((each.more_than, number), 0.0)
            name = f"{'beside' if number else 'cost'}: {each.what}"
            yield Row(name, percent, "%", None if number else each.bar)
            bar = None if number else each.memory_bar
            yield Row(f"{name}, memory", resident(each.pid), "MiB", bar)
