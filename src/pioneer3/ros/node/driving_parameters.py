"""RosAria's nine parameters of driving, which may change at run time, within their bounds."""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Final

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError
from pioneer3.limits import Limits
from pioneer3.units import DEGREE, MM

Values = Mapping[str, float]
"""Value of each parameter, by name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivingParameter:
    """One parameter: a number.

    Attributes:
        name: In RosAria.
        standard: Name of the parameter in today's packages, where there is one.
        low: Least value.
        high: Greatest value.
        default: As RosAria has it.
        least: Least whole number that the robot is told; all below it, such as the default, mean
            its own. `None` for accelerations, which are no whole numbers.
        description: Its meaning, for people, with its unit.
    """

    name: str
    standard: str | None = None
    low: float
    high: float
    default: float
    least: int | None = None
    description: str

    @property
    def whole(self) -> bool:
        """Whether it is a whole number."""
        return self.least is not None

    @property
    def lowest_told(self) -> float:
        """The least value that is no word for the robot's own, if it is a whole number."""
        return self.low if self.least is None else self.least

    def known(self, value: float) -> int | float | None:
        """Return a value in its type; `None` where the robot has its own, which nobody knows."""
        if self.least is None:
            return float(value)
        return int(value) if value >= self.least else None

    def bounded(self, value: object) -> float:
        """Return `value` within the bounds, whole if need be.

        Raises:
            ConfigError: it is not a finite number.
        """
        if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value):
            raise ConfigError(f"~{self.name} must be a number, not {value!r}")
        inside = min(max(value, self.low), self.high)
        return round(inside) if self.whole else float(inside)


PARAMETERS: Final = (
    DrivingParameter(
        name="trans_accel",
        standard="max_linear_acceleration",
        low=0.0,
        high=9.999,
        default=0.3,
        description="Acceleration [m/s^2]; 0 is the robot's own",
    ),
    DrivingParameter(
        name="trans_decel",
        standard="max_linear_deceleration",
        low=0.0,
        high=9.999,
        default=0.3,
        description="Deceleration [m/s^2]; 0 is the robot's own",
    ),
    DrivingParameter(
        name="lat_accel",
        low=0.0,
        high=0.0001,
        default=0.0,
        description="No Pioneer drives sideways",
    ),
    DrivingParameter(
        name="lat_decel",
        low=0.0,
        high=0.0001,
        default=0.0,
        description="No Pioneer drives sideways",
    ),
    DrivingParameter(
        name="rot_accel",
        standard="max_angular_acceleration",
        low=0.0,
        high=174.5,
        default=1.745,
        description="Acceleration of turning [rad/s^2]; 0 is the robot's own",
    ),
    DrivingParameter(
        name="rot_decel",
        standard="max_angular_deceleration",
        low=0.0,
        high=174.5,
        default=1.745,
        description="Deceleration of turning [rad/s^2]; 0 is the robot's own",
    ),
    DrivingParameter(
        name="TicksMM",
        standard="ticks_mm",
        low=0,
        high=200,
        default=0,
        least=1,
        description="Encoder ticks per mm",
    ),
    DrivingParameter(
        name="DriftFactor",
        standard="drift_factor",
        low=-99999,
        high=32767,
        default=-99999,
        least=-32768,
        description="Correction of the left encoder [1/8192]",
    ),
    DrivingParameter(
        name="RevCount",
        standard="rev_count",
        low=0,
        high=65535,
        default=0,
        least=1,
        description="Encoder ticks of half a turn",
    ),
)
NAMES: Final = tuple(name for each in PARAMETERS for name in (each.name, each.standard) if name)
"""All their names."""
ACCELERATIONS: Final = {
    "trans_accel": "acceleration",
    "trans_decel": "deceleration",
    "rot_accel": "turn_acceleration",
    "rot_decel": "turn_deceleration",
}
"""The limit of the driver that each one sets."""
BRAKES: Final = {"trans_decel": 0.3, "rot_decel": 1.745}
"""Least decelerations, which every stop needs: those of firmware as it is delivered."""
COMMANDS: Final[Mapping[str, Callable[[int], Command]]] = {
    "TicksMM": lambda value: commands.TicksMM(ticks_per_mm=value),
    "DriftFactor": lambda value: commands.DriftFactor(correction=value),
    "RevCount": lambda value: commands.RevCount(ticks=value),
}
"""The command that tells the robot each one of its wheels."""


