"""The place of a laser on the robot, the sectors in which it sees the robot, and its scans."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import degrees, nan, pi, radians
from typing import NamedTuple

from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.lasers.client import RawScan
from pioneer3.state import Scan

PoseAt = Callable[[float], Pose2]
"""Returns the robot's pose in odometry's frame at a time [s, monotonic]."""

ROUNDING = 1e-9
"""A reading at the very end of a sector belongs to it, however the two are rounded [rad]."""


class Sector(NamedTuple):
    """Directions from `first` counter-clockwise to `last` [rad]."""

    first: float
    last: float

    def holds(self, angle: float) -> bool:
        """Whether `angle` [rad] lies in it."""
        width = (self.last - self.first) % (2 * pi)
        return (angle - self.first + ROUNDING) % (2 * pi) <= width + 2 * ROUNDING


@dataclass(frozen=True, slots=True, kw_only=True)
class Mounting:
    """The place of a laser on the robot; `upside_down` it turns clockwise.

    Its scans are stamped too late by its `delay` [s]; with `None`, by that of the robot's model.

    Sectors `masked` are left out, such as posts of the robot itself; in the laser's frame, as
    :attr:`Scan.angles` are, seen from above.
    """

    sensor_in_robot: Pose2 = ORIGIN
    upside_down: bool = False
    masked: tuple[Sector, ...] = ()
    delay: float | None = None

    def scan(self, raw: RawScan, sequence: int, name: str, pose_at: PoseAt) -> Scan:
        """Return the scan of the robot for the readings of its laser."""
        count = len(raw.ranges)
        last = raw.stamp + raw.beam_time * max(0, count - 1)
        began, ended = pose_at(raw.stamp), pose_at(last)
        moved = None if ended == began else ended
        ranges: Sequence[float] = raw.ranges
        reflectances, echoes = raw.intensities, raw.echoes
        first, stamp, beam_time = raw.first, raw.stamp, raw.beam_time
        if self.upside_down:
            ranges, reflectances, echoes = ranges[::-1], reflectances[::-1], echoes[::-1]
            first = wrap(-(raw.first + raw.step * max(0, count - 1)))
            stamp, beam_time = last, -raw.beam_time
            began, moved = ended, None if moved is None else began
        angles, hidden = _geometry(first, raw.step, count, self.masked)
        if hidden:
            shown = list(ranges)
            for i in hidden:
                shown[i] = nan
            ranges = shown
        return Scan(
            stamp=stamp,
            sequence=sequence,
            robot_in_odom=began,
            sensor_in_robot=self.sensor_in_robot,
            angles=angles,
            ranges=tuple(ranges),
            reflectances=reflectances,
            laser=name,
            beam_time=beam_time,
            period=raw.period,
            near=raw.near,
            far=raw.far,
            echoes=echoes,
            last_in_odom=moved,
        )


@lru_cache(maxsize=32)
def _geometry(
    first: float, step: float, count: int, masked: tuple[Sector, ...]
) -> tuple[tuple[float, ...], tuple[int, ...]]:
    """Return the angles of the readings, and the numbers of those that are masked."""
    angles = tuple(first + i * step for i in range(count))
    hidden = (i for i, angle in enumerate(angles) if any(s.holds(angle) for s in masked))
    return angles, tuple(hidden)


MARGIN = radians(1.0)
"""Added on both sides: a beam is wide, and mounts tremble."""
ALWAYS = 0.9
"""A part of the robot is seen in this share of the scans at least."""


def learned(scans: Sequence[Scan], nearer_than: float) -> tuple[Sector, ...]:
    """Return the sectors in which something nearer than `nearer_than` [m] is in every scan.

    A reading that is too near to be valid counts, too.
    """
    if not scans:
        return ()
    angles = scans[-1].angles
    alike = [scan.ranges for scan in scans if scan.angles == angles]
    counts = [sum(metres < nearer_than for metres in beam) for beam in zip(*alike, strict=True)]
    near = [angle for angle, n in zip(angles, counts, strict=True) if n >= ALWAYS * len(alike)]
    return tuple(_joined(Sector(angle - MARGIN, angle + MARGIN) for angle in near))


def _joined(sectors: Iterable[Sector]) -> Iterator[Sector]:
    """Yield the unions of sectors in ascending order that overlap."""
    current: Sector | None = None
    for sector in sectors:
        if current is not None and sector.first <= current.last:
            current = Sector(current.first, sector.last)
            continue
        if current is not None:
            yield current
        current = sector
    if current is not None:
        yield current


def words(sectors: Sequence[Sector]) -> tuple[str, str]:
    """Return the sectors as an option, and as a line of a laser in a robot's file."""
    ends = [(f"{degrees(s.first):.1f}", f"{degrees(s.last):.1f}") for s in sectors]
    option = ",".join(f"{first}:{last}" for first, last in ends)
    line = ", ".join(f"[{first}, {last}]" for first, last in ends)
    return f"--laser-mask={option}", f"masked_deg = [{line}]"
