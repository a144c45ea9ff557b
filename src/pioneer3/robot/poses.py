"""The robot's pose at any time of the last seconds, from its odometry."""

from bisect import bisect_right
from collections import deque

from pioneer3.geometry import ORIGIN, STILL, Pose2, arc, wrap
from pioneer3.state import Snapshot

KEPT = 5.0
"""Poses are kept so long [s]."""
AHEAD = 0.3
"""A robot is taken to go on as it did for so long after its last report [s]."""


class Poses:
    """Poses of odometry by time: between two reports interpolated, after the last extrapolated."""

    def __init__(self) -> None:
        self._stamps: deque[float] = deque()
        self._poses: deque[Pose2] = deque()
        self._twist = STILL

    def add(self, snapshot: Snapshot) -> None:
        """Take the pose of the newest snapshot."""
        if self._stamps and snapshot.stamp <= self._stamps[-1]:
            self._stamps.pop()
            self._poses.pop()
        self._stamps.append(snapshot.stamp)
        self._poses.append(snapshot.odometry.robot_in_odom)
        self._twist = snapshot.odometry.twist
        while self._stamps[0] < snapshot.stamp - KEPT:
            self._stamps.popleft()
            self._poses.popleft()

    def at(self, time: float) -> Pose2:
        """Return the pose of the robot in odometry's frame at `time` [s, monotonic].

        Before the first report of the last seconds it is the pose of that report, and without any
        report the origin.
        """
        if not self._stamps:
            return ORIGIN
        after = bisect_right(self._stamps, time)
        if after == len(self._stamps):
            seconds = min(time - self._stamps[-1], AHEAD)
            return self._poses[-1] @ arc(self._twist.v, self._twist.w, seconds)
        if after == 0:
            return self._poses[0]
        begin, end = self._poses[after - 1], self._poses[after]
        began, ended = self._stamps[after - 1], self._stamps[after]
        share = (time - began) / (ended - began)
        return Pose2(
            begin.x + share * (end.x - begin.x),
            begin.y + share * (end.y - begin.y),
            wrap(begin.theta + share * wrap(end.theta - begin.theta)),
        )
