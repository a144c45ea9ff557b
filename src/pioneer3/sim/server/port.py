"""Where hosts meet one simulated robot: one at a time, any number one after the other.

Rules, besides those of :mod:`pioneer3.sim.server.clients`:

1. What hosts send waits in a small buffer for the next tick; when that is full the host waits.
   Each tick a robot takes as much as a fast serial line would bring, answers included, so a flood
   costs the other robots nothing that a busy serial line would not.
2. A host that leaves the network without CLOSE has ended its session, as with MobileSim: the robot
   stops, and the next host finds it waiting. On a serial line, or with `keep_session`, the robot
   cannot know: it goes on, and :data:`STALE` simulated seconds after the last word the session is
   ended as the firmware's watchdog would, unless the next host has come before.
"""

from collections.abc import Callable
from math import inf
from typing import Protocol

from pioneer3.arcos.device import Phase
from pioneer3.links import Link
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server.clients import STALE, Client, LinkClient, Seat
from pioneer3.sim.server.faults import Line, LinkFaults

BYTES_PER_TICK = 256
"""Taken from a host and answered to it in each tick, on average: 115 200 baud are 230."""
BURST = 2 * BYTES_PER_TICK
"""The most in one tick."""
MOST_WAITING = 4096
"""What may wait for the coming ticks [bytes]; beyond that the host waits."""


class Door(Protocol):
    """Where hosts come in: a listening socket, a terminal."""

    def shut(self) -> None:
        """Let nobody in any more."""


