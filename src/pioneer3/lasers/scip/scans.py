"""The data of scans: distances, intensities and echoes (scip.md 2, 3). No I/O."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf, nan
from operator import itemgetter
from typing import Final

from pioneer3.lasers.scip.wire import decode_values, from_lines, from_plain_lines
from pioneer3.models.lasers import Steps
from pioneer3.units import MM

ECHO: Final = b"&"
"""Stands between the echoes of one step."""
MAX_VALUE: Final = (1 << 18) - 1
WIDE_RANGE: Final = 20000
"""Lasers with a DMAX above this have the codes of the UTM-30LX [mm]."""
CODES: Final = {0: inf, 6: inf}
UTM_CODES: Final = {1: inf, 2: -inf}
"""Values below DMIN that tell more than that there is no reading."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Format:
    """The data that one measuring command asks for.

    A distance has `width` characters, and an intensity behind it three. With `multi_echo` a step
    may have several echoes; `streamed` scans go on, of others there is one only.
    """

    width: int = 3
    intensities: bool = False
    multi_echo: bool = False
    streamed: bool

    @property
    def echo(self) -> int:
        """Characters of one echo."""
        return self.width + 3 * self.intensities


FORMATS: Final = {
    "MD": Format(streamed=True),
    "MS": Format(width=2, streamed=True),
    "ME": Format(intensities=True, streamed=True),
    "ND": Format(multi_echo=True, streamed=True),
    "NE": Format(intensities=True, multi_echo=True, streamed=True),
    "GD": Format(streamed=False),
    "GS": Format(width=2, streamed=False),
    "GE": Format(intensities=True, streamed=False),
    "HD": Format(multi_echo=True, streamed=False),
    "HE": Format(intensities=True, multi_echo=True, streamed=False),
    "G": Format(width=2, streamed=False),
}
"""By the letters of the command; `G` is SCIP 1.1."""


@dataclass(frozen=True, slots=True)
class ScanReadings:
    """The numbers of one scan: distances [mm], or codes, of the first echo of each step.

    `intensities` are of these, or empty; `echoes` are all distances of each step [mm], empty for
    formats with one echo.
    """

    distances: list[int]
    intensities: list[int]
    echoes: list[list[int]]


def decode(
    lines: Sequence[bytes], format_: Format, count: int, *, summed: bool = True
) -> ScanReadings | None:
    """Return the readings in the data lines of a scan, or `None` if they are not `count` good ones.

    `lines` come after the time stamp; those that are `summed` have checksums.
    """
    if not lines:
        return None
    if not summed:
        text = from_plain_lines(lines)
    else:
        text = from_lines(lines, ECHO if format_.multi_echo else b"")
    if text is None:
        return None
    if format_.multi_echo:
        return _decode_echoes(text, format_, count)
    if len(text) != count * format_.echo:
        return None
    values = decode_values(text, format_.width)
    if format_.intensities:
        return ScanReadings(values[0::2], values[1::2], [])
    return ScanReadings(values, [], [])


def _decode_echoes(text: bytes, format_: Format, count: int) -> ScanReadings | None:
    """Return the readings of multi-echo data: each `&` joins an echo to the step before it."""
    per_echo = 2 if format_.intensities else 1
    echoes: list[list[int]] = []
    intensities: list[int] = []
    for number, part in enumerate(text.split(ECHO)):
        if not part or len(part) % format_.echo:
            return None
        values = decode_values(part, format_.width)
        distances = values[0::per_echo]
        if number:
            echoes[-1].append(distances.pop(0))
        echoes += [[distance] for distance in distances]
        if format_.intensities:
            intensities += values[3 if number else 1 :: 2]
    if len(echoes) != count:
        return None
    return ScanReadings([step[0] for step in echoes], intensities, echoes)


def ranges_of(values: Sequence[int], steps: Steps) -> tuple[float, ...]:
    """Return the range of each value [m], as REP 117 has it (scip.md 3.2)."""
    table = _ranges(steps.shortest, steps.longest)
    try:
        ranges: tuple[float, ...] = itemgetter(0, 0, *values)(table)[2:]  # of one it is no tuple
    except IndexError:
        return tuple([table[value] if value < len(table) else inf for value in values])
    return ranges


@lru_cache(maxsize=8)
def _ranges(low: int, high: int) -> tuple[float, ...]:
    """Return the range of each value up to the next power of two above `high` [m]."""
    codes = UTM_CODES if high > WIDE_RANGE else CODES
    return tuple(
        [
            value * MM if low <= value <= high else codes.get(value, nan) if value < low else inf
            for value in range(1 << min(high.bit_length(), MAX_VALUE.bit_length()))
        ]
    )
