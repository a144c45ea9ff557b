"""Robots whose laser and odometry err more than by default: the hard row of navigation."""

from bisect import bisect_right
from collections import deque
from dataclasses import dataclass, replace
from math import radians

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World
from tests.support import SimulatedRobot

Float = NDArray[np.float64]

KEPT = 20
"""Poses by odometry that are remembered."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Errors:
    """Errors beyond the default ones.

    Attributes:
        noise: Standard deviation of the laser's ranges [m].
        short: Share of its beams that meet nothing of the world.
        late: Age of the odometry that is reported [s].
        lasts: From the first reading of a scan to the last one [s].
        askew: The laser is mounted so much to the left of what is known [rad].
    """

    noise: float = 0.02
    short: float = 0.01
    late: float = 0.05
    lasts: float = 0.025
    askew: float = radians(2)


class LateBody(Body):
    """A robot that reports where it was by odometry a while ago."""

    def __init__(self, model: RobotModel, home: Pose2, late: float) -> None:
        self._late = late
        self._poses: deque[tuple[float, Pose2]] = deque(maxlen=KEPT)
        super().__init__(model, home)

    def note(self, now: float) -> None:
        """Remember the pose of `now` [s]."""
        self._poses.append((now, super().robot_in_odom))

    @property
    def robot_in_odom(self) -> Pose2:
        """Pose by odometry of a while ago [m, rad]."""
        if len(self._poses) < 2:
            return super().robot_in_odom
        due = self._poses[-1][0] - self._late
        after = bisect_right(self._poses, due, key=lambda each: each[0])
        after = min(max(after, 1), len(self._poses) - 1)
        (before, one), (then, other) = self._poses[after - 1], self._poses[after]
        share = min(max((due - before) / (then - before), 0.0), 1.0)
        step = one.inverse() @ other
        return one @ Pose2(share * step.x, share * step.y, share * step.theta)


class HardWorld(World):
    """A world whose lasers are mounted askew, take their time, and see things that are not there.

    The first readings of a scan are of the step before, as many as its duration has of a step.
    """

    def __init__(self, line_map: LineMap, body: LateBody, seed: int, errors: Errors) -> None:
        self._errors, self._chances = errors, np.random.default_rng((seed, 7))
        self._asked: tuple[Pose2, float, float, int] | None = None
        self._earlier: Float | None = None
        self._body, self._dt = body, 0.02
        realism = replace(Realism(), laser_noise=errors.noise)
        super().__init__(line_map, [body], Kernels(), seed=seed, realism=realism)

    def step(self, dt: float) -> None:
        """Let `dt` [s] pass."""
        if self._asked is not None:
            self._earlier = super().laser(self._body, *self._asked)
        self._dt = dt
        super().step(dt)
        self._body.note(self.time)

    def laser(self, body: Body, mount: Pose2, start: float, step: float, count: int) -> Float:
        """Return the ranges [m] of a scan whose last reading is now, shape (count,)."""
        errors, rng = self._errors, self._chances
        self._asked = mount @ Pose2(theta=errors.askew), start, step, count
        ranges = super().laser(body, *self._asked).copy()
        if self._earlier is not None and len(self._earlier) == count:
            old = round(count * max(0.0, 1 - self._dt / 2 / errors.lasts))
            ranges[:old] = self._earlier[:old]
        short = rng.random(count) < errors.short
        ranges[short] *= rng.random(int(short.sum()))
        return ranges


class HardRobot(SimulatedRobot):
    """A robot at the end of a cable, with all of :class:`Errors`."""

    def __init__(
        self, line_map: LineMap, *, home: Pose2, model: str, seed: int, errors: Errors
    ) -> None:
        super().__init__(line_map, home=home, model=model, seed=seed)
        body = LateBody(load_model(model), home, errors.late)
        self.body = body
        self.world = HardWorld(line_map, body, seed, errors)
        self.firmware = Firmware(self.world, self.body, equipment=self.equipment)
