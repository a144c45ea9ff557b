"""How a differential drive answers its commands: ramps, trapezoids, arcs. Knows no walls."""

from dataclasses import dataclass
from math import copysign, sqrt

from pioneer3.geometry import Pose2, arc

SUBSTEP = 0.02
"""Longest piece of a step along which the path is taken as one arc [s]."""
ARRIVED = 1e-4
"""A distance with less than this left to go is done [m or rad]."""
HARDEST = 4.0
"""Deceleration of wheels that brake with all they have [m/s^2]."""
HARDEST_TURN = 16.0
"""The same, turning [rad/s^2]."""


@dataclass(slots=True)
class Axis:
    """One velocity with its ramp: metres or radians alike.

    Attributes:
        acceleration: Away from zero [1/s^2], positive.
        deceleration: Towards zero [1/s^2], positive.
        top: Highest speed [1/s].
        velocity: Now [1/s].
        target: Wanted [1/s].
        remaining: Way left of a commanded distance, or `None` in velocity mode.
    """

    acceleration: float
    deceleration: float
    top: float
    velocity: float = 0.0
    target: float = 0.0
    remaining: float | None = None

    def go(self, velocity: float) -> None:
        """Hold `velocity`, at most :attr:`top`."""
        self.target, self.remaining = velocity, None

    def travel(self, distance: float) -> None:
        """Cover `distance` and stand: a trapezoid."""
        self.target, self.remaining = 0.0, distance

    def step(self, dt: float, *, held: bool = False, deceleration: float | None = None) -> float:
        """Advance by `dt` [s]; return the way covered.

        Args:
            dt: [s].
            held: Brake to a stand without forgetting what was commanded.
            deceleration: In place of the own one.
        """
        brake = deceleration or self.deceleration
        if self.remaining is None or held:
            return self._ramp(0.0 if held else self._clip(self.target), brake, dt)
        left = abs(self.remaining)
        speed = min(self.top, sqrt(2 * brake * max(0.0, left - abs(self.velocity) * dt / 2)))
        way = self._ramp(copysign(speed, self.remaining), brake, dt)
        after = copysign(1.0, self.remaining) * (self.remaining - way)
        if after > ARRIVED:
            self.remaining -= way
            return way
        way = self.remaining
        self.go(0.0)
        self.velocity = 0.0
        return way

    def _clip(self, velocity: float) -> float:
        return max(-self.top, min(self.top, velocity))

    def _ramp(self, goal: float, brake: float, dt: float) -> float:
        """Approach `goal`: towards zero with `brake`, away from it with the acceleration."""
        way = 0.0
        while dt > 0:
            v = self.velocity
            if v * goal < 0 or abs(goal) < abs(v):
                end, rate = (0.0 if v * goal < 0 else goal), brake
            else:
                end, rate = goal, self.acceleration
            time = min(dt, abs(end - v) / rate) if rate > 0 else 0.0
            if end == v or time == 0.0:
                self.velocity = end
                return way + end * dt if end == goal else way
            new = end if time < dt else v + copysign(rate * time, end - v)
            way += (v + new) / 2 * time
            self.velocity = new
            dt -= time
        return way


@dataclass(slots=True)
class Drive:
    """Two axes and the motors' power.

    Attributes:
        powered: Motors on. Without power commands are ignored, and the wheels brake.
        held: The watchdog holds the robot; the commands are kept.
        braking: An emergency stop is under way; commands are ignored until the robot stands.
    """

    linear: Axis
    angular: Axis
    powered: bool = False
    held: bool = False
    braking: bool = False

    @property
    def obeys(self) -> bool:
        """Whether motion commands have an effect."""
        return self.powered and not self.braking

    def stop(self) -> None:
        """Decelerate both axes to a stand; forget what was commanded."""
        self.linear.go(0.0)
        self.angular.go(0.0)

    def emergency_stop(self) -> None:
        """Brake as hard as the wheels can."""
        self.stop()
        self.braking = any((self.linear.velocity, self.angular.velocity))

    def power(self, *, on: bool) -> None:
        """Switch the motors."""
        self.powered = on
        if not on:
            self.stop()

    def halt(self) -> None:
        """Stand at once: something is in the way."""
        for axis in (self.linear, self.angular):
            axis.velocity = 0.0

    def step(self, dt: float) -> Pose2:
        """Advance by `dt` <= :data:`SUBSTEP` [s]; return the motion in the robot's frame."""
        hard = self.braking or not self.powered
        distance = self.linear.step(dt, held=self.held, deceleration=HARDEST if hard else None)
        angle = self.angular.step(dt, held=self.held, deceleration=HARDEST_TURN if hard else None)
        if self.braking and self.linear.velocity == self.angular.velocity == 0.0:
            self.braking = False
        return arc(distance / dt, angle / dt, dt)

    @property
    def moves(self) -> bool:
        """Whether anything turns, or is about to."""
        wanted = (self.linear.target, self.angular.target) if self.powered else (0.0, 0.0)
        moving = (self.linear.velocity, self.angular.velocity)
        left = (self.linear.remaining, self.angular.remaining)
        return any(moving) or any(wanted) or any(x is not None for x in left)
