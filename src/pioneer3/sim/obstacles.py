"""Boxes, and people on their paths: the things in a world that may move, beside robots."""

from collections.abc import Sequence
from dataclasses import replace
from math import hypot, pi, tan

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.kernels import Kernels, RobotArrays
from pioneer3.sim.worldfile import Box, Person

CUT = 1 - tan(pi / 8)
"""Share of half a side that cut corners take, to make a square a regular octagon."""
SHANK = 0.24
"""Radius of a lower leg, as a share of a person's radius."""
APART = 1.0
"""Distance of legs side by side, as a share of a person's radius."""
PERSON_HEIGHT = 1.7
"""[m]."""
POLITE = 0.15
"""Nearer to a robot nobody walks on towards it [m]."""


class Obstacle:
    """A box or a person in a world, as its `kind` says; a box of it can be moved."""

    def __init__(self, kind: Box | Person) -> None:
        self.kind = replace(kind, movable=True) if isinstance(kind, Box) else kind
        self._clock, self._waited, self._onward, self._shift = 0.0, 0.0, 1.0, (0.0, 0.0)
        self.pose = kind.pose if isinstance(kind, Box) else kind.pose_at(0.0)

    @property
    def name(self) -> str:
        """Name on the screen."""
        return self.kind.name

    @property
    def walks(self) -> bool:
        """Whether it moves by itself."""
        return isinstance(self.kind, Person) and len(set(self.kind.path)) > 1

    @property
    def sizes(self) -> tuple[float, float, float, float]:
        """From the pose to the front, to the rear, to either side; cut off the corners [m]."""
        if isinstance(self.kind, Box):
            length, width = self.kind.size
            return length / 2, length / 2, width / 2, 0.0
        radius = self.kind.radius
        return radius, radius, radius, radius * CUT

    @property
    def height(self) -> float:
        """Height of the whole [m]."""
        return self.kind.block.size[2] if isinstance(self.kind, Box) else PERSON_HEIGHT

    @property
    def legs(self) -> tuple[Pose2, ...]:
        """Legs of a person, the left one first; a box has none."""
        if isinstance(self.kind, Box):
            return ()
        ahead, aside = self.kind.stride_at(self._clock), self.kind.radius * APART / 2
        return self.pose @ Pose2(ahead, aside), self.pose @ Pose2(-ahead, -aside)

    @property
    def leg_sizes(self) -> tuple[float, float, float, float]:
        """Sizes of one leg, as `sizes` [m]."""
        radius = self.sizes[0] * SHANK
        return radius, radius, radius, radius * CUT

    def move(self, pose: Pose2) -> None:
        """Put it somewhere else; a person takes the whole path along."""
        if isinstance(self.kind, Person):
            path = self.kind.pose_at(self._clock)
            self._shift = pose.x - path.x, pose.y - path.y
        self.pose = pose

    def outline_at(self, pose: Pose2) -> Float:
        """Return its sides at `pose` [m], shape (S, 4)."""
        if isinstance(self.kind, Box):
            return replace(self.kind, pose=pose).outline
        return replace(self.kind, path=((pose.x, pose.y),)).outline_at(0.0)

    def walk(self, dt: float, bodies: Float) -> bool:
        """Let `dt` [s] pass; who meets a robot waits until it is gone, or turns round.

        `bodies` is `Robots.state` of the robots, (8, N). Return whether they moved.
        """
        person = self.kind
        if not isinstance(person, Person) or not self.walks:
            return False
        clock = self._clock + self._onward * dt
        ahead = person.pose_at(clock)
        theta = ahead.theta if self._onward > 0 else wrap(ahead.theta + pi)
        pose = Pose2(ahead.x + self._shift[0], ahead.y + self._shift[1], theta)
        if bodies.shape[1]:
            after = _gaps(pose, bodies)
            near = after < person.radius + POLITE
            if near.any() and (near & (after < _gaps(self.pose, bodies))).any():
                self._wait(dt, person.patience)
                return False
        self._clock, self._waited = clock, 0.0
        moved = hypot(pose.x - self.pose.x, pose.y - self.pose.y) > 0
        self.pose = pose
        return moved

    def _wait(self, dt: float, patience: float) -> None:
        self._waited += dt
        if self._waited > patience:
            self._onward, self._waited = -self._onward, 0.0


def at_laser_height(
    outlines: RobotArrays, obstacles: Sequence[Obstacle], kernels: Kernels
) -> RobotArrays:
    """Return the outlines that a laser meets: of people their legs, of all others the same.

    `outlines` are those of robots, then of `obstacles`, all placed; they are returned where nobody
    is. Otherwise left legs take the places of people, right legs come after all others, and robots
    keep their numbers.
    """
    first = len(outlines) - len(obstacles)
    people = [(first + n, o) for n, o in enumerate(obstacles) if isinstance(o.kind, Person)]
    if not people:
        return outlines
    state = np.concatenate([outlines.state, np.zeros((8, len(people)))], axis=1)
    for right, (left, person) in enumerate(people, len(outlines)):
        for number, leg in zip((left, right), person.legs, strict=True):
            state[:, number] = leg.x, leg.y, leg.theta, *person.leg_sizes, 0.0
    seen = RobotArrays(*state[3:7])
    seen.state[:] = state
    kernels.place(seen)
    return seen


def _gaps(pose: Pose2, bodies: Float) -> Float:
    """Return the distance [m] from a point to the rectangle of each robot, ghosts far, (N,)."""
    x, y, theta, front, rear, half, _, hidden = bodies
    c, s = np.cos(theta), np.sin(theta)
    dx, dy = pose.x - x, pose.y - y
    ahead = abs(c * dx + s * dy - (front - rear) / 2) - (front + rear) / 2
    left = abs(c * dy - s * dx) - half
    gaps: Float = np.hypot(ahead.clip(min=0), left.clip(min=0))
    gaps[hidden != 0] = np.inf
    return gaps
