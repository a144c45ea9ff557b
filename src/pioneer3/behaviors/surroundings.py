"""Obstacles around the robot, as its range sensors see them and have seen them."""

from collections.abc import Sequence
from enum import Enum
from math import atan2, cos, hypot, inf, pi, radians, sin
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


NO_ECHO = Echo(inf)


class Point(NamedTuple):
    """Something that sent an echo, in the robot's frame: x forward, y left [m]; polar [m, rad]."""

    x: float
    y: float
    distance: float
    bearing: float


_POINT = Point._make
"""Half of the time of calling the class, and there are many."""


class Buffer(Enum):
    """The points that a query looks at (facts.md 7.2).

    Sonars fire in turn and miss echoes, and new points push older ones out of the current buffer:
    a limiter, which has to be sure of an obstacle, asks for the window.
    """

    CURRENT = 0
    """As ARIA's current buffers: the newest points of each sensor."""
    WINDOW = 1
    """All points of the last :data:`WINDOW` seconds."""
    CUMULATIVE = 2
    """As ARIA's cumulative buffers: older points, too, near the robot."""


WINDOW = 2.0
"""Six rounds of a ring of sonars that fire in turn [s]."""


class FieldOfView(NamedTuple):
    """Directions that a sensor sees, from `first` counter-clockwise to `last` [rad]."""

    first: float
    last: float

    def holds(self, bearing: float) -> bool:
        """Whether `bearing` [rad] lies in it."""
        return (bearing - self.first) % TURN <= self.last - self.first


EVERYWHERE = (FieldOfView(-pi, pi),)
BEARINGS_BEHIND = (radians(155), radians(165))
"""Bearings of which one is seen, and one on the right, where behind is seen: no sonar of an
AmigoBot looks nearer to straight back, and no laser of 270 degrees that looks ahead sees as far
round."""


class Surroundings:
    """Points around the robot at one instant, by buffer: (x, y, ...) in odometry's frame [m].

    Without a `window` it has the current ones. The `fields` are the directions in the robot's frame
    that range sensors see now.
    """

    def __init__(
        self,
        pose: Pose2,
        current: Sequence[tuple[float, ...]] = (),
        cumulative: Sequence[tuple[float, ...]] = (),
        window: Sequence[tuple[float, ...]] | None = None,
        *,
        fields: Sequence[FieldOfView] = EVERYWHERE,
    ) -> None:
        self._fields = fields
        self._pose = pose
        self._given = {
            Buffer.CURRENT: current,
            Buffer.WINDOW: current if window is None else window,
            Buffer.CUMULATIVE: cumulative,
        }
        self._points: dict[Buffer, tuple[Point, ...]] = {}
        self._known: dict[tuple[float, ...], Point] = {}

    @property
    def sensing(self) -> bool:
        """Whether any range sensor works.

        Without one, nothing is known of obstacles, and limiters allow no motion.
        """
        return bool(self._fields)

    @property
    def sees_behind(self) -> bool:
        """Whether range sensors look behind the robot, on both sides of straight back."""
        return self._sees_any(BEARINGS_BEHIND) and self._sees_any(
            [-bearing for bearing in BEARINGS_BEHIND]
        )

    def points(self, buffer: Buffer = Buffer.CURRENT) -> tuple[Point, ...]:
        """Return all points."""
        if buffer not in self._points:
            self._points[buffer] = _seen_from(self._pose, self._given[buffer], self._known)
        return self._points[buffer]

    def nearest(self, start: float, end: float, buffer: Buffer = Buffer.CURRENT) -> Echo:
        """Return the nearest point between two bearings [rad], counter-clockwise from `start`.

        (-70 degrees, 70 degrees) is the front, (120, -120) the back (facts.md 7.2).
        """
        span = min(end - start, TURN) if end > start else (end - start) % TURN
        best = NO_ECHO
        for _, _, distance, bearing in self.points(buffer):
            if distance < best.distance and (bearing - start) % TURN <= span:
                best = Echo(distance, bearing)
        return best

    def nearest_in_box(
        self, x1: float, y1: float, x2: float, y2: float, buffer: Buffer = Buffer.CURRENT
    ) -> Echo:
        """Return the point nearest to the centre in a box [m], any two opposite corners given."""
        left, right = (x1, x2) if x1 <= x2 else (x2, x1)
        low, high = (y1, y2) if y1 <= y2 else (y2, y1)
        best = NO_ECHO
        for x, y, distance, bearing in self.points(buffer):
            if distance < best.distance and left <= x <= right and low <= y <= high:
                best = Echo(distance, bearing)
        return best

    def _sees_any(self, bearings: Sequence[float]) -> bool:
        return any(field.holds(bearing) for field in self._fields for bearing in bearings)


def _seen_from(
    pose: Pose2, points: Sequence[tuple[float, ...]], known: dict[tuple[float, ...], Point]
) -> tuple[Point, ...]:
    """Return points in the frame of `pose`; `known` holds those worked out before."""
    c, s, here_x, here_y = cos(pose.theta), sin(pose.theta), pose.x, pose.y
    for point in points:
        if point not in known:
            dx, dy = point[0] - here_x, point[1] - here_y
            x, y = c * dx + s * dy, c * dy - s * dx
            known[point] = _POINT((x, y, hypot(x, y), atan2(y, x)))
    return tuple([known[point] for point in points])


NOTHING_SENSED = Surroundings(Pose2(), fields=())
"""Surroundings of a robot without range sensors, or before the first snapshot."""
