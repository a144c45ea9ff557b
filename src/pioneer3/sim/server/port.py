"""The port of one simulated robot: hosts connect to it, one at a time.

Rules, besides those of :mod:`pioneer3.sim.server.clients`:

1. Bytes of hosts wait in a small buffer for the next tick; when it is full the host waits. Each
   tick a robot takes as much as a fast serial line would bring, answers included, so a flood costs
   the other robots no more than a busy serial line would.
2. A host that leaves the network without CLOSE has ended its session, as with MobileSim: the robot
   stops, and the next host finds it waiting. On a serial line, or with `keep_session`, the robot
   cannot know: it goes on, and :data:`STALE` simulated seconds after the last byte the session
   ends, unless the next host has connected before.
"""

from collections.abc import Callable
from math import inf

from pioneer3.arcos.device import SessionPhase
from pioneer3.links import Link
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server.clients import STALE, ClientSlot, HostConnection, LinkClient
from pioneer3.sim.server.faults import CableDirection, LinkFaults
from pioneer3.sim.server.listeners import PtyListener, TcpListener

BYTES_PER_TICK = 256
"""Taken from a host and answered to it in each tick, on average: 115 200 baud are 230."""
BURST = 2 * BYTES_PER_TICK
"""The most in one tick."""
MOST_WAITING = 4096
"""Most that waits for the coming ticks [bytes]; then the host waits."""


