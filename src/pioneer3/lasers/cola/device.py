"""A simulated LMS-1xx, LMS-5xx or TiM: one unit, and the programs connected to it. No I/O.

Rules:

1. All connections share the mirror and the settings.
2. :attr:`ColaDevice.turn` is `None` while nobody waits for a scan. A request for the last scan is
   answered with the next one where the last one is old.
3. A scan goes to all subscribers, if its number fits the interval of LMDscandatacfg.
4. A power cycle ends all connections: bytes that a host sends over an old one are not heard.

Facts: cola.md 1.1, 6.2.
"""

from math import inf
from typing import Final

from pioneer3.lasers.cola.connection import ColaConnection
from pioneer3.lasers.cola.unit import ColaUnit
from pioneer3.lasers.device import MirrorTurn, Sweep
from pioneer3.models.lasers import LaserModel

DEFAULT_SERIAL: Final = 10_010_001


class ColaDevice:
    """One laser, which has run for long until :meth:`switch_on` is called.

    The server calls :meth:`ColaConnection.outgoing` of each connection after every other call, and
    sends its bytes in one piece: some programs put no pieces together (cola.md 5.2). `spin_up` is
    the time from power-on until it measures [s]. Raises ConfigError if the model does not speak
    CoLa-A.
    """

    def __init__(
        self, model: LaserModel, *, spin_up: float = 15.0, serial: int = DEFAULT_SERIAL
    ) -> None:
        self.speed: int | None = None
        self.deadline = inf
        self.unit = ColaUnit(model, spin_up=spin_up, serial=serial)
        self._connections: list[ColaConnection] = []
        self.plan(0.0)

    @property
    def turn(self) -> MirrorTurn | None:
        """The next turn of the mirror, or `None` while nobody wants readings."""
        wanted = any(c.subscribed or c.polling for c in self._connections)
        return self.unit.turn() if wanted else None

    def connect(self, *, network: bool = True) -> ColaConnection:
        """Return the connection of one more host."""
        connection = ColaConnection(self.unit, self)
        self._connections.append(connection)
        return connection

    def forget(self, connection: ColaConnection) -> None:
        """Drop a connection that has been closed."""
        if connection in self._connections:
            self._connections.remove(connection)

    def switch_on(self, now: float) -> None:
        """Begin as after a power cycle: unstored settings are forgotten, connections are dead."""
        for connection in self._connections:
            connection.cut()
        self.unit.switch_on(now)
        self.plan(now)

    def tick(self, now: float) -> None:
        """Act on the passing of time."""
        self.unit.tick(now)
        self.plan(now)

    def measured(self, sweep: Sweep, now: float) -> None:
        """Take the readings of a turn that is over."""
        self.unit.tick(now)
        words = self.unit.measured(sweep, now)
        if words is not None:
            for connection in self._connections:
                connection.send_scan(words)
        self.plan(now)

    def plan(self, now: float) -> None:
        """Set the deadline anew; connections call this when their output changes."""
        if any(connection.has_output for connection in self._connections):
            self.deadline = now
        else:
            self.deadline = inf if self.unit.up else self.unit.ready_at
