"""Readings of logs, and scans that wait for the odometry of their time."""

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import hypot, inf, isfinite

from pioneer3.geometry import Pose2, wrap
from pioneer3.state import Scan

NO_ECHO = 50.0
"""Reading from which on a SICK LMS-2xx has seen nothing [m]."""
CODES = (8.18, 8.2), (16.36, 16.4), (32.74, 32.8)
"""Readings that mean the same where its 13 bits count in 1, 2 or 4 mm [m]."""
FARTHEST_PLACE = 1e6
"""Distance from the origin beyond which a pose is a mistake [m]."""
MOST_OFFSET = 10.0
"""Distance of a laser from the middle of its robot at most [m]."""
PATIENCE = 5.0
"""Difference of the stamps of a scan and of the odometry beside it at most [s]; beyond it their
clocks differ, and the order in the log counts."""
LATE = 2.0
"""Time by which odometry is held back [s]: scans come later, and in bursts over a network."""
MOST_WAITING = 100
"""Scans that wait for odometry at most."""


@dataclass(frozen=True, slots=True)
class Sources:
    """The names of lasers and odometry in a log, those to be taken first before the others."""

    lasers: tuple[str, ...]
    odometry: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class LoggedOdometry:
    """A reading of the raw odometry between scans; its stamp [s] is that of the log."""

    stamp: float
    robot_in_odom: Pose2


@dataclass(frozen=True, slots=True)
class LoggedScan:
    """A scan with the raw odometry, and its pose in the map that corrected its log, if one did."""

    scan: Scan
    corrected: Pose2 | None = None


@dataclass(frozen=True, slots=True)
class LoggedPlace:
    """A place that somebody has marked at the robot; `kind` is ARIA's, as `GoalWithHeading`."""

    kind: str
    name: str


@dataclass(frozen=True, slots=True)
class LoggedDamage:
    """A line of a text, counted from 1, that cannot be read and is left out."""

    line: int


Reading = LoggedOdometry | LoggedScan
"""Reading of a sensor in a log."""
Entry = Reading | LoggedPlace
"""Entry of a log."""


def range_of(metres: float, far: float = NO_ECHO) -> float:
    """Return a reading as in REP 117: `inf` where nothing echoed, `-inf` where it is too near.

    `far` is the longest range of the laser; `NO_ECHO` where the log does not tell.
    """
    if 0 < metres < min(far, CODES[0][0]):  # most are, and a log has millions
        return metres
    coded = far == NO_ECHO and any(low <= metres <= high for low, high in CODES)
    return inf if coded or metres >= far else metres if metres > 0 else -inf


def is_pose(pose: Pose2) -> bool:
    """Return whether numbers of a log may be a pose: finite, and on this side of the horizon."""
    return abs(pose.x) < FARTHEST_PLACE and abs(pose.y) < FARTHEST_PLACE and isfinite(pose.theta)


def is_mount(pose: Pose2) -> bool:
    """Return whether numbers of a log may be the place of a laser on a robot."""
    return is_pose(pose) and hypot(pose.x, pose.y) <= MOST_OFFSET


class Pairing:
    """Gives each scan the odometry of its time, which comes before or after it in a log."""

    def __init__(self) -> None:
        self._track: list[LoggedOdometry] = []
        self._told = 0
        self._waiting: list[Scan] = []

    def move(self, reading: LoggedOdometry) -> Iterator[Reading]:
        """Take odometry; yield what it completes, in the order of time."""
        late = self._track[-1].stamp - reading.stamp if self._track else 0.0
        if 0 < late < PATIENCE:
            return  # out of order
        if late > 0:
            yield from self.rest()  # the clock was set back
            self._track, self._told = [], 0
        self._track.append(reading)
        while self._waiting and _end(self._waiting[0]) <= reading.stamp:
            yield from self._pair(self._waiting.pop(0))
        if not self._waiting:
            yield from self._tell(self._before(reading.stamp - LATE))

    def scan(self, scan: Scan) -> Iterator[Reading]:
        """Take a scan whose odometry is not known; yield it, now or later."""
        if self._track and abs(scan.stamp - self._track[-1].stamp) > PATIENCE:
            yield from self.rest()
            yield LoggedScan(replace(scan, robot_in_odom=self._track[-1].robot_in_odom))
        elif self._track and not self._waiting and _end(scan) <= self._track[-1].stamp:
            yield from self._pair(scan)
        else:
            self._waiting.append(scan)
            if self._track and len(self._waiting) > MOST_WAITING:
                yield from self._pair(self._waiting.pop(0))
            elif len(self._waiting) > MOST_WAITING:
                self._waiting.pop(0)

    def rest(self) -> Iterator[Reading]:
        """Yield the scans that no odometry comes after."""
        waiting, self._waiting = self._waiting, []
        if self._track:
            for scan in waiting:
                yield from self._pair(scan)
            yield from self._tell(len(self._track))

    def _pair(self, scan: Scan) -> Iterator[Reading]:
        last = scan.stamp + scan.beam_time * (len(scan.angles) - 1)
        yield from self._tell(self._before(_end(scan)))
        yield LoggedScan(
            replace(
                scan,
                robot_in_odom=self._pose_at(scan.stamp),
                last_in_odom=self._pose_at(last) if scan.beam_time else None,
            )
        )

    def _tell(self, end: int) -> Iterator[Reading]:
        """Yield the odometry before `end` that was not told; forget what no scan needs."""
        yield from self._track[self._told : end]
        self._told = max(self._told, end)
        if self._told > MOST_WAITING:
            del self._track[: self._told - MOST_WAITING]
            self._told = MOST_WAITING

    def _before(self, stamp: float) -> int:
        """Return how many readings are not later than a time."""
        return bisect_right(self._track, stamp, key=lambda each: each.stamp)

    def _pose_at(self, stamp: float) -> Pose2:
        """Return the robot's pose at a time: on the line between the readings beside it."""
        track, after = self._track, self._before(stamp)
        if after in (0, len(track)):
            return track[max(0, after - 1)].robot_in_odom
        before, behind = track[after - 1], track[after]
        share = (stamp - before.stamp) / (behind.stamp - before.stamp)
        first, second = before.robot_in_odom, behind.robot_in_odom
        return Pose2(
            first.x + share * (second.x - first.x),
            first.y + share * (second.y - first.y),
            wrap(first.theta + share * wrap(second.theta - first.theta)),
        )


def _end(scan: Scan) -> float:
    """Return the time of the reading that was measured last [s]."""
    return scan.stamp + max(0.0, scan.beam_time * (len(scan.angles) - 1))
