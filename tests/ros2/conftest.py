import signal
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass

import pytest
import pytest_asyncio

from pioneer3.ros.ros2.network import BackendName
from tests.e2e.processes import Command, running
from tests.ros1.tap import Tap, tapped
from tests.ros2.networks import Ros2, network_of


@dataclass
class Robot:
    """A node of a simulated robot, as a process.

    Attributes:
        node: The running command.
        simulator: The running command.
        tap: On the cable between them.
        said: All that the node has said until it was ready.
    """

    node: Command
    simulator: Command
    tap: Tap
    said: tuple[str, ...] = ()


@pytest_asyncio.fixture(params=[BackendName.DDS, BackendName.ZENOH])
async def ros2(request: pytest.FixtureRequest) -> AsyncIterator[Ros2]:
    """Return a network of each kind."""
    async with network_of(request.param) as network:
        yield network


@asynccontextmanager
async def robot_on(
    network: Ros2, *arguments: str, world: tuple[str, ...] = ("--nomap",)
) -> AsyncIterator[Robot]:
    """Run a simulated robot, in the open or in another `world`, and its node."""
    async with (
        running("sim", "--ideal", *world, "--fit", "bumpers", "--port", "0") as simulator,
        tapped((await simulator.line()).split()[-1]) as tap,
        running(
            *("ros2", "--port", tap.url, *network.options, *arguments),
            variables=network.variables,
        ) as node,
    ):
        said = [""]
        while "ready" not in said[-1]:
            said.append(await node.line())
            assert said[-1], await node.end()
        yield Robot(node, simulator, tap, tuple(said))
        if node.process.returncode is None:
            await node.end(signal.SIGINT)
