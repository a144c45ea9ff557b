"""Learns the sectors in which a laser sees the robot that it is mounted on."""

from collections.abc import Iterable, Iterator, Sequence
from math import degrees, radians

from pioneer3.robot.lasers.mounting import Sector
from pioneer3.state import Scan

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
    """Return the sectors as an option, and as a line of the table `[laser]` of a robot's file."""
    ends = [(f"{degrees(s.first):.1f}", f"{degrees(s.last):.1f}") for s in sectors]
    option = ",".join(f"{first}:{last}" for first, last in ends)
    line = ", ".join(f"[{first}, {last}]" for first, last in ends)
    return f"--laser-mask={option}", f"masked_deg = [{line}]"
