"""The only conversions between SI and the robot's millimetres, degrees, counts and decivolts.

Also the parser of quantities that a person writes, such as `30cm/s`.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, pi
from typing import Final

MM = 0.001
"""One millimetre [m]."""

MS = 0.001
"""One millisecond [s]."""

DEGREE = pi / 180
"""One degree [rad]."""

HEADING_UNITS = 4096
"""ARCOS heading units in a full turn (protocol.md 4.2)."""

HEADING_UNIT = 2 * pi / HEADING_UNITS
"""One ARCOS heading unit [rad]."""

DECIVOLT = 0.1
"""One step of the battery byte [V]."""

NUMBER: Final = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*)", re.DOTALL)


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """A kind of number that a person writes with or without its unit.

    `name` has its article; the first of `units`, by their size in SI, is that of a bare number.
    """

    name: str
    units: Mapping[str, float]
    example: str

    @property
    def bare(self) -> str:
        """The unit of a number without one."""
        return next(iter(self.units))

    def read(self, text: str, bare: str | None = None) -> float:
        """Return the number in `text` in SI; `bare` replaces the unit of a bare number.

        Raises:
            ValueError: it is no finite number with a known unit; the message lists the units.
        """
        match = NUMBER.fullmatch(text.strip())
        size = self.units.get(match[2] or bare or self.bare) if match else None
        if match is None or size is None:
            wrong = f"{match[2]!r} is no unit of {self.name}" if match else ""
            wrong = wrong or f"{text!r} is not {self.name}"
            units = ", ".join(self.units)
            raise ValueError(f"{wrong}; write it as {self.example} (units: {units})")
        value = float(match[1]) * size
        if not isfinite(value):
            raise ValueError(f"{text!r} is too large for {self.name}")
        return value

    def written(self, value: float) -> str:
        """Return `value` [SI] in the unit of bare numbers."""
        return f"{value / self.units[self.bare]:.4g} {self.bare}"


LENGTH: Final = Quantity("a length", {"m": 1.0, "cm": 0.01, "mm": MM}, "0.5, 50cm")
ANGLE: Final = Quantity("an angle", {"deg": DEGREE, "°": DEGREE, "rad": 1.0}, "90, 90deg, 1.57rad")
SPEED: Final = Quantity("a speed", {"m/s": 1.0, "cm/s": 0.01, "mm/s": MM}, "0.3, 30cm/s")
TURN_RATE: Final = Quantity(
    "a turn rate", {"deg/s": DEGREE, "°/s": DEGREE, "rad/s": 1.0}, "45, 45deg/s, 0.8rad/s"
)
DURATION: Final = Quantity("a time", {"s": 1.0, "ms": MS, "min": 60.0, "h": 3600.0}, "60, 1min")
