"""The only conversions between SI and the robot's millimetres, degrees, counts and decivolts."""

from math import degrees, pi, radians

MM = 0.001
"""One millimetre [m]."""

MS = 0.001
"""One millisecond [s]."""

DEGREE = pi / 180
"""One degree [rad]."""

HEADING_UNITS = 4096
"""ARCOS heading units in a full turn (arcos.md 4.2)."""

HEADING_UNIT = 2 * pi / HEADING_UNITS
"""One ARCOS heading unit [rad]."""

DECIVOLT = 0.1
"""One step of the battery byte [V]."""

__all__ = ["DECIVOLT", "DEGREE", "HEADING_UNIT", "HEADING_UNITS", "MM", "MS", "degrees", "radians"]
