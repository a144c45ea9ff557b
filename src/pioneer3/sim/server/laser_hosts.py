"""Hosts that connect to a simulated laser.

1. A unit with a serial line, which has a speed, has one connection for ever: hosts come and go at
   its terminal and, through a serial device server, on the network. One on the network gets nothing
   that has been sent before it came. All others have a connection per host, on the network or at a
   terminal that stands for USB.
2. Units that speak CoLa-A serve several hosts, of which the longest silent one gives way to one too
   many; others one at a time: the rules of :class:`pioneer3.sim.server.clients.ClientSlot` hold. A
   host that gets scans is not silent. The last requests of a host that leaves are still obeyed.
3. At the terminal of a serial line a host must have set the speed of the device, else neither
   understands the other. A host that changes its speed right after its last byte is understood. A
   device server on the network always has the right speed.
4. A terminal that is full stops the line: the laser leaves out whole scans, as where its line is
   too slow for them.
"""

import asyncio
import logging
from collections.abc import Callable
from math import inf
from random import Random

from pioneer3.lasers.device import DeviceConnection, LaserDevice
from pioneer3.sim.server.clients import STALE, ClientSlot, HostConnection
from pioneer3.sim.server.faults import CableDirection, LinkFaults

log = logging.getLogger(__name__)

MOST_WAITING = 4096
"""Most that waits for the next tick [bytes]; then the host waits."""
MOST_TAKEN = 64
"""Taken from a host at once [bytes]; a few times each tick, so a flood is as a busy serial line."""
MOST_FAREWELL = 256
"""Taken from a host that has gone: its last requests, but no flood [bytes]."""
LANDING = 0.05
"""A terminal may hand bytes over so long after its new speed, on a busy computer [s, real]."""
MOST_HOSTS = 8
"""At a unit that serves several."""


class Cable:
    """The way between a host and a connection of the device, with faults."""

    def __init__(self, connection: DeviceConnection, faults: LinkFaults) -> None:
        self.connection = connection
        self._inbox = bytearray()
        self.replace(faults)

    def replace(self, faults: LinkFaults) -> None:
        """Have other faults from now on."""
        self._faults = faults
        self._to_laser = CableDirection(faults, "to laser")
        self._to_host = CableDirection(faults, "to host")

    def keep(self, client: HostConnection, data: bytes) -> None:
        """Keep the bytes of `client` for :meth:`take`."""
        self._inbox += data
        if len(self._inbox) >= MOST_WAITING:
            client.pause()

    def take(self, client: HostConnection | None, now: float, most: int = MOST_TAKEN) -> None:
        """Give the device bytes that have come by `now` [s], at most so many at once."""
        data = bytes(self._inbox[:most])
        del self._inbox[:most]
        if client is not None and len(self._inbox) < MOST_WAITING:
            client.resume()
        if self._faults.any or self._to_laser.due < inf:
            data = self._to_laser.transmit(data, now)
        if data:
            self.connection.receive(data, now)

    def from_laser(self, now: float) -> bytes:
        """Return the bytes that reach the host at `now` [s]."""
        data = self.connection.outgoing(now)
        if self._faults.any or self._to_host.due < inf:
            data = self._to_host.transmit(data, now)
        return data

    def hang_up(self) -> None:
        """Note that the host has gone: its last bytes still arrive, none come to it."""
        del self._inbox[MOST_FAREWELL:]
        self._to_host.clear()

    def clear(self) -> None:
        """Drop the bytes that are on their way."""
        self._inbox.clear()
        self._to_laser.clear()
        self._to_host.clear()


