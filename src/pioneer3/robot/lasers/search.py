"""Finds the protocol of the laser at a link, then speaks it. No I/O.

Rules:

1. It listens before it asks: a laser that was left scanning tells its protocol and its speed.
   Once bytes have come that no laser sends at that speed, the quick speeds are next: a scan shows
   there at once, and a laser that scans elsewhere hears no question.
2. It asks in all languages at once. Each device ignores the questions in the others': SCIP ends a
   line at LF, an LMS-2xx looks for a right checksum, CoLa for STX and ETX.
3. No question changes a setting.
4. A robot that sends its reports is told apart, and left alone.
"""

from collections.abc import Callable, Sequence
from math import inf

from pioneer3.arcos.packet import PacketReader
from pioneer3.arcos.reports import Sip, from_payload
from pioneer3.errors import ConfigError
from pioneer3.lasers.client import (
    Event,
    LaserClient,
    LineSpeedWanted,
    Patience,
    Remarked,
    ScanSettings,
    ScansLost,
)
from pioneer3.lasers.cola.client import ColaClient
from pioneer3.lasers.lms2xx.client import LmsClient
from pioneer3.lasers.recognition import QUESTION, recognise
from pioneer3.lasers.scip.client import TEXT, ScipClient
from pioneer3.models.lasers import LaserProtocol

LISTEN = 0.1
"""At each speed before asking [s]: a laser that scans has sent something by then."""
WHOLE_SCAN = 0.1
"""Where something comes, it is listened to for so long [s], besides the time of a scan's bytes."""
LMS_SCAN = 750 * 10
"""Bits of a scan of an LMS-2xx."""
SCIP_SCAN = 2150 * 10
"""Bits of a scan of a Hokuyo; only its beginning tells the protocol."""
LONGEST_SCAN = 0.45
QUICK = 38400
"""At this speed [baud] and above a scan would have been recognised: bytes that were not are of a
laser that scans at another speed, and does not hear questions."""
WAIT = 0.1
"""For an answer [s], besides the time of its bytes: an LMS-2xx answers within 60 ms."""
ANSWER = 250 * 10
"""Bits of the question and the longest answer."""
HEARD = 4096
TAIL = 64
"""Latest bytes, of which :data:`WRONG` that are no text show that no SCIP laser sends at this
speed; the first bytes may have come at the speed before."""
WRONG = 8
SPEEDS = (115200, 38400, 9600, 19200, 57600, 500000)
"""Speeds of all lasers [baud]; those with USB answer at any."""
SPEEDS_OF_SCANS = (115200, 38400, 57600, 500000, 19200, 9600)
"""Speeds in the order in which a laser that scans is looked for [baud]."""
SPEEDS_OF = {
    LaserProtocol.SCIP: (115200, 19200, 57600, 38400),
    LaserProtocol.LMS2XX: (38400, 9600, 19200, 500000),
}
"""Speeds of each protocol's lasers with a serial line [baud], the likeliest first."""
ROBOT = "this port leads to the robot, not to a laser: give it with --port"
ECHO = "what was sent comes back: the line's two ends are joined"
NOTHING = "nothing answers as a laser does: is it switched on, and is this its port?"


