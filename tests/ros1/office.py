"""A simulated robot among walls, with bumpers and a gyro, and its node."""

import os
import signal
import subprocess
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass

from tests.e2e.processes import COMMAND, PATIENCE, Command, environment, running

ROBOT = ("sim", "--ideal", "--fit", "bumpers,gyro", "--port", "0")


@dataclass
class Office:
    """The running commands."""

    simulator: Command
    node: Command


@asynccontextmanager
async def office(*arguments: str) -> AsyncIterator[Office]:
    """Run both while the block lasts."""
    async with running(*ROBOT) as simulator:
        url = (await simulator.line()).split()[-1]
        async with running("ros1", "--port", url, *arguments) as node:
            assert "Pioneer 3-AT" in await node.line()
            assert (await node.line()).startswith("node /")
            yield Office(simulator, node)
            if node.process.returncode is None:
                await node.end(signal.SIGINT)


@contextmanager
def shared_office(ros: Mapping[str, str], *arguments: str) -> Iterator[None]:
    """Run both, for as many tests as need no others, while the block lasts."""
    with (
        _started(ROBOT, "SIMULATOR", ros) as said,
        _started(("ros1", "--port", said.split()[-1], *arguments), "node /", ros),
    ):
        yield


@contextmanager
def _started(command: tuple[str, ...], words: str, ros: Mapping[str, str]) -> Iterator[str]:
    """Run a command; the block begins with the line in which it says `words`."""
    process = subprocess.Popen(
        [*COMMAND, *command],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        env={**environment(), **ros},
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    try:
        yield next(line for line in process.stdout if words in line)
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(PATIENCE)
        finally:
            if process.returncode is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            process.stdout.close()
