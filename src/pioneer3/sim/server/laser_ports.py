"""The lasers of a simulation: their devices, their ports, and their share of each tick."""

import logging
import os
import socket
from collections.abc import Callable
from importlib import import_module
from math import inf
from typing import cast

from pioneer3.errors import ConfigError, LinkError
from pioneer3.lasers.device import LaserDevice
from pioneer3.models.lasers import HOKUYO_PORT, LaserModel, LaserProtocol, load_laser
from pioneer3.sim.body import Body
from pioneer3.sim.server.laser import SimulatedLaser
from pioneer3.sim.server.listeners import PtyListener, TcpListener, first_free, listening
from pioneer3.sim.world import World

log = logging.getLogger(__name__)

DEVICES = {
    LaserProtocol.SCIP: ("pioneer3.lasers.scip.device", "ScipDevice"),
    LaserProtocol.LMS2XX: ("pioneer3.lasers.lms2xx.device", "LmsDevice"),
    LaserProtocol.COLA: ("pioneer3.lasers.cola.device", "ColaDevice"),
}
"""Module and class of the device that speaks each protocol."""
SERVER_PORT = 4001
"""Port of a serial line on the network, as many device servers have it."""


def device_of(model: LaserModel) -> LaserDevice:
    """Return a new device of this model.

    Raises:
        ConfigError: Its protocol is not simulated.
    """
    module, name = DEVICES[model.protocol]
    try:
        make = getattr(import_module(module), name)
    except (ImportError, AttributeError):
        raise ConfigError(f"{model.name}: {model.protocol} is not simulated") from None
    return cast("LaserDevice", make(model))


class LaserPorts:
    """All lasers of a simulation; `wake` is called whenever a host has sent bytes."""

    def __init__(self, world: World, wake: Callable[[], None]) -> None:
        self.lasers: list[SimulatedLaser] = []
        self._world, self._wake = world, wake

    async def add(
        self, body: Body, name: str, port: int | None, host: str, *, free: bool = False
    ) -> SimulatedLaser:
        """Fit a laser to a robot and let hosts connect: by TCP, and at a pseudo terminal.

        A laser without serial line has no terminal.

        Without `port` it has the usual ones of its model, or the next free ones; with `free`, any.

        Raises:
            ConfigError: There is no such laser.
            PortBusyError: Another program listens at `port`.
            LinkError: There is no free port or no pseudo terminal left.
        """
        model = load_laser(name)
        laser = SimulatedLaser(self._world, body, model, device_of(model), self._wake)
        try:
            for listener in await _listeners(model, 0 if free and port is None else port, host):
                laser.add_listener(TcpListener(laser.hosts, listener))
                address, number = listener.getsockname()[:2]
                laser.addresses.append((address, number))
            if (model.speeds or model.usb) and os.name == "posix":
                laser.add_listener(PtyListener(laser.hosts))
        except LinkError:
            laser.close()
            raise
        self.lasers.append(laser)
        return laser

    def remove(self, laser: SimulatedLaser) -> None:
        """Disconnect a laser's hosts and close its ports."""
        self.lasers.remove(laser)
        laser.close()

    @property
    def due(self) -> float:
        """When bytes may leave a serial line towards its host [s, simulated]; `inf`: never."""
        return min((laser.due for laser in self.lasers if laser.on_serial_line), default=inf)

    def exchange(self, now: float) -> None:
        """Pass the bytes of hosts and lasers on, up to a tick after the last one [s, simulated]."""
        for laser in self.lasers:
            self._guarded(laser, laser.exchange, now)

    def tick(self, now: float) -> None:
        """Let time pass for all lasers until `now` [s, simulated]."""
        for laser in self.lasers:
            self._guarded(laser, laser.tick, now)

    def close(self) -> None:
        """Close all ports."""
        for laser in self.lasers:
            laser.close()

    def _guarded(self, laser: SimulatedLaser, act: Callable[[float], None], now: float) -> None:
        """Keep an error of one laser from all others; it is switched off."""
        try:
            act(now)
        except Exception:
            log.exception("%s: the simulated laser failed, it is switched off", laser.label)
            laser.switch_off()


async def _listeners(model: LaserModel, port: int | None, host: str) -> list[socket.socket]:
    """Return the listening sockets of a laser, at `port` or else at its usual ports."""
    if port is not None:
        return [await listening(host, port)]
    default = HOKUYO_PORT if model.protocol is LaserProtocol.SCIP else SERVER_PORT
    found: list[socket.socket] = []
    try:
        for usual in model.tcp_ports or (default,):
            found.append(await first_free(host, usual))  # noqa: PERF401  closed if one fails
    except LinkError:
        for listener in found:
            listener.close()
        raise
    return found
