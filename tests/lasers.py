"""A simulated laser at the far end of a cable in memory, on a robot of :mod:`tests.support`.

The unit is the simulator's own, with its mirror and its maker's protocol. A driver reads it as it
would read a real one.
"""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from types import TracebackType
from typing import Any, Self

from pioneer3.errors import LinkError, PortNotFoundError
from pioneer3.lasers.client import AS_DELIVERED, ScanSettings
from pioneer3.lasers.lms2xx.commands import CommandCode
from pioneer3.lasers.lms2xx.telegram import encode as telegram
from pioneer3.links import Link, Opener
from pioneer3.links.memory import MemoryLink
from pioneer3.models.lasers import load_laser
from pioneer3.robot.lasers.driver import LaserConfig, LaserDriver
from pioneer3.robot.lasers.mounting import Mounting
from pioneer3.robot.lasers.spec import LaserSpec
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.laser_hosts import OneHost
from pioneer3.sim.server.laser_ports import device_of
from pioneer3.sim.server.simulation import PIECES_APART
from tests.support import TICK, SimulatedRobot

SPEEDS = (9600, 19200, 38400, 57600, 115200, 500000)
"""That a serial port of the computer can have [baud]."""
STARTS = {"utm-30lx": 1.0, "urg-04lx": 1.0, "lms-200": 30.0, "lms-111": 15.0, "tim551": 15.0}
"""At most from power to the first answer or scan [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OpenedSpec(LaserSpec):
    """A laser whose link is opened by `open`."""

    open: Opener

    def config(self) -> LaserConfig:
        return LaserConfig(
            url=self.url,
            open=self.open,
            name=self.name,
            protocol=self.protocol,
            settings=self.settings,
            time_offset=self.time_offset,
        )


LEFT = {
    "urg-04lx": (
        (19200, b"\nSCIP2.0\n"),
        (19200, b"BM\n"),
        (19200, b"SS057600\n"),
        (57600, b"MD0044072501000\n"),
    ),
    "lms-200": (
        (9600, telegram(CommandCode.MODE, bytes([0x41]))),
        (19200, telegram(CommandCode.MODE, bytes([0x24]))),
    ),
}
"""Speeds and bytes that leave a laser at another speed, and scanning."""


class CableEnd(MemoryLink):
    """The host's end of a serial cable; the laser decides whether it understands the speed."""

    async def set_speed(self, baud: int) -> None:
        self.speed = baud
        assert self.peer is not None
        self.peer.speed = baud


class Host:
    """The host as the simulated laser sees it.

    Attributes:
        permanent: Whether it is a terminal, which is always there.
    """

    full = False

    def __init__(
        self, laser: SimulatedLaser, heard: Callable[[], None], *, permanent: bool
    ) -> None:
        self.peer, self.permanent = "memory", permanent
        self._heard = heard
        self._laser = laser
        self._outbox: asyncio.Queue[bytes] = asyncio.Queue()
        self._link: MemoryLink | None = None
        self._tasks: list[asyncio.Task[None]] = []

    def plug_in(self, link: MemoryLink) -> None:
        """Use `link` from now on."""
        self.close_link()
        self._link = link
        self._outbox = asyncio.Queue()
        self._tasks = [
            asyncio.ensure_future(self._listen(link)),
            asyncio.ensure_future(self._speak(link, self._outbox)),
        ]

    def resume(self) -> None:
        """Never pauses."""

    def pause(self) -> None:
        """Never pauses."""

    def send(self, data: bytes) -> None:
        """Send `data` soon."""
        self._outbox.put_nowait(data)

    def close(self) -> None:
        """Disconnect a host that is not permanent."""
        if not self.permanent:
            self.close_link()

    def close_link(self) -> None:
        """Cut the cable."""
        link, self._link = self._link, None
        if link is not None:
            self._outbox.put_nowait(b"")
            self._tasks.append(asyncio.ensure_future(link.close()))

    def end(self) -> list["asyncio.Task[None]"]:
        """Cancel the work in the background, and return it."""
        for task in self._tasks:
            task.cancel()
        return self._tasks

    async def _listen(self, link: MemoryLink) -> None:
        while data := await link.read():
            if link is self._link:
                self._laser.hosts.received(self, data)
                self._heard()
        if link is self._link and not self.permanent:
            self._link = None
            self._laser.hosts.disconnected(self)

    async def _speak(self, link: MemoryLink, outbox: "asyncio.Queue[bytes]") -> None:
        try:
            while data := await outbox.get():
                await link.write(data)
        except LinkError:
            pass  # the host has closed: _listen learns of it, too


