import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest
import pytest_asyncio

from tests.e2e.processes import PATIENCE, Command, free_port, running
from tests.ros1.master import environment_of, has_ros, roscore
from tests.ros1.tap import Tap, tapped


@dataclass
class Lab:
    """A simulated robot and its node.

    Attributes:
        url: Of the simulator.
        simulator: The running command.
        node: The running command.
        tap: On the cable between them.
    """

    url: str
    simulator: Command
    node: Command
    tap: Tap

    async def warns(self, words: str) -> None:
        """Wait until the node says `words`."""
        assert self.node.process.stderr is not None
        async with asyncio.timeout(PATIENCE):
            async for line in self.node.process.stderr:
                if words in line.decode():
                    return
        raise AssertionError(f"the node ended without saying {words!r}")


@pytest.fixture(scope="session")
def master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """Run one master for all tests; return what makes programs find it."""
    if not has_ros():
        if os.environ.get("CI") == "true":
            pytest.fail("ROS 1 is not installed; scripts/test installs it")
        pytest.skip("ROS 1 is not installed; scripts/test installs it")
    port, home = free_port(), tmp_path_factory.mktemp("ros")
    with roscore(port, home):
        yield environment_of(port, home)


@pytest.fixture(scope="module")
def ros1(master: dict[str, str]) -> Iterator[None]:
    """Let programs find the master."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in master.items():
            patch.setenv(name, value)
        yield


@pytest_asyncio.fixture
async def lab(ros1: None) -> AsyncIterator[Lab]:
    """Run a simulated robot and its node."""
    async with laboratory() as running_lab:
        yield running_lab


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def shared_lab(ros1: None) -> AsyncIterator[Lab]:
    """Run a simulated robot and its node for all tests of a file, which leave it standing."""
    async with laboratory() as running_lab:
        yield running_lab


@asynccontextmanager
async def laboratory(*arguments: str, sim_port: int = 0) -> AsyncIterator[Lab]:
    """Run a simulated robot, and its node with `arguments`, while the block lasts."""
    async with (
        simulated(sim_port) as (simulator, url),
        tapped(url) as tap,
        running("ros1", "--port", tap.url, *arguments) as node,
    ):
        assert (await node.line()).startswith("SIMULATOR: Pioneer 3-AT on ")
        assert (await node.line()).startswith("node /")
        try:
            yield Lab(url, simulator, node, tap)
        finally:
            if node.process.returncode is None:  # killed, it would stay registered
                _, said = await node.end(signal.SIGINT)
                sys.stderr.write(said)


@asynccontextmanager
async def simulated(port: int = 0) -> AsyncIterator[tuple[Command, str]]:
    """Run a simulated robot with bumpers in the open, on `port`, while the block lasts."""
    command = ("sim", "--ideal", "--nomap", "--fit", "bumpers", "--port", str(port))
    async with running(*command) as simulator:
        yield simulator, (await simulator.line()).split()[-1]


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """Return a folder for a master of a test's own."""
    return tmp_path
