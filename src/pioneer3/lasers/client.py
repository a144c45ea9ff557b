"""The host's side of a laser, as every protocol has it. No I/O.

A :class:`LaserClient` finds the laser in whatever state it is, makes it scan, and returns scans.
When it says :class:`ScansLost`, the caller closes the link, and begins anew with a new client.
"""

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True, kw_only=True)
class LaserIdentity:
    """The identity that a laser sends; empty for what it does not tell.

    `firmware_date` is as the laser writes it; `status` is how it says that it is, such as
    `Sensor works well.`
    """

    vendor: str = ""
    product: str = ""
    serial: str = ""
    firmware: str = ""
    firmware_date: str = ""
    protocol: str = ""
    status: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RawScan:
    """One scan in the laser's frame.

    Attributes:
        stamp: Time of the first reading [s, monotonic].
        first: Direction of the first reading, counter-clockwise from straight ahead [rad].
        step: From one reading to the next [rad].
        beam_time: From one reading to the next [s].
        period: From one scan to the next [s].
        near: Shortest range that the laser measures [m].
        far: Longest one [m].
        ranges: [m], shape (N,), as in REP 117: `inf` where nothing is in range, `-inf` where
            something is too near, NaN where there is no valid reading.
        intensities: In the laser's own unit, shape (N,); empty where it sends none.
        echoes: For multi-echo lasers all echoes of each reading [m], the nearest first; else empty.
        device_time: The laser's own clock at the scan [s], or `None` without one.
    """

    stamp: float
    first: float
    step: float
    beam_time: float
    period: float
    near: float
    far: float
    ranges: tuple[float, ...]
    intensities: tuple[int, ...] = ()
    echoes: tuple[tuple[float, ...], ...] = ()
    device_time: float | None = None


@dataclass(frozen=True, slots=True)
class LineSpeedWanted:
    """The link must be set to `baud` at once, before the bytes of `outgoing()` leave."""

    baud: int


@dataclass(frozen=True, slots=True)
class Identified:
    """The laser has said what it is."""

    identity: LaserIdentity


@dataclass(frozen=True, slots=True)
class Measured:
    """A scan has come."""

    scan: RawScan


@dataclass(frozen=True, slots=True)
class Remarked:
    """Something for the log: a recovery step, an error that the laser reports."""

    text: str


@dataclass(frozen=True, slots=True)
class ScansLost:
    """No scans come; the reason, and advice, in a sentence without a final stop."""

    reason: str


Event = LineSpeedWanted | Identified | Measured | Remarked | ScansLost


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanSettings:
    """Wishes for the scans; a laser that cannot fulfil one does what comes nearest.

    Directions and `step` are in [rad], `None` for the whole field and the laser's own step. So many
    neighbouring readings become one, `cluster` from 1 to 99 (SCIP); so many scans are left out
    after each one, `skip` from 0 to 9. All echoes come from lasers that have them, and
    `calibrate_time` compares the laser's clock with ours.
    """

    first: float | None = None
    last: float | None = None
    step: float | None = None
    cluster: int = 1
    skip: int = 0
    intensities: bool = False
    multi_echo: bool = False
    calibrate_time: bool = True


AS_DELIVERED = ScanSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class Patience:
    """Time that a client waits [s].

    `answer` is for what lasers give at once, `give_up` for the first scan, and `silence` for the
    next one before the laser is lost, at least ten scan periods.
    """

    answer: float = 0.25
    silence: float = 1.0
    give_up: float = 8.0


class LaserClient(Protocol):
    """The host's side: call :meth:`receive` and :meth:`tick`, obey the events, send `outgoing`.

    :meth:`tick` must next be called at `deadline` [s, monotonic].
    """

    deadline: float

    def receive(self, data: bytes, now: float) -> list[Event]:
        """Process bytes received at `now` [s, monotonic]; return the events that follow."""

    def tick(self, now: float) -> list[Event]:
        """Act on the passing of time. Harmless to call too often."""

    def outgoing(self) -> bytes:
        """Return and forget the bytes to put on the wire, after the events have been obeyed."""

    def leave(self, now: float) -> None:
        """Queue the commands that end scanning and leave the laser as the next program likes it."""