class LaserUnit:
    """A simulated laser on `robot` during the block; :meth:`open` lays a cable to it.

    Args:
        robot: Whose world steps; the unit measures after each step.
        name: Of the laser's model.
        serial: Whether it is at a serial port, else in the network; `None` for a serial port if
            its model has one.
        name_in_scans: Of the laser.

    Attributes:
        laser: The simulated unit; it can be silenced and switched off.
        plugged: Whether :meth:`open` works.
    """

    def __init__(
        self,
        robot: SimulatedRobot,
        name: str,
        *,
        serial: bool | None = None,
        name_in_scans: str = "laser",
    ) -> None:
        model = load_laser(name)
        if serial is None:
            serial = bool(model.speeds) or model.usb
        self.laser = SimulatedLaser(robot.world, robot.body, model, device_of(model))
        self.plugged = True
        self.url = f"/dev/{name_in_scans}" if serial else f"tcp://{name_in_scans}:10940"
        self.opened = 0
        self._name = name_in_scans
        self._serial, self._robot = serial, robot
        self._end: MemoryLink | None = None
        self._hosts: list[Host] = []
        self._stepped_at = inf
        self._timer = asyncio.get_running_loop().call_soon(lambda: None)
        if serial:
            self._hosts.append(Host(self.laser, self._exchange, permanent=True))
            self.laser.hosts.admit(self._hosts[0])
            if isinstance(self.laser.hosts, OneHost):
                self.laser.hosts.set_terminal(lambda: self._end.speed if self._end else None)

    async def __aenter__(self) -> Self:
        before = self._stepped = self._robot.stepped

        def stepped() -> None:
            before()
            self._stepped_at = asyncio.get_running_loop().time()
            self.laser.tick(self._robot.world.time)

        self._robot.stepped = stepped
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._robot.stepped = self._stepped
        self.laser.close()
        tasks = [task for host in self._hosts for task in host.end()]
        for ended in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(ended, Exception) and error is None:
                raise ended

    def spec(self, mounting: Mounting | None = None, **parts: Any) -> LaserSpec:
        """Return the laser for :func:`connect_async`."""
        return OpenedSpec(url=self.url, open=self.open, name=self._name, mounting=mounting, **parts)

    def driver(self, settings: ScanSettings = AS_DELIVERED) -> LaserDriver:
        """Return a driver for it alone."""
        return LaserDriver(replace(self.spec().config(), settings=settings))

    async def open(self) -> Link:
        """Lay a cable, as opening a port does."""
        if not self.plugged or (not self._serial and not self.laser.powered):
            raise PortNotFoundError(f"{self.url}: no such port")
        self.opened += 1
        kind = CableEnd if self._serial else MemoryLink
        ours, theirs = kind(self.url), MemoryLink("memory:laser")
        ours.peer, theirs.peer = theirs, ours
        self._end = ours
        if self._serial:
            ours.speeds = SPEEDS
            await ours.set_speed(SPEEDS[0])
            self._hosts[0].plug_in(theirs)
            return ours
        host = Host(self.laser, self._exchange, permanent=False)
        self._hosts.append(host)
        host.plug_in(theirs)
        self.laser.hosts.admit(host)
        return ours

    def _exchange(self) -> None:
        """Pass bytes on between two steps of the world, now and when the next ones leave."""
        loop = asyncio.get_running_loop()
        passed = min(max(loop.time() - self._stepped_at, 0.0), TICK)
        now = self._robot.world.time + passed
        self.laser.exchange(now)
        self._timer.cancel()
        wait = max(self.laser.due - now, PIECES_APART)
        if passed + wait < TICK:
            self._timer = loop.call_later(wait, self._exchange)

    def unplug(self) -> None:
        """Pull the cable out; the port is gone."""
        self.plugged = False
        self.laser.unplug()
        for host in self._hosts:
            host.close_link()

    def plug_in(self) -> None:
        """Put it in again."""
        self.plugged = True
        self.laser.plug_in()
