"""Parameters of driving, which may change at run time, within the bounds of the robot."""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import isfinite
from typing import Final

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError
from pioneer3.limits import Limits
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter import ROS1, Effect, Parameter, rows_of
from pioneer3.units import DEGREE, MM

Values = Mapping[str, float | None]
"""Value of each parameter, by name; `None` for the robot's own, which nobody knows."""


at_once = partial(Parameter, acts=Effect.AT_ONCE)
linear = partial(at_once, low=0.0, high=9.999, unit="m/s^2", rosaria_default=0.3)
angular = partial(at_once, low=0.0, high=174.5, unit="rad/s^2", rosaria_default=1.745)
sideways = partial(
    at_once, "no Pioneer drives sideways", low=0.0, high=0.0001, rosaria_default=0.0, profiles=ROS1
)
encoder = partial(at_once, otherwise="the robot's own")


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivingSettings:
    """The parameters of driving; `None` is the robot's own.

    Bounds and defaults of RosAria's nine are those of its dynamic_reconfigure.
    """

    max_linear_acceleration: float | None = linear(
        "acceleration; 0 is the robot's own", rosaria="trans_accel", p2os="max_xaccel"
    ).field(None)
    max_linear_deceleration: float | None = linear(
        "deceleration; 0 is the robot's own", rosaria="trans_decel", p2os="max_xdecel"
    ).field(None)
    lat_accel: float | None = sideways(rosaria="lat_accel").field(None)
    lat_decel: float | None = sideways(rosaria="lat_decel").field(None)
    max_angular_acceleration: float | None = angular(
        "acceleration of turning; 0 is the robot's own", rosaria="rot_accel", p2os="max_yawaccel"
    ).field(None)
    max_angular_deceleration: float | None = angular(
        "deceleration of turning; 0 is the robot's own", rosaria="rot_decel", p2os="max_yawdecel"
    ).field(None)
    ticks_mm: int | None = encoder(
        "encoder ticks per mm", low=1, high=200, rosaria="TicksMM", rosaria_default=0
    ).field(None)
    drift_factor: int | None = encoder(
        "correction of the left encoder, in 1/8192",
        low=-32768,
        high=32767,
        rosaria="DriftFactor",
        rosaria_default=-99999,
    ).field(None)
    rev_count: int | None = encoder(
        "encoder ticks of half a turn", low=1, high=65535, rosaria="RevCount", rosaria_default=0
    ).field(None)


PARAMETERS: Final = rows_of(DrivingSettings)
ACCELERATIONS: Final = {
    "max_linear_acceleration": "acceleration",
    "max_linear_deceleration": "deceleration",
    "max_angular_acceleration": "turn_acceleration",
    "max_angular_deceleration": "turn_deceleration",
}
"""The limit of the driver that each one sets."""
BRAKES: Final = {"max_linear_deceleration": 0.3, "max_angular_deceleration": 1.745}
"""Least decelerations, which every stop needs: those of firmware as it is delivered."""
COMMANDS: Final[Mapping[str, Callable[[int], Command]]] = {
    "ticks_mm": lambda value: commands.TicksMM(ticks_per_mm=value),
    "drift_factor": lambda value: commands.DriftFactor(correction=value),
    "rev_count": lambda value: commands.RevCount(ticks=value),
}
"""The command that tells the robot each one of its wheels."""


def parameters_of(limits: Limits, config: Config | None) -> tuple[Parameter, ...]:
    """Return the parameters for a robot: nothing beyond the accelerations that it can do.

    The highest accelerations are those of its CONFIG; where that is missing, those in use.
    """
    speed = (config.accel_top_mm_s2 or 0) * MM if config else 0.0
    turn = (config.rotation_accel_top_deg_s2 or 0) * DEGREE if config else 0.0
    speed = speed or max(limits.acceleration, limits.deceleration)
    turn = turn or max(limits.turn_acceleration, limits.turn_deceleration)
    return tuple(
        replace(
            row,
            high=(top := speed if "linear" in row.name else turn),
            rosaria_default=min(row.rosaria_default or 0.0, top),
        )
        if row.name in ACCELERATIONS
        else row
        for row in PARAMETERS
    )


def own_values(limits: Limits) -> Values:
    """Return the values before anybody has set one."""
    known = {name: getattr(limits, field) for name, field in ACCELERATIONS.items()}
    return {row.name: known.get(row.name) for row in PARAMETERS}


def within_bounds(
    wanted: Mapping[str, object], limits: Limits, parameters: Sequence[Parameter] = PARAMETERS
) -> Values:
    """Return `wanted` within the bounds of `parameters`; where it says 0, the robot's own `limits`.

    Raises:
        ConfigError: something is not a finite number.
    """
    inside = dict(own_values(limits))
    for row in parameters:
        value = _bounded(row, wanted.get(row.name))
        if row.name in ACCELERATIONS:
            own = inside[row.name] or 0.0
            value = max(value, min(BRAKES.get(row.name, 0.0), own)) if value else own
        inside[row.name] = value
    return inside


def _bounded(row: Parameter, value: object) -> float | None:
    """Return `value` within bounds, `None` for the robot's own; ConfigError if it is not finite."""
    if value is None or row.name not in {*ACCELERATIONS, *COMMANDS}:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
        raise ConfigError(f"{row.name} must be a number, not {value!r}")
    if row.whole:
        return round(min(value, row.high)) if value >= row.low else None
    return float(min(max(value, row.low), row.high))


def changed(limits: Limits, values: Values) -> Limits:
    """Return `limits` with the accelerations of `values`."""
    return replace(limits, **{field: values[name] or 0.0 for name, field in ACCELERATIONS.items()})


def to_send(values: Values) -> list[Command]:
    """Return the commands that tell the robot of its wheels; none for values that are its own."""
    told = {name: values[name] for name in COMMANDS}
    return [COMMANDS[name](int(value)) for name, value in told.items() if value is not None]


class DrivingParameters:
    """The `values` in force of the parameters of one robot, whose own are `limits` and CONFIG.

    `parameters` have the bounds of this robot, and `wanted` are the values of the settings, to
    begin with once somebody calls :meth:`set`. `apply` is given all values whenever one has been
    set, by the thread that set it.
    """

    def __init__(
        self,
        limits: Limits,
        config: Config | None,
        settings: DrivingSettings,
        apply: Callable[[Values], None],
    ) -> None:
        self.parameters = parameters_of(limits, config)
        self.values = own_values(limits)
        given = {row.name: getattr(settings, row.name) for row in PARAMETERS}
        known = {name: value for name, value in given.items() if value is not None}
        self.wanted = within_bounds({**self.values, **known}, limits, self.parameters)
        self._limits = limits
        self._apply = apply
        self._lock = threading.Lock()

    @property
    def declared(self) -> Mapping[Parameter, float | None]:
        """The values in force of the parameters that ROS 2 has."""
        return {
            row: self.values[row.name] for row in self.parameters if Profile.ROS2 in row.profiles
        }

    def change(self, wanted: Mapping[str, object]) -> Mapping[str, float]:
        """Take new values of some parameters; return those of them that are in force and known.

        Raises:
            ConfigError: something is not a finite number; nothing changes.
        """
        held = self.set({**self.values, **wanted})
        return {name: value for name in wanted if (value := held[name]) is not None}

    def set(self, wanted: Mapping[str, object]) -> Values:
        """Take new values, none if one is no finite number (ConfigError); return those in force."""
        with self._lock:
            values = within_bounds(wanted, self._limits, self.parameters)
            if values != self.values:
                self.values = values
                self._apply(values)
            return values
