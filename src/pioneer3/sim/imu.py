"""Rates and accelerations that a gyro and an accelerometer feel."""

from dataclasses import dataclass

GRAVITY = 9.81
"""[m/s2]."""


@dataclass(frozen=True, slots=True)
class ImuReading:
    """A reading of a gyro and an accelerometer at a robot's origin, about its own axes.

    Attributes:
        rates: Turn rates about x (ahead), y (left) and z (up) [rad/s].
        acceleration: Along the same [m/s2]. At rest on a level floor it is 9.81 upwards.
    """

    rates: tuple[float, float, float]
    acceleration: tuple[float, float, float]
