"""Reads logs of CARMEN, the format in which laser logs of robots are published.

`ODOM x y theta tv rv accel stamp host stamp` is a reading of the odometry. `FLASER n range.. x y
theta odom_x odom_y odom_theta stamp host stamp` is a scan of n readings from -90 to +90 degrees,
the pose of the laser and of the robot; `RLASER` that of the rear laser. Since 2006 `RAWLASER1 type
start fov step far accuracy mode n range.. m remission.. stamp host stamp` is a scan with its
directions, without poses, and `ROBOTLASER1` has after the remissions the two poses, two speeds, the
axis of turns and two lengths. `PARAM name value` is a setting of the robot. Lengths are [m], angles
[rad], stamps [s]; a stamp has six digits and may go backwards, so the order of lines counts where
a scan has poses. Everything else is skipped.

Logs that gmapping has corrected hold the corrected pose in each FLASER, and again in a line `ODOM`
after it, from which odometry goes on; the stamp of that line means nothing, and may be near the
scan's by chance: one that is not tells what the log is. The raw odometry is chained from the ways
between.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import hypot, isfinite, pi

from pioneer3.geometry import ORIGIN, TURN, Pose2, wrap
from pioneer3.nav.logged import (
    NO_ECHO,
    LoggedDamage,
    LoggedOdometry,
    LoggedScan,
    Pairing,
    Reading,
    Sources,
    is_mount,
    is_pose,
    range_of,
)
from pioneer3.state import Scan

RANGE_PARAMETER = "robot_front_laser_max"
"""Parameter of the longest range of the front laser."""
SAME_POSE = 1e-3
"""Difference below which two poses are the same [m, rad]."""
STAMP_GAP = 1.0
"""Difference of neighbouring lines' stamps at most [s], unless one of them means nothing."""
FEWEST = 2
"""Readings of a scan at least."""
HEADER = 8
"""Words before the readings of a scan that tells its directions."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Message:
    """A kind of scan: whether it tells directions and range, and poses; `front`, `rear` or ``."""

    directed: bool
    posed: bool
    side: str


SIDES = ("front", "rear", "", "", "")
"""Lasers 1 to 5 of a robot; the parameters name two."""
MESSAGES = {
    "FLASER": _Message(directed=False, posed=True, side="front"),
    **{
        f"{word}{number}": _Message(directed=True, posed=word == "ROBOTLASER", side=side)
        for number, side in enumerate(SIDES, 1)
        for word in ("ROBOTLASER", "RAWLASER")
    },
    "RLASER": _Message(directed=False, posed=True, side="rear"),
}
"""Scans, those to be taken first before the others: the front laser, and with poses."""
WORDS = frozenset(("ODOM", "PARAM", "SYNC", "TRUEPOS", "NEFF", *MESSAGES))
"""First words of the lines of such logs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Sweep:
    """A scan as it is written; the poses of a line without them are `None`."""

    message: _Message
    angles: tuple[float, ...]
    ranges: tuple[float, ...]
    far: float
    laser: Pose2 | None
    robot: Pose2 | None
    stamp: float


class _Reader:
    """Chains the odometry and makes scans."""

    def __init__(self) -> None:
        self.far = NO_ECHO
        self._corrected = False
        self.mounts = {"front": ORIGIN, "rear": Pose2(0.0, 0.0, pi), "": ORIGIN}
        self._raw = ORIGIN
        self._anchor: Pose2 | None = None
        self._moved = False
        self._number = 0

    def move(self, pose: Pose2, stamp: float) -> LoggedOdometry:
        """Chain the way to a pose of the log's odometry."""
        if self._anchor is not None:
            self._raw @= self._anchor.inverse() @ pose
        self._moved |= pose != self._anchor
        self._anchor = pose
        return LoggedOdometry(stamp, self._raw)

    def posed(self, sweep: _Sweep, robot: Pose2, *, anchored: bool) -> LoggedScan:
        """Make a scan with poses; if `anchored`, odometry goes on from that of the robot.

        The way to it is a correction then, unless the log has no odometry since the last scan: then
        it is the only way that is known.
        """
        if not anchored or not self._moved:
            self.move(robot, sweep.stamp)
        self._anchor, self._moved = robot, False
        laser, known = sweep.laser or robot, self.mounts[sweep.message.side]
        mount = robot.inverse() @ laser
        if mount == ORIGIN and sweep.message.side == "rear":
            mount = known
        if sweep.message.directed:
            differs = not is_mount(mount)
        else:
            # a laser's pose is as far from the robot's as the laser; a corrected one is anywhere
            away, turned = known.inverse() @ mount, hypot(mount.x, mount.y) + abs(mount.theta)
            differs = hypot(away.x, away.y) + abs(away.theta) > SAME_POSE and turned > SAME_POSE
        scan = self.scan(sweep, self._raw, known if differs else mount)
        return LoggedScan(scan, laser if anchored or differs else None)

    def anchors(self, word: str, numbers: list[float], sweep: _Sweep) -> bool:
        """Return whether the line after a scan says that odometry goes on from the scan's pose."""
        robot = sweep.robot
        if robot is None or sweep.message.directed or word != "ODOM" or len(numbers) < 8:
            return False
        if numbers[:3] != [robot.x, robot.y, robot.theta]:
            return False
        self._corrected |= numbers[6] == 0 or abs(numbers[6] - sweep.stamp) > STAMP_GAP
        return self._corrected

    def scan(self, sweep: _Sweep, robot: Pose2, mount: Pose2) -> Scan:
        """Make a scan of a robot and a laser at these poses."""
        self._number += 1
        far = min(sweep.far, self.far if sweep.message.side == "front" else NO_ECHO)
        return Scan(
            stamp=sweep.stamp,
            sequence=self._number,
            robot_in_odom=robot,
            sensor_in_robot=mount,
            angles=sweep.angles,
            ranges=tuple(range_of(value, far) for value in sweep.ranges),
            far=far,
        )

    def set(self, name: str, value: float) -> None:
        """Take a parameter that tells the place or the range of a laser."""
        if name == RANGE_PARAMETER and value > 0:
            self.far = min(value, NO_ECHO)
        for side, mount in self.mounts.items():
            begin = f"robot_{side}laser_"
            if side and name.startswith(begin) and abs(value) < TURN:
                self.mounts[side] = {
                    "offset": Pose2(value, mount.y, mount.theta),
                    "side_offset": Pose2(mount.x, value, mount.theta),
                    "angular_offset": Pose2(mount.x, mount.y, wrap(value)),
                }.get(name.removeprefix(begin), mount)


