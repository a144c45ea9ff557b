"""What is around the robot, as its range sensors see it and have seen it."""

from collections.abc import Sequence
from math import atan2, cos, hypot, inf, sin
from typing import NamedTuple

from pioneer3.geometry import TURN, Pose2


class Echo(NamedTuple):
    """The nearest point of a query: distance from the robot's centre [m], bearing [rad].

    `distance` is `inf` where there is none.
    """

    distance: float
    bearing: float = 0.0

    def __bool__(self) -> bool:
        """Whether there is one."""
        return self.distance < inf


SILENCE = Echo(inf)


class Point(NamedTuple):
    """Something that sent an echo, in the robot's frame: x forward, y left [m]; polar [m, rad]."""

    x: float
    y: float
    distance: float
    bearing: float


class Surroundings:
    """Points around the robot at one instant.

    Args:
        pose: The robot's, in the frame of the points.
        current: Recent points in odometry's frame [m], (x, y) each.
        remembered: Older ones, too.
        sensing: Whether any range sensor works. Without one, nothing is known of what is near, and
            limiters let no one move.
    """

    def __init__(
        self,
        pose: Pose2,
        current: Sequence[tuple[float, float]] = (),
        remembered: Sequence[tuple[float, float]] = (),
        *,
        sensing: bool = True,
    ) -> None:
        self.sensing = sensing
        self._pose = pose
        self._given = (current, remembered)
        self._points: list[tuple[Point, ...] | None] = [None, None]

    def points(self, *, remembered: bool = False) -> tuple[Point, ...]:
        """Return all points, recent ones or those remembered (arcos.md 7.2)."""
        which = int(remembered)
        points = self._points[which]
        if points is None:
            points = self._points[which] = _seen_from(self._pose, self._given[which])
        return points

    def nearest(self, start: float, end: float, *, remembered: bool = False) -> Echo:
        """Return the nearest point between two bearings [rad], counter-clockwise from `start`.

        (-70 degrees, 70 degrees) is the front, (120, -120) the back (arcos.md 7.2).
        """
        span = min(end - start, TURN) if end > start else (end - start) % TURN
        best = SILENCE
        for _, _, distance, bearing in self.points(remembered=remembered):
            if distance < best.distance and (bearing - start) % TURN <= span:
                best = Echo(distance, bearing)
        return best

    def nearest_in_box(
        self, x1: float, y1: float, x2: float, y2: float, *, remembered: bool = False
    ) -> Echo:
        """Return the point nearest to the centre in a box [m], any two opposite corners given."""
        left, right = (x1, x2) if x1 <= x2 else (x2, x1)
        low, high = (y1, y2) if y1 <= y2 else (y2, y1)
        best = SILENCE
        for x, y, distance, bearing in self.points(remembered=remembered):
            if distance < best.distance and left <= x <= right and low <= y <= high:
                best = Echo(distance, bearing)
        return best


def _seen_from(pose: Pose2, points: Sequence[tuple[float, float]]) -> tuple[Point, ...]:
    c, s = cos(pose.theta), sin(pose.theta)
    seen = []
    for px, py in points:
        dx, dy = px - pose.x, py - pose.y
        x, y = c * dx + s * dy, c * dy - s * dx
        seen.append(Point(x, y, hypot(x, y), atan2(y, x)))
    return tuple(seen)


NOTHING_SENSED = Surroundings(Pose2(), sensing=False)
"""Of a robot without range sensors, or before their first reading."""