class OneHost:
    """A host at a time.

    `label` returns the name of the laser for the log; `wake` is called whenever a host has sent
    bytes.
    """

    def __init__(
        self,
        device: LaserDevice,
        faults: LinkFaults,
        *,
        label: Callable[[], str],
        wake: Callable[[], None],
    ) -> None:
        self._device, self._wake = device, wake
        self._faults = faults
        self._lasting = device.speed is not None
        self._cable = Cable(device.connect(), faults) if self._lasting else None
        self._now, self._heard = -inf, False
        self._slot = ClientSlot(self._another, label)
        self._terminal_speed: Callable[[], int | None] = lambda: None
        self._looked_at, self._wrong_since = -inf, -inf
        self._noise = Random(faults.seed)

    @property
    def full(self) -> bool:
        """Whether one more host would be turned away at once."""
        return self._slot.full

    @property
    def connected(self) -> bool:
        """Whether any host is connected."""
        return self._slot.host is not None

    def set_terminal(self, speed: Callable[[], int | None]) -> None:
        """Ask `speed` for the speed that a host has set at the terminal [baud]."""
        self._terminal_speed = speed

    def admit(self, client: HostConnection) -> None:
        """Give `client` a connection, now or soon, or turn it away."""
        self._slot.admit(client)

    def received(self, client: HostConnection, data: bytes) -> None:
        if self._slot.heard_from(client) and self._cable and self._is_understood(client):
            self._cable.keep(client, data)
            self._wake()

    def disconnected(self, client: HostConnection) -> None:
        if self._slot.disconnected(client) and not self.connected:
            self._hang_up()

    def exchange(self, now: float, *, heard: bool) -> None:
        """Pass the bytes of hosts and laser on at `now` [s]; if not `heard`, all are lost."""
        self._now, self._heard = now, heard
        cable, host = self._cable, self._slot.host
        if cable is None:
            return
        if not heard or self._slot.closed:
            cable.clear()
        cable.take(host, now)
        if self._lasting:
            self._look_at_terminal()
        if host is not None and host.full:
            return
        understands = host is not None and self._understands(host)
        data = cable.from_laser(now)  # after its last byte the laser may change its speed
        if not data or host is None or not heard:
            return
        if not host.permanent:
            self._slot.heard_from(host)
        host.send(data if understands else self._noise.randbytes(len(data)))

    def _look_at_terminal(self) -> None:
        """Note since when the speed of the terminal has been seen to be wrong."""
        self._looked_at = _now()
        if self._terminal_speed() == self._device.speed:
            self._wrong_since = inf
        elif self._wrong_since == inf:
            self._wrong_since = self._looked_at

    def _is_understood(self, client: HostConnection) -> bool:
        """Whether the laser understands bytes that are read now: they were sent a moment ago.

        Time counts only up to the last look, so that a simulator that was held up reads first.
        """
        was_right = self._looked_at - self._wrong_since <= LANDING
        return was_right or self._understands(client)

    def shut(self, *, closed: bool) -> None:
        """Disconnect all hosts and turn others away, or no longer."""
        self._slot.closed = closed
        if closed:
            self._slot.disconnect_all()

    def use(self, faults: LinkFaults) -> None:
        """Give every cable these faults."""
        self._faults = faults
        if self._cable is not None:
            self._cable.replace(faults)

    def _another(self) -> None:
        """Prepare for another host."""
        self._hang_up()
        assert self._slot.host is not None
        connection = self._device.connect(network=not self._slot.host.permanent)
        self._cable = Cable(connection, self._faults)

    def _hang_up(self) -> None:
        """Let the device take the last requests; a connection that does not last ends."""
        cable = self._cable
        if cable is None:
            return
        cable.hang_up()
        if self._heard:
            cable.take(None, self._now, MOST_FAREWELL)
        if not self._lasting:
            cable.connection.close()
            self._cable = None

    def _understands(self, client: HostConnection) -> bool:
        if not client.permanent or self._device.speed is None:
            return True
        return self._terminal_speed() == self._device.speed


class SeveralHosts:
    """Several hosts, each with a connection of its own; all else as for :class:`OneHost`."""

    def __init__(
        self,
        device: LaserDevice,
        faults: LinkFaults,
        *,
        label: Callable[[], str],
        wake: Callable[[], None],
    ) -> None:
        self._device, self._faults, self._wake, self._label = device, faults, wake, label
        self._cables: dict[HostConnection, Cable] = {}
        self._leaving: list[Cable] = []
        self._heard: dict[HostConnection, float] = {}
        self._closed = False

    @property
    def full(self) -> bool:
        return self._closed or (len(self._cables) >= MOST_HOSTS and self._silent_host() is None)

    @property
    def connected(self) -> bool:
        return bool(self._cables)

    def admit(self, client: HostConnection) -> None:
        if self.full:
            client.close()
            return
        if len(self._cables) >= MOST_HOSTS and (silent := self._silent_host()) is not None:
            log.info("%s: silent, gives way at %s", silent.peer, self._label())
            silent.close()
            self.disconnected(silent)
        log.info("%s: connected to %s", client.peer, self._label())
        self._cables[client] = Cable(self._device.connect(network=True), self._faults)
        self._heard[client] = _now()
        client.resume()

    def received(self, client: HostConnection, data: bytes) -> None:
        if client in self._cables:
            self._heard[client] = _now()
            self._cables[client].keep(client, data)
            self._wake()

    def disconnected(self, client: HostConnection) -> None:
        if (cable := self._cables.pop(client, None)) is not None:
            log.info("%s: gone from %s", client.peer, self._label())
            del self._heard[client]
            self._leaving.append(cable)

    def exchange(self, now: float, *, heard: bool) -> None:
        for client, cable in tuple(self._cables.items()):
            if not heard:
                cable.clear()
            cable.take(client, now)
            data = cable.from_laser(now)
            if data and heard:
                client.send(data)
                if client in self._heard:  # sending has not closed it
                    self._heard[client] = _now()
        self._let_go(now)

    def shut(self, *, closed: bool) -> None:
        self._closed = closed
        if closed:
            for client in tuple(self._cables):
                client.close()
                self.disconnected(client)

    def use(self, faults: LinkFaults) -> None:
        self._faults = faults
        for cable in self._cables.values():
            cable.replace(faults)

    def _let_go(self, now: float) -> None:
        """End the connections of hosts that have gone, after their last requests."""
        leaving, self._leaving = self._leaving, []
        for cable in leaving:
            cable.hang_up()
            cable.take(None, now, MOST_FAREWELL)
            cable.connection.close()

    def _silent_host(self) -> HostConnection | None:
        """Return the host that has been silent for longest, and for long enough to give way."""
        silent = min(self._heard, key=self._heard.__getitem__, default=None)
        return silent if silent and _now() - self._heard[silent] >= STALE else None


def _now() -> float:
    return asyncio.get_running_loop().time()
