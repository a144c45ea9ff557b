"""Where a laser was at each stand, by its scans: against a map, or against each other."""

from collections.abc import Sequence
from math import hypot, radians

import numpy as np

from pioneer3.arrays import Float
from pioneer3.calibration.course import StepDrive
from pioneer3.calibration.ends import MeasuredRun
from pioneer3.errors import DeviceError
from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.maps import LineMap
from pioneer3.maps.grid import samples
from pioneer3.models import OdometryCorrection
from pioneer3.nav.beams import Beams
from pioneer3.nav.matching import Cloud, Prior, Submap
from pioneer3.state import Scan

WAY_ERROR = 0.06
"""Error of a way by wheels that were never measured, as a share of it."""
TURN_ERROR = 0.12
"""Error of a turn, as a share of it; a robot that skids has more than others."""
BEND = 0.12
"""Error of the heading by the way [rad/m]."""
NEAR = 0.05
"""Error of anything besides [m]."""
NEAR_TURN = radians(3)
"""Error of a heading besides [rad]."""
LEAST_INLIERS = 0.5
"""Share of a scan that has to lie on what was seen before."""
WALL_CELL = 0.05
"""Distance of points on the walls of a map [m]."""
SET_DOWN = 0.5
"""A robot may have been put elsewhere between two steps, by this way and turn [m, rad]."""
SIGMA = 0.004
"""Standard deviation of a place by scans [m]."""
TURN_SIGMA = radians(0.1)
"""Standard deviation of a heading by scans [rad]."""
FAST = radians(12)
"""Turn rate from which on a scan tells of its time [rad/s]."""
STEADY = 0.15
"""Longest time between two reports around a scan [s]."""
FEWEST_SCANS = 12
"""Scans from which on the time of a laser is certain."""


class SeenPoses:
    """Poses of a laser in one frame. Scans that fit are added to what others are compared with.

    With a map, `walls`, the frame is the map's, and `begin` the laser's pose at the first stand.
    """

    def __init__(self, walls: LineMap | None = None, begin: Pose2 = ORIGIN) -> None:
        self.latest = begin
        self._clouds: list[Cloud] = []
        self._poses: list[Pose2] = []
        self._on_map = walls is not None
        if walls is not None:
            self._clouds.append(_cloud_of(walls))
            self._poses.append(ORIGIN)
        self._submap: Submap | None = None

    def add(self, scan: Scan, moved: Pose2 = ORIGIN, way: float = 0.0, turn: float = 0.0) -> Pose2:
        """Return where the laser is at a stand.

        It has `moved` since the one before, by odometry, which is after a `way` [m] and a `turn`
        [rad].

        Raises:
            DeviceError: The scan fits nothing that was seen before.
        """
        cloud = cloud_of(scan)
        if self._clouds:
            self.latest = self._found(cloud, self.latest @ moved, way, turn)
        if not self._on_map:
            self._clouds.append(cloud)
            self._poses.append(self.latest)
            self._submap = None
        return self.latest

    def near(self, cloud: Cloud, guess: Pose2) -> Pose2 | None:
        """Return where a scan fits near `guess`, if it does."""
        match = self._all.match(cloud, guess, Prior.around(guess, 1.0, 1.0))
        return match.pose if match.inliers > LEAST_INLIERS else None

    @property
    def _all(self) -> Submap:
        if self._submap is None:
            self._submap = Submap(self._clouds, self._poses)
        return self._submap

    def _found(self, cloud: Cloud, guess: Pose2, way: float, turn: float) -> Pose2:
        askew = NEAR_TURN + TURN_ERROR * turn + BEND * way
        off = NEAR + WAY_ERROR * way + askew * way / 2 + 0.2 * min(turn, 1.0)
        rough = self._all.search(cloud.points, guess, min(off, 0.8), min(askew, 0.6))
        found = self.near(cloud, rough)
        if found is None or hypot(found.x - guess.x, found.y - guess.y) > 2 * off:
            raise DeviceError("the laser does not see again what it saw before: repeat this step")
        return found


