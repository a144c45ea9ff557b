"""The 16-bit values of the LMS-2xx: variants, units and measuring modes as data (lms2xx.md 1.8).

A value carries a distance in its lower bits, and flags or a reflectivity above. The highest
distances are codes.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import inf, isnan, nan, radians
from typing import Final

MIRROR_TURN: Final = 1 / 75
"""Time of one turn [s] (lms2xx.md 1.9)."""
PULSE_STEP_CDEG: Final = 100
"""From one pulse of a turn to the next, always [1/100 degree]."""


class Units(IntEnum):
    """The unit of distances, as the configuration and the header of scans name it."""

    CENTIMETRES = 0
    MILLIMETRES = 1
    DECIMETRES = 2

    @property
    def metres(self) -> float:
        """Its size [m]."""
        return (0.01, 0.001, 0.1)[self]


@dataclass(frozen=True, slots=True)
class Variant:
    """A field, its middle straight ahead, and a step that the unit can scan."""

    field_deg: int
    step_cdeg: int

    def __str__(self) -> str:
        return f"{self.field_deg} degrees in steps of {self.step_cdeg / 100:g}"

    @property
    def count(self) -> int:
        """Number of readings."""
        return self.field_deg * 100 // self.step_cdeg + 1

    @property
    def turns(self) -> int:
        """Number of turns that are put together to one scan."""
        return PULSE_STEP_CDEG // self.step_cdeg

    @property
    def first(self) -> float:
        """Direction of the first reading [rad]."""
        return -radians(self.field_deg / 2)

    @property
    def step(self) -> float:
        """From one reading to the next [rad]."""
        return radians(self.step_cdeg / 100)

    @property
    def beam_time(self) -> float:
        """From one reading to the next, on average over the turns [s]."""
        return MIRROR_TURN * self.step_cdeg / 36000

    @property
    def scan_time(self) -> float:
        """Time of all turns of a scan [s]."""
        return self.turns * MIRROR_TURN


VARIANTS: Final = tuple(
    Variant(*numbers) for numbers in ((180, 100), (180, 50), (100, 100), (100, 50), (100, 25))
)
AT_POWER_ON: Final = Variant(180, 50)
VARIANT_OF_COUNT: Final[Mapping[int, Variant]] = {v.count: v for v in VARIANTS}
"""The number of readings tells the variant."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuringMode:
    """A row of the table of measuring modes, by its `number` in the configuration.

    The lower `bits` carry the distance, or the strength of the echo with `amplitude`. Those above
    are a reflectivity, or else flags of fields and dazzling. With `codes` the highest distances are
    codes.
    """

    number: int
    bits: int
    reflectivity: bool = False
    codes: bool = True
    amplitude: bool = False

    @property
    def mask(self) -> int:
        """The bits of the distance; as a number, the code of a reading that is not valid."""
        return (1 << self.bits) - 1

    @property
    def beyond(self) -> int:
        """The code of nothing in range; valid distances are smaller."""
        return self.mask - 8 if self.codes else self.mask + 1

    @property
    def levels(self) -> int:
        """Number of values that the reflectivity has; 1 without one."""
        return 1 << 16 - self.bits if self.reflectivity else 1

    def far(self, units: Units) -> float:
        """Return the longest distance that fits [m]."""
        return (self.beyond - 1) * units.metres

    def ranges(self, values: Sequence[int], units: Units) -> tuple[float, ...]:
        """Return the distances in `values` [m]; `inf`: nothing in range, NaN: not measured."""
        mask, beyond, metres = self.mask, self.beyond, units.metres
        return tuple(
            v * metres if (v := value & mask) < beyond else inf if v == beyond else nan
            for value in values
        )

    def reflectivities(self, values: Sequence[int]) -> tuple[int, ...]:
        """Return the reflectivity in each of `values`, or nothing in modes without it."""
        return tuple(value >> self.bits for value in values) if self.reflectivity else ()

    def values(
        self, ranges: Iterable[float], intensities: Iterable[float], units: Units
    ) -> list[int]:
        """Return the values of a turn: the inverse of :meth:`ranges` and :meth:`reflectivities`.

        No distance becomes 0. Intensities are shares of the light of a white wall, as in a `Sweep`;
        a value shows how many times two white walls one is, as far as its bits go.
        """
        per_metre, top = 1 / units.metres, self.levels - 1
        values = []
        for metres, intensity in zip(ranges, intensities, strict=True):
            if isnan(metres):
                values.append(self.mask)
                continue
            distance = self.beyond if metres == inf else max(1, round(metres * per_metre))
            level = min(top, int(intensity / 2)) if top else 0
            values.append(min(distance, self.beyond, self.mask) | level << self.bits)
        return values


MEASURING_MODES: Final[Mapping[int, MeasuringMode]] = {
    mode.number: mode
    for mode in (
        MeasuringMode(number=0x00, bits=13),
        MeasuringMode(number=0x01, bits=13, reflectivity=True),
        MeasuringMode(number=0x02, bits=13),
        MeasuringMode(number=0x03, bits=14, reflectivity=True),
        MeasuringMode(number=0x04, bits=14),
        MeasuringMode(number=0x05, bits=15, reflectivity=True),
        MeasuringMode(number=0x06, bits=15),
        MeasuringMode(number=0x0F, bits=16, codes=False),
        MeasuringMode(number=0x3F, bits=16, codes=False, amplitude=True),
    )
}
"""By number."""
