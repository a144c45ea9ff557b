"""Reads scan logs of ARIA (`.2d`), of which Mapper3 makes maps.

The first line is `LaserOdometryLog`; the others are `tag: values`, in mm and degrees, or comments.
`sick1pose: x y theta` is the place of laser 1, `sick1conf: first last count` tells its directions.
Of each scan `robot: x y theta` is the pose by odometry, `robotGlobal:` by localization,
`robotRaw:` without corrections, and the readings come after it: until version 2 `sick1: range..`,
later `scan1: x y x y ..`, in the laser's frame, turned as the robot until version 3; `0 0` is no
reading. `scan2:` is of another laser. `cairn: kind "" icon "name"` marks a place. facts.md 10.4.
"""

import re
from collections.abc import Iterable, Iterator
from math import atan2, hypot, isfinite, pi, radians

from pioneer3.geometry import ORIGIN, TURN, Pose2, wrap
from pioneer3.nav.logged import (
    NO_ECHO,
    Entry,
    LoggedDamage,
    LoggedOdometry,
    LoggedPlace,
    LoggedScan,
    Sources,
    is_mount,
    is_pose,
    range_of,
)
from pioneer3.state import Scan

FIRST_LINE = "LaserOdometryLog"
"""First line of such a log."""
POSES = ("robot", "robotRaw", "robotGlobal")
"""Tags of poses, the one to be taken first before the others."""
TURNED_SINCE = 4
"""Version from which on readings are in the laser's frame, turned as it is."""
READINGS = re.compile(r"(?:scan|sick)(\d{1,2})")
"""Tag of the readings of a laser."""
PLACE = re.compile(r'(?P<kind>\w{1,60})\s+"[^"]*"\s+\w*\s*"(?P<name>[^"]{0,200})"')
"""Values of a place."""


class _Reader:
    """Takes the lines of a log."""

    def __init__(self, laser: str, pose: str) -> None:
        self._laser, self._pose = laser, pose
        self._version = 1.0
        self._mount = ORIGIN
        self._directions = (-pi / 2, pi / 2, 0.0)
        self._robot: Pose2 | None = None
        self._seen = True
        self._stamp = 0.0
        self._number = 0

    def take(self, tag: str, values: str, line: int) -> Entry | LoggedDamage | None:
        """Take a line and its number; return the reading in it."""
        if tag == "cairn":
            place = PLACE.match(values)
            return LoggedPlace(place["kind"], place["name"]) if place and self._robot else None
        numbers = _numbers(values)
        if tag == self._pose:
            moved = len(numbers) >= 3 and self._move(_pose(numbers))
            return moved or LoggedDamage(line)
        if tag in (f"scan{self._laser}", f"sick{self._laser}"):
            if values and not (numbers and isfinite(sum(numbers))):
                return LoggedDamage(line)
            return self._scan(numbers, in_plane=tag.startswith("scan"))
        if tag in ("time", "logTime") and numbers and isfinite(numbers[0]):
            self._stamp = numbers[0]
        elif tag == "version" and numbers:
            self._version = numbers[0]
        elif tag == f"sick{self._laser}pose" and len(numbers) == 3:
            self._mount = _pose(numbers) if is_mount(_pose(numbers)) else ORIGIN
        elif tag == f"sick{self._laser}conf" and len(numbers) == 3:
            first, last = sorted(numbers[:2])
            if isfinite(numbers[2]) and -TURN <= radians(first) < radians(last) <= TURN:
                self._directions = (radians(first), radians(last), numbers[2])
        return None

    def _move(self, pose: Pose2) -> LoggedOdometry | None:
        if not is_pose(pose):
            return None
        self._robot, self._seen = pose, False
        return LoggedOdometry(self._stamp, pose)

    def _scan(self, numbers: list[float], *, in_plane: bool) -> LoggedScan | None:
        """Make a scan: of points, or of ranges from right to left."""
        if self._robot is None or self._seen or len(numbers) <= 3:
            return None
        mount, self._seen = self._mount, True
        if in_plane:
            points = zip(numbers[::2], numbers[1::2], strict=False)
            polar = sorted((atan2(y, x), hypot(x, y) / 1000) for x, y in points if x or y)
            if self._version < TURNED_SINCE:
                mount = Pose2(mount.x, mount.y)
        else:
            polar = list(zip(self._angles(len(numbers)), (n / 1000 for n in numbers), strict=True))
        self._number += 1
        return LoggedScan(
            Scan(
                stamp=self._stamp,
                sequence=self._number,
                robot_in_odom=self._robot,
                sensor_in_robot=mount,
                angles=tuple(angle for angle, _ in polar),
                ranges=tuple(range_of(metres) for _, metres in polar),
                far=NO_ECHO,
            )
        )

    def _angles(self, count: int) -> tuple[float, ...]:
        """Return the directions of ranges, of which there may be one more or less than is told."""
        first, last, told = self._directions
        steps = told - 1 if abs(told - count) <= 1 else count - 1
        return tuple(first + (last - first) * number / steps for number in range(count))


def scan_log_sources(lines: Iterable[str]) -> Sources:
    """Return the lasers of a log as `scan1`, `scan2`, and the tags of its poses."""
    tags = {line.partition(":")[0].strip() for line in lines}
    numbers = {int(found[1]) for tag in tags if (found := READINGS.fullmatch(tag))}
    return Sources(
        tuple(f"scan{number}" for number in sorted(numbers)),
        tuple(tag for tag in POSES if tag in tags),
    )


def read_scan_log(
    lines: Iterable[str], laser: str = "scan1", pose: str = POSES[0]
) -> Iterator[Entry | LoggedDamage]:
    """Yield the readings of a log in their order, and the lines that are damaged."""
    reader = _Reader(laser.removeprefix("scan"), pose)
    for number, line in enumerate(lines, 1):
        tag, colon, values = line.partition(":")
        entry = reader.take(tag.strip(), values.strip(), number) if colon else None
        if entry is not None:
            yield entry


def _pose(numbers: list[float]) -> Pose2:
    x, y, heading = numbers[:3]
    return Pose2(x / 1000, y / 1000, wrap(radians(heading)) if isfinite(heading) else heading)


def _numbers(values: str) -> list[float]:
    try:
        return [float(word) for word in values.split()]
    except ValueError:
        return []
