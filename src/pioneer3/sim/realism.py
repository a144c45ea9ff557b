"""Errors of a simulated robot, as large as those of a real one; each part can be switched off.

The numbers are of the size that calibrated robots and ordinary rooms show; their sources are in
docs/explanation/realism.md.
"""

from dataclasses import astuple, dataclass, replace
from math import isfinite, pi, radians
from typing import Literal, get_args

import numpy as np
from numpy.random import Generator

from pioneer3.arrays import Float, Int
from pioneer3.errors import ConfigError
from pioneer3.models import RobotModel
from pioneer3.models.odometry import UNCORRECTED, true_of_measured
from pioneer3.sim.kernels import Grid, Reflectors, find_edges
from pioneer3.sim.kernels.drives import W_OF_V, W_OF_W

OdometryMode = Literal["none", "constant", "random_init", "random_each_update", "all"]
"""Source of the odometry's error.

`none`: it is right. `constant`: the wheels are as wrong as configured. `random_init`: each robot is
wrong in its own way, drawn once. `random_each_update`: nothing is systematic, not even slip; every
step adds a random error. `all`: the last two together. The names are MobileSim's (facts.md 14.5).
"""

MODES: tuple[str, ...] = get_args(OdometryMode)


def _within(name: str, value: float, low: float, high: float) -> None:
    if not (isfinite(value) and low <= value <= high):
        raise ConfigError(f"{name}: {value} is not between {low:g} and {high:g}")


@dataclass(frozen=True, slots=True, kw_only=True)
class OdometryErrors:
    """Errors of the odometry (Borenstein and Feng, UMBmark, 1995).

    Where each robot is wrong in its own way, the three ratios are bounds: a robot has something
    between one over it and it.

    Attributes:
        mode: Which of these count.
        wheel_ratio: Diameter of the right wheel over that of the left.
        base_ratio: Distance of the wheels over what the controller takes it for.
        scale: True way over measured way.
        way_noise: Standard deviation of the way per root of way [m^0.5].
        turn_noise: Of the turn per root of turn [rad^0.5].
        drift_noise: Of the heading per root of way [rad/m^0.5].
        slip: Share of a turn that the wheels of a skid-steered robot slip away.
    """

    mode: OdometryMode = "all"
    wheel_ratio: float = 1.002
    base_ratio: float = 1.01
    scale: float = 1.005
    way_noise: float = 0.004
    turn_noise: float = 0.01
    drift_noise: float = 0.008
    slip: float = 0.05

    def __post_init__(self) -> None:
        """Refuse impossible values, with the name of the field."""
        if self.mode not in MODES:
            raise ConfigError(f"odometry mode: {self.mode!r} is not one of {', '.join(MODES)}")
        for name in ("wheel_ratio", "base_ratio", "scale"):
            _within(name, getattr(self, name), 0.5, 2.0)
        for name in ("way_noise", "turn_noise", "drift_noise"):
            _within(name, getattr(self, name), 0.0, 1.0)
        _within("slip", self.slip, 0.0, 0.9)

    @property
    def of_wheels(self) -> "OdometryErrors":
        """Those of the wheels' sizes alone, without what slips by itself where there is mass."""
        return replace(self, way_noise=0.0, turn_noise=0.0, drift_noise=0.0, slip=0.0)

    def column(self, model: RobotModel, rng: Generator) -> Float:
        """Return a robot's column of `Drives.errors`, shape (7,).

        Where each robot is wrong in its own way, one that was measured has its model's `odometry`,
        which has its slip in it.
        """
        own = rng.uniform(-1, 1, 3)
        drawn = self.mode in {"random_init", "all"}
        part = own if drawn else np.ones(3) if self.mode == "constant" else np.zeros(3)
        wheel, base, scale = np.array([self.wheel_ratio, self.base_ratio, self.scale]) ** part
        slip = self.slip
        if drawn and model.odometry != UNCORRECTED:
            scale, base, wheel = astuple(model.odometry)
            slip = 0.0
        matrix = true_of_measured(scale, base, wheel, model.wheel_base)
        column = np.array([*matrix, self.way_noise, self.turn_noise, self.drift_noise])
        if model.drive == "skid" and part.any():
            column[W_OF_V : W_OF_W + 1] *= 1 - slip
        if self.mode not in {"all", "random_each_update"}:
            column[4:] = 0.0
        return column


