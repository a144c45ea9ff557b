"""What a P3-AT hears of people and walls, one transducer every 40 ms; exact, without noise."""

from dataclasses import dataclass, field, replace
from math import inf, radians

import numpy as np

from pioneer3.behaviors.action import Situation
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.sim.raycast import cast_reference
from pioneer3.sim.worldfile import Person
from pioneer3.state import LinkQuality, Sonar
from tests.unit.behaviors.support import P3AT, seen

BEAM = np.radians(np.linspace(-15, 15, 31))
Point = tuple[float, float]


@dataclass
class Scene:
    """A robot, people and walls; the front eight fire in turn.

    Attributes:
        people: Where their middles are [m].
        walls: From where to where [m].
        pose: Of the robot.
        now: [s]
    """

    people: list[Point] = field(default_factory=list)
    walls: list[tuple[float, float, float, float]] = field(default_factory=list)
    pose: Pose2 = ORIGIN
    now: float = 0.0
    session: int = 1
    _sequence: int = 0
    _shots: int = 0
    _ranges: list[float] = field(default_factory=lambda: [inf] * len(P3AT.sonars))

    def report(self) -> Situation:
        """Let 0.1 s pass; return the situation then."""
        self.now = round(self.now + 0.1, 3)
        self._sequence += 1
        shots = range(self._shots, int(self.now / 0.04 + 1e-6))
        self._shots = shots.stop
        fresh = tuple(sorted({shot % 8 for shot in shots}))
        for number in fresh:
            self._ranges[number] = self.range(number)
        sonar = Sonar(ranges=tuple(self._ranges), fresh=fresh, enabled=True)
        place = seen(self.now, pose=self.pose, sequence=self._sequence)
        link = LinkQuality(sessions=self.session)
        return replace(place, snapshot=replace(place.snapshot, sonar=sonar, link=link))

    def range(self, number: int) -> float:
        """Return what a transducer hears [m]; `inf` for nothing."""
        mount = P3AT.sonars[number]
        at = self.pose @ Pose2(mount.x, mount.y, mount.theta)
        outlines = [Person(path=(person,)).outline_at(0.0) for person in self.people]
        walls = np.concatenate([np.array(self.walls).reshape(-1, 4), *outlines])
        ranges = cast_reference(np.array([at.x, at.y]), at.theta + BEAM, walls, 5.0)
        nearest = float(ranges.min())
        return nearest if nearest < 5.0 else inf


def ahead(distance: float, degrees: float = 0.0) -> Point:
    """Return the middle of somebody so far from the front end of a P3-AT at the origin [m]."""
    there = Pose2(theta=radians(degrees)) @ Pose2(P3AT.length_front + distance + 0.25)
    return there.x, there.y
