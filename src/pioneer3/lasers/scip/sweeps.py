"""Readings of one turn as SCIP sends them (scip.md 2, 3). No I/O."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Final, TypeVar

from pioneer3.lasers.device import Sweep
from pioneer3.lasers.scip.scans import ECHO, MAX_VALUE, WIDE_RANGE, Format
from pioneer3.lasers.scip.wire import LINE, encode_values, to_lines
from pioneer3.models.lasers import LaserModel, Steps

WHITE: Final = 3000
"""Intensity of a perfect matt white wall (scip.md 3.3)."""
LONGEST_SHORT_VALUE: Final = (1 << 12) - 1
"""The most that two characters carry [mm]."""
NOT_MEASURED: Final = 0
"""Value of steps outside the field."""
_Value = TypeVar("_Value")


@dataclass(frozen=True, slots=True)
class Codes:
    """Values in place of distances: nothing came back, or something is nearer than is measured."""

    nothing: int
    near: int


def codes_of(model: LaserModel, steps: Steps) -> Codes:
    """Return the codes of a laser (scip.md 3.2)."""
    if model.name.startswith("ust"):
        return Codes(nothing=65533, near=2)
    return Codes(nothing=1, near=2) if steps.longest > WIDE_RANGE else Codes(nothing=0, near=19)


def data_lines(
    sweep: Sweep,
    format_: Format,
    steps: Steps,
    codes: Codes,
    *,
    start: int,
    end: int,
    cluster: int,
    summed: bool = True,
) -> bytes:
    """Return the data lines of `sweep`, which has all steps of the laser.

    They are of the steps from `start` to `end`, the shortest distance of each `cluster`; those that
    are `summed` have checksums.
    """
    longest = steps.longest
    if format_.width == 2:
        longest = min(longest, LONGEST_SHORT_VALUE)
        codes = Codes(min(codes.nothing, LONGEST_SHORT_VALUE), codes.near)
    distances: Sequence[int] = sweep.millimetres
    if not distances or sweep.least < steps.shortest or sweep.most > longest:
        distances = values_of(sweep.ranges, steps.shortest, longest, codes)
    distances = _with_margins(distances, steps, start, end, NOT_MEASURED)
    lights: Sequence[int] = [0] * len(distances)
    if format_.intensities:
        lights = _with_margins(intensities_of(sweep), steps, start, end, 0)
    picks = _picks(distances, steps.shortest, cluster)
    if format_.multi_echo:
        echoes: Sequence[list[int]] = [[distance] for distance in distances]
        if sweep.echoes:
            found = [values_of(step, steps.shortest, longest, codes) for step in sweep.echoes]
            found = [step or [codes.nothing] for step in found]
            echoes = _with_margins(found, steps, start, end, [NOT_MEASURED])
        text = b"".join([_echo_text(echoes[at], lights[at], format_) for at in picks])
    elif format_.intensities:
        text = encode_values(
            list(chain.from_iterable((distances[at], lights[at]) for at in picks)), 3
        )
    else:
        chosen = distances if cluster == 1 else [distances[at] for at in picks]
        text = encode_values(chosen, format_.width)
    if summed:
        return to_lines(text)
    return b"".join([text[at : at + LINE] + b"\n" for at in range(0, len(text), LINE)])


def values_of(ranges: Sequence[float], shortest: int, longest: int, codes: Codes) -> list[int]:
    """Return distances [mm] or codes for `ranges` [m]."""
    near, far = (shortest - 0.5) / 1000, (longest + 0.5) / 1000
    return [
        int(metres * 1000 + 0.5)
        if near <= metres < far
        else (codes.near if metres < near else codes.nothing)
        for metres in ranges
    ]


def intensities_of(sweep: Sweep) -> list[int]:
    """Return the intensities of `sweep` as numbers of 18 bits."""
    return [min(int(light * WHITE), MAX_VALUE) for light in sweep.intensities]


def _with_margins(
    values: Sequence[_Value], steps: Steps, start: int, end: int, margin: _Value
) -> Sequence[_Value]:
    """Return the values of the steps from `start` to `end`, of which the laser has some."""
    if start >= steps.first and end <= steps.last:
        return values[start - steps.first : end - steps.first + 1]
    return [
        values[step - steps.first] if steps.first <= step <= steps.last else margin
        for step in range(start, end + 1)
    ]


def _picks(distances: Sequence[int], shortest: int, cluster: int) -> Sequence[int]:
    """Return which distance of each cluster is sent: the shortest that is no code."""
    everything = range(len(distances))
    if cluster == 1:
        return everything
    return [
        min(
            everything[at : at + cluster],
            key=lambda at: (distances[at] < shortest, distances[at]),
        )
        for at in everything[::cluster]
    ]


def _echo_text(echoes: Sequence[int], light: int, format_: Format) -> bytes:
    """Return the data of one step; its later echoes are as bright as the first."""
    numbers = [[value, light] if format_.intensities else [value] for value in echoes]
    return ECHO.join([encode_values(number, 3) for number in numbers])
