"""A simulated robot among walls, with bumpers and a gyro, and its node."""

import signal
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass

from tests.e2e.processes import COMMAND, Command, running
from tests.ros1.master import started

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
        started((*COMMAND, *ROBOT), "SIMULATOR", ros) as said,
        started((*COMMAND, "ros1", "--port", said.split()[-1], *arguments), "node /", ros),
    ):
        yield
