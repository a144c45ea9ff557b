"""Remembers what the range sensors saw, in odometry's frame (arcos.md 7.2)."""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from math import hypot, inf, isfinite, radians

from pioneer3.behaviors.laser_memory import STALE, LaserMemory
from pioneer3.behaviors.seen import Seen
from pioneer3.behaviors.surroundings import LATELY, Surroundings
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models import RobotModel
from pioneer3.state import Bumpers, Scan, Snapshot, Sonar

SILENT = 1.0
"""A sonar that has told nothing new for this long [s] does not work."""
CREEP = 0.02
"""Slower than this [m/s] says nothing of where the robot goes."""
BUMPER_ARC = radians(135)
"""The angle over which the segments of one end are spread (arcos.md 4.7)."""


@dataclass(frozen=True, slots=True)
class Keep:
    """How much of a sensor is kept, for how long.

    Attributes:
        recent: Number of points.
        recent_age: [s].
        remembered: Number of points of the longer memory.
        remembered_age: [s].
        remembered_distance: From the robot [m]; farther ones are neither taken nor kept.
        spacing: An older point nearer to a new one than this [m] is replaced by it.
    """

    recent: int
    recent_age: float
    remembered: int
    remembered_age: float
    remembered_distance: float = inf
    spacing: float = 0.05


SONAR = Keep(24, 5.0, 64, 15.0, remembered_distance=3.0)
BUMPERS = Keep(30, 15.0, 30, 15.0)


class RangeBuffer:
    """Points of one sensor; a full one drops its oldest."""

    def __init__(self, keep: Keep) -> None:
        self._keep = keep
        self.recent: deque[Seen] = deque(maxlen=keep.recent)
        self.remembered: deque[Seen] = deque(maxlen=keep.remembered)

    def add(self, point: Seen, distance: float) -> None:
        """Take a new point, `distance` [m] from the robot."""
        self.recent.append(point)
        if distance < self._keep.remembered_distance:
            self._drop_near(point)
            self.remembered.append(point)

    def forget(self, pose: Pose2, now: float) -> None:
        """Drop what is too old, and what has been left behind."""
        keep = self._keep
        while self.recent and now - self.recent[0].stamp > keep.recent_age:
            self.recent.popleft()
        kept = [
            point
            for point in self.remembered
            if now - point.stamp <= keep.remembered_age
            and hypot(point.x - pose.x, point.y - pose.y) <= keep.remembered_distance
        ]
        if len(kept) < len(self.remembered):
            self.remembered = deque(kept, maxlen=keep.remembered)

    def _drop_near(self, new: Seen) -> None:
        spacing = self._keep.spacing
        kept = [p for p in self.remembered if hypot(p.x - new.x, p.y - new.y) > spacing]
        if len(kept) < len(self.remembered):
            self.remembered = deque(kept, maxlen=self._keep.remembered)


class RangeMemory:
    """Takes in every reading of one robot; says what is around."""

    def __init__(self, model: RobotModel) -> None:
        self.model = model
        self._pose, self._session = ORIGIN, 0
        self._forget_all()

    def update(self, snapshot: Snapshot, scan: Scan | None = None) -> None:
        """Take in the next reading, and the last scan. What an earlier session saw is forgotten."""
        here, now = snapshot.odometry.robot_in_odom, snapshot.stamp
        if snapshot.link.sessions != self._session:
            self._session, self._pose = snapshot.link.sessions, here
            self._forget_all()
        # readings were made on the way here: the pose before is as near (arcos.md 7.2)
        self._listen(snapshot.sonar, self._pose, now)
        self._feel(snapshot.bumpers, here, now)
        self._push(snapshot, here, now)
        if scan is not None and now - scan.stamp <= STALE:
            self._laser.add(scan)
        for buffer in (self._sonar, self._bumpers, self._laser):
            buffer.forget(here, now)
        self._pose = here

    def around(self, now: float) -> Surroundings:
        """Return what is around the robot where it was last heard of, as known at `now` [s]."""
        sensors = (self._sonar, self._bumpers, self._laser)
        return Surroundings(
            self._pose,
            [(p.x, p.y) for sensor in sensors for p in sensor.recent],
            [(p.x, p.y) for sensor in sensors for p in sensor.remembered],
            [(p.x, p.y) for p in self._seen_lately(now)],
            sensing=now - self._heard <= SILENT or self._laser.sensing(now),
        )

    def _seen_lately(self, now: float) -> Iterable[Seen]:
        points = (*self._sonar.recent, *self._sonar.remembered, *self._bumpers.recent)
        return dict.fromkeys((*self._laser.recent, *(p for p in points if now - p.stamp <= LATELY)))

    def _forget_all(self) -> None:
        self._sonar, self._bumpers = RangeBuffer(SONAR), RangeBuffer(BUMPERS)
        self._laser, self._heard, self._forwards = LaserMemory(), -inf, True

    def _listen(self, sonar: Sonar, pose: Pose2, now: float) -> None:
        mounts = self.model.sonars
        for number in sonar.fresh:
            if number >= len(mounts):
                continue
            self._heard = now
            metres = sonar.ranges[number]
            if isfinite(metres):
                mount = mounts[number]
                echo = Pose2(mount.x, mount.y, mount.theta) @ Pose2(metres)
                point = pose @ echo
                self._sonar.add(Seen(point.x, point.y, now), hypot(echo.x, echo.y))

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
                self._bumpers.add(Seen(point.x, point.y, now), model.radius)

    def _feel(self, bumpers: Bumpers, pose: Pose2, now: float) -> None:
        for behind, segments in ((0.0, bumpers.front), (radians(180), bumpers.rear)):
            for i, hit in enumerate(segments):
                if hit:
                    bearing = behind + BUMPER_ARC / 2 - (i + 0.5) * BUMPER_ARC / len(segments)
                    point = pose @ Pose2(theta=bearing) @ Pose2(self.model.radius)
                    self._bumpers.add(Seen(point.x, point.y, now), self.model.radius)
