"""Remembers points that range sensors saw, in odometry's frame (facts.md 7.2)."""

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import chain, compress, groupby
from math import asin, atan2, ceil, cos, floor, hypot, inf, isfinite, nan, radians, sin
from typing import NamedTuple

from pioneer3.behaviors.surroundings import WINDOW, FieldOfView, Surroundings
from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.models import RobotModel
from pioneer3.state import Bumpers, Scan, Snapshot, Sonar


class StampedPoint(NamedTuple):
    """A point in the frame of the odometry [m], and the time it was seen [s]."""

    x: float
    y: float
    stamp: float


STALE_SCAN = 1.0
"""A scan older than this [s] says nothing of now."""
AGE = 30.0
"""Age up to which points are cumulative [s]."""
DISTANCE = 6.0
"""Distance from the robot up to which points are cumulative [m]."""
NEAR = 3.0
"""Range up to which points become cumulative [m]."""
SPACING = 0.2
"""Distance between two cumulative points at least [m]."""
MOST_POINTS = 500
"""Cumulative points that are kept at most."""
LEARN_EVERY = 0.5
"""So often a scan is taken in while nobody asks for what the sensors see [s]."""
CLEAN_EVERY = 1.0
"""Time between two looks whether cumulative points are still there [s]."""
CLEAR = 0.075
"""Distance by which all beams near a point pass it before it is forgotten [m]."""
PASSED = 0.05
"""Beams are near a point within this [m]: between beams of a degree a table's leg is easily lost,
and a pose by odometry is off by as much."""
SECTOR = radians(1)
"""Angle of a sector [rad]; only the nearest reading in each counts."""
POST = radians(10)
"""A laser sees around a mask no wider than this [rad]."""
HERE_AND_BESIDE = ((0, 0), *((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j))
"""Steps from a cell to itself, and to those around it."""
OWN = 0.03
"""A point so deep within the robot's outline is of the robot itself [m]."""


class LaserMemory:
    """The last scan, and points of those before.

    Points of the robot itself are left out. A laser forgets points that it sees past, but only its
    own: sonars hear glass that it looks through.
    """

    def __init__(self, model: RobotModel) -> None:
        self._model = model
        self.current: tuple[StampedPoint, ...] = ()
        self._fields: tuple[FieldOfView, ...] = ()
        self._cells: dict[
            tuple[int, int], StampedPoint
        ] = {}  # oldest first; at most one point in each
        self._sequence = -1
        self._cleaned = 0.0

    @property
    def cumulative(self) -> Iterable[StampedPoint]:
        """Points of earlier scans, too."""
        return self._cells.values()

    def add(self, scan: Scan) -> None:
        """Take in a scan; the same one again changes nothing."""
        if scan.sequence == self._sequence:
            return
        self._sequence = scan.sequence
        scan = thinned(scan)
        self._fields = fields_of(scan)
        sensor = scan.sensor_in_odom
        if scan.stamp - self._cleaned >= CLEAN_EVERY:
            self._cleaned = scan.stamp
            self._clean(scan, sensor)
        here, is_own = scan.robot_in_odom, self._own(scan.robot_in_odom)
        last = (scan.last_in_odom or here) @ scan.sensor_in_robot
        away = max(hypot(each.x - here.x, each.y - here.y) for each in (sensor, last))
        reach = min(NEAR, self._model.corner + away)
        ranges = [metres for metres in scan.ranges if isfinite(metres)]
        current = []
        for (x, y), metres in zip(scan.points_in_odom(), ranges, strict=True):
            point = StampedPoint(x, y, scan.stamp)
            if metres <= reach and is_own(x, y):
                continue
            if metres <= NEAR:
                self._remember(point)
            current.append(point)
        self.current = tuple(current)

    def forget(self, pose: Pose2, now: float) -> None:
        """Drop points that are too old or too far away."""
        if self.current and now - self.current[0].stamp > STALE_SCAN:
            self.current = ()
        x, y = pose.x, pose.y
        self._cells = {
            cell: point
            for cell, point in self._cells.items()
            if now - point[2] <= AGE and hypot(point[0] - x, point[1] - y) <= DISTANCE
        }

    def fields(self, now: float) -> tuple[FieldOfView, ...]:
        """Return the directions that it sees at `now` [s]; none while no scans come."""
        comes = self.current and now - self.current[0].stamp <= STALE_SCAN
        return self._fields if comes else ()

    def _remember(self, new: StampedPoint) -> None:
        cells, (x, y, _) = self._cells, new
        i, j = floor(x / SPACING), floor(y / SPACING)
        for di, dj in HERE_AND_BESIDE:
            old = cells.get((i + di, j + dj))
            if old is not None and hypot(old[0] - x, old[1] - y) < SPACING:
                return
        cells[i, j] = new
        if len(cells) > MOST_POINTS:
            del cells[next(iter(cells))]

    def _own(self, robot: Pose2) -> Callable[[float, float], bool]:
        """Return the test whether a place is within the robot's outline."""
        c, s = cos(robot.theta), sin(robot.theta)
        front, rear = self._model.length_front - OWN, OWN - self._model.length_rear
        side = self._model.width / 2 - OWN

        def is_own(x: float, y: float) -> bool:
            dx, dy = x - robot.x, y - robot.y
            return rear < c * dx + s * dy < front and abs(c * dy - s * dx) < side

        return is_own

    def _clean(self, scan: Scan, sensor: Pose2) -> None:
        """Forget points that all beams near them see past."""
        count = len(scan.ranges)
        step = (scan.angles[-1] - scan.angles[0]) / max(1, count - 1)
        if not step:
            return
        span = scan.angles[-1] - scan.angles[0]

        def stays(point: StampedPoint) -> bool:
            dx, dy = point.x - sensor.x, point.y - sensor.y
            away = hypot(dx, dy)
            off = wrap(atan2(dy, dx) - sensor.theta - scan.angles[0] - span / 2) + span / 2
            aside = asin(min(1.0, PASSED / max(away, PASSED)))
            first, last = floor((off - aside) / step), ceil((off + aside) / step)
            if first < 0 or last >= count:
                return True
            return not all(metres > away + CLEAR for metres in scan.ranges[first : last + 1])

        self._keep(stays)

    def _keep(self, stays: Callable[[StampedPoint], bool]) -> None:
        self._cells = {cell: point for cell, point in self._cells.items() if stays(point)}


def thinned(scan: Scan) -> Scan:
    """Return a scan with the nearest reading of each `SECTOR`; a coarse scan as it is.

    A sector's reading is in its middle, off by at most 9 mm at 1 m.
    """
    count = len(scan.ranges)
    step = (scan.angles[-1] - scan.angles[0]) / (count - 1) if count > 1 else SECTOR
    size = floor(SECTOR / step + 1e-6)
    if size < 2:
        return scan
    starts = range(0, count, size)
    first = scan.angles[0] + (size - 1) / 2 * step
    return replace(
        scan,
        angles=tuple(first + i * step for i in starts),
        ranges=_nearest_of(scan.ranges, size),
        reflectances=(),
        echoes=(),
        beam_time=scan.beam_time * size,
    )


def fields_of(scan: Scan) -> tuple[FieldOfView, ...]:
    """Return the directions of readings that are valid, in the robot's frame."""
    theta = scan.sensor_in_robot.theta
    if scan.ranges and _is_all_valid(scan.ranges):
        return (FieldOfView(theta + scan.angles[0] - POST / 2, theta + scan.angles[-1] + POST / 2),)
    readings = zip(scan.angles, scan.ranges, strict=True)
    runs = (
        [angle for angle, _ in run]
        for valid, run in groupby(readings, key=lambda reading: reading[1] > 0)
        if valid  # NaN and -inf are not
    )
    return tuple(FieldOfView(theta + run[0] - POST / 2, theta + run[-1] + POST / 2) for run in runs)


def _is_all_valid(ranges: Sequence[float]) -> bool:
    """Return whether no range is NaN or `-inf`, nor 0."""
    return sum(ranges) > -inf and min(ranges) > 0


def _nearest_of(ranges: Sequence[float], size: int) -> tuple[float, ...]:
    """Return the nearest range of each `size` neighbours; the last ones may be fewer."""
    if not _is_all_valid(ranges):
        return tuple([_nearest(ranges[i : i + size]) for i in range(0, len(ranges), size)])
    whole = len(ranges) // size * size
    nearest = map(min, *(ranges[place:whole:size] for place in range(size)))
    return (*nearest, min(ranges[whole:])) if whole < len(ranges) else tuple(nearest)


def _nearest(readings: Sequence[float]) -> float:
    """Return the nearest that echoed; `inf` if nothing did, NaN if any reading is not valid."""
    echoed = [metres for metres in readings if isfinite(metres)]
    if echoed:
        return min(echoed)
    return inf if all(metres == inf for metres in readings) else nan


SILENT = 1.0
"""A sonar that has told nothing new for this long [s] does not work."""
CONE = radians(15)
"""So far off its axis a sonar sees."""
CREEP = 0.02
"""Slower than this [m/s] says nothing of where the robot goes."""
BUMPER_ARC = radians(135)
"""The angle over which the segments of one end are spread (protocol.md 4.7)."""


@dataclass(frozen=True, slots=True)
class Capacity:
    """Numbers of points of a sensor that are kept, and their ages [s]; `cumulative` ones longer.

    Attributes:
        cumulative_distance: From the robot [m]; farther ones are neither taken nor kept.
        spacing: An older point nearer to a new one than this [m] is replaced by it.
    """

    current: int
    current_age: float
    cumulative: int
    cumulative_age: float
    cumulative_distance: float = inf
    spacing: float = 0.05


SONAR = Capacity(24, 5.0, 64, 15.0, cumulative_distance=3.0)
BUMPERS = Capacity(30, 15.0, 30, 15.0)


class RangeBuffer:
    """Points of one sensor; a full one drops its oldest."""

    def __init__(self, keep: Capacity) -> None:
        self._keep = keep
        self.current: deque[StampedPoint] = deque(maxlen=keep.current)
        self.cumulative: deque[StampedPoint] = deque(maxlen=keep.cumulative)

    def add(self, point: StampedPoint, distance: float) -> None:
        """Take a new point, `distance` [m] from the robot."""
        self.current.append(point)
        if distance < self._keep.cumulative_distance:
            near, (x, y, _) = self._keep.spacing, point
            self._keep_those([hypot(p[0] - x, p[1] - y) > near for p in self.cumulative])
            self.cumulative.append(point)

    def forget(self, pose: Pose2, now: float) -> None:
        """Drop points that are too old or too far away."""
        keep = self._keep
        while self.current and now - self.current[0].stamp > keep.current_age:
            self.current.popleft()
        age, far, x, y = keep.cumulative_age, keep.cumulative_distance, pose.x, pose.y
        self._keep_those(
            [now - at <= age and hypot(px - x, py - y) <= far for px, py, at in self.cumulative]
        )

    def _keep_those(self, stays: list[bool]) -> None:
        if not all(stays):
            self.cumulative = deque(compress(self.cumulative, stays), self._keep.cumulative)


class RangeMemory:
    """Takes in every snapshot of one robot; returns its surroundings."""

    def __init__(self, model: RobotModel) -> None:
        self.model = model
        self._pose, self._session = ORIGIN, 0
        self._scan: Scan | None = None
        self._forget_all()

    def update(self, snapshot: Snapshot, scans: Sequence[Scan] = ()) -> None:
        """Take in the next snapshot, and the last scan of each laser, in the lasers' order.

        Points of an earlier session go.
        """
        here, now = snapshot.odometry.robot_in_odom, snapshot.stamp
        if snapshot.link.sessions != self._session:
            self._session, self._pose = snapshot.link.sessions, here
            self._forget_all()
        # its readings were made on the way here: the pose before is as near (facts.md 7.2)
        self._listen(snapshot.sonar, self._pose, now)
        self._feel(snapshot.bumpers, here, now)
        self._push(snapshot, here, now)
        for number, scan in enumerate(scans):
            if now - scan.stamp <= STALE_SCAN:
                self._new[scan.laser] = scan
                self._scan = scan if number == 0 else self._scan
        if now >= self._learned_at + LEARN_EVERY:
            self._learn(now)
        for buffer in self._sensors:
            buffer.forget(here, now)
        self._pose = here

    def around(self, now: float) -> Surroundings:
        """Return the surroundings of the robot at its last snapshot, as known at `now` [s]."""
        self._learn(now)
        sensors = self._sensors
        return Surroundings(
            self._pose,
            [*chain.from_iterable(sensor.current for sensor in sensors)],
            [*chain.from_iterable(sensor.cumulative for sensor in sensors)],
            [*self._window(now)],
            fields=self._fields(now),
        )

    @property
    def _sensors(self) -> tuple[RangeBuffer | LaserMemory, ...]:
        return self._sonar, self._bumpers, *self._lasers.values()

    def newest_scan(self, now: float) -> Scan | None:
        """Return the last scan, unless it says nothing of `now` [s]."""
        scan = self._scan
        return scan if scan is not None and now - scan.stamp <= STALE_SCAN else None

    def _fields(self, now: float) -> tuple[FieldOfView, ...]:
        """Return the directions that sonars and lasers see."""
        axes = (self.model.sonars[n].theta for n, at in self._heard.items() if now - at <= SILENT)
        sonars = (FieldOfView(axis - CONE, axis + CONE) for axis in axes)
        lasers = (field for laser in self._lasers.values() for field in laser.fields(now))
        return (*sonars, *lasers)

    def _window(self, now: float) -> Iterable[StampedPoint]:
        points = (*self._sonar.current, *self._sonar.cumulative, *self._bumpers.current)
        seen = (point for laser in self._lasers.values() for point in laser.current)
        return dict.fromkeys((*seen, *(p for p in points if now - p.stamp <= WINDOW)))

    def _forget_all(self) -> None:
        self._sonar, self._bumpers = RangeBuffer(SONAR), RangeBuffer(BUMPERS)
        self._lasers: dict[str, LaserMemory] = {}
        self._new: dict[str, Scan] = {}  # not learned yet, by laser
        self._learned_at = -inf
        self._heard: dict[int, float] = {}  # when each transducer was read last [s]
        self._forwards = True
        self._scan = None

    def _learn(self, now: float) -> None:
        """Take in the scans that wait: it takes most of all time, and idle robots need few."""
        for name, scan in self._new.items():
            self._lasers.setdefault(name, LaserMemory(self.model)).add(scan)
        self._new.clear()
        self._learned_at = now

    def _listen(self, sonar: Sonar, pose: Pose2, now: float) -> None:
        mounts, c, s = self.model.sonars, cos(pose.theta), sin(pose.theta)
        for number in sonar.fresh:
            if number >= len(mounts):
                continue
            self._heard[number] = now
            metres = sonar.ranges[number]
            if isfinite(metres):
                mount = mounts[number]
                x = mount.x + cos(mount.theta) * metres
                y = mount.y + sin(mount.theta) * metres
                point = StampedPoint(pose.x + c * x - s * y, pose.y + s * x + c * y, now)
                self._sonar.add(point, hypot(x, y))

    def _push(self, snapshot: Snapshot, pose: Pose2, now: float) -> None:
        """Take a stall for something at the corners it drove with: sonars had not seen it."""
        v, motors = snapshot.odometry.twist.v, snapshot.motors
        if not motors.stalled:
            self._forwards = v > 0 if abs(v) > CREEP else self._forwards
            return
        model = self.model
        x = model.length_front if self._forwards else -model.length_rear
        for stalled, side in ((motors.left_stalled, 1), (motors.right_stalled, -1)):
            if stalled:
                point = pose @ Pose2(x, side * model.width / 2)
                self._bumpers.add(StampedPoint(point.x, point.y, now), model.radius)

    def _feel(self, bumpers: Bumpers, pose: Pose2, now: float) -> None:
        for behind, segments in ((0.0, bumpers.front), (radians(180), bumpers.rear)):
            for i, hit in enumerate(segments):
                if hit:
                    bearing = behind + BUMPER_ARC / 2 - (i + 0.5) * BUMPER_ARC / len(segments)
                    point = pose @ Pose2(theta=bearing) @ Pose2(self.model.radius)
                    self._bumpers.add(StampedPoint(point.x, point.y, now), self.model.radius)
