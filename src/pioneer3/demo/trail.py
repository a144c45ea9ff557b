"""Where the robot has been."""

from collections import deque
from math import hypot

from pioneer3.geometry import Pose2

STEP = 0.05
"""Between two points [m]."""
MOST = 400
JUMP = 1.0
"""Farther than this [m] is not driven: the trail begins anew."""


class Trail:
    """Places in odometry's frame, seen from the robot."""

    def __init__(self) -> None:
        self._places: deque[tuple[float, float]] = deque(maxlen=MOST)

    def add(self, pose: Pose2) -> None:
        """Note where the robot is now."""
        if self._places:
            x, y = self._places[-1]
            way = hypot(pose.x - x, pose.y - y)
            if way < STEP:
                return
            if way > JUMP:
                self._places.clear()
        self._places.append((pose.x, pose.y))

    def seen_from(self, pose: Pose2) -> list[tuple[float, float]]:
        """Return the places in the frame of a robot at `pose` [m]."""
        to_robot = pose.inverse()
        places = (to_robot @ Pose2(x, y) for x, y in self._places)
        return [(place.x, place.y) for place in places]