def parameters_of(limits: Limits, config: Config | None) -> tuple[DrivingParameter, ...]:
    """Return the parameters for a robot: nothing beyond the accelerations that it can do.

    The highest accelerations are those of its CONFIG; where that is missing, those in use.
    """
    own = own_values(limits)
    speed = (config.accel_top_mm_s2 or 0) * MM if config else 0.0
    turn = (config.rotation_accel_top_deg_s2 or 0) * DEGREE if config else 0.0
    tops = {
        "trans_accel": speed or max(own["trans_accel"], own["trans_decel"]),
        "rot_accel": turn or max(own["rot_accel"], own["rot_decel"]),
    }
    tops |= {"trans_decel": tops["trans_accel"], "rot_decel": tops["rot_accel"]}
    return tuple(
        replace(each, high=top, default=min(each.default, top))
        if (top := tops.get(each.name)) is not None
        else each
        for each in PARAMETERS
    )


def by_name(raw: Mapping[str, object]) -> dict[str, object]:
    """Return the values in `raw`, which may have either name, by RosAria's names."""
    found = {}
    for each in PARAMETERS:
        for name in (each.standard, each.name):
            if name is not None and name in raw:
                found[each.name] = raw[name]
    return found


def own_values(limits: Limits) -> dict[str, float]:
    """Return the values before anybody has set one."""
    known = {name: getattr(limits, field) for name, field in ACCELERATIONS.items()}
    return {each.name: known.get(each.name, each.default) for each in PARAMETERS}


def within_bounds(
    wanted: Mapping[str, object],
    limits: Limits,
    parameters: Sequence[DrivingParameter] = PARAMETERS,
) -> dict[str, float]:
    """Return `wanted` within the bounds of `parameters`; where it says 0, the robot's own `limits`.

    Raises:
        ConfigError: something is not a finite number.
    """
    own = own_values(limits)
    inside = {each.name: each.bounded(wanted.get(each.name, 0)) for each in parameters}
    inside["lat_accel"] = inside["lat_decel"] = 0.0
    for name in ACCELERATIONS:
        least = min(BRAKES.get(name, 0.0), own[name])
        inside[name] = max(inside[name], least) if inside[name] else own[name]
    return inside


def changed(limits: Limits, values: Values) -> Limits:
    """Return `limits` with the accelerations of `values`."""
    return replace(limits, **{field: values[name] for name, field in ACCELERATIONS.items()})


def to_send(values: Values) -> list[Command]:
    """Return the commands that tell the robot of its wheels; none for values that are its own."""
    told = {each.name: each.known(values[each.name]) for each in PARAMETERS if each.whole}
    return [COMMANDS[name](int(value)) for name, value in told.items() if value is not None]


class DrivingParameters:
    """The values of the parameters of one robot.

    Args:
        limits: The robot's own.
        config: The robot's report of itself, if it has sent one.
        raw: Parameters that somebody has written below the node's name.
        apply: Given all values whenever one has been set; by the thread that set it.

    Attributes:
        parameters: With the bounds of this robot.
        before: The values that were written before the node began, by name.
        wanted: Those to begin with, once somebody calls :meth:`set`.
        values: In force.

    Raises:
        ConfigError: one in `raw` is not a number.
    """

    def __init__(
        self,
        limits: Limits,
        config: Config | None,
        raw: Mapping[str, object],
        apply: Callable[[Values], None],
    ) -> None:
        self.parameters = parameters_of(limits, config)
        self.before = {each.name: raw[each.name] for each in PARAMETERS if each.name in raw}
        self.values = own_values(limits)
        self.wanted = within_bounds({**self.values, **by_name(raw)}, limits, self.parameters)
        self._limits = limits
        self._apply = apply
        self._lock = threading.Lock()

    def set(self, wanted: Mapping[str, object]) -> dict[str, float]:
        """Take new values; return those in force now.

        Raises:
            ConfigError: something is not a finite number; nothing changes.
        """
        with self._lock:
            values = within_bounds(wanted, self._limits, self.parameters)
            if values != self.values:
                self.values = values
                self._apply(values)
            return values