@dataclass(frozen=True, slots=True, kw_only=True)
class SonarErrors:
    """Errors of the sonar.

    A flat wall is heard as far off the axis as half of `width` and `critical` together: 42 degrees
    unless set otherwise, as Cao and Borenstein (2002) measured with Polaroid transducers.

    Attributes:
        rays: That make up its beam; the nearest echo counts.
        width: Full angle of the beam [rad].
        critical: From this angle between a ray and the wall's normal on, no echo comes back [rad].
        edge_range: An edge or a corner of walls is heard from nearer than this [m], if it lies in
            the beam; 0 if never.
        noise: Standard deviation of a range, as a share of it.
        quantum: Ranges come in steps of this [m]; 0 for none.
        drop_out: Chance that an echo is missed.
        cross_talk: Chance that a transducer takes the echo of another for its own: of the one that
            fired before it in its array or, where all fire at once, of the one beside it.
        cycle: Time from one transducer of an array to the next [s]; 0 fires all at once, whenever
            they are asked.
    """

    rays: int = 5
    width: float = radians(30)
    critical: float = radians(27)
    edge_range: float = 1.0
    noise: float = 0.005
    quantum: float = 0.001
    drop_out: float = 0.005
    cross_talk: float = 0.005
    cycle: float = 0.04

    def __post_init__(self) -> None:
        """Refuse impossible values, with the name of the field."""
        if not 1 <= self.rays <= 99:
            raise ConfigError(f"sonar rays: {self.rays}, but it takes 1 to 99")
        _within("sonar width", self.width, 0.0, radians(120))
        _within("sonar critical angle", self.critical, radians(1), radians(90))
        _within("sonar edge_range", self.edge_range, 0.0, 5.0)
        for name in ("noise", "quantum", "drop_out", "cross_talk"):
            _within(f"sonar {name}", getattr(self, name), 0.0, 1.0)
        _within("sonar cycle", self.cycle, 0.0, 1.0)
        _within("sonar drop_out and cross_talk together", self.drop_out + self.cross_talk, 0.0, 1.0)

    def echoes(self, grid: Grid) -> Reflectors:
        """Return the walls and edges of a map that are heard."""
        return Reflectors(
            steep=float(np.cos(self.critical)) if self.critical < pi / 2 else 0.0,
            edges=find_edges(grid) if self.edge_range else None,
            edge_range=self.edge_range,
        )

    @property
    def spoils(self) -> bool:
        """Whether a reading ever differs from the exact range."""
        return any((self.cross_talk, self.drop_out, self.noise, self.quantum))

    def spoil(self, ranges: Float, limit: float, rng: Generator) -> Float:
        """Return the readings for exact `ranges` (..., M) if all fire together.

        Each transducer is mistaken for the one beside it. Ranges end at `limit` [m].
        """
        heard, fire = ranges.copy(), np.arange(ranges.shape[-1])
        before = abs(fire - 1) % max(1, len(fire))  # the first is beside the second
        self.mistake(heard, limit, rng, fire=fire, before=before)
        return self.blurred(heard, limit, rng)

    def blurred(self, ranges: Float, limit: float, rng: Generator) -> Float:
        """Return exact `ranges` of any shape as they are measured, up to `limit` [m]."""
        if self.noise:
            heard = rng.standard_normal(ranges.shape)
            heard *= self.noise
            heard += 1
            heard *= ranges
        else:
            heard = ranges.copy()
        if self.quantum:
            np.rint(np.multiply(heard, 1 / self.quantum, out=heard), out=heard)
            heard *= self.quantum
        heard[ranges >= limit] = limit
        return np.minimum(heard, limit, out=heard)

    def mistake(
        self, heard: Float, limit: float, rng: Generator, *, fire: Int, before: Int
    ) -> None:
        """Let some echoes in `heard` (..., M), up to `limit` [m], be missed or mistaken.

        The ranges are new of the transducers `fire` (F,), each of which may take the echo of the
        one in `before` (F,) for its own.
        """
        if not (self.cross_talk or self.drop_out):
            return
        chance = rng.random((*heard.shape[:-1], len(fire)))
        rare = (chance < self.cross_talk + self.drop_out).nonzero()
        if len(rare[0]):
            *robot, which = rare
            own, other = heard[*robot, fire[which]], heard[*robot, before[which]]
            missed = chance[rare] >= self.cross_talk
            heard[*robot, fire[which]] = np.where(missed, limit, np.minimum(own, other))


@dataclass(frozen=True, slots=True, kw_only=True)
class RangeFinderErrors:
    """Errors of laser range finders, as shares of those of their models.

    Attributes:
        systematic: Of the lasting error; each unit has something between minus and plus that.
        noise: Of the standard deviation of a reading.
        spot: Whether a reading looks at a spot rather than at a point: readings at edges then lie
            between two surfaces, and slanted surfaces are noisy and send less light back.
    """

    systematic: float = 1.0
    noise: float = 1.0
    spot: bool = True

    def __post_init__(self) -> None:
        """Refuse impossible values, with the name of the field."""
        for name in ("systematic", "noise"):
            _within(f"range finder {name}", getattr(self, name), 0.0, 10.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Realism:
    """All errors of a robot; `laser_noise` is the standard deviation of the in-band laser [m]."""

    odometry: OdometryErrors = OdometryErrors()
    sonar: SonarErrors = SonarErrors()
    range_finder: RangeFinderErrors = RangeFinderErrors()
    laser_noise: float = 0.005

    def __post_init__(self) -> None:
        """Refuse impossible noise of the laser."""
        _within("laser noise", self.laser_noise, 0.0, 1.0)

    @classmethod
    def ideal(cls) -> "Realism":
        """Return a robot without any error: one exact ray per sonar, wheels that never slip."""
        exact = SonarErrors(
            rays=1,
            width=0.0,
            critical=radians(90),
            edge_range=0.0,
            noise=0.0,
            quantum=0.0,
            drop_out=0.0,
            cross_talk=0.0,
            cycle=0.0,
        )
        return cls(
            odometry=OdometryErrors(mode="none", slip=0.0),
            sonar=exact,
            range_finder=RangeFinderErrors(systematic=0.0, noise=0.0, spot=False),
            laser_noise=0.0,
        )

    def with_odometry(self, mode: OdometryMode) -> "Realism":
        """Return the same with another source of odometry errors."""
        return replace(self, odometry=replace(self.odometry, mode=mode))
