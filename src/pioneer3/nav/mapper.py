"""Makes a map: poses of a robot, live, from scans and odometry.

In every tick :meth:`Mapper.add` matches a scan against the last key frames. What takes longer is
left to a thread: it is given a :attr:`Mapper.snapshot`, whose `improve` finds loops and better
poses, and :meth:`Mapper.apply` takes the result, whatever has been added meanwhile.
"""

from collections.abc import Mapping
from math import hypot
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from pioneer3.arrays import Float
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.beams import Beams
from pioneer3.nav.frames import Edge, KeyFrame, Survey, arrays_of, survey_of
from pioneer3.nav.graph import pieces_of
from pioneer3.nav.loops import RECENT_FRAMES, Improvement, MapSnapshot, certainty
from pioneer3.nav.matching import Cloud, Match, Prior, Submap
from pioneer3.nav.mounting import LearnedMounting
from pioneer3.nav.odometry import (
    SEARCHED_SIGMAS,
    SEARCHED_TURN,
    SEARCHED_WAY,
    LearnedScale,
    backwards,
    expected_pose,
    search_window,
    slip,
)
from pioneer3.nav.pose_graph import Progress
from pioneer3.nav.relocalization import CLEARLY, CONTRADICTED, Vicinity
from pioneer3.nav.settings import AS_SHIPPED, MapperSettings

WIDE_WAY = 0.12
"""Distance of a scan above which matching needs a search before it [m]."""
WIDE_TURN = 0.1
"""Turn of a scan above which matching needs a search before it [rad]."""
BEGIN_WAY = 1.0
"""Distance from where the robot is said to be within which a map is continued [m]."""
BEGIN_TURN = 0.5
"""Difference from the heading that is said within which a map is continued [rad]."""
TRACKED_INLIERS = 0.1
"""Share of inliers below which a scan does not fit."""
SURE_INLIERS = 0.4
"""Share of inliers from which on a pose may be far from odometry's. Around a corner little of a
scan was seen before."""
LOST_INLIERS = 0.3
"""Share of inliers from which on a scan that contradicts others was taken near them all the same:
where there is much glass, or many people are."""
LOST_CONTRADICTION = 0.3
"""Share of contradictions below which a scan that is found nowhere stays where odometry has it."""
NEAR_ODOMETRY = 16.0
"""Squared error up to which a pose is near odometry's [squared sigmas]."""
LIFTED_WAY = 1.0
"""Distance within which a robot is looked for at once that was moved without its odometry [m]."""
FOUND_INLIERS = 0.5
"""Share of inliers below which the place to continue from is not found."""
UNKNOWN_WAY = np.diag([1.0, 1.0, 10.0])
"""Information of the way to a place that was not found."""
PLAINLY = 0.2
"""Share of a scan by which it fits better where odometry is called wrong; or half of what does not
fit by odometry."""
SLIPPED = 0.01
"""Share of its information that odometry has where a scan says otherwise."""
UNSURE = 0.04
"""Share of its information that such a scan has for the map."""
TORN_WAY = 1e-4 * UNKNOWN_WAY
"""Information of a way that odometry missed."""


