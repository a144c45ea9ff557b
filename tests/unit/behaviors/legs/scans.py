"""Scans of people on two legs, of walls and posts; exact, without noise."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import cos, inf, pi, radians, sin

import numpy as np

from pioneer3.behaviors.action import Situation
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.sim.raycast import cast_reference
from pioneer3.state import Scan
from tests.unit.behaviors.support import seen

Point = tuple[float, float]
Wall = tuple[float, float, float, float]
LEG = 0.06
"""Radius [m]."""
SIDES = 16


@dataclass
class Room:
    """A robot with a laser in its middle, people and walls.

    Attributes:
        people: Where they are, and which way they face [m, rad].
        posts: Round, with a radius: x, y, radius [m].
        walls: From where to where [m].
        pose: Of the robot.
        now: [s]
        beams: Of a scan.
        view: From its first beam to the last [rad].
    """

    people: list[Pose2] = field(default_factory=list)
    posts: list[tuple[float, float, float]] = field(default_factory=list)
    walls: list[Wall] = field(default_factory=list)
    pose: Pose2 = ORIGIN
    now: float = 0.0
    beams: int = 361
    view: float = pi
    _sequence: int = 0

    def scan(self, seconds: float = 0.1) -> Scan:
        """Let so much time pass; return the scan then."""
        self.now = round(self.now + seconds, 3)
        self._sequence += 1
        angles = np.linspace(-self.view / 2, self.view / 2, self.beams)
        walls = np.array([*self.walls, *self._outlines()]).reshape(-1, 4)
        origin = np.array([self.pose.x, self.pose.y])
        ranges = cast_reference(origin, self.pose.theta + angles, walls, 30.0)
        return Scan(
            stamp=self.now,
            sequence=self._sequence,
            robot_in_odom=self.pose,
            sensor_in_robot=ORIGIN,
            angles=tuple(float(a) for a in angles),
            ranges=tuple(float(r) if r < 30.0 else inf for r in ranges),
        )

    def report(self, seconds: float = 0.1) -> Situation:
        """Let so much time pass; return the situation then, with a scan."""
        scan = self.scan(seconds)
        return replace(seen(self.now, pose=self.pose, sequence=self._sequence), scan=scan)

    def _outlines(self) -> list[Wall]:
        legs = [person @ Pose2(0.0, side) for person in self.people for side in (0.125, -0.125)]
        rounds = [(leg.x, leg.y, LEG) for leg in legs] + self.posts
        return [wall for x, y, radius in rounds for wall in _circle(x, y, radius)]


def spoiled(scan: Scan, ranges: Sequence[float]) -> Scan:
    """Return a scan with other ranges."""
    return replace(scan, ranges=tuple(ranges))


def _circle(x: float, y: float, radius: float) -> list[Wall]:
    angles = [radians(360 / SIDES * k) for k in range(SIDES + 1)]
    corners = [(x + radius * cos(a), y + radius * sin(a)) for a in angles]
    return [(*a, *b) for a, b in pairwise(corners)]
