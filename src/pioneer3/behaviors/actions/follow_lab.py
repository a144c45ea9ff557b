"""The lab's rule to follow somebody: turn to the nearest echo, keep a distance from it."""

from dataclasses import dataclass, field
from math import inf, radians

from pioneer3.behaviors.desire import Desire
from pioneer3.behaviors.goal import Goal
from pioneer3.behaviors.situation import Situation
from pioneer3.geometry import Pose2

BEARINGS = {
    1: radians(40),
    2: radians(40),
    3: 0.0,
    4: 0.0,
    5: radians(-40),
    6: radians(-40),
}
"""Where the lab takes an echo to be, by transducer [rad]. Numbers begin with 0 at the front left:
1 and 2, at 50 and 30 degrees, look to the left (arcos.md 6.4)."""
REACH = 1.0
"""Farther echoes are nobody [m]."""
SECONDS = 1.2
"""In which a difference shall be gone: three of the lab's cycles of 0.4 s [s]."""
FASTEST, FASTEST_BACK = 0.5, 0.3
"""[m/s]"""
FASTEST_TURN = radians(45)
"""[rad/s]"""


@dataclass(slots=True, kw_only=True)
class FollowLab:
    """Follow the nearest echo of the front, as the lab's `p3_sonar_following_moving_object` does.

    Speed (d - 0.3 m) / 1.2 s from -0.3 to 0.5 m/s, turn rate bearing / 1.2 s up to 45 degrees/s
    towards the echo; stand still when nothing is within 1.0 m. Distances are ranges of
    transducers: the lab takes them from points around the robot's centre and subtracts how far
    out each transducer sits, 0.16 to 0.24 m on a P3-AT, which gives the same within 15 mm, but
    for the outermost two, which it does not use. Unlike the lab's node, it decides at each report,
    ten times a second, not 2.5 times.

    Attributes:
        keep: Range to keep [m].
        goal: Where it takes the nearest echo to come from; `None` without any.
    """

    keep: float = 0.3
    name: str = "follow"
    goal: Goal | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return speed and turn rate for the nearest echo."""
        ranges = situation.snapshot.sonar.ranges
        near = [(ranges[i], i) for i in BEARINGS if i < len(ranges) and ranges[i] <= REACH]
        distance, number = min(near, default=(inf, -1))
        self.goal = None
        if distance == inf:
            return Desire(v=0.0, w=0.0, reason="looks for somebody")
        self.goal = _place(situation, number, distance)
        speed = (distance - self.keep) / SECONDS
        turn_rate = BEARINGS[number] / SECONDS
        return Desire(
            v=max(-FASTEST_BACK, min(FASTEST, speed)),
            w=max(-FASTEST_TURN, min(FASTEST_TURN, turn_rate)),
            reason=f"follows at {distance:.2f} m, sonar {number}",
        )


def _place(situation: Situation, number: int, distance: float) -> Goal | None:
    """Return what is `distance` [m] before a transducer; `None` where it sits is not known."""
    sonars = situation.model.sonars
    if number >= len(sonars):
        return None
    mount = Pose2(sonars[number].x, sonars[number].y, sonars[number].theta)
    echo = situation.pose @ mount @ Pose2(distance)
    return Goal(x=echo.x, y=echo.y, person=True)
