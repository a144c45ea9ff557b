"""The limiter that keeps a robot's outline out of walls and echoes, asked last of all."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pioneer3.arrays import Float
from pioneer3.behaviors.action import Action, Desire, Situation
from pioneer3.behaviors.engine import decided
from pioneer3.geometry import Pose2
from pioneer3.nav.beams import LatestBeams
from pioneer3.nav.clearance import Clearance, Walls
from pioneer3.nav.particles import points_by
from pioneer3.nav.sightings import Sightings


@dataclass(slots=True, kw_only=True)
class LimiterOutline(Action):
    """Lets no mode move the robot's outline into a wall of the map, or an echo.

    It knows the motion that all other actions ask for, and shortens it where it has to.

    Attributes:
        margin: Distance within which the robot only gets farther [m].
        odom_in_map: Returns the pose of odometry's frame on the map.
        unsure: Returns the reason that nobody knows that, or `None`.
        walls: Of the map.
        sightings: Things seen that are not on it.
        beams: Arrays of scans.
    """

    margin: float
    odom_in_map: Callable[[], Pose2]
    unsure: Callable[[], str | None]
    walls: Walls = field(default_factory=lambda: Walls.of(np.empty((0, 4))))
    sightings: Sightings | None = None
    beams: LatestBeams = field(default_factory=LatestBeams)
    name: str = "limiter outline"
    _clearance: Clearance | None = field(default=None, init=False)

    def decide(self, situation: Situation) -> Desire | None:
        """Return the limits of a motion that would come too near, or `None`."""
        model, limits = situation.model, situation.limits
        asked = decided(situation.higher, limits)
        clearance = self._clearance
        if clearance is None or clearance.model is not model or clearance.limits != limits:
            clearance = self._clearance = Clearance(model=model, limits=limits, margin=self.margin)
        reach, until = clearance.horizon(situation.twist, asked)
        around = self._around(situation, reach, until)
        passed = clearance.limit(asked, situation.twist, around, situation.now)
        if passed == asked:
            return None
        left, right = max(passed.w, 0.0), max(-passed.w, 0.0)
        return Desire(
            v_max=max(passed.v, 0.0),
            back_max=max(-passed.v, 0.0),
            left_max=left,
            right_max=right,
            reason="else the robot comes too near to something",
        )

    def _around(self, situation: Situation, reach: float, until: float) -> Float:
        """Return all that is near, in the robot's frame [m], shape (N, 5).

        Bodies take the room that they walk through in the next moment, `until` it is over [s].
        """
        here, now = self.odom_in_map() @ situation.pose, situation.now
        to_robot, parts = here.inverse(), [self._echoes(situation)]
        if self.unsure() is None:
            walls = points_by(to_robot, self.walls.near(here.x, here.y, reach).reshape(-1, 2))
            parts.append(np.pad(walls.reshape(-1, 4), ((0, 0), (0, 1))))
            if self.sightings is not None:
                things = self.sightings.near(here.x, here.y, reach, now)
                parts.append(_points(points_by(to_robot, things)))
                bodies = self.sightings.bodies(here.x, here.y, reach, now)
                ahead = bodies[:, :2] + until * bodies[:, 2:4]
                ends = points_by(to_robot, bodies[:, :2]), points_by(to_robot, ahead)
                parts.append(np.column_stack([*ends, bodies[:, 4]]))
        around = np.concatenate(parts)
        x, y, reaches = around[:, :4:2], around[:, 1:4:2], reach + around[:, 4]
        near = (x.min(axis=1) < reaches) & (x.max(axis=1) > -reaches)
        near &= (y.min(axis=1) < reaches) & (y.max(axis=1) > -reaches)
        return np.ascontiguousarray(around[near])

    def _echoes(self, situation: Situation) -> Float:
        """Return the echoes of the laser, or else of the sonars, shape (N, 5)."""
        if situation.scan is None:
            heard = [(point.x, point.y) for point in situation.around.points()]
            return _points(np.array(heard).reshape(-1, 2))
        beams = self.beams.of(situation.scan)
        to_robot = situation.pose.inverse() @ beams.robot_in_odom
        return _points(points_by(to_robot, beams.points))


def _points(points: Float) -> Float:
    """Return points (N, 2) as segments without a length, with no room around them, (N, 5)."""
    return np.column_stack([points, points, np.zeros(len(points))])
