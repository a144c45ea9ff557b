"""Reads logs of CARMEN, the format in which laser logs of robots are published.

`ODOM x y theta tv rv accel stamp host stamp` is a reading of the odometry. `FLASER n range.. x y
theta odom_x odom_y odom_theta stamp host stamp` is a scan of n readings from -90 to +90 degrees,
the pose of the laser and of the robot. `PARAM name value` is a setting of the robot. Lengths are
[m], angles [rad], stamps [s]; a stamp has six digits and may go backwards, so the order of lines
counts. Everything else is skipped.

Logs that gmapping has corrected hold the corrected pose in each FLASER, and again in a line `ODOM`
after it, from which odometry goes on; the stamp of that line means nothing. The raw odometry is
chained from the ways between.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import hypot, inf, isfinite, pi

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.state import Scan

NO_ECHO = 50.0
"""Reading from which on a laser of the time has seen nothing [m]."""
CODES = (8.18, 8.2), (16.36, 16.4), (32.74, 32.8)
"""Readings that mean the same where a SICK's 13 bits count in 1, 2 or 4 mm [m]."""
OFFSET_PARAMETER = "robot_frontlaser_offset"
"""Parameter of the laser's place ahead of the robot's middle."""
RANGE_PARAMETER = "robot_front_laser_max"
"""Parameter of the laser's longest range."""
SAME_POSE = 1e-3
"""Difference below which two poses are the same [m, rad]."""
STAMP_GAP = 1.0
"""Difference of neighbouring lines' stamps at most [s], unless one of them means nothing."""


@dataclass(frozen=True, slots=True)
class LoggedOdometry:
    """A reading of the odometry between scans.

    Attributes:
        stamp: [s], as in the log.
        robot_in_odom: The raw odometry.
    """

    stamp: float
    robot_in_odom: Pose2


@dataclass(frozen=True, slots=True)
class LoggedScan:
    """A scan.

    Attributes:
        scan: The readings, with the raw odometry.
        corrected: Its pose in the map that the log was corrected with [m, rad], or `None` in a raw
            log.
    """

    scan: Scan
    corrected: Pose2 | None


@dataclass(frozen=True, slots=True)
class _Sweep:
    """A FLASER as it is written."""

    ranges: tuple[float, ...]
    laser: Pose2
    robot: Pose2
    stamp: float


class _Reader:
    """Chains the odometry and makes scans."""

    def __init__(self) -> None:
        self.offset, self.far = 0.0, NO_ECHO
        self._raw = ORIGIN
        self._anchor: Pose2 | None = None
        self._number = 0

    def move(self, pose: Pose2, stamp: float) -> LoggedOdometry:
        """Chain the way to a pose of the log's odometry."""
        if self._anchor is not None:
            self._raw @= self._anchor.inverse() @ pose
        self._anchor = pose
        return LoggedOdometry(stamp, self._raw)

    def scan(self, sweep: _Sweep, *, anchored: bool) -> LoggedScan:
        """Make a scan; `anchored` says that odometry goes on from its pose."""
        if anchored:
            self._anchor = sweep.robot
        else:
            self.move(sweep.robot, sweep.stamp)
        mount = sweep.robot.inverse() @ sweep.laser
        # a laser's pose is as far from the robot's as the laser; a corrected one is anywhere
        differs = hypot(mount.x - self.offset, mount.y) > SAME_POSE or abs(mount.theta) > SAME_POSE
        differs = differs and hypot(mount.x, mount.y) + abs(mount.theta) > 0
        self._number += 1
        return LoggedScan(
            Scan(
                stamp=sweep.stamp,
                sequence=self._number,
                robot_in_odom=self._raw,
                sensor_in_robot=ORIGIN if differs else mount,
                angles=_angles(len(sweep.ranges)),
                ranges=tuple(self._range(value) for value in sweep.ranges),
                far=self.far,
            ),
            sweep.laser if anchored or differs else None,
        )

    def _range(self, metres: float) -> float:
        nothing = metres >= self.far or any(low <= metres <= high for low, high in CODES)
        return inf if nothing else metres if metres > 0 else -inf


def read_carmen(lines: Iterable[str]) -> Iterator[LoggedOdometry | LoggedScan]:
    """Yield the readings of a log in their order; lines that are damaged are skipped."""
    reader, waiting = _Reader(), None
    for line in lines:
        words = line.split()
        if not words or words[0] not in ("ODOM", "FLASER", "PARAM"):
            continue
        numbers = _numbers(words[1:])
        if words[0] == "PARAM" and len(words) > 2:
            _set(reader, words[1], words[2])
            continue
        anchors = waiting is not None and _anchors(words, numbers, waiting)
        if waiting is not None:
            yield reader.scan(waiting, anchored=anchors)
            waiting = None
        if words[0] == "FLASER":
            waiting = _sweep(numbers)
        elif len(numbers) >= 8 and isfinite(sum(numbers[:3])) and not anchors:
            yield reader.move(Pose2(*numbers[:3]), numbers[6])
    if waiting is not None:
        yield reader.scan(waiting, anchored=False)


def _set(reader: _Reader, name: str, value: str) -> None:
    number = _number(value)
    if name == OFFSET_PARAMETER and isfinite(number):
        reader.offset = number
    elif name == RANGE_PARAMETER and number > 0:
        reader.far = min(number, NO_ECHO)


def _sweep(numbers: list[float]) -> _Sweep | None:
    count = int(numbers[0]) if numbers and isfinite(numbers[0]) else 0
    if count < 2 or len(numbers) < count + 8 or not isfinite(sum(numbers[: count + 8])):
        return None
    x, y, theta, odom_x, odom_y, odom_theta, stamp = numbers[count + 1 : count + 8]
    return _Sweep(
        ranges=tuple(numbers[1 : count + 1]),
        laser=Pose2(x, y, theta),
        robot=Pose2(odom_x, odom_y, odom_theta),
        stamp=stamp,
    )


def _anchors(words: list[str], numbers: list[float], sweep: _Sweep) -> bool:
    """Whether the line after a scan says that odometry goes on from the scan's pose."""
    robot = sweep.robot
    if words[0] != "ODOM" or len(numbers) < 8 or numbers[:3] != [robot.x, robot.y, robot.theta]:
        return False
    return numbers[6] == 0 or abs(numbers[6] - sweep.stamp) > STAMP_GAP


def _angles(count: int) -> tuple[float, ...]:
    """Return the directions: a half circle, of which some logs leave out the last reading."""
    step = pi / (count - count % 2)
    return tuple(-pi / 2 + step * number for number in range(count))


def _numbers(words: list[str]) -> list[float]:
    return [_number(word) for word in words]


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return float("nan")
