"""Tracks a person by the echoes of sonars: position and velocity, filtered."""

from collections.abc import Sequence
from math import asin, copysign, cos, hypot, inf, radians, sin, sqrt

from pioneer3.behaviors.detection import RADIUS, ClutterMap
from pioneer3.behaviors.pings import HALF_BEAM, RING, Ping

WANDERS = 0.5
"""Change of the velocity of a person who walks, turns and stops, in 1 s [m/s]."""
UNSURE_SPEED = 0.3
"""Standard deviation of the speed of a person who has just been seen [m/s]."""
FASTEST = 0.8
"""Highest speed of a person who is followed [m/s]."""


class KalmanFilter:
    """Position and velocity of a person who walks with nearly constant velocity.

    The state is (x, y, vx, vy), `spread` its covariance, shape (4, 4), in SI units, in odometry's
    frame. A measurement is the position along some direction, so no matrix need be inverted.
    """

    def __init__(self, x: float, y: float, stamp: float, sigma: float) -> None:
        self.state = [x, y, 0.0, 0.0]
        self.stamp = stamp
        p, v = sigma**2, UNSURE_SPEED**2
        self.spread = [[p, 0, 0, 0], [0, p, 0, 0], [0, 0, v, 0], [0, 0, 0, v]]

    @property
    def position(self) -> tuple[float, float]:
        """At `stamp` [m]."""
        return self.state[0], self.state[1]

    @property
    def velocity(self) -> tuple[float, float]:
        """Along x and y [m/s]."""
        return self.state[2], self.state[3]

    def at(self, stamp: float) -> tuple[float, float]:
        """Return where they are expected at `stamp` [s], which may lie ahead."""
        dt = stamp - self.stamp
        return self.state[0] + dt * self.state[2], self.state[1] + dt * self.state[3]

    def advance(self, stamp: float) -> None:
        """Let time pass until `stamp` [s]."""
        dt = stamp - self.stamp
        if dt <= 0:
            return
        self.stamp, spread = stamp, self.spread
        for axis in (0, 1):
            self.state[axis] += dt * self.state[axis + 2]
            spread[axis] = [a + dt * b for a, b in zip(spread[axis], spread[axis + 2], strict=True)]
        for axis in (0, 1):
            for row in spread:
                row[axis] += dt * row[axis + 2]
            noise = WANDERS**2 * dt
            spread[axis][axis] += noise * dt * dt / 3
            spread[axis][axis + 2] += noise * dt / 2
            spread[axis + 2][axis] += noise * dt / 2
            spread[axis + 2][axis + 2] += noise

    def variance(self, nx: float, ny: float) -> float:
        """Return the variance of the position along a unit vector [m^2]."""
        p = self.spread
        return nx * nx * p[0][0] + 2 * nx * ny * p[0][1] + ny * ny * p[1][1]

    def correct(self, nx: float, ny: float, error: float, sigma: float) -> None:
        """Take in that they are `error` [m] farther along a unit vector than expected.

        `sigma` [m] is the standard deviation of that measurement.
        """
        covariance = [nx * row[0] + ny * row[1] for row in self.spread]
        total = nx * covariance[0] + ny * covariance[1] + sigma**2
        gain = [c / total for c in covariance]
        self.state = [s + g * error for s, g in zip(self.state, gain, strict=True)]
        self.spread = [
            [p - g * c for p, c in zip(row, covariance, strict=True)]
            for row, g in zip(self.spread, gain, strict=True)
        ]
        speed = hypot(*self.velocity)
        if speed > FASTEST:
            self.state[2:] = [part * FASTEST / speed for part in self.velocity]


RANGE_SIGMA = 0.06
"""Of the distance to the middle of a person, whose outline is no circle [m]."""
BLUR = radians(5)
"""A person so far beside the beam is measured half as well [rad]."""
MISS_SIGMA = radians(28)
"""Of the bearing of a person who is not heard [rad]."""
FACE_SIGMA = radians(8)
"""Of the bearing of a person whom several transducers hear [rad]."""
GATE = 2.5
"""Echoes that differ from the expectation by more standard deviations are another's."""
ALIKE = 0.18
"""Side by side, transducers whose ranges differ less hear the same person [m]."""
CORE = radians(12)
"""A person this near to the axis of a transducer is heard [rad]."""
OUT = radians(20)
"""A person who is not heard is so far from the axis [rad]."""
WALKED = 0.6
"""A track that has come this far walks [m]; noise does not get that far."""


class Track:
    """A person, tracked by sonar.

    An echo says how far away they are and, roughly, in which direction; silence from where they are
    expected says that they are beside the beam.

    Attributes:
        estimate: Of their middle, in odometry's frame.
        heard: When their last echo came [s].
        found: When their first echo came [s].
        walked: Whether they have ever left the place where they were first heard.
        echoes: The last one of each transducer that has heard them, by its number.
    """

    def __init__(self, ping: Ping) -> None:
        reach = ping.distance + RADIUS
        x, y = ping.x + reach * cos(ping.axis), ping.y + reach * sin(ping.axis)
        self.estimate = KalmanFilter(x, y, ping.stamp, sigma=0.15)
        self.heard = self.found = ping.stamp
        self.walked = False
        self.echoes = {ping.number: ping}
        self._first = x, y

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
        if hypot(x - self._first[0], y - self._first[1]) > WALKED:
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
        return beside and abs(ping.distance - min(e.distance for e in recent)) < ALIKE

    def _recent(self, stamp: float) -> list[Ping]:
        return [echo for echo in self.echoes.values() if stamp - echo.stamp <= RING]

    def _is_furniture(self, ping: Ping, clutter: ClutterMap) -> bool:
        longer = ping.distance - expected_range(*ping.seen(*self.estimate.position))
        return abs(longer) > 1.5 * abs(clutter.explains(ping)) + 0.05

    def _take(self, ping: Ping) -> None:
        self.heard = ping.stamp
        self.echoes[ping.number] = ping
        away, off = ping.seen(*self.estimate.position)
        nx, ny = cos(ping.axis + off), sin(ping.axis + off)
        longer = ping.distance - expected_range(away, off)
        self.estimate.correct(nx, ny, longer, RANGE_SIGMA * (1 + _outside(off) / BLUR))

    def _face(self) -> None:
        """Take in that they are amid the transducers that have heard them in this turn of the ring.

        All of these at once: one after the other, they would pull them to and fro.
        """
        recent = self._recent(self.heard)
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
