"""Remembers what a laser saw, in odometry's frame (arcos.md 7.2, LMS2xx)."""

from collections.abc import Callable, Iterable
from math import atan2, cos, floor, hypot, isfinite, sin

from pioneer3.behaviors.seen import Seen
from pioneer3.geometry import Pose2, wrap
from pioneer3.state import Scan

STALE = 1.0
"""A scan older than this [s] says nothing of now."""
AGE, DISTANCE = 30.0, 6.0
"""How long [s] and how far from the robot [m] points are remembered."""
NEAR, SPACING = 3.0, 0.2
"""Points within the first [m] are remembered, no two closer than the second [m]."""
MOST = 500
CLEAN_EVERY, CLEAR = 1.0, 0.075
"""Every so often [s], what a beam sees past by more than this [m] is forgotten."""


class LaserMemory:
    """The last scan, and points of those before."""

    def __init__(self) -> None:
        self.recent: tuple[Seen, ...] = ()
        self._cells: dict[tuple[int, int], Seen] = {}  # oldest first; at most one point in each
        self._sequence = -1
        self._cleaned = 0.0

    @property
    def remembered(self) -> Iterable[Seen]:
        """Points of earlier scans, too."""
        return self._cells.values()

    def add(self, scan: Scan) -> None:
        """Take in a scan; the same one again changes nothing."""
        if scan.sequence == self._sequence:
            return
        self._sequence = scan.sequence
        sensor = scan.sensor_in_odom
        if scan.stamp - self._cleaned >= CLEAN_EVERY:
            self._cleaned = scan.stamp
            self._clean(scan, sensor)
        seen = []
        for angle, metres in zip(scan.angles, scan.ranges, strict=True):
            if isfinite(metres):
                bearing = sensor.theta + angle
                x, y = sensor.x + metres * cos(bearing), sensor.y + metres * sin(bearing)
                seen.append(Seen(x, y, scan.stamp))
                if metres <= NEAR:
                    self._remember(seen[-1])
        self.recent = tuple(seen)

    def forget(self, pose: Pose2, now: float) -> None:
        """Drop what is too old, and what has been left behind."""
        if self.recent and now - self.recent[0].stamp > STALE:
            self.recent = ()
        self._keep(lambda p: now - p.stamp <= AGE and hypot(p.x - pose.x, p.y - pose.y) <= DISTANCE)

    def sensing(self, now: float) -> bool:
        """Whether scans come."""
        return bool(self.recent) and now - self.recent[0].stamp <= STALE

    def _remember(self, new: Seen) -> None:
        i, j = floor(new.x / SPACING), floor(new.y / SPACING)
        if (i, j) in self._cells and self._near(self._cells[i, j], new):
            return
        beside = (self._cells.get((i + di, j + dj)) for di in (-1, 0, 1) for dj in (-1, 0, 1))
        if not any(p is not None and self._near(p, new) for p in beside):
            self._cells[i, j] = new
            if len(self._cells) > MOST:
                del self._cells[next(iter(self._cells))]

    @staticmethod
    def _near(one: Seen, other: Seen) -> bool:
        return hypot(one.x - other.x, one.y - other.y) < SPACING

    def _clean(self, scan: Scan, sensor: Pose2) -> None:
        """Forget points that the beam in their direction sees past."""
        step = (scan.angles[-1] - scan.angles[0]) / max(1, len(scan.angles) - 1)

        def stays(point: Seen) -> bool:
            dx, dy = point.x - sensor.x, point.y - sensor.y
            off = wrap(atan2(dy, dx) - sensor.theta - scan.angles[0])
            beam = round(off / step) if step else -1
            past = 0 <= beam < len(scan.ranges) and scan.ranges[beam] > hypot(dx, dy) + CLEAR
            return not past

        self._keep(stays)

    def _keep(self, stays: Callable[[Seen], bool]) -> None:
        self._cells = {cell: point for cell, point in self._cells.items() if stays(point)}
