"""Auxiliary serial ports of the controller, for serial devices (protocol.md 3.2, 5.5)."""

from collections.abc import Sequence
from math import inf
from typing import Protocol

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Report, SerialAux
from pioneer3.sim.accessories.base import Accessory

TTY = (commands.Tty2.ID, commands.Tty3.ID, commands.Tty4.ID)
GETAUX = (commands.GetAux.ID, commands.GetAux2.ID, commands.GetAux3.ID)
NUMBERS = (0xB0, 0xB8, 0xC8)
"""Numbers of the reports of AUX1, AUX2 and AUX3."""
MOST_ASKED = 200
"""Bytes that GETAUX may ask for (protocol.md 3.2)."""
BUFFER = 256
"""Bytes that wait for GETAUX; later ones are lost. Unverified."""


class SerialDevice(Protocol):
    """A device on a serial port."""

    @property
    def due(self) -> float:
        """Time of the next bytes [s]; `inf` if there are none."""

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the robot."""

    def transmit(self, now: float) -> bytes:
        """Return the bytes since the last call."""


class SimulatedAuxPort(Accessory):
    """One port: TTY sends out of it, GETAUX n waits until n bytes came in, GETAUX 0 forgets them.

    A request takes the place of one that still waits. Bytes for a `device` that is `None` are lost.
    """

    def __init__(self, port: int, device: SerialDevice | None = None) -> None:
        """`port` is 1, 2 or 3."""
        self.device = device
        self._tty, self._getaux = TTY[port - 1], GETAUX[port - 1]
        self._number = NUMBERS[port - 1]
        self._came_in = bytearray()
        self._wanted = 0
        self._ready: list[Report] = []

    @property
    def due(self) -> float:
        """Time when the requested bytes may be there [s]; `inf` without a request."""
        if self._ready or 0 < self._wanted <= len(self._came_in):
            return -inf
        return self.device.due if self.device and self._wanted else inf

    def deliver(self, data: bytes) -> None:
        """Let `data` come in, as from a device."""
        self._came_in += data[: BUFFER - len(self._came_in)]

    def obey(self, command: Command, now: float) -> bool:
        """Send bytes, or take a request for some."""
        match command:
            case commands.Tty2(data) | commands.Tty3(data) | commands.Tty4(data):
                if self._tty == command.ID and self.device:
                    self.device.receive(data, now)
                return self._tty == command.ID
            case commands.GetAux(count) | commands.GetAux2(count) | commands.GetAux3(count):
                if self._getaux == command.ID:
                    self._serve(now)
                    self._ask(count, now)
                return self._getaux == command.ID
        return False

    def _ask(self, count: int, now: float) -> None:
        if count == 0:
            self._came_in.clear()
        self._wanted = count if count <= MOST_ASKED else 0
        self._serve(now)

    def _serve(self, now: float) -> None:
        if self.device:
            self.deliver(self.device.transmit(now))
        if 0 < self._wanted <= len(self._came_in):
            data = bytes(self._came_in[: self._wanted])
            del self._came_in[: self._wanted]
            self._wanted = 0
            self._ready.append(SerialAux(self._number, data))

    def reports(self, now: float, *, cycle: bool) -> Sequence[Report]:
        """Return the requested bytes as soon as they are there."""
        self._serve(now)
        ready, self._ready = self._ready, []
        return ready

    def hang_up(self) -> None:
        """Drop requests and received bytes; the device goes on."""
        self._came_in.clear()
        self._ready.clear()
        self._wanted = 0
