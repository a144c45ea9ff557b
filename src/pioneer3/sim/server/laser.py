"""A simulated laser range finder on a robot: its mirror, its protocol, its ports.

The device says which turn its mirror makes next. The turn takes its time: the scanner takes each
reading when it is due, and in the tick of the last one the device gets the turn, at the exact time
of that reading. No turn begins while the device wants none, so that lasers without a host cost
nothing.
"""

from array import array
from collections.abc import Callable
from math import inf

import numpy as np

from pioneer3.errors import LinkError
from pioneer3.lasers.device import LaserDevice, MirrorTurn, Sweep
from pioneer3.links.hosts import url_of
from pioneer3.models.lasers import LaserModel, LaserProtocol
from pioneer3.sim.body import Body
from pioneer3.sim.laser_scanner import Arc, LaserScanner
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.server.laser_hosts import OneHost, SeveralHosts
from pioneer3.sim.server.listeners import PtyListener, TcpListener
from pioneer3.sim.world import World

SWITCHED_ON = 60.0
"""A laser has been on for so long when it comes into the world [s]: all have started by then."""
SAID = 1.0
"""Its words at the start have left by so long ago [s]; no host hears them."""
FARTHEST = 1e6
"""In place of what did not come back, in whole millimetres [m]."""
SLACK = 1e-6
"""Times are sums of ticks, and rounded [s]."""