class RobotPort:
    """The place of one robot's host, and the cable between the two.

    Args:
        firmware: The robot.
        wake: Called whenever a host has said something.
        keep_session: Whether hosts on the network leave as on a serial line.

    Attributes:
        firmware: The robot.
        address: Host and number of its TCP port, `None` without.
        doors: What is to be shut in the end.
        pending: Whether there is something for :meth:`take`.
        due: When to call :meth:`tick` next [s, simulated].
        slot: In which tick of the cycle this session's reports come.
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
        self.doors: list[Door] = []
        self.pending = False
        self.due = inf
        self.slot = 0
        self._wake = wake
        self._keep_session = keep_session
        self._last_words: bytes | None = None
        self._served: Client | None = None
        self._seat = Seat(self._welcome, lambda: self.label)
        self._rated_watchdog = firmware.watchdog
        self._spoke_at = -inf
        self._inbox, self._outbox = bytearray(), b""
        self._credit, self._turn = BURST, 0
        self._asked_at = 0
        self.faults = LinkFaults()

    @property
    def faults(self) -> LinkFaults:
        """What is wrong with the cable; may be changed, and replaced, at any time."""
        return self._faults

    @faults.setter
    def faults(self, faults: LinkFaults) -> None:
        self._faults = faults
        self._to_robot, self._to_host = Line(faults, "to robot"), Line(faults, "to host")

    @property
    def label(self) -> str:
        """What people tell it by: its model and its TCP port, where it has one."""
        model = self.firmware.body.model.name
        return f"{model} at port {self.address[1]}" if self.address else model

    @property
    def connected(self) -> bool:
        """Whether a host is here."""
        return self._seat.host is not None

    @property
    def peer(self) -> str | None:
        """The host's address, or the terminal it uses; `None` without a host."""
        return self._seat.host.peer if self._seat.host else None

    @property
    def full(self) -> bool:
        """Whether one more host would be turned away at once."""
        return self._seat.full

    @property
    def is_open(self) -> bool:
        """Whether a session is open, with or without its host."""
        return self.firmware.device.phase is Phase.OPEN

    @property
    def opens_next(self) -> bool:
        """Whether the host's next word opens a session."""
        return self.firmware.device.phase is Phase.READY

    @property
    def awaited(self) -> bool:
        """Whether a host in session has not sent a valid packet since :meth:`ask`."""
        return (
            self.connected
            and self.is_open
            and not self.firmware.body.drive.held
            and self.firmware.device.reader.packets <= self._asked_at
        )

    def ask(self) -> None:
        """From now on the host is awaited."""
        self._asked_at = self.firmware.device.reader.packets

    def stretch(self, factor: float) -> None:
        """Let the watchdog wait by `factor` longer than the robot's own."""
        if self._rated_watchdog:
            self.firmware.watchdog = self._rated_watchdog * factor
            self.due = -inf

    async def serve(self, link: Link) -> None:
        """Serve the host at the far end of `link` until it leaves or is turned away."""
        client = LinkClient(self, link)
        self.admit(client)
        await client.live()

    def admit(self, client: Client) -> None:
        """Give `client` the place, now or soon, or turn it away."""
        self._seat.admit(client)

    def hear(self, client: Client, data: bytes) -> None:
        """Keep what `client` says for the next tick."""
        if not self._seat.speaks(client):
            return
        self._inbox += data
        self.pending = True
        if len(self._inbox) >= MOST_WAITING:
            client.pause()
            self._seat.flooded(flooded=True)
        self._wake()

    def leave(self, client: Client) -> None:
        """Take note that `client` has gone."""
        if client is self._seat.host and not client.standing:
            self._end_session()
        if self._seat.leave(client):
            self.due = -inf

    def check_cable(self) -> None:
        """Do what follows when the cable has been pulled out, or put in again."""
        if self._faults.unplugged != self._seat.closed:
            self._seat.closed = self._faults.unplugged
            if self._seat.closed:
                self._part()

    def take(self, now: float, turn: int, *, listen: bool = True) -> None:
        """Give the robot what its host has said.

        Args:
            now: [s, simulated].
            turn: Counts the ticks; each brings :data:`BYTES_PER_TICK`.
            listen: Whether the host is listened to, or only what is on its way arrives.
        """
        if self._last_words is not None:
            self._tell(self._last_words, now)
            self._last_words = None
            if self.firmware.device.phase is not Phase.WAITING:
                self.firmware.hang_up(now)
        self._credit = min(BURST, self._credit + BYTES_PER_TICK * (turn - self._turn))
        self._turn = turn
        data = self._from_inbox(max(0, self._credit)) if listen else b""
        self._credit -= len(data)
        if self._faults.any or self._to_robot.due < inf:
            data = self._to_robot.carry(data, now)
        self.pending = bool(self._inbox) or self._to_robot.due < inf
        if data:
            self._tell(data, now)

    def tick(self, now: float) -> None:
        """Let the robot look at the clock, and send what it has to say at `now` [s, simulated]."""
        self.firmware.tick(now)
        if self._is_left_over() and now - self._spoke_at > STALE:
            self.firmware.hang_up(now)
        self.flush(now)

    def flush(self, now: float) -> None:
        """Send what the robot has said."""
        data, self._outbox = self._outbox + self.firmware.device.outgoing(), b""
        if self._faults.any or self._to_host.due < inf:
            data = self._to_host.carry(data, now)
        host = self._seat.host
        if data and host is not None:
            host.send(data)
        if host is not None and host.standing and self.firmware.device.phase is Phase.WAITING:
            host.close()  # it has said CLOSE: the place is free
            self._seat.leave(host)
        self.due = min(self.firmware.due, self._to_host.due)
        if self._is_left_over():
            self.due = min(self.due, self._spoke_at + STALE)

    def break_down(self) -> None:
        """Cut the host off and forget the session: this robot has failed."""
        self._outbox = b""
        self._part()
        self.firmware.device.hang_up()
        self.firmware.body.session_ended()
        self.due = inf  # until a host speaks to it again

    def close(self) -> None:
        """Part from the host, and let nobody in any more."""
        for door in self.doors:
            door.shut()
        self.doors.clear()
        self.address = None
        self._part()

    def _from_inbox(self, most: int) -> bytes:
        data = bytes(self._inbox[:most])
        del self._inbox[:most]
        if self._seat.host is not None and len(self._inbox) < MOST_WAITING:
            self._seat.host.resume()
        if not self._inbox:
            self._seat.flooded(flooded=False)
        return data

    def _tell(self, data: bytes, now: float) -> None:
        was_open = self.is_open
        self.firmware.receive(data, now)
        self._spoke_at = now
        if self.is_open and not was_open:
            self.ask()
        self._outbox = self.firmware.device.outgoing()
        self._credit -= len(self._outbox)

    def _end_session(self) -> None:
        """Let the robot hear the last words of its host, and then that it is gone."""
        if not self._keep_session:
            self._last_words = ((self._last_words or b"") + self._inbox)[:BURST]
            self._forget()
            self.pending = True
            self._wake()

    def _welcome(self) -> None:
        """Make ready for another host."""
        last, self._served = self._served, self._seat.host
        if last is not None and not last.standing and self.is_open:
            self._end_session()  # it was silent, and gave way
        self.firmware.device.reader.discard()
        self._to_host.lose()  # that was for the last one
        if len(self._inbox) > BURST:  # it has flooded us; less may be its farewell
            self._forget()

    def _part(self) -> None:
        self._forget()
        self._seat.clear()
        self.due = -inf

    def _forget(self) -> None:
        """Lose what hosts have said and the robot has not heard."""
        self._inbox.clear()
        self._to_robot.lose()
        self.pending = False

    def _is_left_over(self) -> bool:
        return not self.connected and self.is_open
