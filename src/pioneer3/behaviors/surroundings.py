"""What is around the robot, as its range sensors see it and have seen it."""

from collections.abc import Sequence
from enum import Enum
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


_POINT = Point._make
"""Half of the time of calling the class, and there are many."""


class Recall(Enum):
    """How far back a query looks (arcos.md 7.2).

    Sonars fire in turn and miss echoes, and new points push older ones out of what is recent: what
    has to be sure that something is there, such as a limiter, asks for what was seen lately.
    """

    RECENT = 0
    """As ARIA's current buffers: the newest points of each sensor."""
    LATELY = 1
    """Everything seen in the last :data:`LATELY` seconds."""
    REMEMBERED = 2
    """As ARIA's cumulative buffers: older points, too, of what is near."""


LATELY = 2.0
"""Six rounds of a ring of sonars that fire in turn [s]."""


class Surroundings:
    """Points around the robot at one instant.

    Args:
        pose: The robot's, in the frame of the points.
        recent: Points in odometry's frame [m], (x, y) each.
        remembered: Older ones, too.
        lately: What was seen lately; what is recent if `None`.
        sensing: Whether any range sensor works. Without one, nothing is known of what is near, and
            limiters let no one move.
    """

    def __init__(
        self,
        pose: Pose2,
        recent: Sequence[tuple[float, float]] = (),
        remembered: Sequence[tuple[float, float]] = (),
        lately: Sequence[tuple[float, float]] | None = None,
        *,
        sensing: bool = True,
    ) -> None:
        self.sensing = sensing
        self._pose = pose
        self._given = {
            Recall.RECENT: recent,
            Recall.LATELY: recent if lately is None else lately,
            Recall.REMEMBERED: remembered,
        }
        self._points: dict[Recall, tuple[Point, ...]] = {}
        self._known: dict[tuple[float, float], Point] = {}

    def points(self, recall: Recall = Recall.RECENT) -> tuple[Point, ...]:
        """Return all points."""
        if recall not in self._points:
            self._points[recall] = _seen_from(self._pose, self._given[recall], self._known)
        return self._points[recall]

    def nearest(self, start: float, end: float, recall: Recall = Recall.RECENT) -> Echo:
        """Return the nearest point between two bearings [rad], counter-clockwise from `start`.

        (-70 degrees, 70 degrees) is the front, (120, -120) the back (arcos.md 7.2).
        """
        span = min(end - start, TURN) if end > start else (end - start) % TURN
        best = SILENCE
        for _, _, distance, bearing in self.points(recall):
            if distance < best.distance and (bearing - start) % TURN <= span:
                best = Echo(distance, bearing)
        return best

    def nearest_in_box(
        self, x1: float, y1: float, x2: float, y2: float, recall: Recall = Recall.RECENT
    ) -> Echo:
        """Return the point nearest to the centre in a box [m], any two opposite corners given."""
        left, right = (x1, x2) if x1 <= x2 else (x2, x1)
        low, high = (y1, y2) if y1 <= y2 else (y2, y1)
        best = SILENCE
        for x, y, distance, bearing in self.points(recall):
            if distance < best.distance and left <= x <= right and low <= y <= high:
                best = Echo(distance, bearing)
        return best


def _seen_from(
    pose: Pose2, points: Sequence[tuple[float, float]], known: dict[tuple[float, float], Point]
) -> tuple[Point, ...]:
    """Return points in the frame of `pose`; `known` holds those worked out before."""
    c, s, here_x, here_y = cos(pose.theta), sin(pose.theta), pose.x, pose.y
    for point in points:
        if point not in known:
            dx, dy = point[0] - here_x, point[1] - here_y
            x, y = c * dx + s * dy, c * dy - s * dx
            known[point] = _POINT((x, y, hypot(x, y), atan2(y, x)))
    return tuple([known[point] for point in points])


NOTHING_SENSED = Surroundings(Pose2(), sensing=False)
"""Of a robot without range sensors, or before their first reading."""
