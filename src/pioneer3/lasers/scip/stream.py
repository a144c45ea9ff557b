"""The scans that a laser is asked for: the command, and the meaning of its numbers (scip.md 2, 3).

The directions count from the middle of each cluster, whose shortest reading is what is sent.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from pioneer3.geometry import TURN
from pioneer3.lasers.client import ScanSettings
from pioneer3.lasers.scip.scans import FORMATS, Format
from pioneer3.lasers.scip.wire import LINE, STAMP
from pioneer3.models.lasers import Steps

MAX_CLUSTER: Final = 99
MAX_SKIP: Final = 9
SHORT_VALUE: Final = 4095
"""The most that two characters carry [mm]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanStream:
    """Scans of one kind, from the step `start` to the step `end`.

    So many neighbouring steps become one reading, `cluster`; so many scans are left out after each
    one, `skip`.
    """

    letters: str
    steps: Steps
    start: int
    end: int
    cluster: int
    skip: int

    @property
    def command(self) -> bytes:
        """The command, without LF: scans without end, or in SCIP 1.1 one scan."""
        if self.letters == "G":
            return f"G{self.start:03}{self.end:03}{self.cluster:02}".encode()
        return f"{self.letters}{self.start:04}{self.end:04}{self.cluster:02}{self.skip}00".encode()

    @property
    def format(self) -> Format:
        """The layout of the data."""
        return FORMATS[self.letters]

    @property
    def summed(self) -> bool:
        """Whether the lines have checksums."""
        return self.letters != "G"

    @property
    def count(self) -> int:
        """Readings of a scan."""
        return (self.end - self.start) // self.cluster + 1

    @property
    def first(self) -> float:
        """Direction of the first reading [rad]."""
        return self.steps.angle(self.start) + (self.cluster - 1) / 2 * TURN / self.steps.per_turn

    @property
    def step(self) -> float:
        """From one reading to the next [rad]."""
        return self.cluster * TURN / self.steps.per_turn

    @property
    def step_time(self) -> float:
        """From one step to the next [s]."""
        return 60 / (self.steps.rpm * self.steps.per_turn)

    @property
    def turn(self) -> float:
        """Time of one turn of the mirror [s]."""
        return 60 / self.steps.rpm

    @property
    def period(self) -> float:
        """From one scan to the next, where the line is fast enough [s]."""
        return self.turn * (self.skip + 1)

    @property
    def size(self) -> int:
        """Bytes of a scan, with one echo for each step."""
        data = self.count * self.format.echo
        return len(self.command) + 1 + 4 + STAMP + 2 + data + 2 * -(-data // LINE) + 1


def streams(
    steps: Steps, settings: ScanSettings, baud: int | None, *, scip1: bool = False
) -> Iterator[ScanStream]:
    """Yield the streams that fulfil `settings`, the best first; lasers do not know all of them."""
    start = _step_at(steps, settings.first, steps.first)
    end = max(_step_at(steps, settings.last, steps.last), start)
    cluster = settings.cluster
    if settings.step is not None:
        cluster = max(cluster, round(settings.step * steps.per_turn / TURN))
    cluster = min(max(cluster, 1), MAX_CLUSTER)
    skip = min(max(settings.skip, 0), MAX_SKIP)

    def stream(letters: str) -> ScanStream:
        return ScanStream(
            letters=letters, steps=steps, start=start, end=end, cluster=cluster, skip=skip
        )

    if scip1:
        yield stream("G")
        return
    if settings.multi_echo and settings.intensities:
        yield stream("NE")
    if settings.multi_echo:
        yield stream("ND")
    if settings.intensities:
        yield stream("ME")
    if not fits(stream("MD"), baud) and steps.longest <= SHORT_VALUE:
        yield stream("MS")
    yield stream("MD")


def fits(stream: ScanStream, baud: int | None) -> bool:
    """Tell whether a serial line at `baud` carries each scan before the next one is measured."""
    return baud is None or stream.size * 10 / baud <= stream.period


def _step_at(steps: Steps, angle: float | None, otherwise: int) -> int:
    if angle is None:
        return otherwise
    step = round(steps.front + angle * steps.per_turn / TURN)
    return min(max(step, steps.first), steps.last)
