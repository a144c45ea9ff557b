"""Goes where there is room, and rather where it has not been."""

from dataclasses import dataclass, field
from math import cos, inf, pi, radians, sin

from pioneer3.behaviors.action import Action, Desire, Situation
from pioneer3.behaviors.actions.sensing import BLIND
from pioneer3.behaviors.surroundings import Buffer, Point
from pioneer3.geometry import TURN, Pose2, wrap

CELL = 0.5
"""Side of the squares in which it notes where it has been [m]."""
HEADINGS = 36
"""Headings that it looks at."""
EXPLORE_LOOK = 2.5
"""Distance up to which it looks for ways [m]."""
AGAIN = 2.0
"""Time between two choices of a heading [s]."""
STEEP_HEADING = radians(30)
"""Angle off its heading above which it turns where it stands [rad]."""
HELD = 0.3
"""A robot that may turn no faster has a corner near an obstacle [rad/s]: 20 degrees from it, for
:class:`LimiterSweep`."""
ARC = 1.0
"""Radius to turn on in place of a turn where it stands [m]. The rear corner of a P3-AT that leaves
a wall so swings out by 4 cm, hypot(0.31, 1.25) - 1.25; where it stands by 15 cm."""
GOING_ON_WORTH = 0.5
"""Worth of going on; a new square is worth 1."""
TURN_COST = 1.0
"""Cost of turning around."""
ROOM_WORTH = 0.3
"""Worth of each metre of room."""


@dataclass(slots=True)
class Explore(Action):
    """Chooses the heading with most room and most new ground, and drives there.

    Ways count as free where what is seen and remembered leaves the robot's width and twice
    `side_clearance`. So it passes doors that :class:`AvoidFront`, which keeps a circle clear of
    everything, takes for walls. Limiters belong above it.

    Where a corner has no room for a turn on the spot it drives on, on an arc. It often comes that
    close: without arcs 20 of 60 runs of 10 minutes touched something, 626 times, nearly always
    with a rear corner that swung into the wall beside the robot; with them 1, 32 times.

    Attributes:
        front_clearance: Nearer than this it takes another way [m].
    """

    speed: float = 0.3
    side_clearance: float = 0.08
    front_clearance: float = 0.35
    name: str = "explore"
    _heading: float | None = field(default=None, init=False)
    _chosen: float = field(default=-inf, init=False)
    _visits: dict[tuple[int, int], int] = field(default_factory=dict, init=False)
    _cell: tuple[int, int] | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire:
        pose, around = situation.pose, situation.around
        self._note(pose)
        if not around.sensing:
            return Desire(v=0.0, turn=0.0, lacks=True, reason=BLIND)
        model = situation.model
        half, front = model.width / 2 + self.side_clearance, model.length_front
        points = (*around.points(Buffer.WINDOW), *around.points(Buffer.CUMULATIVE))
        heading, free = self._heading, 0.0
        if heading is not None:
            free = room(points, wrap(heading - pose.theta), half) - front
        if heading is None or situation.now - self._chosen > AGAIN or free < self.front_clearance:
            heading = self._heading = self._choose(pose, points, half, front)
            free = room(points, wrap(heading - pose.theta), half) - front
            self._chosen = situation.now
        off, reason = wrap(heading - pose.theta), f"{min(free, EXPLORE_LOOK):.1f} m of room"
        v = self.speed * max(0.0, 1 - abs(off) / STEEP_HEADING)
        rate = situation.higher.limits.get("left_max" if off > 0 else "right_max", inf)
        slow = min(self.speed, ARC * rate)
        if rate < HELD and v < slow and room(points, 0.0, half) - front > self.front_clearance:
            v, reason = slow, f"{reason}, on an arc"
        return Desire(v=v, heading=heading, reason=reason)

    def _note(self, pose: Pose2) -> None:
        cell = _cell(pose.x, pose.y)
        if cell != self._cell:
            self._visits[cell] = self._visits.get(cell, 0) + 1
            self._cell = cell

    def _choose(self, pose: Pose2, points: tuple[Point, ...], half: float, front: float) -> float:
        best, found = -inf, pose.theta
        for n in range(HEADINGS):
            bearing = wrap(n * TURN / HEADINGS)
            free = min(EXPLORE_LOOK, room(points, bearing, half) - front)
            heading = wrap(pose.theta + bearing)
            worth = ROOM_WORTH * free - TURN_COST * abs(bearing) / pi
            if free > self.front_clearance:
                worth += self._news(pose, heading, free + front)
                if (
                    self._heading is not None
                    and abs(wrap(heading - self._heading)) < STEEP_HEADING / 2
                ):
                    worth += GOING_ON_WORTH
            else:
                worth -= EXPLORE_LOOK / CELL
            if worth > best:
                best, found = worth, heading
        return found

    def _news(self, pose: Pose2, heading: float, reach: float) -> float:
        """Return how much new ground a way of so many metres has; each square at most 1."""
        news, away = 0.0, CELL
        while away <= reach:
            x, y = pose.x + away * cos(heading), pose.y + away * sin(heading)
            news += 1 / (1 + self._visits.get(_cell(x, y), 0))
            away += CELL
        return news


def room(points: tuple[Point, ...], bearing: float, half: float) -> float:
    """Return how far the nearest point is along a bearing, in a strip `half` to each side [m]."""
    c, s = cos(bearing), sin(bearing)
    nearest = inf
    for x, y, _, _ in points:
        along = c * x + s * y
        if 0 < along < nearest and -half < c * y - s * x < half:
            nearest = along
    return nearest


def _cell(x: float, y: float) -> tuple[int, int]:
    return int(x // CELL), int(y // CELL)