def cloud_of(scan: Scan, turn_rate: float = 0.0) -> Cloud:
    """Return the points of a scan in the laser's frame at its middle, while it turns [rad/s]."""
    angles, ranges = np.array(scan.angles), np.array(scan.ranges)
    middle = (len(angles) - 1) / 2
    bearings = angles + turn_rate * scan.beam_time * (np.arange(len(angles)) - middle)
    hit = np.isfinite(ranges)
    points = ranges[hit, None] * np.stack([np.cos(bearings), np.sin(bearings)], axis=1)[hit]
    nothing = np.empty((0, 2))
    return Cloud.of(
        Beams(
            stamp=scan.stamp,
            robot_in_odom=ORIGIN,
            points=points,
            clear=nothing,
            origin=np.zeros(2),
            far=scan.far,
        )
    )


def _cloud_of(line_map: LineMap) -> Cloud:
    """Return points of a map's walls, with their normals."""
    points = samples(line_map.walls, WALL_CELL)
    ways = line_map.walls[:, 2:] - line_map.walls[:, :2]
    lengths = np.maximum(np.hypot(*ways.T), 1e-9)
    normals = np.stack([-ways[:, 1], ways[:, 0]], axis=1) / lengths[:, None]
    counts = [len(samples(wall[None], WALL_CELL)) for wall in line_map.walls]
    return Cloud(np.ascontiguousarray(points), np.repeat(normals, counts, axis=0))


def seen_runs(
    drive: StepDrive,
    poses: SeenPoses,
    correction: OdometryCorrection,
    wheel_base: float,
    laser: Pose2,
) -> tuple[Pose2, list[MeasuredRun]]:
    """Return where the laser was first, and the runs from there to each stand, as it saw them."""
    corrected = drive.track.poses(correction, wheel_base)
    begin = poses.add(drive.stands[0], way=SET_DOWN, turn=SET_DOWN)
    runs, turned, before = [], 0.0, 0
    for number, (mark, scan) in enumerate(zip(drive.marks, drive.stands, strict=True)):
        if number == 0:
            before = mark
            continue
        part = drive.track.part(before, mark)
        moved = Pose2(*corrected[before].tolist()).inverse() @ Pose2(*corrected[mark].tolist())
        seen_before = poses.latest
        seen = poses.add(scan, laser.inverse() @ moved @ laser, part.way, part.turn)
        expected = float(corrected[mark, 2] - corrected[before, 2])
        turned += expected + wrap(seen.theta - seen_before.theta - expected)
        there = begin.inverse() @ seen
        runs.append(
            MeasuredRun(
                track=drive.track.part(drive.marks[0], mark),
                end=(there.x, there.y, turned),
                sigma=(SIGMA, SIGMA, TURN_SIGMA),
                of_laser=True,
                name=f"stand {number}",
            )
        )
        before = mark
    return begin, runs


def delays(drive: StepDrive, poses: SeenPoses, headings: Float, laser_at: Float) -> Float:
    """Return by how much each scan of a robot that turns is late [s], shape (K,).

    `headings` (N + 1,) are those of the laser in the frame of `poses` by corrected odometry, and
    `laser_at` (N + 1, 2) its places [m].
    """
    found, track = [], drive.track
    for scan in drive.scans:
        stamp = scan.stamp + scan.beam_time * (len(scan.angles) - 1) / 2
        after = int(np.searchsorted(track.stamps, stamp))
        if not 2 <= after < len(track.stamps) - 1:
            continue
        span = track.stamps[after + 1] - track.stamps[after - 2]
        rate = float((headings[after + 1] - headings[after - 2]) / span)
        if abs(rate) < FAST or track.stamps[after] - track.stamps[after - 1] > STEADY:
            continue
        heading = float(np.interp(stamp, track.stamps, headings))
        x, y = (float(np.interp(stamp, track.stamps, laser_at[:, i])) for i in range(2))
        seen = poses.near(cloud_of(scan, rate), Pose2(x, y, wrap(heading)))
        if seen is not None:
            found.append(wrap(heading - seen.theta) / rate)
    return np.array(found)


def delay_of(late: Sequence[Float]) -> tuple[float, float] | None:
    """Return the delay of a laser and its standard deviation [s], if enough scans tell it."""
    each = np.concatenate([*late, np.empty(0)])
    if len(each) < FEWEST_SCANS:
        return None
    middle = float(np.median(each))
    spread = 1.4826 * float(np.median(np.abs(each - middle)))
    return middle, max(0.001, 1.25 * spread / float(np.sqrt(len(each))))
