"""A simulated laser range finder at the far end of a cable in memory, beside a simulated robot.

The unit is the simulator's own: a mirror that turns, and its maker's protocol. A driver reads it as
it would read a real one.
"""

import asyncio
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from pioneer3.errors import LinkError
from pioneer3.links import Link, Opener
from pioneer3.links.memory import MemoryLink
from pioneer3.models.lasers import load_laser
from pioneer3.robot.lasers.driver import LaserConfig
from pioneer3.robot.lasers.spec import LaserSpec
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.laser_hosts import OneHost
from pioneer3.sim.server.laser_ports import device_of
from tests.support import SimulatedRobot


class Line(MemoryLink):
    """The driver's end of the cable: the speed that it sets is that of the cable.

    The unit compares it with its own.
    """

    async def set_speed(self, baud: int) -> None:
        """Change the line speed."""
        self.speed = baud
        if self.peer is not None:
            self.peer.speed = baud


class MemoryHost:
    """A host of a simulated laser, at a cable in memory.

    Args:
        link: The laser's end of the cable.
        permanent: Whether it is a serial line.
    """

    def __init__(self, link: MemoryLink, *, permanent: bool) -> None:
        self.peer, self.permanent = link.url, permanent
        self._link = link
        self._unsent: asyncio.Queue[bytes] = asyncio.Queue()

    def resume(self) -> None:
        """It is always read."""

    def pause(self) -> None:
        """The cable holds any number of bytes."""

    def send(self, data: bytes) -> None:
        """Send at the next round of the loop."""
        self._unsent.put_nowait(data)

    def close(self) -> None:
        """Unplug a cable that does not last."""
        if not self.permanent:
            self._unsent.put_nowait(b"")

    async def write(self) -> None:
        """Pass on what the laser sends, until either end has closed."""
        while data := await self._unsent.get():
            try:
                await self._link.write(data)
            except LinkError:
                return
        await self._link.close()


@dataclass(frozen=True, slots=True, kw_only=True)
class UnitSpec(LaserSpec):
    """A laser that is reached by a function, not by the URL of a port."""

    open: Opener

    def config(self) -> LaserConfig:
        """Return the laser for a driver."""
        return LaserConfig(url=self.url, open=self.open, name=self.name, protocol=self.protocol)


class LaserUnit:
    """A laser on a simulated robot, in the loop's time, while the block lasts.

    Args:
        sim: The robot; the unit measures after each of its world's steps.
        name: Of the laser's model.

    Attributes:
        laser: The unit; it can be silenced, switched off, unplugged.
        spec: For `connect_async`.
    """

    def __init__(self, sim: SimulatedRobot, name: str) -> None:
        model = load_laser(name)
        self.laser = SimulatedLaser(sim.world, sim.body, model, device_of(model))
        self.spec = UnitSpec(url=f"memory:{name}", open=self.open, protocol=model.protocol)
        self._sim, self._stepped = sim, sim.stepped
        self._line: Line | None = None
        self._tasks: list[asyncio.Task[None]] = []
        hosts = self.laser.hosts
        if isinstance(hosts, OneHost):
            hosts.set_terminal(lambda: self._line.speed if self._line else None)

    async def __aenter__(self) -> Self:
        self._sim.stepped = self._step
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._sim.stepped = self._stepped
        for task in self._tasks:
            task.cancel()
        for ended in await asyncio.gather(*self._tasks, return_exceptions=True):
            if isinstance(ended, Exception) and error is None:
                raise ended
        self.laser.close()

    async def open(self) -> Link:
        """Lay a cable, as opening a port does."""
        model = self.laser.model
        ours, theirs = Line(self.spec.url, speeds=model.speeds), MemoryLink("memory:laser")
        ours.peer, theirs.peer, theirs.speed = theirs, ours, ours.speed
        self._line = ours
        host = MemoryHost(theirs, permanent=self.laser.device.speed is not None)
        if not host.permanent:
            self.laser.hosts.admit(host)
        self._tasks = [task for task in self._tasks if not task.done()]
        self._tasks += [
            asyncio.ensure_future(self._listen(theirs, host)),
            asyncio.ensure_future(host.write()),
        ]
        return ours

    def _step(self) -> None:
        self._stepped()
        self.laser.tick(self._sim.world.time)

    async def _listen(self, link: MemoryLink, host: MemoryHost) -> None:
        while data := await link.read():
            self.laser.hosts.received(host, data)
        self.laser.hosts.disconnected(host)
