"""The simulator on the network: each robot listens on a TCP port, the world runs in real time."""

import asyncio
import errno
import logging
from collections.abc import Sequence
from contextlib import AsyncExitStack

from pioneer3.errors import LinkError, PortBusyError
from pioneer3.links import Link
from pioneer3.links.tcp import accepted
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.world import World

log = logging.getLogger(__name__)

TICK = 0.02
"""Simulated and real time between two looks at the world [s]."""
STALE = 2.0
"""A client that has been silent for this long [s] loses its place to the next one."""
GRACE = 0.1
"""A client that has just left may not have been noticed when the next one is here [s]."""
STUCK = 0.5
"""A client that takes nothing for this long [s], its buffers full, is cut off."""
LATE = 0.5
"""When the machine could not keep up for this long [s], simulated time falls behind real time."""


class RobotPort:
    """Where hosts meet one simulated robot: one at a time, any number one after the other."""

    def __init__(self, firmware: Firmware) -> None:
        self.firmware = firmware
        self._clock = asyncio.get_running_loop().time
        self._link: Link | None = None
        self._heard_at = float("-inf")

    async def serve(self, link: Link) -> None:
        """Serve one host until its link ends; a second host is turned away."""
        if self._link is not None:
            await asyncio.sleep(GRACE)
        if self._link is not None and self._clock() - self._heard_at < STALE:
            log.info("%s: turned away, another host is connected", link.url)
            await link.close()
            return
        if self._link is not None:
            await self._link.close()
        self._link, self._heard_at = link, self._clock()
        log.info("%s: connected", link.url)
        try:
            while data := await link.read():
                if self._link is not link:
                    break
                self._heard_at = self._clock()
                self.firmware.receive(data, self._heard_at)
                await self._flush()
        except LinkError as error:
            log.info("%s", error)
        finally:
            log.info("%s: gone", link.url)
            if self._link is link:
                self._link = None
            await link.close()

    async def tick(self) -> None:
        """Send what is due. Without a host, the watchdog ends the session that is left over."""
        now = self._clock()
        self.firmware.tick(now)
        if self._link is None and self.firmware.device.is_open and now - self._heard_at > STALE:
            self.firmware.hang_up(now)
        await self._flush()

    async def _flush(self) -> None:
        data, link = self.firmware.device.outgoing(), self._link
        if not data or link is None:
            return
        try:
            async with asyncio.timeout(STUCK):
                await link.write(data)
        except (LinkError, TimeoutError):
            await self.close()

    async def close(self) -> None:
        """Part from the host, if there is one."""
        link, self._link = self._link, None
        if link is not None:
            await link.close()


class Simulation:
    """A world in real time with its robots' ports.

    Args:
        world: What is simulated.
        firmwares: One for each robot that can be connected to.
    """

    def __init__(self, world: World, firmwares: Sequence[Firmware]) -> None:
        self.world = world
        self.ports = [RobotPort(firmware) for firmware in firmwares]
        self.addresses: list[tuple[str, int]] = []
        self._stack = AsyncExitStack()

    async def listen(self, first_port: int, host: str = "127.0.0.1") -> None:
        """Open a TCP port per robot: `first_port`, and the next ones; 0 takes free ones.

        Raises:
            PortBusyError: somebody else listens there.
            LinkError: this machine has no such address, or the port is not allowed.
        """
        for number, port in enumerate(self.ports):
            wanted = first_port + number if first_port else 0
            try:
                server = await _listen(port, host, wanted)
            except LinkError:
                await self._stack.aclose()
                raise
            await self._stack.enter_async_context(server)
            self._stack.push_async_callback(port.close)
            self.addresses.append(server.sockets[0].getsockname()[:2])

    async def run(self) -> None:
        """Let time pass until cancelled; then every port is closed."""
        clock = asyncio.get_running_loop().time
        due = clock()
        async with self._stack:
            while True:
                self.world.step(TICK)
                for port in self.ports:
                    await port.tick()
                due = max(due + TICK, clock() - LATE)
                await asyncio.sleep(due - clock())


async def _listen(port: RobotPort, host: str, number: int) -> asyncio.Server:
    async def on_client(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        peer = writer.get_extra_info("peername") or ("?", 0)
        await port.serve(accepted(f"tcp://{peer[0]}:{peer[1]}", reader, writer))

    try:
        return await asyncio.start_server(on_client, host, number)
    except OSError as error:
        where = f"{host}:{number}"
        if error.errno == errno.EADDRINUSE:
            raise PortBusyError(
                f"{where}: in use; is another simulator running? Choose another port with -p"
            ) from None
        raise LinkError(f"{where}: cannot listen there: {error.strerror}") from None
    except OverflowError:
        raise LinkError(f"{host}:{number}: ports are numbers from 1 to 65535") from None
