"""The track of a person by the echoes of sonars."""

from collections.abc import Sequence
from math import asin, copysign, cos, hypot, inf, radians, sin, sqrt
from typing import Self

from pioneer3.behaviors.detection import RADIUS, ClutterMap
from pioneer3.behaviors.kalman import KalmanFilter
from pioneer3.behaviors.pings import HALF_BEAM, RING, Ping

RANGE_SIGMA = 0.06
"""Standard deviation of the distance to the middle of a person, whose outline is no circle [m]."""
BLUR = radians(5)
"""A person so far beside the beam is measured half as well [rad]."""
MISS_SIGMA = radians(28)
"""Standard deviation of the bearing of a person who is not heard [rad]."""
FACE_SIGMA = radians(8)
"""Standard deviation of the bearing of a person whom several transducers hear [rad]."""
GATE = 2.5
"""Echoes that differ from the expectation by more standard deviations are another's."""
ALIKE_RANGES = 0.18
"""Difference of the ranges of transducers side by side that hear the same person [m]."""
CORE = radians(12)
"""A person this near to the axis of a transducer is heard [rad]."""
OUT = radians(20)
"""A person who is not heard is so far from the axis [rad]."""
WALKS_FROM = 0.6
"""Way from which on a track walks [m]; noise does not get that far."""


class Track:
    """A person, tracked by sonar.

    An echo says how far away they are and, roughly, in which direction; silence from where they are
    expected says that they are beside the beam.

    Attributes:
        estimate: Of their middle, in odometry's frame.
        walked: Whether they have ever left the place where they were first heard.
        echoes: The last one of each transducer that has heard them, by its number.
    """

    def __init__(self, estimate: KalmanFilter, now: float, *, walked: bool = False) -> None:
        self.estimate = estimate
        self.seen = self.found = now
        self.walked = walked
        self.echoes: dict[int, Ping] = {}
        self._first = estimate.position

    @classmethod
    def from_ping(cls, ping: Ping) -> Self:
        """Return the track of a person whose first echo is `ping`."""
        reach = ping.distance + RADIUS
        x, y = ping.x + reach * cos(ping.axis), ping.y + reach * sin(ping.axis)
        track = cls(KalmanFilter(x, y, ping.stamp, sigma=0.15), ping.stamp)
        track.echoes[ping.number] = ping
        return track

    def hear(self, pings: Sequence[Ping], clutter: ClutterMap) -> list[Ping]:
        """Take in those echoes that are theirs; return the others."""
        if pings:
            self.estimate.advance(pings[0].stamp)
        others = []
        for ping in sorted(pings, key=self.differs):
            theirs = self.differs(ping) < GATE or self._continues(ping)
            if theirs and not self._is_furniture(ping, clutter):
                self._take(ping)
            else:
                self._miss(ping)
                others.append(ping)
        if len(others) < len(pings):
            self._face()
        x, y = self.estimate.position
        if hypot(x - self._first[0], y - self._first[1]) > WALKS_FROM:
            self.walked = True
        return others

    def differs(self, ping: Ping) -> float:
        """Return how unlike them an echo is, in standard deviations; `inf` if it cannot be theirs.

        Its bearing counts little as long as the beam and they are wide enough to meet.
        """
        if ping.distance == inf:
            return inf
        away, off = ping.seen(*self.estimate.position)
        nx, ny = cos(ping.axis + off), sin(ping.axis + off)
        wide = asin(RADIUS / max(away, RADIUS))
        along = self.estimate.variance(nx, ny) + RANGE_SIGMA**2
        doubt = self.estimate.variance(-ny, nx) / max(away, RADIUS) ** 2
        if _outside(off) > wide + sqrt(doubt):
            return inf
        longer = ping.distance - expected_range(away, off)
        return sqrt(longer**2 / along + off**2 / (doubt + ((HALF_BEAM + wide) / 2) ** 2))

    def _continues(self, ping: Ping) -> bool:
        """Return whether a transducer hears them beside one that does, hardly farther away."""
        recent = self._recent(ping.stamp)
        beside = any(abs(echo.number - ping.number) == 1 for echo in recent)
        return beside and abs(ping.distance - min(e.distance for e in recent)) < ALIKE_RANGES

    def _recent(self, stamp: float) -> list[Ping]:
        return [echo for echo in self.echoes.values() if stamp - echo.stamp <= RING]

    def _is_furniture(self, ping: Ping, clutter: ClutterMap) -> bool:
        longer = ping.distance - expected_range(*ping.seen(*self.estimate.position))
        return abs(longer) > 1.5 * abs(clutter.explains(ping)) + 0.05

    def _take(self, ping: Ping) -> None:
        self.seen = ping.stamp
        self.echoes[ping.number] = ping
        away, off = ping.seen(*self.estimate.position)
        nx, ny = cos(ping.axis + off), sin(ping.axis + off)
        longer = ping.distance - expected_range(away, off)
        self.estimate.correct(nx, ny, longer, RANGE_SIGMA * (1 + _outside(off) / BLUR))

    def _face(self) -> None:
        """Take in that they are amid the transducers that have heard them in this turn of the ring.

        All of these at once: one after the other, they would pull them to and fro.
        """
        recent = self._recent(self.seen)
        off = sum(p.seen(*self.estimate.at(p.stamp))[1] for p in recent) / len(recent)
        last = max(recent, key=lambda p: p.stamp)
        away, aside = last.seen(*self.estimate.position)
        nx, ny = cos(last.axis + aside), sin(last.axis + aside)
        self.estimate.correct(-ny, nx, -away * sin(off), away * FACE_SIGMA)

    def _miss(self, ping: Ping) -> None:
        """Take in that a transducer hears past where they are expected."""
        away, off = ping.seen(*self.estimate.position)
        if abs(off) < CORE and ping.distance > away + RADIUS and RADIUS < away < 2:
            nx, ny = cos(ping.axis + off), sin(ping.axis + off)
            aside = away * (copysign(OUT, off) - off)
            self.estimate.correct(-ny, nx, aside, away * MISS_SIGMA)


def expected_range(away: float, off: float) -> float:
    """Return the range of a round person whose middle is `away` [m] and `off` the axis [rad].

    A person beside the beam is met by its edge, which is farther away than their nearest point. No
    beam has a sharp edge, so it is taken to reach half as far out again as they are.
    """
    outside = _outside(off) / 2
    across = min(away * sin(outside), RADIUS)
    return away * cos(outside) - sqrt(RADIUS * RADIUS - across * across)


def _outside(off: float) -> float:
    return max(0.0, abs(off) - HALF_BEAM)
