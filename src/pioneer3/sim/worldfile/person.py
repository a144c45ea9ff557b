"""People who walk: their position is a function of time alone."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import atan2, cos, hypot, pi, sin
from typing import Annotated, NamedTuple

import numpy as np
from msgspec import Meta

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.sim.relief.shapes import Point

RADIUS = 0.25
"""Radius of a standing person with arms at the sides [m]."""
SPEED = 1.0
"""A slow walk [m/s]."""
CORNERS = 8
PATIENCE = 10.0
"""Nobody waits longer for a robot that does not move on [s]."""
STEP_TIME = 0.6
"""From one step to the next, at any speed [s] (docs/explanation/follow.md)."""


class _Leg(NamedTuple):
    """A pause, then a straight walk; times since the round began [s]."""

    start: Pose2
    leaves: float
    ends: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Person:
    """A person who walks along a path at constant speed, for ever, through everything.

    With one point [m] they stand still. Round a `loop` they go from the last point to the first,
    else back along the path, with a `pause` [s] at each point. After waiting for a robot for as
    long as their `patience` [s] they turn round. The outline is around a circle of the `radius`.
    """

    path: Annotated[
        tuple[Point, ...],
        Meta(min_length=1, extra={"expected": "a list of 1 or more points [x, y]"}),
    ]
    speed: Annotated[float, Meta(ge=0.01, le=10)] = SPEED
    radius: Annotated[float, Meta(ge=0.05, le=2)] = RADIUS
    loop: bool = True
    pause: Annotated[float, Meta(ge=0, le=3600)] = 0.0
    patience: Annotated[float, Meta(ge=0, le=1e9)] = PATIENCE
    name: str = ""
    _legs: tuple[_Leg, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Compute the timetable of a round."""
        object.__setattr__(self, "_legs", tuple(self._timetable()))

    def pose_at(self, time: float) -> Pose2:
        """Return the pose `time` [s] after the beginning, facing the direction of the walk.

        During a pause it already faces the next point; people turn at once.
        """
        if not self._legs:
            return Pose2(*self.path[0])
        leg, walks = self._leg_at(time)
        return leg.start @ Pose2(walks * self.speed)

    def stride_at(self, time: float) -> float:
        """Return how far the left foot is ahead of the middle [m]; the right one is as far behind.

        The foot on the ground stands still while the other one swings, twice as fast as the
        person walks. A walk begins and ends with the feet side by side.
        """
        if not self._legs:
            return 0.0
        leg, walks = self._leg_at(time)
        swing = 0.5 - abs((walks / STEP_TIME + 0.5) % 2 - 1)
        left = leg.ends - leg.leaves - walks
        return swing * self.speed * min(STEP_TIME, walks, left)

    def _leg_at(self, time: float) -> tuple[_Leg, float]:
        """Return the part of the way, and for how long they have been walking on it [s]."""
        within = time % self._legs[-1].ends
        leg = next((leg for leg in self._legs if within < leg.ends), self._legs[-1])
        return leg, max(0.0, within - leg.leaves)

    def outline_at(self, time: float) -> Float:
        """Return the octagon around them [m], shape (8, 4), for ray casting and collisions.

        It is drawn around the circle: its sides touch it, its corners lie 8 % further out.
        """
        pose = self.pose_at(time)
        outline: Float = _octagon(self.radius) + np.array((pose.x, pose.y, pose.x, pose.y))
        return outline

    def _timetable(self) -> Iterator[_Leg]:
        clock = 0.0
        for start, end in pairwise(self._round()):
            length = hypot(end[0] - start[0], end[1] - start[1])
            heading = atan2(end[1] - start[1], end[0] - start[0])
            leaves = clock + self.pause
            clock = leaves + length / self.speed
            yield _Leg(Pose2(*start, heading), leaves, clock)

    def _round(self) -> Sequence[Point]:
        """Return the points of a round, back to the first; repeated ones left out."""
        back = self.path[:1] if self.loop else self.path[-2::-1]
        points = self.path + back
        return [p for p, before in zip(points, (None, *points), strict=False) if p != before]


def _octagon(radius: float) -> Float:
    reach = radius / cos(pi / CORNERS)
    angles = [(2 * k + 1) * pi / CORNERS for k in range(CORNERS)]
    corners = [(reach * cos(angle), reach * sin(angle)) for angle in angles]
    after = corners[1:] + corners[:1]
    return np.array([(*a, *b) for a, b in zip(corners, after, strict=True)])
