"""The range of every number of a robot model, wide enough for any robot that drives in a building.

They are here to catch millimetres written as metres, and degrees as radians.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import pi, tau
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Bounds:
    """A closed range, SI."""

    low: float
    high: float

    def holds(self, value: float) -> bool:
        """Whether `value` [SI] is inside; NaN never is."""
        return self.low <= value <= self.high

    def complaint(self, value: float, unit: float = 1.0) -> str:
        """Say what is wrong with `value`; it and the limits are shown in `unit` [SI]."""
        shown = f"{value:g}" if not abs(value) > 1e300 else "this number"
        return f"{shown} is out of range, expected {self.in_words(unit)}"

    def in_words(self, unit: float = 1.0) -> str:
        """Return the limits, shown in `unit` [SI]."""
        return f"{self.low / unit:g} to {self.high / unit:g}"


_SIZE = Bounds(0.01, 10.0)
_FACTOR = Bounds(1e-6, 0.1)
_ACCELERATION = Bounds(0.001, 20.0)
_TURN_ACCELERATION = Bounds(0.001, 200.0)

BOUNDS: Mapping[str, Bounds] = MappingProxyType(
    {
        "radius": _SIZE,
        "width": _SIZE,
        "length_front": _SIZE,
        "length_rear": _SIZE,
        "wheel_base": _SIZE,
        "max_speed": Bounds(0.01, 10.0),
        "max_turn_rate": Bounds(0.01, 50.0),
        "acceleration": _ACCELERATION,
        "deceleration": _ACCELERATION,
        "turn_acceleration": _TURN_ACCELERATION,
        "turn_deceleration": _TURN_ACCELERATION,
        "braking": _ACCELERATION,
        "turn_braking": _TURN_ACCELERATION,
        "distance_factor": _FACTOR,
        "heading_factor": _FACTOR,
        "speed_factor": _FACTOR,
        "range_factor": _FACTOR,
        "vel2_unit": Bounds(1e-4, 1.0),
        "gyro_scaler": Bounds(0.001, 1000.0),
    }
)
"""Of each numeric field of `RobotModel` [SI]."""

REACH = Bounds(-10.0, 10.0)
"""Of a sensor's position along one axis [m]."""

BEARING = Bounds(-tau, tau)
"""Of a sensor's direction as files give it [rad]."""

HEADING = Bounds(-pi, pi)
"""Of a sensor's direction in a model [rad]."""

BUMPERS = Bounds(0, 7)
"""Segments on one side: a stall byte has bits 1 to 7 for them (arcos.md 4.7)."""

SWITCH_SPEEDS = (0, 9600, 19200, 38400, 57600, 115200)
"""Line speeds that HOSTBAUD can name [baud] (arcos.md 1.1); 0 means never switch."""
