"""Scans as bytes and back, exactly, in a small part of the room that JSON takes.

They are msgpack with the fields of :class:`Scan`, but the angles. Ranges are bytes of whole numbers
of a unit, as lasers send them: a chunk has the laser's own beside them, and grows little.
"""

from collections.abc import Sequence
from itertools import accumulate, chain, pairwise
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from pioneer3.log.differences import sums
from pioneer3.state import Scan
from pioneer3.units import MM

UNITS: Final = (MM, 10 * MM)
"""Units of lasers [m]."""
NO_ECHO: Final = {"<u2": 0x7FFF, "<u4": 0x7FFF_FFFF}
"""Types of whole numbers, and what stands for inf, as in simulators; one less for -inf, two for
NaN."""
EXACT: Final = "<f8"
"""Type of ranges that are no whole numbers of a unit."""


def packed_ranges(scans: Sequence[Sequence[float]]) -> dict[str, Sequence[Any]]:
    """Return the ranges of scans as fields: the unit, the type and the bytes of each."""
    every = np.fromiter(chain.from_iterable(scans), np.float64, sum(map(len, scans)))
    unit, kind, data = _packed(every)
    ends = [*accumulate((len(each) * np.dtype(kind).itemsize for each in scans), initial=0)]
    ranges = [data[begin:end] for begin, end in pairwise(ends)]
    return {"unit": [unit] * len(scans), "type": [kind] * len(scans), "ranges": ranges}


def unpack_scan(data: bytes, angles: Any) -> Scan:
    """Return a scan.

    Raises:
        msgspec.MsgspecError, ValueError, KeyError, TypeError: It is none.
    """
    is_json = data.startswith(b"{")  # older logs have msgpack
    told = (msgspec.json if is_json else msgspec.msgpack).decode(data)
    unit, kind, ranges = told.pop("unit"), told.pop("type"), told.pop("ranges")
    ranges = msgspec.convert(ranges, bytes) if is_json else ranges
    if step := told.pop("step", 0):  # as in some older logs
        ranges = sums(ranges, step)
    told |= {"angles": angles, "ranges": _unpacked(unit, kind, ranges)}
    return msgspec.convert(told, Scan, strict=False)


def _packed(ranges: NDArray[np.float64]) -> tuple[float, str, bytes]:
    """Return the unit of ranges, their type, and their bytes."""
    is_number = np.isfinite(ranges)
    known = ranges[is_number]
    for unit in () if np.signbit(known).any() else UNITS:
        with np.errstate(over="ignore"):
            counts = np.rint(known / unit)
        if not (counts * unit == known).all():
            continue
        for kind, code in NO_ECHO.items():
            if counts.max(initial=0) >= code - 2:
                continue
            whole = np.full(ranges.shape, code, dtype=kind)
            whole[is_number] = counts
            whole[np.isneginf(ranges)] = code - 1
            whole[np.isnan(ranges)] = code - 2
            return unit, kind, whole.tobytes()
    return 1.0, EXACT, ranges.astype(EXACT).tobytes()


def _unpacked(unit: float, kind: str, data: bytes) -> list[float]:
    if kind == EXACT:
        return np.frombuffer(data, EXACT).tolist()  # type: ignore[no-any-return]
    code = NO_ECHO[kind]
    whole = np.frombuffer(data, kind)
    ranges = whole * unit
    ranges[whole == code] = np.inf
    ranges[whole == code - 1] = -np.inf
    ranges[whole == code - 2] = np.nan
    return ranges.tolist()  # type: ignore[no-any-return]
