"""Single firings of sonar transducers, placed in odometry's frame."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import atan2, cos, hypot, inf, isnan, radians, sin

from pioneer3.behaviors.action import Situation
from pioneer3.geometry import Pose2, wrap

RING = 0.36
"""In this time each transducer fires once, and some [s] (docs/explanation/realism.md)."""
HALF_BEAM = radians(15)
"""Half the opening angle of a transducer [rad]."""


@dataclass(frozen=True, slots=True)
class Ping:
    """The result of one firing: an echo from a point on an arc, or none.

    The transducer is at `x` and `y` in odometry's frame [m], and looks along `axis` there [rad];
    `distance` is the range [m], `inf` when nothing echoed.
    """

    number: int
    x: float
    y: float
    axis: float
    distance: float
    stamp: float

    @property
    def point(self) -> tuple[float, float]:
        """The middle of the arc, in odometry's frame [m]."""
        return self.x + self.distance * cos(self.axis), self.y + self.distance * sin(self.axis)

    def seen(self, x: float, y: float) -> tuple[float, float]:
        """Return how far a point is from the transducer [m], and how far off its axis [rad]."""
        dx, dy = x - self.x, y - self.y
        return hypot(dx, dy), wrap(atan2(dy, dx) - self.axis)


class PingReader:
    """Takes the fresh readings of each report, once.

    It has the `latest` firing of each transducer, by its number; the first one came at `since` [s].
    """

    def __init__(self) -> None:
        self.latest: dict[int, Ping] = {}
        self.since = inf
        self._pose: Pose2 | None = None
        self._sequence = self._session = -1

    def listen(self, situation: Situation) -> list[Ping]:
        """Return the pings since the last call."""
        snapshot = situation.snapshot
        if snapshot.sequence == self._sequence:
            return []
        if snapshot.link.sessions != self._session:
            self._pose, self.latest, self.since = None, {}, inf
        self._sequence, self._session = snapshot.sequence, snapshot.link.sessions
        between = _middle(self._pose or situation.pose, situation.pose)
        self._pose = situation.pose
        fresh = list(self._pings(situation, between))
        self.latest.update((ping.number, ping) for ping in fresh)
        if fresh:
            self.since = min(self.since, snapshot.stamp)
        return fresh

    def _pings(self, situation: Situation, pose: Pose2) -> Iterator[Ping]:
        sonar, mounts = situation.snapshot.sonar, situation.model.sonars
        for number in sonar.fresh:
            if number < len(mounts):
                mount, metres = mounts[number], sonar.ranges[number]
                at = pose @ Pose2(mount.x, mount.y, mount.theta)
                heard = inf if isnan(metres) else metres
                yield Ping(number, at.x, at.y, at.theta, heard, situation.snapshot.stamp)


def _middle(before: Pose2, after: Pose2) -> Pose2:
    """Return the pose halfway: transducers fire at any time between two reports."""
    return Pose2(
        (before.x + after.x) / 2,
        (before.y + after.y) / 2,
        wrap(before.theta + wrap(after.theta - before.theta) / 2),
    )
