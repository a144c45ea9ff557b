"""Where an action is going to, and whether it comes nearer."""

from dataclasses import dataclass, field
from math import hypot, inf

PATIENCE = 15.0
"""On the way somewhere, people may step aside within this time [s]."""
HEADWAY = 0.1
"""Less than this in that time is none [m]."""
PAUSE = 1.0
"""Between two looks no more than this counts [s]: a robot that is not heard of makes no headway."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Goal:
    """A place in odometry's frame.

    Attributes:
        x: [m].
        y: [m].
        heading: To turn to there [rad], or `None`.
        person: Somebody is taken to be there, and is followed.
    """

    x: float
    y: float
    heading: float | None = None
    person: bool = False


@dataclass(slots=True)
class Headway:
    """Watches whether a robot comes nearer to its goal."""

    _goal: Goal | None = field(default=None, init=False)
    _best: float = field(default=inf, init=False)
    _without: float = field(default=0.0, init=False)
    _looked_at: float = field(default=inf, init=False)

    def made(self, goal: Goal | None, x: float, y: float, now: float) -> bool:
        """Return whether a robot at `x`, `y` [m] makes some; one that follows a person need not."""
        passed = max(0.0, min(now - self._looked_at, PAUSE))
        self._looked_at = now
        if goal is None or goal.person:
            self._goal = None
            return True
        distance = hypot(goal.x - x, goal.y - y)
        if goal != self._goal or distance < self._best - HEADWAY:
            self._goal, self._best, self._without = goal, distance, 0.0
        else:
            self._without += passed
        return self._without < PATIENCE
