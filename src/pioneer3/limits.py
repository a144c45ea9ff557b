"""Bounds on the motion of one robot."""

from dataclasses import dataclass, fields, replace
from math import isfinite

from pioneer3.errors import ConfigError
from pioneer3.units import DEGREE


@dataclass(frozen=True, slots=True)
class Accelerations:
    """Accelerations of the speed [m/s^2], then of the turn rate [rad/s^2]; all positive."""

    acceleration: float
    deceleration: float
    turn_acceleration: float
    turn_deceleration: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Bounds on motion, for both directions, all positive: [m/s], [rad/s], [m/s^2], [rad/s^2].

    A command that is not renewed for the time `expiry` [s] ends in a stop.
    """

    max_speed: float
    max_turn_rate: float
    acceleration: float = 0.3
    deceleration: float = 0.3
    turn_acceleration: float = 100 * DEGREE
    turn_deceleration: float = 100 * DEGREE
    expiry: float = 0.5

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (isinstance(value, int | float) and isfinite(value) and value > 0):
                raise ConfigError(f"limits: {field.name} must be a positive number, not {value!r}")
        if not 0.1 <= self.expiry <= 2.0:
            raise ConfigError(f"limits: expiry must be 0.1 to 2 s, not {self.expiry:g}")

    @property
    def accelerations(self) -> "Accelerations":
        """The accelerations."""
        return Accelerations(
            self.acceleration, self.deceleration, self.turn_acceleration, self.turn_deceleration
        )

    def lowered_to(
        self, max_speed: float | None = None, max_turn_rate: float | None = None
    ) -> "Limits":
        """Return limits with lower maxima; a higher value than the robot's own has no effect.

        Raises:
            ConfigError: a maximum is not a positive number.
        """
        speed = self.max_speed if max_speed is None else max_speed
        rate = self.max_turn_rate if max_turn_rate is None else max_turn_rate
        wanted = replace(self, max_speed=speed, max_turn_rate=rate)
        return replace(
            self,
            max_speed=min(self.max_speed, wanted.max_speed),
            max_turn_rate=min(self.max_turn_rate, wanted.max_turn_rate),
        )
