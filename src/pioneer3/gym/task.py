"""The task of an environment: the map, the sensors, the reward."""

from dataclasses import dataclass
from math import inf, isfinite
from pathlib import Path
from typing import Literal, TypedDict, get_args

from pioneer3.errors import ConfigError
from pioneer3.maps import LineMap
from pioneer3.models import RobotModel
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile.spec import Physics

Sensors = Literal["sonar", "laser", "both"]

EPISODE = 500
"""The longest episode unless told otherwise [steps]."""
LONGEST_STEP = 1.0
"""The longest step [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reward:
    """The reward of a step is the sum of these.

    Attributes:
        progress: Per metre that the goal has come nearer, as the crow flies [1/m].
        arrival: Once, on reaching the goal.
        collision: Once, on running into something.
        time: Every step.
    """

    progress: float = 1.0
    arrival: float = 10.0
    collision: float = -10.0
    time: float = -0.01

    def __post_init__(self) -> None:
        """Refuse numbers that are not finite, naming the field."""
        for name in ("progress", "arrival", "collision", "time"):
            if not isfinite(getattr(self, name)):
                raise ConfigError(f"reward {name}: {getattr(self, name)} is not finite")


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """Drive to a goal in a map without running into anything.

    Attributes:
        map: A shipped map's name, a map file, or a map. A fence is put around it, 1 m beyond its
            walls.
        model: A robot model's name, its file, or a model.
        sensors: The sensors in an observation: `sonar`, `laser` or `both`.
        beams: Of the laser, spread evenly over the half circle ahead.
        laser_range: Farther than this the laser sees nothing [m].
        realism: How wrong wheels and sensors are; `None` is not at all.
        physics: How robots move: `planar`, or `mujoco` with mass, motors and tires. Then a robot
            has collided that has pushed against something for 0.3 s.
        dt: Of a step [s].
        goal_distance: Least and greatest distance of a goal from the start, as the crow flies [m].
        goal_radius: Nearer than this the goal is reached [m].
        threads: Number of threads for 50 robots and more; they pay only with numba.

    Raises:
        ConfigError: A number is out of range.
    """

    map: str | Path | LineMap = "office"
    model: str | Path | RobotModel = "p3dx-sh"
    sensors: Sensors = "sonar"
    beams: int = 61
    laser_range: float = 8.0
    realism: Realism | None = None
    physics: Physics = "planar"
    dt: float = 0.1
    goal_distance: tuple[float, float] = (1.0, inf)
    goal_radius: float = 0.3
    reward: Reward = Reward()
    threads: int = 1

    def __post_init__(self) -> None:
        """Refuse an impossible task, naming the field."""
        for name, choices in (("sensors", get_args(Sensors)), ("physics", get_args(Physics))):
            given = getattr(self, name)
            if given not in choices:
                raise ConfigError(f"{name}: {given!r} is not one of {', '.join(choices)}")
        if not 0 < self.dt <= LONGEST_STEP:
            raise ConfigError(f"dt: {self.dt} s is not between 0 and {LONGEST_STEP:g} s")
        if self.beams < 2 or self.threads < 1:
            raise ConfigError(
                f"beams: {self.beams}, threads: {self.threads}; it takes at least 2 beams, 1 thread"
            )
        if not 0 < self.laser_range < inf:
            raise ConfigError(f"laser_range: {self.laser_range} m is not positive and finite")
        least, greatest = self.goal_distance
        if not 0 < self.goal_radius < least <= greatest:
            raise ConfigError(
                f"goal_distance: {least:g} to {greatest:g} m; the least must be above goal_radius, "
                f"{self.goal_radius:g} m, and not above the greatest"
            )


class TaskOptions(TypedDict, total=False):
    """The fields of :class:`Task`, as keyword arguments of an environment."""

    map: str | Path | LineMap
    model: str | Path | RobotModel
    sensors: Sensors
    beams: int
    laser_range: float
    realism: Realism | None
    physics: Physics
    dt: float
    goal_distance: tuple[float, float]
    goal_radius: float
    reward: Reward
    threads: int