class Mapper:
    """Makes a map from scans and odometry; the robot begins at `start` in it.

    With `repair`, scans tell where odometry is wrong: in the sign of ways, or altogether.
    """

    def __init__(
        self,
        start: Pose2 = ORIGIN,
        settings: MapperSettings = AS_SHIPPED.mapper,
        *,
        repair: bool = False,
    ) -> None:
        self._settings, self._repair, self._reversed = settings, repair, False
        self._survey = Survey((), (), ())
        self._recent: tuple[int, ...] = ()
        self._submap = Submap((), ())
        self._vicinity = Vicinity((), (), self._submap)
        self._here = start
        self._match: Match | None = None
        self._odom: Pose2 | None = None
        self._odom_of_scan: Pose2 | None = None
        self._way = self._turn = 0.0
        self._way_of_scan = self._turn_of_scan = 0.0
        self._progress = Progress()
        self._mounting, self._scale = LearnedMounting(), LearnedScale()
        self._pieces, self._moves, self._moved_at = 1, 0, -1
        self._missed = False

    @classmethod
    def of(
        cls,
        state: Mapping[str, NDArray[Any]],
        start: Pose2 | None = None,
        settings: MapperSettings = AS_SHIPPED.mapper,
    ) -> Self:
        """Return a mapper that goes on with the map of a :attr:`state`.

        The robot is now at `start`, roughly; if that is not given, where it was last.
        """
        survey, looked, waiting = survey_of(state)
        mapper = cls(start or (survey.poses[-1] if survey.poses else ORIGIN), settings)
        mapper._survey, mapper._progress = survey, Progress(looked=looked, waiting=waiting)
        if survey.frames:
            mapper._pieces = len(np.unique(pieces_of(len(survey.frames), survey.edges)))
            mapper._way, mapper._turn = survey.frames[-1].way, survey.frames[-1].turn
            away = [hypot(p.x - mapper._here.x, p.y - mapper._here.y) for p in survey.poses]
            mapper._recall(tuple(np.argsort(away)[:RECENT_FRAMES].tolist()))
        for edge in survey.edges:
            mapper._note(edge)
            if not edge.loop and edge.second == edge.first + 1:
                first, second = survey.frames[edge.first], survey.frames[edge.second]
                odometry = first.beams.robot_in_odom.inverse() @ second.beams.robot_in_odom
                mapper._mounting.take(odometry, edge.second_in_first)
        return mapper

    @property
    def state(self) -> dict[str, NDArray[Any]]:
        """All that a map is made of, as arrays that can be written to a file."""
        return arrays_of(self._survey, self._progress.looked, self._progress.waiting)

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
    def pieces(self) -> int:
        """Pieces of the map whose places to each other are not known; one if all is well."""
        return self._pieces

    def remarks(self, laser: Pose2 | None = None) -> tuple[str, ...]:
        """Return sentences, without a final stop, for the person who makes the map.

        The `laser` is said to be at this place on the robot; `None` if that is not known.
        """
        askew = self._mounting.remark(laser) if laser is not None else None
        return self._moved() if askew is None else (*self._moved(), askew)

    def _moved(self) -> tuple[str, ...]:
        if not self._moves:
            return ()
        times = "once" if self._moves == 1 else f"{self._moves} times"
        said = (
            "; the scans show by how far"
            if self._pieces == 1
            else f": the map has {self._pieces} pieces whose places to each other are not known;"
            " drive to where the robot was before"
        )
        return (f"the robot was moved, or its wheels slipped, {times} unnoticed{said}",)

    @property
    def snapshot(self) -> MapSnapshot:
        """The map at this instant, to be improved in a thread."""
        return MapSnapshot(survey=self._survey, progress=self._progress)

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

    def improve(self) -> None:
        """Look for all loops at once; a thread takes them one by one, as this may take seconds."""
        while not self.snapshot.is_looked_through:
            self.apply(self.snapshot.improve())

    def apply(self, improvement: Improvement) -> None:
        """Take better poses for the key frames of a snapshot; what came later moves along."""
        survey, poses, count = self._survey, improvement.poses, len(improvement.poses)
        later = survey.edges[improvement.before :]
        self._progress = improvement.progress
        self._pieces = improvement.pieces + sum(edge.torn for edge in later)
        if poses == survey.poses[:count]:
            self._survey = Survey(survey.frames, survey.poses, improvement.edges + later)
            return
        moved = poses[-1] @ survey.poses[count - 1].inverse()
        poses += tuple(moved @ pose for pose in survey.poses[count:])
        self._here = moved @ self._here
        self._survey = Survey(survey.frames, poses, improvement.edges + later)
        self._recall(self._recent)

    def _track(self, beams: Beams, cloud: Cloud, odom_of_scan: Pose2) -> None:
        """Find the robot where odometry leads to from the last key frame and scan."""
        key = self._survey.frames[-1]
        since_key = self._signed(key.beams.robot_in_odom.inverse() @ beams.robot_in_odom)
        odometry = self._mounting.seen(self._scale.seen(since_key), beams.origin)
        key_sigmas = slip(self._settings, self._way - key.way, self._turn - key.turn)
        prior = expected = expected_pose(self._survey.poses[-1], odometry, *key_sigmas)
        odometry = self._signed(odom_of_scan.inverse() @ beams.robot_in_odom)
        odometry = self._mounting.seen(self._scale.seen(odometry), beams.origin)
        guess = self._here @ odometry
        way, turn = self._way - self._way_of_scan, self._turn - self._turn_of_scan
        sigma, sigma_theta = slip(self._settings, way, turn)
        if self._way_of_scan + self._turn_of_scan > key.way + key.turn:
            # nothing that walks along with the robot is to take it with it in small steps
            prior = prior.joined(expected_pose(self._here, odometry, sigma, sigma_theta))
        if self._missed:
            # who lifts or pushes it may do so still, while its wheels turn in vain
            prior = Prior(prior.pose, SLIPPED * prior.information)
        way, turn = search_window(odometry, sigma, sigma_theta)
        if wide := way > WIDE_WAY or turn > WIDE_TURN:
            guess = self._submap.search(cloud.points, guess, way, turn)
        match = self._submap.match(cloud, guess, prior)
        far = prior.squared_error(match.pose) > NEAR_ODOMETRY
        if far and wide:
            # after a gap people may hide what tells, and much looks alike
            tight = Prior(prior.pose, prior.information / SLIPPED)
            held = self._submap.match(cloud, prior.pose, tight)
            if held.inliers > match.inliers - CLEARLY:
                match, far = held, False
        if far:
            loose = Prior(prior.pose, SLIPPED * prior.information)
            match = self._submap.match(cloud, match.pose, loose)
        self._match = match
        if self._repair:
            repaired = self._repaired(beams, cloud, match, odometry, (sigma, sigma_theta))
            match, far = repaired or match, far or repaired is not None
            self._match = match
        if match.inliers < (SURE_INLIERS if far else TRACKED_INLIERS):
            match = Match(pose=prior.pose, information=np.zeros((3, 3)), inliers=match.inliers)
            far = False
        fit = self._settings.fit + (PLAINLY if self._missed else 0.0)
        if match.inliers < fit and self._find_again(beams, cloud, match, expected):
            return
        self._here = match.pose
        step = self._survey.poses[-1].inverse() @ self._here
        if hypot(step.x, step.y) >= self._settings.way or abs(step.theta) >= self._settings.turn:
            self._mounting.take(since_key, step)
            self._scale.take(since_key, step, match.share(prior))
            self._link(beams, cloud, match, expected, prior.information)
        elif far:
            # what follows is measured from here: odometry missed a motion
            self._link(beams, cloud, match, expected)

    def _repaired(
        self,
        beams: Beams,
        cloud: Cloud,
        match: Match,
        odometry: Pose2,
        sigmas: tuple[float, float],
    ) -> Match | None:
        """Return where a scan fits much better than odometry has it since the last one.

        Ways may have the other sign, which they keep from then on; or odometry counts little.
        """
        worth = match.inliers - self._vicinity.contradiction(beams, match.pose)
        if worth > 1 - CLEARLY:
            return None
        found = list[tuple[float, bool, Match]]()
        anywhere = SEARCHED_WAY / SEARCHED_SIGMAS, SEARCHED_TURN / SEARCHED_SIGMAS
        for step, (sigma, sigma_theta) in (odometry, anywhere), (backwards(odometry), sigmas):
            prior = expected_pose(self._here, step, sigma, sigma_theta)
            window = search_window(step, sigma, sigma_theta)
            guess = self._submap.search(cloud.points, self._here @ step, *window)
            other = self._submap.match(cloud, guess, prior)
            fits = other.inliers - self._vicinity.contradiction(beams, other.pose)
            found.append((fits, step != odometry, other))
        fits, turned, other = max(found, key=lambda each: each[0])
        if fits - worth < min(PLAINLY, (1 - worth) / 2):
            return None
        self._reversed ^= turned
        return other

    def _signed(self, odometry: Pose2) -> Pose2:
        return backwards(odometry) if self._reversed else odometry

    def _find_again(self, beams: Beams, cloud: Cloud, match: Match, expected: Prior) -> bool:
        """Find a robot that was moved without its odometry, or begin a new piece of the map.

        Return whether it was moved: the scan contradicts those before it.
        """
        contradiction = self._vicinity.contradiction(beams, match.pose)
        if contradiction < CONTRADICTED and not self._missed:
            return False
        fit = max(self._settings.fit, match.inliers + CLEARLY)
        found = self._vicinity.find(cloud, beams, match.pose, way=LIFTED_WAY, fit=fit)
        if found is not None:
            self._match, self._here = found, found.pose
            self._link(beams, cloud, found, expected)
            return True
        if match.inliers > LOST_INLIERS or contradiction < LOST_CONTRADICTION:
            return False
        self._here = match.pose
        number = len(self._survey.frames)
        step = self._survey.poses[-1].inverse() @ match.pose
        edge = Edge(number - 1, number, step, TORN_WAY, torn=True)
        self._recent = ()
        self._keep(KeyFrame.of(beams, cloud, self._way, self._turn), (edge,))
        self._pieces += 1
        return True

    def _link(
        self,
        beams: Beams,
        cloud: Cloud,
        match: Match,
        expected: Prior,
        known: Float = UNKNOWN_WAY,
    ) -> None:
        """Keep a scan with its place by other scans, and what is `known` of that besides.

        By odometry it is `expected` elsewhere, perhaps.
        """
        number = len(self._survey.frames)
        step = self._survey.poses[-1].inverse() @ self._here
        missed = expected.squared_error(self._here) > NEAR_ODOMETRY
        information = certainty(match, known)
        if missed:  # scans while it is pushed are skewed, and loops will know better
            information = UNSURE * information
        edge = Edge(number - 1, number, step, information, missed=missed)
        self._keep(KeyFrame.of(beams, cloud, self._way, self._turn), (edge,))

    def _continue(self, beams: Beams, cloud: Cloud) -> None:
        """Find the robot near where it is said to be on a map that was made before."""
        said = self._here
        guess = self._submap.search(cloud.points, said, BEGIN_WAY, BEGIN_TURN)
        prior = Prior(said, UNKNOWN_WAY)
        match = self._match = self._submap.match(cloud, guess, prior)
        if match.inliers < FOUND_INLIERS:
            match = Match(pose=said, information=np.zeros((3, 3)), inliers=match.inliers)
        self._here = match.pose
        # no edge from the key frame before tells that a day begins: see `changes.days_of`
        last = len(self._survey.frames) - 1
        old = next((near for near in self._recent if near != last), last)
        way = self._survey.poses[old].inverse() @ self._here
        edge = Edge(old, len(self._survey.frames), way, certainty(match, UNKNOWN_WAY))
        self._keep(KeyFrame.of(beams, cloud, self._way, self._turn), (edge,))

    def _keep(self, frame: KeyFrame, edges: tuple[Edge, ...]) -> None:
        survey = self._survey
        number = len(survey.frames)
        self._survey = Survey(
            (*survey.frames, frame), (*survey.poses, self._here), survey.edges + edges
        )
        self._missed = any(edge.missed for edge in edges)
        for edge in edges:
            self._note(edge)
        self._recall((*self._recent, number)[-RECENT_FRAMES:])

    def _note(self, edge: Edge) -> None:
        """Count a motion that odometry missed, however many edges it takes."""
        if edge.torn or edge.missed:
            self._moves += edge.second != self._moved_at + 1
            self._moved_at = edge.second

    def _recall(self, numbers: tuple[int, ...]) -> None:
        """Match against these key frames from now on."""
        survey, self._recent = self._survey, numbers
        frames = [survey.frames[number] for number in numbers]
        poses = [survey.poses[number] for number in numbers]
        self._submap = Submap([frame.cloud for frame in frames], poses)
        self._vicinity = Vicinity(frames, poses, self._submap)