class RobotPort:
    """Connects one robot to its host, over a cable that may have faults.

    `wake` is called whenever a host has sent bytes. With `keep_session` hosts on the network leave
    as on a serial line.

    Its `address` is host and number of its TCP port. If something is `pending`, :meth:`take` comes
    next, :meth:`tick` when it is `due` [s, simulated]. This session's reports are sent in the
    `report_tick` of the cycle.
    """

    def __init__(
        self,
        firmware: Firmware,
        wake: Callable[[], None] = lambda: None,
        *,
        keep_session: bool = False,
    ) -> None:
        self.firmware = firmware
        self.address: tuple[str, int] | None = None
        self.listeners: list[TcpListener | PtyListener] = []
        self.pending = False
        self.due = inf
        self.report_tick = 0
        self._wake = wake
        self._keep_session = keep_session
        self._final_bytes: bytes | None = None
        self._served: HostConnection | None = None
        self._slot = ClientSlot(self._reset_for_host, lambda: self.label)
        self._rated_watchdog = firmware.device.watchdog
        self._heard_at = -inf
        self._inbox, self._outbox = bytearray(), b""
        self._budget, self._turn = BURST, 0
        self._packets_before = 0
        self.faults = LinkFaults()

    @property
    def faults(self) -> LinkFaults:
        """Faults of the cable; may be changed, and replaced, at any time."""
        return self._faults

    @faults.setter
    def faults(self, faults: LinkFaults) -> None:
        self._faults = faults
        self._to_robot = CableDirection(faults, "to robot")
        self._to_host = CableDirection(faults, "to host")

    @property
    def label(self) -> str:
        """A name for people: its model and its TCP port, if it has one."""
        model = self.firmware.body.model.name
        return f"{model} at port {self.address[1]}" if self.address else model

    @property
    def connected(self) -> bool:
        """Whether a host is connected."""
        return self._slot.host is not None

    @property
    def peer(self) -> str | None:
        """The host's address, or the terminal it uses; `None` without a host."""
        return self._slot.host.peer if self._slot.host else None

    @property
    def full(self) -> bool:
        return self._slot.full

    @property
    def is_open(self) -> bool:
        """Whether a session is open, with or without its host."""
        return self.firmware.device.phase is SessionPhase.OPEN

    @property
    def opens_next(self) -> bool:
        """Whether the host's next packet opens a session."""
        return self.firmware.device.phase is SessionPhase.READY

    @property
    def awaited(self) -> bool:
        """Whether a host in session has not sent a valid packet since :meth:`expect_packet`."""
        return (
            self.connected
            and self.is_open
            and not self.firmware.body.drive.held
            and self.firmware.device.reader.packets <= self._packets_before
        )

    def expect_packet(self) -> None:
        """Await a packet of the host from now on."""
        self._packets_before = self.firmware.device.reader.packets

    def scale_watchdog(self, factor: float) -> None:
        """Let the watchdog wait `factor` times as long as the robot's own."""
        if self._rated_watchdog:
            self.firmware.device.watchdog = self._rated_watchdog * factor
            self.due = -inf

    async def serve(self, link: Link) -> None:
        """Serve the host at the far end of `link` until it leaves or is turned away."""
        client = LinkClient(self, link)
        self.admit(client)
        await client.live()

    def admit(self, client: HostConnection) -> None:
        self._slot.admit(client)

    def received(self, client: HostConnection, data: bytes) -> None:
        """Keep the bytes of `client` for the next tick."""
        if not self._slot.heard_from(client):
            return
        self._inbox += data
        self.pending = True
        if len(self._inbox) >= MOST_WAITING:
            client.pause()
            self._slot.set_flooded(flooded=True)
        self._wake()

    def disconnected(self, client: HostConnection) -> None:
        if client is self._slot.host and not client.permanent:
            self._end_session()
        if self._slot.disconnected(client):
            self.due = -inf

    def check_cable(self) -> None:
        """Disconnect every host while the cable is pulled out."""
        if self._faults.unplugged != self._slot.closed:
            self._slot.closed = self._faults.unplugged
            if self._slot.closed:
                self._disconnect()

    def take(self, now: float, turn: int, *, listen: bool = True) -> None:
        """Give the robot the bytes of its host, `now` [s, simulated]; `turn` counts the ticks.

        Each brings :data:`BYTES_PER_TICK`. If it does not `listen`, it takes no new bytes, but
        those that are on their way.
        """
        if self._final_bytes is not None:
            self._deliver(self._final_bytes, now)
            self._final_bytes = None
            if self.firmware.device.phase is not SessionPhase.WAITING:
                self.firmware.hang_up(now)
        self._budget = min(BURST, self._budget + BYTES_PER_TICK * (turn - self._turn))
        self._turn = turn
        data = self._from_inbox(max(0, self._budget)) if listen else b""
        self._budget -= len(data)
        if self._faults.any or self._to_robot.due < inf:
            data = self._to_robot.transmit(data, now)
        self.pending = bool(self._inbox) or self._to_robot.due < inf
        if data:
            self._deliver(data, now)

    def tick(self, now: float) -> None:
        """Let time pass for the robot until `now` [s, simulated], and send its reports."""
        self.firmware.tick(now)
        if self._has_orphan_session() and now - self._heard_at > STALE:
            self.firmware.hang_up(now)
        self.flush(now)

    def flush(self, now: float) -> None:
        """Send the robot's bytes."""
        data, self._outbox = self._outbox + self.firmware.device.outgoing(), b""
        if self._faults.any or self._to_host.due < inf:
            data = self._to_host.transmit(data, now)
        host = self._slot.host
        if data and host is not None:
            host.send(data)
        if (
            host is not None
            and host.permanent
            and self.firmware.device.phase is SessionPhase.WAITING
        ):
            host.close()  # it has sent CLOSE: the slot is free
            self._slot.disconnected(host)
        self.due = min(self.firmware.due, self._to_host.due)
        if self._has_orphan_session():
            self.due = min(self.due, self._heard_at + STALE)

    def fail(self) -> None:
        """Disconnect the host and end the session of a robot that has failed."""
        self._outbox = b""
        self._disconnect()
        self.firmware.device.hang_up()
        self.firmware.body.session_ended()
        self.due = inf  # until a host sends bytes again

    def close(self) -> None:
        """Disconnect the host and stop listening."""
        for listener in self.listeners:
            listener.close()
        self.listeners.clear()
        self.address = None
        self._disconnect()

    def _from_inbox(self, most: int) -> bytes:
        data = bytes(self._inbox[:most])
        del self._inbox[:most]
        if self._slot.host is not None and len(self._inbox) < MOST_WAITING:
            self._slot.host.resume()
        if not self._inbox:
            self._slot.set_flooded(flooded=False)
        return data

    def _deliver(self, data: bytes, now: float) -> None:
        was_open = self.is_open
        self.firmware.receive(data, now)
        self._heard_at = now
        if self.is_open and not was_open:
            self.expect_packet()
        self._outbox = self.firmware.device.outgoing()
        self._budget -= len(self._outbox)

    def _end_session(self) -> None:
        """Give the robot the last bytes of its host, and then end the session."""
        if not self._keep_session:
            self._final_bytes = ((self._final_bytes or b"") + self._inbox)[:BURST]
            self._discard()
            self.pending = True
            self._wake()

    def _reset_for_host(self) -> None:
        """Prepare for another host."""
        last, self._served = self._served, self._slot.host
        if last is not None and not last.permanent and self.is_open:
            self._end_session()  # it was silent and lost the slot
        self.firmware.device.reader.discard()
        self._to_host.clear()  # bytes for the last one
        if len(self._inbox) > BURST:  # a flood; fewer bytes may be the last packets of a session
            self._discard()

    def _disconnect(self) -> None:
        self._discard()
        self._slot.disconnect_all()
        self.due = -inf

    def _discard(self) -> None:
        """Drop the bytes that the robot has not taken."""
        self._inbox.clear()
        self._to_robot.clear()
        self.pending = False

    def _has_orphan_session(self) -> bool:
        return not self.connected and self.is_open
