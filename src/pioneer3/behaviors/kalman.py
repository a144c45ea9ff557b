"""The filter that estimates the position and the velocity of a person who walks."""

from math import hypot

WANDERS = 0.5
"""Change of the velocity of a person who walks, turns and stops, in 1 s [m/s]."""
UNSURE_SPEED = 0.3
"""Standard deviation of the speed of a person who has just been seen [m/s]."""
FASTEST_FOLLOWED = 0.8
"""Highest speed of a person who is followed [m/s]."""


class KalmanFilter:
    """Position and velocity of a person who walks with nearly constant velocity.

    The state is (x, y, vx, vy), `spread` its covariance, shape (4, 4), in SI units, in odometry's
    frame. A measurement is the position along some direction, so no matrix need be inverted.
    """

    def __init__(
        self, x: float, y: float, stamp: float, sigma: float, fastest: float = FASTEST_FOLLOWED
    ) -> None:
        self.fastest = fastest
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
        if speed > self.fastest:
            self.state[2:] = [part * self.fastest / speed for part in self.velocity]
