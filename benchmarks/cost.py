"""What one robot costs: shares of a core that whole programs take, each in a process of its own.

python -m benchmarks cost
"""

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from statistics import median

from benchmarks.table import Row

SECONDS = 6.0
"""Length of a measurement."""
TIMES = 5
"""Measurements of each program; the median counts."""
SETTLED = 4.0
"""Time after which a program has begun all that it goes on with [s]."""
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
BARS: dict[str, float | None] = {
    "simulator, no host": 0.8,
    "simulator, a host, standing": 0.8,
    "simulator, driving": 1.4,
    "simulator, a UTM-30LX at 40 Hz": 3.5,
    "driver, standing": None,
    "driver with a UTM-30LX, more than without": 1.8,
    "page, a robot without a laser": 1.4,
}
"""Bars [% of a core of a machine that does nothing else]."""


def processor_time(pid: int) -> float:
    """Return what all threads of a process have used [s]."""
    threads = Path(f"/proc/{pid}/task").glob("*/schedstat")
    return sum(int(each.read_text().split()[0]) for each in threads) / 1e9


def share(pid: int) -> float:
    """Return the share of a core that a process takes [%]."""
    time.sleep(SETTLED)
    shares = []
    for _ in range(TIMES):
        began, used = time.monotonic(), processor_time(pid)
        time.sleep(SECONDS)
        shares.append(100 * (processor_time(pid) - used) / (time.monotonic() - began))
    return median(shares)


@contextmanager
def program(*arguments: str, lines: int = 1) -> Iterator[tuple[int, list[str]]]:
    """Run a Python program; yield its number, and the URLs in its first lines."""
    command = [sys.executable, *arguments]
    environment = os.environ | {"PIONEER3_RECORD": "0"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        try:
            assert process.stdout is not None
            told = "".join(process.stdout.readline() for _ in range(lines))
            yield process.pid, re.findall(r"\w+://[\d.:]+", told)
        finally:
            process.terminate()


simulator = partial(program, "-m", "pioneer3", "sim", "-p", "0")


def rows() -> Iterator[Row]:
    """Yield what each program takes."""

    def row(what: str, percent: float) -> Row:
        return Row(f"cost: {what}", percent, "%", BARS[what])

    with simulator() as (pid, (url,)):
        yield row("simulator, no host", share(pid))
        with program("-c", HOST, url, "standing") as (host, _):
            yield row("simulator, a host, standing", share(pid))
            without = share(host)
            yield row("driver, standing", without)
        with program("-c", HOST, url, "driving"):
            yield row("simulator, driving", share(pid))
        arguments = "-m", "pioneer3", "run", "--port", url, "--web-port", "0"
        with program(*arguments) as (page, _):
            yield row("page, a robot without a laser", share(page))
    with (
        simulator("--fit", "laser=utm-30lx", lines=2) as (pid, (url, laser)),
        program("-c", HOST, url, "standing", f"utm-30lx@{laser}") as (host, _),
    ):
        yield row("simulator, a UTM-30LX at 40 Hz", share(pid))
        yield row("driver with a UTM-30LX, more than without", share(host) - without)
