"""The bridge's session with the robot. No I/O: bytes and the time in, bytes out.

::

    AWAY ──begin──► SHAKING ──identity──► SERVING ──end──► ENDING ──it stands──► CLOSED
      ▲                └───────────────── no robot answers ────────────────────────┘ │
      └──────────────────────────────────── away ────────────────────────────────────┘

The handshake is that of a driver: it finds the speed, and closes a session that the robot serves.
Then STOP and ENABLE 0 have been sent. A session ends with STOP, and when the robot stands with
ENABLE 0, SONAR 0 and CLOSE.
"""

from collections.abc import Sequence
from enum import Enum, auto
from math import inf
from typing import Final

from pioneer3.arcos import reports
from pioneer3.arcos.host import Host
from pioneer3.arcos.host_events import Event, Lost, Opened, SpeedWanted, Timing
from pioneer3.arcos.packet import HEADER, PacketReader, encode
from pioneer3.arcos.reports import Sip
from pioneer3.arcos.reports.sip import SIP_NUMBERS
from pioneer3.bridge.braking import BRAKING, Braking
from pioneer3.bridge.guard import moves

ID_PLACE: Final = len(HEADER) + 1
"""Place of the id in a frame."""


class RobotSideState(Enum):
    """State of the session."""

    AWAY = auto()
    SHAKING = auto()
    SERVING = auto()
    ENDING = auto()
    CLOSED = auto()
    """The last bytes may be sent; then the link is to be closed."""


class RobotSide:
    """The sessions with one robot, one after the other.

    `identity` is the payload of the robot's answer to SYNC2 and `config` of its last CONFIG, empty
    before; `failure` is the reason that the handshake failed, empty if it did not.
    """

    def __init__(self, timing: Timing | None = None) -> None:
        self.state = RobotSideState.AWAY
        self.identity = self.config = b""
        self.failure = ""
        self._timing = timing or Timing()
        self._reader = PacketReader()
        self._host: Host | None = None
        self._braking = Braking()
        self._speeds: list[int] = []
        self._outbox: list[bytes] = []
        self._ending_until = inf

    @property
    def deadline(self) -> float:
        """When :meth:`tick` must next be called [s, monotonic]; `inf` for never."""
        if self.state is RobotSideState.SHAKING and self._host is not None:
            return self._host.deadline
        if self.state in {RobotSideState.SERVING, RobotSideState.ENDING}:
            return min(self._braking.deadline, self._ending_until)
        return inf

    @property
    def powerless(self) -> bool:
        """Whether the last report said that the motors have no power."""
        return self._braking.powerless

    @property
    def unfinished(self) -> bytes:
        """The bytes of a packet of the robot that has begun, and is not whole yet."""
        return self._reader.unfinished

    @property
    def speed(self) -> int | None:
        """The line speed at which the robot has told its identity [baud]; `None` without one."""
        return self._host.speed if self._host is not None and self.identity else None

    @property
    def unsent(self) -> int:
        """Number of bytes that wait for the link."""
        return sum(map(len, self._outbox))

    def begin(self, now: float, speeds: Sequence[int] = (), round_trip: float = 0.0) -> None:
        """Begin a session at a link that is open now."""
        self.state = RobotSideState.SHAKING
        self.identity = self.config = b""
        self.failure = ""
        self._reader, self._braking = PacketReader(), Braking()
        self._host = Host(now, speeds, self._timing, round_trip=round_trip)
        self.tick(now)

    def receive(self, data: bytes, now: float) -> None:
        """Process bytes that the robot has sent."""
        if self.state is RobotSideState.SHAKING and self._host is not None:
            self._obey(self._host.receive(data, now))
        for payload in self._reader.feed(data, now):
            self._note(payload, now)
        if self.state is RobotSideState.ENDING:
            self.tick(now)

    def tick(self, now: float) -> None:
        """Act on the passing of time; harmless to call too often."""
        if self.state is RobotSideState.SHAKING and self._host is not None:
            self._obey(self._host.tick(now))
        elif self.state is RobotSideState.SERVING:
            self.send(self._braking.tick(now))
        elif self.state is RobotSideState.ENDING:
            if self._braking.active and now < self._ending_until:
                self.send(self._braking.tick(now))
            else:
                self.finish(now)

    def send(self, payloads: Sequence[bytes]) -> None:
        """Queue packets."""
        self._outbox += [encode(payload) for payload in payloads]

    def brake(self, now: float, *, take_power: bool = False, hard: bool = False) -> None:
        """Stop the robot before all that waits; motion that waits is dropped."""
        others = [frame for frame in self._outbox if not moves(frame[ID_PLACE:])]
        self._outbox.clear()
        self.send(self._braking.begin(now, take_power=take_power, hard=hard))
        self._outbox += others

    def release(self) -> None:
        """Repeat no stop any more: a fresh command moves the robot."""
        self._braking.cancel()

    def end(self, now: float, *, moving: bool) -> None:
        """Stop the robot if it may be `moving`, wait for it to stand, then close the session."""
        if self.state is RobotSideState.SERVING and (moving or not self._braking.at_rest):
            self.brake(now)
            self.state, self._ending_until = RobotSideState.ENDING, now + BRAKING
        elif self.state in {RobotSideState.SERVING, RobotSideState.SHAKING}:
            self.finish(now)

    def finish(self, now: float) -> None:
        """Close the session: STOP, ENABLE 0, SONAR 0, CLOSE; once is enough."""
        if self.state in {RobotSideState.AWAY, RobotSideState.CLOSED}:
            return
        if self._host is not None:
            self._host.leave(now)
            self._outbox.append(self._host.outgoing())
        self.state = RobotSideState.CLOSED

    def lose(self) -> None:
        """Note that the link does not open, or has failed."""
        self.state, self._host = RobotSideState.CLOSED, None
        self.failure = ""
        self._outbox.clear()

    def away(self) -> None:
        """Note that the link has been closed."""
        self.state, self._host = RobotSideState.AWAY, None
        self.identity = b""
        self._outbox.clear()
        self._ending_until = inf

    def outgoing(self) -> bytes:
        """Return and forget the bytes to send."""
        data = b"".join(self._outbox)
        self._outbox.clear()
        return data

    def speed_wanted(self) -> int | None:
        """Return and forget the speed to which the link is to be set before the next bytes."""
        return self._speeds.pop(0) if self._speeds else None

    def _note(self, payload: bytes, now: float) -> None:
        if payload[0] == reports.SyncIdentity.ID:
            self.identity = payload
        elif payload[0] == reports.Config.ID:
            self.config = payload
        elif payload[0] in SIP_NUMBERS and isinstance(sip := reports.from_payload(payload), Sip):
            self._braking.observe(sip, now)

    def _obey(self, events: Sequence[Event]) -> None:
        """Act on events of the handshake."""
        assert self._host is not None
        for event in events:
            match event:
                case SpeedWanted(baud):
                    self._speeds.append(baud)
                    self._reader.discard()
                case Opened():
                    self.state = RobotSideState.SERVING
                case Lost(reason):
                    self.failure = reason
                    return
        if data := self._host.outgoing():
            self._outbox.append(data)