class SimulatedLaser:
    """One laser on a robot, which may have a serial port `pty`.

    `wake` is called whenever a host has sent bytes.

    Attributes:
        addresses: Host and number of its TCP ports, the first one for most programs.
    """

    def __init__(
        self,
        world: World,
        body: Body,
        model: LaserModel,
        device: LaserDevice,
        wake: Callable[[], None] = lambda: None,
    ) -> None:
        self.model, self.device, self.body = model, device, body
        self.addresses: list[tuple[str, int]] = []
        self.pty: str | None = None
        self._listeners: list[TcpListener | PtyListener] = []
        self._world = world
        self._scanner = LaserScanner(world, body, model)
        self._turn: MirrorTurn | None = None
        self._began, self._next, self._looked = -inf, -inf, world.time
        self._exchanged = world.time
        self._powered, self._closed = True, False
        self._silent_until = -inf
        self._faults = LinkFaults()
        kind = SeveralHosts if model.protocol is LaserProtocol.COLA else OneHost
        self.hosts = kind(device, self._faults, label=lambda: self.label, wake=wake)
        device.switch_on(world.time - SWITCHED_ON)
        device.tick(world.time - SAID)
        self.hosts.exchange(world.time, heard=False)

    @property
    def label(self) -> str:
        """A name for people: its type and its TCP port, if it has one."""
        name = self.model.name
        return f"{name} at port {self.addresses[0][1]}" if self.addresses else name

    @property
    def url(self) -> str:
        """URL of its first TCP port.

        Raises:
            LinkError: It does not listen.
        """
        if not self.addresses:
            raise LinkError(f"{self.model.name}: does not listen")
        return url_of(*self.addresses[0])

    @property
    def connected(self) -> bool:
        """Whether any host is connected."""
        return self.hosts.connected

    @property
    def quiet(self) -> bool:
        """Whether it has no host, and its mirror takes no readings."""
        return not self.connected and self._turn is None and self.device.turn is None

    @property
    def powered(self) -> bool:
        """Whether it is switched on."""
        return self._powered

    @property
    def faults(self) -> LinkFaults:
        """Faults of its cable; may be replaced at any time."""
        return self._faults

    @faults.setter
    def faults(self, faults: LinkFaults) -> None:
        self._faults = faults
        self.hosts.use(faults)

    def unplug(self) -> None:
        """Pull the data cable out: hosts are disconnected, and new ones are turned away."""
        self._faults.unplug()
        self._shut()

    def plug_in(self) -> None:
        """Let hosts connect again."""
        self._faults.plug_in()
        self._shut()

    def switch_off(self) -> None:
        """Take its power away; hosts of Ethernet units are disconnected."""
        self._powered, self._turn = False, None
        self._shut()

    def switch_on(self) -> None:
        """Give it power: it begins as after a power cycle."""
        self._powered, self._turn, self._next = True, None, -inf
        self.device.switch_on(max(self._world.time, self._exchanged))
        self._shut()

    def silence(self, seconds: float) -> None:
        """Let it neither hear nor be heard for `seconds` of simulated time."""
        self._silent_until = self._world.time + seconds

    def add_listener(self, listener: TcpListener | PtyListener) -> None:
        """Let hosts connect through `listener`, which is closed with the laser."""
        self._listeners.append(listener)
        if isinstance(listener, PtyListener):
            self.pty = listener.path
            if isinstance(self.hosts, OneHost):
                self.hosts.set_terminal(lambda: listener.speed)

    @property
    def on_serial_line(self) -> bool:
        """Whether its bytes leave one after the other, at a speed."""
        return self.device.speed is not None

    @property
    def due(self) -> float:
        """When bytes may leave towards a host [s, simulated]; `inf`: never."""
        return self.device.deadline if self._powered and self.connected else inf

    def exchange(self, now: float) -> None:
        """Pass the bytes of hosts and laser on at `now` [s, simulated].

        It may be called between two ticks. Its time never goes back: a `now` before that of the
        last call counts as that one.
        """
        self._exchanged = now = max(now, self._exchanged)
        self._shut()
        if self._turn is None and self.device.turn is None:
            self._looked = now  # no turn begins before a host has asked for it
        self.hosts.exchange(now, heard=self._powered and now >= self._silent_until)

    def tick(self, now: float) -> None:
        """Let time pass until `now` [s, simulated], and send what is ready."""
        if self._powered:
            if self.device.deadline <= now + SLACK:
                self.device.tick(now)
            self._measure(now)
        self._looked = now
        self.exchange(now)

    def close(self) -> None:
        """Disconnect all hosts and stop listening."""
        for listener in self._listeners:
            listener.close()
        self._listeners.clear()
        self.addresses.clear()
        self.hosts.shut(closed=True)

    def _measure(self, now: float) -> None:
        """Take the readings that are due, and hand in the turns that are over."""
        scanner = self._scanner
        while self._turn is not None or self._begin():
            if not scanner.look(now):
                return
            assert self._turn is not None
            self._hand_in(self._turn)
            self._turn = None
        scanner.look(now)

    def _hand_in(self, turn: MirrorTurn) -> None:
        """Give the device a turn of which all readings are taken, when the last one was.

        That is before this tick, and may be before the last call of :meth:`exchange`: bytes of the
        turn leave from its end on even so, those that have left by now at once.
        """
        ranges, intensities = self._scanner.readings()
        millimetres = (np.minimum(ranges, FARTHEST) * 1000 + 0.5).astype(np.uint32)
        ended = self._began + (turn.count - 1) * turn.beam_time
        self._next = self._began + turn.period
        self.exchange(ended)  # what is sent before the turn leaves before it
        self.device.measured(
            Sweep(
                turn=turn,
                began=self._began,
                ranges=ranges.data,
                intensities=intensities.data,  # most devices tell none
                millimetres=array("I", millimetres.tobytes()),  # to pack it takes no loop
                least=int(millimetres.min()),
                most=int(millimetres.max()),
            ),
            ended,
        )

    def _begin(self) -> bool:
        """Begin the turn that the device wants, right after the last one; return if there is any.

        After a pause the mirror may be anywhere, so the turn begins at once.
        """
        turn = self.device.turn
        if turn is None:
            return False
        self._turn, self._began = turn, max(self._next, self._looked)
        arc = Arc(first=turn.first, step=turn.step, count=turn.count, beam_time=turn.beam_time)
        self._scanner.begin(arc, self._began)
        return True

    def _shut(self) -> None:
        """Disconnect hosts where cable or power are missing, or let them come again.

        A serial line does not tell whether the laser at its end has power.
        """
        closed = self._faults.unplugged or not (self._powered or self.device.speed is not None)
        if closed != self._closed:
            self._closed = closed
            self.hosts.shut(closed=closed)
