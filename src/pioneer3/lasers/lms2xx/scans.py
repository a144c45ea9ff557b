"""Telegrams of measurements, both directions (lms2xx.md 1.9).

All have a few numbers first, the last of which is the header; then the values; then perhaps the
two real-time indices. RANGE_AND_REFLECTIVITY has the reflectivities of a part of them behind.
"""

from dataclasses import dataclass
from struct import Struct, error, pack, unpack_from
from typing import Final

from pioneer3.lasers.lms2xx.commands import ANSWER, CommandCode, OperatingMode
from pioneer3.lasers.lms2xx.measuring import Units

COUNT: Final = 0x3FF
OFFSET_SHIFT: Final = 11
OFFSET_MASK: Final = 0x3
PARTIAL: Final = 0x2000
UNITS_SHIFT: Final = 14

VALUES: Final = CommandCode.SCAN + ANSWER
MEAN_VALUES: Final = 0xB6
SUBRANGE_VALUES: Final = 0xB7
MEAN_SUBRANGE_VALUES: Final = 0xBF
RANGES_AND_REFLECTIVITIES: Final = 0xC4

TELEGRAMS: Final = {
    OperatingMode.MEAN: MEAN_VALUES,
    OperatingMode.SUBRANGE: SUBRANGE_VALUES,
    OperatingMode.MEAN_OF_SUBRANGE: MEAN_SUBRANGE_VALUES,
}
"""Codes of the telegrams of modes that do not send VALUES."""
_LAYOUTS: Final[dict[int, tuple[Struct, tuple[str, ...]]]] = {
    VALUES: (Struct("<H"), ()),
    MEAN_VALUES: (Struct("<BH"), ("sample",)),
    SUBRANGE_VALUES: (Struct("<HHH"), ("first", "last")),
    MEAN_SUBRANGE_VALUES: (Struct("<BHHH"), ("sample", "first", "last")),
    RANGES_AND_REFLECTIVITIES: (Struct("<H"), ()),
}
"""Numbers before the values, the header last, by code."""
_REFLECTIVITIES: Final = Struct("<HHH")
"""A header, the first and the last reading of the part, from 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """One telegram of measurements.

    Attributes:
        code: Of the telegram.
        values: As :class:`MeasuringMode` reads them, from right to left.
        units: Of their distances.
        partial: Whether this is a single turn of a scan that takes several.
        offset_cdeg: Of the first value of a single turn from the start of the field [1/100 degree].
        sample: Number of scans that the values are the mean of; 0: no mean.
        first: First reading of a part of the field, from 1; 0: not a part.
        last: Last reading of it.
        indices: Counters of scans and of telegrams, where the unit sends them.
        reflectivities: Of the readings from `first` to `last`.
    """

    code: int
    values: tuple[int, ...]
    units: Units
    partial: bool = False
    offset_cdeg: int = 0
    sample: int = 0
    first: int = 0
    last: int = 0
    indices: bytes = b""
    reflectivities: tuple[int, ...] = ()

    @classmethod
    def from_body(cls, code: int, body: bytes) -> "Measurement":
        """Return the measurements in the body of a telegram, without its status byte.

        Raises:
            ValueError: `code` is of another telegram, or the sizes do not fit.
        """
        if code not in _LAYOUTS:
            raise ValueError(f"0x{code:02X} is no telegram of measurements")
        layout, names = _LAYOUTS[code]
        try:
            *numbers, header = layout.unpack_from(body)
            count = header & COUNT
            values = unpack_from(f"<{count}H", body, layout.size)
            extra = dict(zip(names, numbers, strict=True))
            rest = body[layout.size + 2 * count :]
            reflectivities = b""
            if code == RANGES_AND_REFLECTIVITIES:
                _, first, last = _REFLECTIVITIES.unpack_from(rest)
                extra |= {"first": first, "last": last}
                part = max(0, last - first + 1)
                reflectivities = rest[_REFLECTIVITIES.size :][:part]
                rest = rest[_REFLECTIVITIES.size + part :]
                if len(reflectivities) != part:
                    raise ValueError(f"{part} reflectivities do not fit into the telegram")
        except error:
            raise ValueError(f"{len(body)} bytes are too few for their header") from None
        if len(rest) > 2:
            raise ValueError(f"{len(rest)} bytes too many for the header")
        return cls(
            code=code,
            values=values,
            units=Units(header >> UNITS_SHIFT),
            partial=bool(header & PARTIAL),
            offset_cdeg=25 * (header >> OFFSET_SHIFT & OFFSET_MASK),
            indices=rest,
            reflectivities=tuple(reflectivities),
            **extra,
        )

    def to_body(self) -> bytes:
        """Return the body of the telegram, without its status byte."""
        layout, names = _LAYOUTS[self.code]
        header = (
            len(self.values)
            | self.offset_cdeg // 25 << OFFSET_SHIFT
            | self.partial * PARTIAL
            | self.units << UNITS_SHIFT
        )
        body = layout.pack(*(getattr(self, name) for name in names), header)
        body += pack(f"<{len(self.values)}H", *self.values)
        if self.code == RANGES_AND_REFLECTIVITIES:
            part = len(self.reflectivities) | self.units << UNITS_SHIFT
            body += _REFLECTIVITIES.pack(part, self.first, self.last) + bytes(self.reflectivities)
        return body + self.indices
