"""What dynamic_reconfigure may change: RosAria's nine parameters, with bounds that hold."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Final

from pioneer3.arcos import commands
from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Config
from pioneer3.errors import ConfigError
from pioneer3.limits import Limits
from pioneer3.units import DEGREE, MM

Settings = Mapping[str, float]
"""Value of each parameter, by name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One number.

    Attributes:
        name: In RosAria.
        standard: Name of the parameter in today's packages, where there is one.
        low: Least value.
        high: Greatest value.
        default: As RosAria has it; for whole numbers it leaves the robot as it is.
        whole: Whether it is a whole number.
    """

    name: str
    standard: str | None = None
    low: float
    high: float
    default: float
    whole: bool = False
    description: str

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
    Parameter(
        name="trans_accel",
        standard="max_linear_acceleration",
        low=0.0,
        high=9.999,
        default=0.3,
        description="Acceleration [m/s^2]; 0 is the robot's own",
    ),
    Parameter(
        name="trans_decel",
        standard="max_linear_deceleration",
        low=0.0,
        high=9.999,
        default=0.3,
        description="Deceleration [m/s^2]; 0 is the robot's own",
    ),
    Parameter(
        name="lat_accel",
        low=0.0,
        high=0.0001,
        default=0.0,
        description="No Pioneer drives sideways",
    ),
    Parameter(
        name="lat_decel",
        low=0.0,
        high=0.0001,
        default=0.0,
        description="No Pioneer drives sideways",
    ),
    Parameter(
        name="rot_accel",
        standard="max_angular_acceleration",
        low=0.0,
        high=174.5,
        default=1.745,
        description="Acceleration of turning [rad/s^2]; 0 is the robot's own",
    ),
    Parameter(
        name="rot_decel",
        standard="max_angular_deceleration",
        low=0.0,
        high=174.5,
        default=1.745,
        description="Deceleration of turning [rad/s^2]; 0 is the robot's own",
    ),
    Parameter(
        name="TicksMM",
        standard="ticks_mm",
        low=0,
        high=200,
        default=0,
        whole=True,
        description="Encoder ticks per mm; 0 is the robot's own",
    ),
    Parameter(
        name="DriftFactor",
        standard="drift_factor",
        low=-99999,
        high=32767,
        default=-99999,
        whole=True,
        description="Correction of the left encoder [1/8192]; -99999 is the robot's own",
    ),
    Parameter(
        name="RevCount",
        standard="rev_count",
        low=0,
        high=65535,
        default=0,
        whole=True,
        description="Encoder ticks of half a turn; 0 is the robot's own",
    ),
)
NAMES: Final = tuple(name for each in PARAMETERS for name in (each.name, each.standard) if name)
"""All that they are called."""
ACCELERATIONS: Final = {
    "trans_accel": "acceleration",
    "trans_decel": "deceleration",
    "rot_accel": "turn_acceleration",
    "rot_decel": "turn_deceleration",
}
"""Which of the driver's limits each one is."""
BRAKES: Final = {"trans_decel": 0.3, "rot_decel": 1.745}
"""What every stop needs at least, whoever is on the master: as firmware is delivered."""
LEAST_DRIFT: Final = -32768
"""What the command can carry; all below means the robot's own."""


def parameters_of(limits: Limits, config: Config | None) -> tuple[Parameter, ...]:
    """Return the parameters for a robot: nothing beyond the accelerations that it can do.

    They are what its CONFIG says; where that is missing, what it is driven with.
    """
    own = in_force(limits)
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


def written(given: Mapping[str, object]) -> dict[str, object]:
    """Return what `given`, by either name, says of each parameter that is in it."""
    found = {}
    for each in PARAMETERS:
        for name in (each.standard, each.name):
            if name is not None and name in given:
                found[each.name] = given[name]
    return found


def in_force(limits: Limits) -> dict[str, float]:
    """Return what holds before anybody has set anything."""
    known = {name: getattr(limits, field) for name, field in ACCELERATIONS.items()}
    return {each.name: known.get(each.name, each.default) for each in PARAMETERS}


def settled(
    wanted: Mapping[str, object], limits: Limits, parameters: Sequence[Parameter] = PARAMETERS
) -> dict[str, float]:
    """Return `wanted` within the bounds of `parameters`; where it says 0, the robot's own `limits`.

    Raises:
        ConfigError: something is not a finite number.
    """
    own = in_force(limits)
    inside = {each.name: each.bounded(wanted.get(each.name, 0)) for each in parameters}
    inside["lat_accel"] = inside["lat_decel"] = 0.0
    for name in ACCELERATIONS:
        least = min(BRAKES.get(name, 0.0), own[name])
        inside[name] = max(inside[name], least) if inside[name] else own[name]
    return inside


def changed(limits: Limits, settings: Settings) -> Limits:
    """Return `limits` with the accelerations of `settings`."""
    return replace(limits, **{field: settings[name] for name, field in ACCELERATIONS.items()})


def to_send(settings: Settings) -> list[Command]:
    """Return the commands that tell the robot of its wheels; none for what is its own."""
    sent: list[Command] = []
    if settings["TicksMM"] > 0:
        sent.append(commands.TicksMM(ticks_per_mm=int(settings["TicksMM"])))
    if settings["DriftFactor"] >= LEAST_DRIFT:
        sent.append(commands.DriftFactor(correction=int(settings["DriftFactor"])))
    if settings["RevCount"] > 0:
        sent.append(commands.RevCount(ticks=int(settings["RevCount"])))
    return sent
