"""One port for any number of hosts: each gets a robot, which goes when it goes."""

import asyncio
import logging
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from pioneer3.errors import PioneerError
from pioneer3.links.tcp import accepted
from pioneer3.runtime.simulation.address import url_of
from pioneer3.runtime.simulation.running import RunningSimulation
from pioneer3.sim.server.doors import listening
from pioneer3.sim.worldfile import RobotSpec

log = logging.getLogger(__name__)


@asynccontextmanager
async def robot_factory(
    running: RunningSimulation, product: RobotSpec, port: int, host: str
) -> AsyncIterator[str]:
    """Listen while the block runs; yield the URL.

    Args:
        running: Where the robots come into the world.
        product: What every host gets; a free port of its own besides.
        port: TCP port; 0 takes a free one.
        host: Address of this machine to listen at.

    Raises:
        LinkError: The port cannot be listened on.
    """
    serving: set[asyncio.Task[None]] = set()

    def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.ensure_future(_serve(running, product, reader, writer))
        serving.add(task)
        task.add_done_callback(serving.discard)

    listener = await listening(host, port)
    address, number = listener.getsockname()[:2]
    server = await asyncio.start_server(serve, sock=listener)
    try:
        yield url_of(address, number)
    finally:
        server.close()
        for task in serving:
            task.cancel()
        await asyncio.gather(*serving, return_exceptions=True)


async def _serve(
    running: RunningSimulation,
    product: RobotSpec,
    reader: asyncio.StreamReader,
    writer: asyncio.StreamWriter,
) -> None:
    peer = writer.get_extra_info("peername") or ("?", 0)
    link = accepted(f"tcp://{peer[0]}:{peer[1]}", reader, writer)
    try:
        robot = await running.add_robot(product)
    except PioneerError as error:
        log.warning("%s: gets no robot: %s", link.url, error)
        await link.close()
        return
    log.info("%s: gets %s", link.url, robot.name)
    try:
        await robot.port.serve(link)
    finally:
        if robot in running.robots:  # nobody else has taken it away
            await running.remove_robot(robot)
