"""Makes a map: poses of a robot, live, from scans and odometry.

In every tick :meth:`Mapper.add` matches a scan against the last key frames. What takes longer is
left to a thread: it is given a :attr:`Mapper.snapshot`, whose `improve` finds loops and better
poses, and :meth:`Mapper.apply` takes the result, whatever has been added meanwhile.
"""

from collections.abc import Mapping
from dataclasses import replace
from math import cos, hypot, sin
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.frames import Edge, KeyFrame, Survey
from pioneer3.nav.loops import Improvement, Snapshot, certainty
from pioneer3.nav.matching import Cloud, Match, Prior, Submap
from pioneer3.nav.survey_arrays import arrays_of, survey_of

Float = NDArray[np.float64]

APART, TURNED = 0.25, 0.25
"""A key frame is made so far from the last one [m, rad]."""
RECENT = 30
"""Scans are matched against so many key frames."""
SLIP, TURN_SLIP, BEND = 0.03, 0.1, 0.05
"""Errors of odometry, sigma: of a way, of a turn, twice that of skid steering, and the turn per
way, that of wheels one of which is 2 % larger [rad/m]."""
LEVER = 0.03
"""The place of a laser, and of the middle of a turn, are not known better than this [m]."""
STILL, STILL_TURN = 0.007, 0.01
"""Errors of a stretch without a way: of the time of odometry, mostly [m, rad]."""
SIGMAS = 2.5
"""The pose is searched for within so many of these."""
WIDE, WIDE_TURN = 0.12, 0.1
"""Where a scan may lie farther off than this [m, rad], matching needs a search before it."""
BEGIN, BEGIN_TURN = 1.0, 0.5
"""A map is continued from within this of where the robot is said to be [m, rad]."""
TRACKED, SURE, NEAR = 0.1, 0.4, 16.0
"""With fewer inliers a scan does not fit. Around a corner little of it was seen before: unless
there are more, its pose is not to be farther from odometry's than this [squared sigmas]."""
FOUND = 0.5
"""Fewer inliers mean that the place to continue from is not found."""
UNKNOWN = np.diag([1.0, 1.0, 10.0])
"""Information of the way to a place that was not found."""
STRAIGHT, ASKEW = 0.1, 0.2
"""Ways with smaller turns tell where a laser looks; it is not farther off than the latter [rad]."""
HELD = 0.5
"""Weighs against all ways that a laser looks where it is said to [m^2]: about two metres."""


class _Mounting:
    """Finds out how far a laser is turned from where it is said to look.

    A robot that drives ahead moves aside in the scans of such a laser. The prior of odometry would
    pull it back at each scan, and bend straight walls.
    """

    def __init__(self) -> None:
        self._along, self._aside = HELD, 0.0

    @property
    def angle(self) -> float:
        """[rad]; positive if it is turned to the left."""
        return self._aside / self._along

    def take(self, odometry: Pose2, step: Pose2) -> None:
        """Learn from a way by odometry that is known by scans as `step`."""
        if max(abs(odometry.theta), abs(step.theta)) > STRAIGHT:
            return
        # along the chords, as turns may be told wrong
        half = (step.theta - odometry.theta) / 2
        c, s = cos(half), sin(half)
        x, y = c * odometry.x - s * odometry.y, s * odometry.x + c * odometry.y
        along, aside = step.x * x + step.y * y, step.x * y - step.y * x
        if abs(aside) < ASKEW * along:
            self._along += along
            self._aside += aside

    def seen(self, odometry: Pose2, origin: Float) -> Pose2:
        """Return a way by odometry as it is in the scans of a laser at `origin` (2,) [m]."""
        x, y = origin.tolist()
        turned = Pose2(x, y, self.angle) @ Pose2(-x, -y)
        return turned.inverse() @ odometry @ turned


