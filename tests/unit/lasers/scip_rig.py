"""A SCIP client and a simulated laser at the two ends of a cable, in virtual time."""

from collections.abc import Callable, Sequence
from heapq import heappop, heappush
from itertools import count
from math import inf, sin
from random import Random

from pioneer3.lasers.client import (
    Event,
    Identified,
    LineSpeedWanted,
    Measured,
    Patience,
    RawScan,
    Remarked,
    ScanSettings,
    ScansLost,
)
from pioneer3.lasers.device import MirrorTurn, Sweep
from pioneer3.lasers.scip.client import ScipClient
from pioneer3.lasers.scip.device import ScipDevice
from pioneer3.models.lasers import LASERS

URG, UTM, UST = LASERS["urg-04lx"], LASERS["utm-30lx"], LASERS["ust-10lx"]
URG_SPEEDS = (19200, 115200, 57600, 38400, 750000)
SLACK = 1e-9


def room(turn: MirrorTurn, began: float) -> Sweep:
    """Return readings of uneven walls some 2 m away, each fifth of them through a window.

    The first one tells when it was taken.
    """
    ranges = [2.0 + 0.3 * sin(number / 40) for number in range(turn.count)]
    ranges[0] = 1.0 + began % 1.0
    return Sweep(
        turn=turn,
        began=began,
        ranges=ranges,
        intensities=[0.5 + 0.1 * (metres - 2.0) for metres in ranges],
        echoes=[(r, r + 1.0) if n % 5 == 0 else (r,) for n, r in enumerate(ranges)],
    )


class Rig:
    """Cable, mirror and time between one client at a time and one laser.

    Args:
        device: The laser.
        delay: Returns how long the bytes now sent are under way [s].
        drift: Share by which the laser's clock is faster than ours.
        sweep: Makes the readings of a turn.
    """

    def __init__(
        self,
        device: ScipDevice,
        *,
        delay: Callable[[], float] = lambda: 0.0005,
        drift: float = 0.0,
        sweep: Callable[[MirrorTurn, float], Sweep] = room,
    ) -> None:
        self.device = device
        self.host = device.connect()
        self.client: ScipClient | None = None
        self.now = 100.0
        self.baud: int | None = None
        self.events: list[tuple[float, Event]] = []
        self.sent: list[bytes] = []
        self.turns: list[float] = []
        self.unheard: list[bytes] = []
        self.deaf = False
        self.stuck = False
        self.spoil: Callable[[bytes], bytes] = lambda data: data
        self._delay, self._drift, self._sweep = delay, drift, sweep
        self._noise = Random(1)
        self._order = count()
        self._wire: list[tuple[float, int, bool, bytes, int | None]] = []
        self._last_arrival = [0.0, 0.0]
        self._turn: MirrorTurn | None = None
        self._began = -inf

    def connect(
        self,
        speeds: Sequence[int] = (),
        settings: ScanSettings | None = None,
        patience: Patience | None = None,
    ) -> ScipClient:
        """Put a new client at the host's end."""
        self.client = ScipClient(self.now, speeds, settings, patience)
        return self.client

    def laser_time(self, now: float) -> float:
        """Return the time of the laser's crystal."""
        return now * (1 + self._drift)

    def our_time(self, laser_time: float) -> float:
        """Return our time at that."""
        return laser_time / (1 + self._drift)

    def enter(self, text: bytes) -> None:
        """Give the laser bytes of another program, at its own speed."""
        self.host.receive(text, self.laser_time(self.now))

    def run(self, seconds: float, until: type[Event] | None = None) -> float:
        """Let time pass; return how long it took until such an event, or all of it."""
        begin, end = self.now, self.now + seconds
        seen = len(self.events)
        if self.client is not None:
            self._take([])
        while self.now < end:
            if until and any(isinstance(event, until) for _, event in self.events[seen:]):
                return self.now - begin
            self._step(end)
        return self.now - begin

    @property
    def scans(self) -> list[RawScan]:
        """All scans so far."""
        return [event.scan for _, event in self.events if isinstance(event, Measured)]

    @property
    def identities(self) -> list[Identified]:
        """All identities so far."""
        return [event for _, event in self.events if isinstance(event, Identified)]

    @property
    def remarks(self) -> list[str]:
        """All remarks so far."""
        return [event.text for _, event in self.events if isinstance(event, Remarked)]

    @property
    def losses(self) -> list[str]:
        """Reasons of all losses so far."""
        return [event.reason for _, event in self.events if isinstance(event, ScansLost)]

    def stamp_errors(self, since: int = 0) -> list[float]:
        """Return by how much each scan is dated too late [s]: its first reading tells its turn."""
        errors = []
        for scan in self.scans[since:]:
            tag = scan.ranges[0] - 1.0
            same = [turn for turn in self.turns if abs(self.laser_time(turn) % 1.0 - tag) < 0.001]
            errors.append(min((scan.stamp - turn for turn in same), key=abs))
        return errors

    def _step(self, end: float) -> None:
        """Go to the next moment at which something happens."""
        self._begin_turn()
        due = [end, self.our_time(self.device.deadline)]
        if self._turn is not None:
            due.append(self.our_time(self._turn_ends))
        if self._wire:
            due.append(self._wire[0][0])
        if self.client is not None:
            due.append(self.client.deadline)
        self.now = max(self.now, min(due))
        laser_now = self.laser_time(self.now)
        self._deliver(laser_now)
        if self._turn is not None and laser_now >= self._turn_ends - SLACK:
            turn, self._turn = self._turn, None
            self.turns.append(self.our_time(self._began))
            self.device.measured(self._sweep(turn, self._began), laser_now)
        speed = self.device.speed
        if data := self.host.outgoing(laser_now + SLACK):
            self._put(data, 1, speed)
        if self.client is not None:
            self._take(self.client.tick(self.now))

    @property
    def _turn_ends(self) -> float:
        assert self._turn is not None
        return self._began + (self._turn.count - 1) * self._turn.beam_time

    def _begin_turn(self) -> None:
        if self._turn is None and self.device.turn is not None and not self.stuck:
            laser_now = self.laser_time(self.now)
            turn = self.device.turn
            following = self._began + turn.period
            self._turn, self._began = turn, max(following, laser_now)

    def _put(self, data: bytes, direction: int, baud: int | None) -> None:
        lasts = len(data) * 10 / baud if baud and direction == 0 else 0.0
        arrival = max(self.now + lasts + self._delay(), self._last_arrival[direction])
        self._last_arrival[direction] = arrival
        heappush(self._wire, (arrival, next(self._order), direction == 0, data, baud))

    def _deliver(self, laser_now: float) -> None:
        while self._wire and self._wire[0][0] <= self.now + SLACK:
            _, _, to_laser, data, baud = heappop(self._wire)
            if to_laser:
                if not self.deaf:
                    self.host.receive(self._heard(data, baud, self.device.speed), laser_now)
            elif self.client is None:
                self.unheard.append(data)
            else:
                self._take(
                    self.client.receive(self.spoil(self._heard(data, baud, self.baud)), self.now)
                )

    def _heard(self, data: bytes, sent_at: int | None, read_at: int | None) -> bytes:
        if sent_at is None or read_at is None or sent_at == read_at:
            return data
        return self._noise.randbytes(max(1, len(data) * read_at // sent_at))

    def _take(self, events: list[Event]) -> None:
        assert self.client is not None
        for event in events:
            self.events.append((self.now, event))
            if isinstance(event, LineSpeedWanted):
                self.baud = event.baud
        if data := self.client.outgoing():
            self.sent.append(data)
            self._put(data, 0, self.baud)
