"""Lines a robot up with narrow places on its way, by manoeuvres."""

from dataclasses import dataclass, field
from math import hypot, inf

import numpy as np
from numpy.typing import NDArray

from pioneer3.behaviors.action import Desire, Situation
from pioneer3.geometry import Pose2
from pioneer3.nav.manoeuvre import Manoeuvre, find_manoeuvre
from pioneer3.nav.planner import CostToGo

Float = NDArray[np.float64]

HELD_UP, SEARCH_AGAIN = 4.0, 2.0
"""A robot that comes no nearer for so long looks for a manoeuvre, and again so often [s]."""
MOVED = 0.2
"""Nor one that has come so far meanwhile [m]: its way leads elsewhere now."""


@dataclass(slots=True)
class LiningUp:
    """Looks for a manoeuvre where a robot is held up, and drives it."""

    _manoeuvre: Manoeuvre | None = field(default=None, init=False)
    _searched: float = field(default=-inf, init=False)
    _anchor: tuple[float, float] = field(default=(inf, inf), init=False)
    _anchored: float = field(default=-inf, init=False)

    def decide(
        self,
        situation: Situation,
        robot_in_map: Pose2,
        obstacles: Float,
        to_go: CostToGo,
        held_up: float,
    ) -> Desire | None:
        """Return the next velocity, or `None` where no manoeuvre is wanted or found.

        Args:
            situation: Of now.
            robot_in_map: Where the robot is [m, rad].
            obstacles: Everything nearby, as a follower takes it, shape (N, 5).
            to_go: The cost to its goal.
            held_up: For how long it has come no nearer [s].
        """
        x, y = robot_in_map.x, robot_in_map.y
        if hypot(x - self._anchor[0], y - self._anchor[1]) > MOVED:
            self._anchor, self._anchored = (x, y), situation.now
        held_up = min(held_up, situation.now - self._anchored)
        late = situation.now - self._searched > SEARCH_AGAIN
        if self._manoeuvre is None and held_up > HELD_UP and late:
            self._searched = situation.now
            poses = find_manoeuvre(robot_in_map, situation.model, obstacles, to_go)
            if poses is not None:
                self._manoeuvre = Manoeuvre(poses, situation.model, situation.limits)
        if self._manoeuvre is None:
            return None
        v, w = self._manoeuvre.step(robot_in_map, obstacles)
        if self._manoeuvre.done:
            self._manoeuvre = None
            return None
        return Desire(v=v, w=w, reason="lines up with a narrow place")