class Mapper:
    """Makes a map from scans and odometry.

    Args:
        start: Where the robot begins, in the map.
    """

    def __init__(self, start: Pose2 = ORIGIN) -> None:
        self._survey = Survey((), (), ())
        self._recent: tuple[int, ...] = ()
        self._submap = Submap((), ())
        self._here = start
        self._match: Match | None = None
        self._odom: Pose2 | None = None
        self._odom_of_scan: Pose2 | None = None
        self._way = self._turn = 0.0
        self._way_of_scan = self._turn_of_scan = 0.0
        self._looked, self._waiting = 0, tuple[Edge, ...]()
        self._mounting = _Mounting()

    @classmethod
    def of(cls, state: Mapping[str, NDArray[Any]], start: Pose2 | None = None) -> Self:
        """Return a mapper that goes on with a map.

        Args:
            state: As of :attr:`state`.
            start: Where the robot is now, roughly; if not given, where it was last.
        """
        survey, looked, waiting = survey_of(state)
        mapper = cls(start or (survey.poses[-1] if survey.poses else ORIGIN))
        mapper._survey, mapper._looked, mapper._waiting = survey, looked, waiting
        if survey.frames:
            mapper._way, mapper._turn = survey.frames[-1].way, survey.frames[-1].turn
            away = [hypot(p.x - mapper._here.x, p.y - mapper._here.y) for p in survey.poses]
            mapper._recall(tuple(np.argsort(away)[:RECENT].tolist()))
        for edge in survey.edges:
            if not edge.loop and edge.second == edge.first + 1:
                first, second = survey.frames[edge.first], survey.frames[edge.second]
                odometry = first.beams.robot_in_odom.inverse() @ second.beams.robot_in_odom
                mapper._mounting.take(odometry, edge.second_in_first)
        return mapper

    @property
    def state(self) -> dict[str, NDArray[Any]]:
        """All that a map is made of, as arrays that can be written to a file."""
        return arrays_of(self._survey, self._looked, self._waiting)

    @property
    def survey(self) -> Survey:
        """The key frames, their poses and the ways between them."""
        return self._survey

    @property
    def robot_in_map(self) -> Pose2:
        """Pose of the robot at the last scan, or at the last reading of odometry after it."""
        if self._odom is None or self._odom_of_scan is None:
            return self._here
        return self._here @ (self._odom_of_scan.inverse() @ self._odom)

    @property
    def odom_in_map(self) -> Pose2:
        """Pose of odometry's frame."""
        if self._odom_of_scan is None:
            return self._here
        return self._here @ self._odom_of_scan.inverse()

    @property
    def inliers(self) -> float:
        """Share of the last scan that fits the scans before it."""
        return self._match.inliers if self._match is not None else 0.0

    @property
    def mounting_error(self) -> float:
        """How far the laser is turned to the left of where it is said to look [rad]."""
        return self._mounting.angle

    @property
    def snapshot(self) -> Snapshot:
        """The map at this instant, to be improved in a thread."""
        return Snapshot(survey=self._survey, looked=self._looked, waiting=self._waiting)

    def move(self, robot_in_odom: Pose2) -> None:
        """Note odometry between scans: a long way there and back is less certain than none."""
        if self._odom is not None:
            step = self._odom.inverse() @ robot_in_odom
            self._way += hypot(step.x, step.y)
            self._turn += abs(step.theta)
        self._odom = robot_in_odom

    def add(self, beams: Beams) -> Pose2:
        """Take a scan; return the pose of the robot in the map."""
        self.move(beams.robot_in_odom)
        cloud = Cloud.of(beams)
        if not self._survey.frames:
            self._keep(KeyFrame.of(beams, cloud, self._way, self._turn), ())
        elif self._odom_of_scan is None:
            self._continue(beams, cloud)
        else:
            self._track(beams, cloud, self._odom_of_scan)
        self._odom_of_scan = beams.robot_in_odom
        self._way_of_scan, self._turn_of_scan = self._way, self._turn
        return self._here

    def apply(self, improvement: Improvement) -> None:
        """Take better poses for the key frames of a snapshot; what came later moves along."""
        survey, count = self._survey, len(improvement.poses)
        self._looked, self._waiting = improvement.looked, improvement.waiting
        later = tuple(edge for edge in survey.edges if edge.second >= count)
        poses = improvement.poses
        if count and poses != survey.poses[:count]:
            moved = poses[-1] @ survey.poses[count - 1].inverse()
            poses += tuple(moved @ pose for pose in survey.poses[count:])
            self._here = moved @ self._here
        else:
            poses = survey.poses
        changed = poses is not survey.poses
        self._survey = Survey(survey.frames, poses, improvement.edges + later)
        if changed:
            self._recall(self._recent)

    def _track(self, beams: Beams, cloud: Cloud, odom_of_scan: Pose2) -> None:
        """Find the robot where odometry leads to from the last key frame and scan."""
        key = self._survey.frames[-1]
        since_key = key.beams.robot_in_odom.inverse() @ beams.robot_in_odom
        odometry = self._mounting.seen(since_key, beams.origin)
        prior = _expected(
            self._survey.poses[-1], odometry, self._way - key.way, self._turn - key.turn
        )
        odometry = odom_of_scan.inverse() @ beams.robot_in_odom
        odometry = self._mounting.seen(odometry, beams.origin)
        guess = self._here @ odometry
        way, turn = self._way - self._way_of_scan, self._turn - self._turn_of_scan
        if self._way_of_scan + self._turn_of_scan > key.way + key.turn:
            # nothing that walks along with the robot is to take it with it in small steps
            prior = prior.joined(_expected(self._here, odometry, way, turn))
        sigma, sigma_theta = _slip(way, turn)
        aside = hypot(odometry.x, odometry.y) * sigma_theta
        way, turn = SIGMAS * (sigma + aside / 2), SIGMAS * sigma_theta
        if way > WIDE or turn > WIDE_TURN:
            guess, _ = self._submap.search(cloud.points, guess, way, turn)
        match = self._match = self._submap.match(cloud, guess, prior)
        least = SURE if prior.squared_error(match.pose) > NEAR else TRACKED
        if match.inliers < least:
            match = Match(pose=prior.pose, information=np.zeros((3, 3)), inliers=match.inliers)
        self._here = match.pose
        step = self._survey.poses[-1].inverse() @ self._here
        if hypot(step.x, step.y) >= APART or abs(step.theta) >= TURNED:
            self._mounting.take(since_key, step)
            number = len(self._survey.frames)
            edge = Edge(number - 1, number, step, certainty(match, prior.information))
            self._keep(KeyFrame.of(beams, cloud, self._way, self._turn), (edge,))

    def _continue(self, beams: Beams, cloud: Cloud) -> None:
        """Find the robot near where it is said to be on a map that was made before."""
        said = self._here
        guess, _ = self._submap.search(cloud.points, said, BEGIN, BEGIN_TURN)
        prior = Prior(said, UNKNOWN)
        match = self._match = self._submap.match(cloud, guess, prior)
        if match.inliers < FOUND:
            match = Match(pose=said, information=np.zeros((3, 3)), inliers=match.inliers)
        self._here = match.pose
        old = self._recent[0]
        way = self._survey.poses[old].inverse() @ self._here
        edge = Edge(old, len(self._survey.frames), way, certainty(match, UNKNOWN))
        self._keep(KeyFrame.of(beams, cloud, self._way, self._turn), (edge,))

    def _keep(self, frame: KeyFrame, edges: tuple[Edge, ...]) -> None:
        survey = self._survey
        number = len(survey.frames)
        self._survey = Survey(
            (*survey.frames, frame), (*survey.poses, self._here), survey.edges + edges
        )
        self._recall((*self._recent, number)[-RECENT:])

    def _recall(self, numbers: tuple[int, ...]) -> None:
        """Match against these key frames from now on."""
        survey, self._recent = self._survey, numbers
        self._submap = Submap(
            [survey.frames[number].cloud for number in numbers],
            [survey.poses[number] for number in numbers],
        )


