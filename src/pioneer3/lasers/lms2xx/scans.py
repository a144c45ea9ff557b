"""Telegrams of measurements, both directions (lms2xx.md 1.9).

All have a few numbers first, the last of which is the header; then the values; then perhaps the
two real-time indices.
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
}
"""Numbers before the values, the header last, by code."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measurement:
    """One telegram of measurements, with values as :class:`MeasuringMode` reads them.

    They go from right to left. They are a single turn of a scan that takes several (`partial`),
    which begins `offset_cdeg` from the start of the field [1/100 degree]; or the mean of so many
    scans, `sample`, 0 for no mean; or a part of the field, from the reading `first` to `last`,
    counted from 1, 0 for no part. Some units send `indices`, counters of scans and telegrams.
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
        except error:
            raise ValueError(f"{len(body)} bytes are too few for their header") from None
        rest = body[layout.size + 2 * count :]
        if len(rest) > 2:
            raise ValueError(f"{len(rest)} bytes too many for the header")
        return cls(
            code=code,
            values=values,
            units=Units(header >> UNITS_SHIFT),
            partial=bool(header & PARTIAL),
            offset_cdeg=25 * (header >> OFFSET_SHIFT & OFFSET_MASK),
            indices=rest,
            **dict(zip(names, numbers, strict=True)),
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
        return body + pack(f"<{len(self.values)}H", *self.values) + self.indices