def carmen_sources(lines: Iterable[str]) -> Sources:
    """Return the lasers of a log."""
    seen = {line.split(maxsplit=1)[0] for line in lines if line.strip()}
    return Sources(tuple(name for name in MESSAGES if name in seen), ("ODOM",))


def read_carmen(lines: Iterable[str], laser: str = "FLASER") -> Iterator[Reading | LoggedDamage]:
    """Yield the readings of a log in their order, and the lines that are damaged.

    Scans are those whose first word is `laser`.
    """
    reader, pairing, message = _Reader(), Pairing(), MESSAGES[laser]
    waiting: _Sweep | None = None
    for line_number, line in enumerate(lines, 1):
        words = line.split()
        if not words or words[0] not in ("ODOM", "PARAM", laser):
            continue
        if words[0] == "PARAM":
            if len(words) > 2 and isfinite(value := _number(words[2])):
                reader.set(words[1], value)
            continue
        numbers = [_number(word) for word in words[1:]]
        anchors = waiting is not None and reader.anchors(words[0], numbers, waiting)
        if waiting is not None and waiting.robot is not None:
            yield reader.posed(waiting, waiting.robot, anchored=anchors)
        waiting = None
        if words[0] == laser:
            sweep = _sweep(message, numbers)
            if sweep is None:
                yield LoggedDamage(line_number)
            elif sweep.robot is None:
                yield from pairing.scan(reader.scan(sweep, ORIGIN, reader.mounts[message.side]))
            else:
                waiting = sweep
        elif len(numbers) < 8 or not is_pose(Pose2(*numbers[:3])):
            yield LoggedDamage(line_number)
        elif not anchors:
            moved = reader.move(Pose2(*numbers[:3]), numbers[6])
            yield from (moved,) if message.posed else pairing.move(moved)
    if waiting is not None and waiting.robot is not None:
        yield reader.posed(waiting, waiting.robot, anchored=False)
    yield from pairing.rest()


def _sweep(message: _Message, numbers: list[float]) -> _Sweep | None:
    begin = HEADER if message.directed else 1
    count, after = _counted(numbers, begin)
    if count < FEWEST:
        return None
    # some logs leave out the last reading of a half circle
    angles, far = _directions(-pi / 2, pi, pi / (count - count % 2), count), NO_ECHO
    if message.directed:
        angles = _directions(numbers[1], numbers[2], numbers[3], count)
        far = min(numbers[4], NO_ECHO) if numbers[4] > 0 else NO_ECHO
        _, after = _counted(numbers, after + 1)
    laser = robot = None
    if message.posed:
        poses, after = numbers[after : after + 6], after + (11 if message.directed else 6)
        if len(poses) < 6:
            return None
        laser, robot = Pose2(*poses[:3]), Pose2(*poses[3:])
        if not (is_pose(laser) and is_pose(robot)):
            return None
    ranges = numbers[begin : begin + count]
    if not (angles and len(numbers) > after and isfinite(numbers[after] + sum(ranges))):
        return None
    return _Sweep(
        message=message,
        angles=angles,
        ranges=tuple(ranges),
        far=far,
        laser=laser,
        robot=robot,
        stamp=numbers[after],
    )


def _counted(numbers: list[float], begin: int) -> tuple[int, int]:
    """Return how many values begin here, by the number before them, and where they end."""
    told = numbers[begin - 1] if 0 < begin <= len(numbers) else 0.0
    count = int(told) if isfinite(told) and 0 <= told <= len(numbers) - begin else -1
    return count, begin + max(0, count)


@lru_cache
def _directions(start: float, fov: float, step: float, count: int) -> tuple[float, ...]:
    """Return the directions that a line tells; without any where they mean nothing.

    Some programs write other things than the step: it counts if it fills the field of view, with
    or without the last reading.
    """
    if not (isfinite(start) and 0 < fov <= TURN + SAME_POSE):
        return ()
    if not 0 < fov - step * (count - 1) + step / 2 < 2 * step:
        step = fov / (count - 1)
    return tuple(start + step * number for number in range(count))


def _number(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return float("nan")