def prepare() -> None:
    """Compile the kernels, or load them: seconds once, which no tick has to spare."""
    angles = np.linspace(-1.5, 1.5, 60)
    wall = 2.0 * np.stack([np.ones_like(angles), np.tan(angles)], axis=1)
    beams = Beams(
        stamp=0.0,
        robot_in_odom=ORIGIN,
        points=wall,
        clear=np.empty((0, 2)),
        origin=np.zeros(2),
        far=10.0,
    )
    mapper = Mapper()
    for number in range(3):
        mapper.add(replace(beams, robot_in_odom=Pose2(0.2 * number)))
    Mapper.of(mapper.state).add(beams)


def _expected(begin: Pose2, odometry: Pose2, way: float, turn: float) -> Prior:
    """Return where odometry leads to.

    An error of the heading that arises somewhere on the way puts the robot aside of its end, by
    between none and all of it, and half of it if it arises evenly.
    """
    sigma, sigma_theta = _slip(way, turn)
    end = begin @ odometry
    aside = np.array([begin.y - end.y, end.x - begin.x])
    even = sigma_theta * np.array([*(aside / 2), 1.0])
    covariance = np.outer(even, even)
    covariance[:2, :2] += np.outer(aside, aside) * sigma_theta**2 / 12
    covariance += np.diag([sigma**2, sigma**2, 0.0])
    return Prior(end, np.linalg.inv(covariance).astype(np.float64))


def _slip(way: float, turn: float) -> tuple[float, float]:
    """Return the standard deviations of odometry [m, rad] after a way and a turn."""
    return STILL + SLIP * way + LEVER * turn, STILL_TURN + TURN_SLIP * turn + BEND * way
