"""A simulated LMS-2xx at a serial line to test with, in virtual time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from random import Random

from pioneer3.lasers.client import Event, LineSpeedWanted, Measured, RawScan, Remarked
from pioneer3.lasers.device import MirrorTurn, Sweep
from pioneer3.lasers.lms2xx import LmsClient, LmsDevice
from pioneer3.lasers.lms2xx.blocks import UnitConfig
from pioneer3.lasers.lms2xx.measuring import Units
from pioneer3.lasers.lms2xx.telegram import UNITS, LmsTelegramReader, Sign, Telegram
from pioneer3.models.lasers import LASERS

LMS200 = LASERS["lms-200"]
SPEEDS = (9600, 38400, 19200, 500000)
STEP = 0.001
"""Pace of the virtual time [s]; the host reads at most this often."""
WRITTEN = UnitConfig(measuring_mode=5, units=Units.MILLIMETRES)
"""As the client wants it."""
Scene = Callable[[MirrorTurn, int], float]


def circle(_turn: MirrorTurn, _index: int) -> float:
    """Return the ranges [m] in the middle of a round room."""
    return 2.0


@dataclass
class Cable:
    """A line between a unit and a host.

    Who is at another speed than the unit hears rubbish and is not heard.

    Attributes:
        device: The unit.
        speed: Of the host [baud]; `None`: always that of the unit.
        scene: Range [m] of each reading of a turn.
        intensity: Of all readings.
        now: The time [s].
        turns: Number of turns measured.
    """

    device: LmsDevice
    speed: int | None = 9600
    scene: Scene = circle
    intensity: float = 0.0
    now: float = 100.0
    turns: int = 0
    _random: Random = field(default_factory=lambda: Random(1))
    _turn: MirrorTurn | None = None
    _began: float = 0.0

    def __post_init__(self) -> None:
        self.port = self.device.connect()

    def send(self, data: bytes) -> None:
        """Let the host send `data`."""
        if data and self.speed in {None, self.device.speed}:
            self.port.receive(data, self.now)

    def step(self, seconds: float = STEP) -> bytes:
        """Let time pass; return the bytes that the host hears."""
        self.now += seconds
        self._turn_mirror()
        if self.now >= self.device.deadline:
            self.device.tick(self.now)
        speed, data = self.device.speed, self.port.outgoing(self.now)
        return data if self.speed in {None, speed} else self._random.randbytes(len(data))

    def listen(self, seconds: float) -> bytes:
        """Let time pass; return all bytes that the host hears."""
        end, heard = self.now + seconds, bytearray()
        while self.now < end:
            heard += self.step()
        return bytes(heard)

    def ask(self, data: bytes, seconds: float = 0.4) -> bytes:
        """Send `data`; return all bytes that the host hears in answer."""
        self.send(data)
        return self.listen(seconds)

    def _turn_mirror(self) -> None:
        if self._turn is None:
            self._turn, self._began = self.device.turn, self.now
        while self._turn is not None and self.now >= self._began + self._turn.period:
            turn, began = self._turn, self._began
            ranges = [self.scene(turn, index) for index in range(turn.count)]
            light = [self.intensity] * turn.count
            sweep = Sweep(turn=turn, began=began, ranges=ranges, intensities=light)
            self.turns += 1
            self.device.measured(sweep, began + turn.period)
            self._turn, self._began = self.device.turn, began + turn.period


def telegrams(data: bytes) -> list[Telegram]:
    """Return the unit's telegrams in `data`."""
    items = LmsTelegramReader(UNITS).feed(data, 0.0)
    return [item for item in items if isinstance(item, Telegram)]


def signs(data: bytes) -> list[Sign]:
    """Return the single bytes in `data`."""
    return [item for item in LmsTelegramReader(UNITS).feed(data, 0.0) if isinstance(item, Sign)]


def run(
    cable: Cable, client: LmsClient, until: type[Event], limit: float, *, step: float = STEP
) -> list[Event]:
    """Let client and unit talk until an event of a kind comes; return all events.

    Raises:
        AssertionError: the time limit [s] has passed.
    """
    events: list[Event] = []
    end = cable.now + limit
    while cable.now < end:
        heard = cable.step(step)
        new = client.receive(heard, cable.now) if heard else []
        if cable.now >= client.deadline:
            new += client.tick(cable.now)
        for event in new:
            if isinstance(event, LineSpeedWanted):
                cable.speed = event.baud
        cable.send(client.outgoing())
        events += new
        if any(isinstance(event, until) for event in new):
            return events
    raise AssertionError(f"no {until.__name__} in {limit} s: {events}")


def ready(start_speed: int = 38400, **options: object) -> Cable:
    """Return a unit that is set up in all but the variant."""
    device = LmsDevice(LMS200, start_speed=start_speed, **options)  # type: ignore[arg-type]
    device.unit.config = WRITTEN
    return Cable(device, start_speed)


def scans(events: Sequence[Event]) -> list[RawScan]:
    """Return the scans among `events`."""
    return [event.scan for event in events if isinstance(event, Measured)]


def remarks(events: Sequence[Event]) -> str:
    """Return the texts for the log."""
    return "\n".join(event.text for event in events if isinstance(event, Remarked))


def speeds(events: Sequence[Event]) -> list[int]:
    """Return the speeds that have been wanted [baud]."""
    return [event.baud for event in events if isinstance(event, LineSpeedWanted)]


def first_scan(cable: Cable, client: LmsClient, limit: float = 3.0) -> RawScan:
    """Return the next scan, which comes within `limit` [s]."""
    return scans(run(cable, client, Measured, limit))[0]