class ProtocolSearch:
    """A client that becomes the one of the right protocol, and calls `found` with that.

    `speeds` are those of the line [baud], empty without a serial one; `round_trip` is how much
    later than over a cable an answer may come [s].
    """

    def __init__(
        self,
        now: float,
        speeds: Sequence[int],
        settings: ScanSettings,
        patience: Patience,
        *,
        round_trip: float = 0.0,
        found: Callable[[LaserProtocol], None] = lambda protocol: None,
    ) -> None:
        self.deadline = now
        self._speeds = tuple(s for s in SPEEDS if s in speeds) if speeds else ()
        self._settings, self._patience, self._round_trip = settings, patience, round_trip
        self._found = found
        self._until = now + patience.give_up
        self._left: list[int] = []
        self._speed: int | None = None
        self._scans_elsewhere = False
        self._asked = self._listened = True
        self._heard = bytearray()
        self._outbox = b""
        self._client: LaserClient | None = None

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Process received bytes; return the events that follow."""
        if self._client is not None:
            return self._passed(self._client.receive(data, now))
        if data and not self._asked and not self._heard and self._knows_lms:
            self._listen_for_scan(now)
        self._heard += data
        del self._heard[:-HEARD]
        protocol = recognise(bytes(self._heard))
        if protocol is not None:
            return self._speak(protocol, now)
        if self._is_robot():
            return [ScansLost(ROBOT)]
        if self._outbox == b"" and self._asked and QUESTION in self._heard:
            return [ScansLost(ECHO)]
        return []

    def tick(self, now: float) -> list[Event]:
        """Act on the passing of time."""
        if self._client is not None:
            return self._passed(self._client.tick(now))
        if now < self.deadline - 1e-9:
            return []
        if now >= self._until:
            self.deadline = inf
            return [ScansLost(NOTHING)]
        return self._try_next(now) if self._asked else self._end_listening(now)

    def _end_listening(self, now: float) -> list[Event]:
        """Listen for longer to what may be a scan; else ask, or go on to the next speed."""
        if self._heard and self._speed and not self._listened and not self._is_noise():
            self._listen_for_scan(now)
            return []
        if self._heard and (self._speed or 0) >= QUICK:
            self._scans_elsewhere = True
            return self._try_next(now)
        self._asked, self._outbox = True, QUESTION
        bits = ANSWER / self._speed if self._speed else 0.0
        self.deadline = now + WAIT + bits + self._round_trip
        return []

    def _try_next(self, now: float) -> list[Event]:
        """Go on to the next speed, or begin a new round over all of them."""
        if not self._left:
            self._left, self._scans_elsewhere = [*self._speeds], False
        if self._left:
            order = SPEEDS_OF_SCANS if self._scans_elsewhere else SPEEDS
            self._speed = next(speed for speed in order if speed in self._left)
            self._left.remove(self._speed)
        self._asked = self._listened = False
        self._heard.clear()
        self.deadline = now + LISTEN
        return [LineSpeedWanted(self._speed)] if self._speed else []

    @property
    def _knows_lms(self) -> bool:
        """Whether an LMS-2xx, whose scans are no text, may be at this speed."""
        return self._speed in SPEEDS_OF[LaserProtocol.LMS2XX]

    def _listen_for_scan(self, now: float) -> None:
        """Wait until a scan from its beginning on has come."""
        assert self._speed is not None
        self._listened = True
        scan = scan_bits(self._speed) / self._speed
        self.deadline = now + min(WHOLE_SCAN + scan, LONGEST_SCAN)

    def _is_noise(self) -> bool:
        """Whether the latest bytes are not those of a scan at this speed."""
        return not self._knows_lms and len(self._heard[-TAIL:].translate(None, TEXT)) >= WRONG

    def outgoing(self) -> bytes:
        """Return and forget the bytes to put on the wire."""
        if self._client is not None:
            return self._client.outgoing()
        data, self._outbox = self._outbox, b""
        return data

    def leave(self, now: float) -> None:
        """Queue the commands that end scanning."""
        if self._client is not None:
            self._client.leave(now)

    def _speak(self, protocol: LaserProtocol, now: float) -> list[Event]:
        """Become the client of `protocol`, beginning at the speed that was found."""
        self._found(protocol)
        self._client = client_of(
            protocol,
            now,
            self._speeds,
            self._settings,
            self._patience,
            round_trip=self._round_trip,
            first_speed=self._speed,
        )
        events = [Remarked(f"the laser speaks {protocol.value}"), *self._client.tick(now)]
        return self._passed(events)

    def _passed(self, events: list[Event]) -> list[Event]:
        assert self._client is not None
        self.deadline = self._client.deadline
        return events

    def _is_robot(self) -> bool:
        """Whether a report was heard; a SCIP laser repeats commands that were meant for a robot."""
        packets = PacketReader().feed(bytes(self._heard))
        return any(isinstance(from_payload(packet), Sip) for packet in packets)


def scan_bits(speed: int) -> int:
    """Return the bits of the longest scan that lasers send at `speed` [baud]."""
    return LMS_SCAN if speed in SPEEDS_OF[LaserProtocol.LMS2XX] else SCIP_SCAN


def client_of(
    protocol: LaserProtocol,
    now: float,
    speeds: Sequence[int],
    settings: ScanSettings,
    patience: Patience,
    *,
    round_trip: float = 0.0,
    first_speed: int | None = None,
) -> LaserClient:
    """Return a new client of `protocol`, which tries `first_speed` [baud] before all others.

    See :class:`ProtocolSearch` for the other arguments.
    """
    usual = [speed for speed in SPEEDS_OF.get(protocol, ()) if speed in speeds]
    if first_speed is not None and first_speed in speeds:
        usual = [first_speed, *(speed for speed in usual if speed != first_speed)]
    match protocol:
        case LaserProtocol.SCIP:
            return ScipClient(now, usual, settings, patience, round_trip=round_trip)
        case LaserProtocol.LMS2XX:
            return LmsClient(now, usual, settings, patience, round_trip=round_trip)
        case LaserProtocol.COLA:
            return ColaClient(now, settings, patience, round_trip=round_trip)
    raise ConfigError(f"{protocol}: no such protocol")
