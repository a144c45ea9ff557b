"""What the ROS 1 node adds: latency both ways, its share of a processor, memory, and its rate.

`chrt -r 1 python -m benchmarks ros1` measures it undisturbed.
"""

import asyncio
import os
import sys
from bisect import bisect_right
from itertools import pairwise
from math import inf
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from benchmarks.simulator import simulator_process
from benchmarks.table import Row, percentile_99
from tests.e2e.processes import Command, free_port, running
from tests.ros1.master import PYTHON, environment_of, has_ros, ros, roscore
from tests.ros1.tap import Tap, tapped

COMMANDS = 200
LISTENING = 30.0
"""[s]"""
SETTLED = 3.0
"""Time for connections to be made [s]."""
CLIENT = str(Path(__file__).parent / "ros1_client.py")
TICKS = os.sysconf("SC_CLK_TCK")


def rows() -> list[Row]:
    """Measure everything of this file."""
    if not has_ros():
        print("ROS 1 is not installed; scripts/test installs it", file=sys.stderr)
        return []
    with TemporaryDirectory() as home, simulator_process("--nomap") as url:
        port = free_port()
        os.environ.update(environment_of(port, Path(home)))
        with roscore(port, Path(home)):
            return asyncio.run(_measure(url))


async def _measure(url: str) -> list[Row]:
    async with tapped(url) as tap, running("ros1", "--port", tap.url) as node:
        await node.line()
        await node.line()
        return [*await _commands(tap), *await _readings(tap, node)]


async def _commands(tap: Tap) -> list[Row]:
    published: list[float] = await _client("drive", str(COMMANDS))
    delays = []
    for number, (asked, until) in enumerate(pairwise([*published, inf])):
        wanted = 0.1 + number % 100 / 1000
        sent = (
            when
            for when, twist in tap.velocities
            if asked < when < until and abs(twist.v - wanted) < 5e-4
        )
        if (when := next(sent, None)) is not None:
            delays.append(1000 * (when - asked))
    return [
        Row("commands that reached the robot", len(delays), "", COMMANDS, more_is_better=True),
        Row("cmd_vel published to velocity on the wire, median", median(delays), "ms", 2),
        Row("the same, 99th percentile", percentile_99(delays), "ms", 5),
    ]


async def _readings(tap: Tap, node: Command) -> list[Row]:
    client = asyncio.create_task(_client("listen", str(LISTENING + 2 * SETTLED)))
    await asyncio.sleep(SETTLED)
    before = processor_seconds(node.process.pid)
    await asyncio.sleep(LISTENING)
    share = (processor_seconds(node.process.pid) - before) / LISTENING
    memory = resident(node.process.pid)
    came: list[float] = (await client)[10:]
    delays = [1000 * (when - tap.answered[bisect_right(tap.answered, when) - 1]) for when in came]
    pauses = [after - before for before, after in pairwise(came)]
    return [
        Row("SIP to Odometry in a subscriber, median", median(delays), "ms", 2.5),
        Row("the same, 99th percentile", percentile_99(delays), "ms", None),
        Row("off from 10 poses a second", abs(len(pauses) / sum(pauses) - 10), "Hz", 0.1),
        Row("one core per node, six topics subscribed to", 100 * share, "%", 3),
        Row("memory of a node", memory, "MiB", 90),
    ]


async def _client(*arguments: str) -> list[float]:
    said = await ros(PYTHON, CLIENT, *arguments, patience=120.0)
    return [float(number) for number in said.strip("[] ").split(",")]


def processor_seconds(pid: int) -> float:
    """Return the time that a process has had [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def resident(pid: int) -> float:
    """Return the resident memory [MiB]."""
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    (resident,) = (line.split()[1] for line in lines if line.startswith("VmRSS"))
    return int(resident) / 1024
