"""Scans as bytes and back, exactly, in a small part of the room that JSON takes.

They are msgpack with the fields of :class:`Scan`, but the angles. Ranges are bytes of whole numbers
of a unit, as lasers send them: a chunk has the laser's own beside them, and grows little.
"""

from dataclasses import fields
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
OTHERS: Final = tuple(each.name for each in fields(Scan) if each.name not in {"angles", "ranges"})
"""Fields that stay as they are."""


def scan_fields(scan: Scan) -> dict[str, object]:
    """Return the fields of a scan, without its angles."""
    unit, kind, ranges = _packed(np.array(scan.ranges, dtype=np.float64))
    others = {name: msgspec.to_builtins(getattr(scan, name)) for name in OTHERS}
    return others | {"unit": unit, "type": kind, "ranges": ranges}


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
    for unit in UNITS:
        with np.errstate(over="ignore"):
            counts = np.rint(known / unit)
        if not (counts * unit == known).all() or (known < 0).any() or np.signbit(known).any():
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
