"""A scan as arrays, in the frame of the robot."""

from dataclasses import dataclass

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2, wrap
from pioneer3.state import Scan

CLEAR_RANGE = 8.0
"""Longest way that is free where nothing echoes [m]. A URG-04LX tells 5.6 m and hears to 4.095 m.
"""
CLEAR_SHARE = 1 / 3
"""Share of the longest range that is free where nothing echoes: farther off, glass and dark walls
send too little back."""
LONGEST_RANGE = 80.0
"""Longest range where the laser tells none [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Beams:
    """The readings of a scan, seen from where the robot was at the last one.

    Attributes:
        stamp: Time of the last reading [s, monotonic].
        robot_in_odom: Pose of the robot then [m, rad].
        points: The echoes [m] in the robot's frame, shape (N, 2).
        clear: Ends of the beams that echoed nothing [m], as far as `far`, shape (M, 2).
        origin: Place of the laser [m] in the same frame, shape (2,), at the last reading.
        far: Longest range of the laser [m].
    """

    stamp: float
    robot_in_odom: Pose2
    points: Float
    clear: Float
    origin: Float
    far: float

    @property
    def free(self) -> Float:
        """Ends of the free part of the beams that echoed nothing [m], shape (M, 2)."""
        ways = self.clear - self.origin
        lengths = np.maximum(np.hypot(*ways.T), 1e-9)
        known = min(CLEAR_RANGE, CLEAR_SHARE * self.far)
        ends: Float = self.origin + ways * np.minimum(1.0, known / lengths)[:, None]
        return ends


@dataclass(slots=True)
class LatestBeams:
    """The latest scan as arrays, made once for all that look at it."""

    _scan: Scan | None = None
    _beams: Beams | None = None

    def of(self, scan: Scan) -> Beams:
        """Return a scan as arrays."""
        if self._beams is None or scan is not self._scan:
            self._scan, self._beams = scan, beams_of(scan)
        return self._beams


def beams_of(scan: Scan) -> Beams:
    """Return a scan as arrays; the motion of the robot within it is taken out.

    Readings that are no distance, NaN and `-inf` of REP 117, are left out.
    """
    angles, ranges = np.array(scan.angles), np.array(scan.ranges)
    first, last = scan.robot_in_odom, scan.last_in_odom or scan.robot_in_odom
    here = first if scan.beam_time < 0 else last  # the mirror of a laser upside down ends at first
    begin, end = here.inverse() @ first, here.inverse() @ last
    share, sensor = np.linspace(0.0, 1.0, len(angles)), scan.sensor_in_robot
    theta = begin.theta + share * wrap(end.theta - begin.theta)
    x, y = begin.x + share * (end.x - begin.x), begin.y + share * (end.y - begin.y)
    c, s = np.cos(theta), np.sin(theta)
    origins = np.stack([x + c * sensor.x - s * sensor.y, y + s * sensor.x + c * sensor.y], axis=1)
    bearing = theta + sensor.theta + angles
    ahead = np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    far = min(scan.far, LONGEST_RANGE)
    hit, none = np.isfinite(ranges), np.isposinf(ranges)
    return Beams(
        stamp=scan.stamp + max(0.0, scan.beam_time) * max(0, len(angles) - 1),
        robot_in_odom=here,
        points=origins[hit] + ranges[hit, None] * ahead[hit],
        clear=origins[none] + far * ahead[none],
        origin=np.array([sensor.x, sensor.y]),
        far=far,
    )
