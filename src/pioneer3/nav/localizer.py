"""Finds a robot on a map of walls, by its laser or by its sonars, and keeps track of it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import hypot, inf

import numpy as np
from numpy.random import Generator

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models import RobotModel
from pioneer3.nav.beams import Beams
from pioneer3.nav.estimate import Estimate, Stage, deviation_of
from pioneer3.nav.global_search import CandidatePoses, Candidates, GlobalSearch
from pioneer3.nav.hypotheses import AGREEING_PLACE, ComparedScan, Hypotheses, share_of
from pioneer3.nav.likelihood import LAST_SCALES, Agreement, ScanLikelihood, WallField
from pioneer3.nav.likelihood_sonar import EchoMap, Pings
from pioneer3.nav.mounting import STRAIGHT_TURN, LearnedMounting
from pioneer3.nav.particles import MotionErrors, array_of, moved, pose_of, rows_of
from pioneer3.nav.settings import AS_SHIPPED, LocalizerSettings
from pioneer3.nav.tracking import Fix, LaserTrack, SonarTrack, is_known

LOOK_PERIOD = 1.0
"""Time between two looks whether the map still agrees, even if the robot stands [s]."""
CONTRADICTIONS = 3
"""Contradictions in turn after which the robot was carried away."""
JUMP_SPEED = 3.0
"""Speed of odometry above which it was set anew [m/s]."""
JUMP_TURN_RATE = 8.0
"""Turn rate of odometry above which it was set anew [rad/s]."""
JUMP_DELAY = 0.2
"""Error of the times of odometry [s]."""
WHIRL_RATE = 0.6
"""Turn rate above which a scan does not count for that [rad/s]: a pose that is 50 ms late is some
degrees off."""
THROUGH_SHARE = 0.1
"""Share of beams through walls that tells of another place. A robot that stands and sees less was
not carried away: it may be crowded."""
FEWEST_BEAMS = 10
"""Beams that meet anything below which nothing contradicts the map: the robot looks out into the
open."""
SURE_WAY = 1.0
"""Way that a robot drives from an unknown start before it is sure [m]."""
SEARCH_WAY = 4.0
"""Way after which a search is too old: if nothing explains the scans, or if one place now does [m].
"""
LOOK_SHARE = 0.3
"""Share of a new scan that one is at least which is kept for the next search."""
MOST_LOOKS = 40
"""Scans that are kept for it."""
SURE_DEVIATION = 0.5
"""Standard deviation below which the position of a sure robot is [m]."""
GUESSES = 200
"""Hypotheses around a start that is known roughly."""
COMPARED_BEAMS = 40
"""Beams that hypotheses are compared by."""
MOUNTING_WAY = 0.5
"""Way by which a robot that is sure learns where its laser looks [m]: by shorter ones, centimetres
of its place turn the laser by degrees."""
SONAR_AGREES = 0.5
"""Share of echoes that agree with the map above which a robot becomes sure by sonar: among
furniture half of them are of edges."""
SONAR_CONTRADICTS = 0.25
"""Share of echoes below which a robot is not sure any more by sonar."""

UNKNOWN_COVARIANCE: Float = np.full((3, 3), inf)
"""Covariance of a robot that may be anywhere."""


@dataclass(slots=True, kw_only=True)
class _Progress:
    """Everything since the last start or search.

    Attributes:
        start: Poses (S, 3) that somebody told, and their standard deviations (3,), before the first
            reading.
        hypotheses: While several places are compared.
        looks: Scans that these were compared by.
        searched: How far the robot had driven at the latest search [m].
        decided: Whether one of the hypotheses explains all, and none elsewhere does nearly as well.
        laser: While scans track the robot.
        sonar: While pings do.
        at: Odometry at the last reading that counted.
        told: Whether somebody told where the robot is.
        low: Readings in turn that contradicted the map.
        looked: When the map was last looked at [s].
        way: Where the present way began by which the laser's mounting is learned: by odometry, and
            on the map.
    """

    stage: Stage
    reason: str
    start: tuple[Float, Float] | None = None
    hypotheses: Hypotheses | None = None
    looks: list[ComparedScan] = field(default_factory=list)
    searched: float = 0.0
    decided: bool = False
    laser: LaserTrack | None = None
    sonar: SonarTrack | None = None
    at: Pose2 | None = None
    told: bool = False
    driven: float = 0.0
    low: int = 0
    looked: float = -inf
    way: tuple[Pose2, Pose2] | None = None
    fix: Fix = field(default_factory=lambda: Fix(np.zeros(3), UNKNOWN_COVARIANCE, 0.0))


class Localizer:
    """Where a robot is on a map, from scans or pings and odometry.

    Give it all scans, or all pings, with :meth:`take` or :meth:`take_sonar`. While
    :attr:`wants_search`, run :meth:`search` in a thread and give the result to :meth:`adopt`.

    Attributes:
        mounting: How far the laser is turned from where it is said to look, as far as known.
    """

    def __init__(
        self,
        line_map: LineMap,
        model: RobotModel,
        rng: Generator,
        settings: LocalizerSettings = AS_SHIPPED.localizer,
    ) -> None:
        self.line_map, self.mounting = line_map, LearnedMounting()
        self._model, self._rng, self._settings = model, rng, settings
        self._errors = MotionErrors(way_share=settings.way_error, turn_share=settings.turn_error)
        way, turn = settings.way**-2, settings.turn**-2
        self._uncounted = np.diag([way, way, turn])  # information since the last that counted
        self._beams: Beams | None = None
        self._odom: Pose2 | None = None
        self._stamp = inf
        self._odom_in_map: Pose2 | None = None
        self._now = self._sought = _Progress(stage="lost", reason="the robot may be anywhere")

    def prepare(self, *, sonar: bool = False) -> None:
        """Compute what takes long, up to some seconds, so that no reading waits for it.

        Call it in a thread before anything else; with `sonar` for pings, not for scans.
        """
        _ = self._echoes if sonar else self._places

    def start(
        self,
        pose: Pose2,
        spread: float = 0.3,
        turn_spread: float = 0.15,
        others: Sequence[Pose2] = (),
    ) -> None:
        """Begin near a pose that somebody tells, with its standard deviations [m, rad].

        A laser also looks at `others` that are as likely; sonars do not tell them apart.
        """
        start = rows_of([pose, *others]), np.array([spread, spread, turn_spread])
        self._now = _Progress(
            stage="looking", reason="has not looked around yet", start=start, told=True
        )
        self._now.fix = Fix(start[0][0], np.diag(start[1] ** 2), 0.0)
        if self._odom is not None:
            self._odom_in_map = pose @ self._odom.inverse()

    def start_unknown(self) -> None:
        """Begin anywhere on the map; a laser is needed."""
        self._now = _Progress(stage="lost", reason="the robot may be anywhere")
        self._odom_in_map = None

    def take(self, beams: Beams) -> None:
        """Take a scan."""
        now, whirls = self._now, self._whirls(beams)
        self._follow(beams.robot_in_odom, beams.stamp)
        self._beams = beams
        if now.start is not None:
            self._begin(beams, *now.start)
        elif now.stage == "lost":
            return
        elif self._has_moved():
            motion = self._motion()
            now.looked = beams.stamp
            if now.hypotheses is not None:
                look = self._look(beams, share_of(motion))
                now.hypotheses.take(look, motion, self._errors)
                last = now.looks[-1].robot_in_odom
                share = share_of(last.inverse() @ look.robot_in_odom)
                if share >= LOOK_SHARE:
                    now.looks = [*now.looks[1 - MOST_LOOKS :], replace(look, share=share)]
                self._compare(now.hypotheses, now.hypotheses.agreement)
            elif now.laser is not None:
                now.laser.move(motion)
                fix, verdict = now.laser.take(ScanLikelihood.of(self._walls, beams))
                self._place(fix)
                self._learn_mounting(pose_of(fix.pose))
                if not whirls and _tells(verdict):
                    self._watch(contradicts=fix.agreement < self._settings.contradiction)
        elif beams.stamp >= now.looked + LOOK_PERIOD:
            self._look_again(beams)

    def take_sonar(self, pings: Pings) -> None:
        """Take pings. The start must have been told: pings alone do not tell rooms apart."""
        now = self._now
        self._follow(pings.robot_in_odom, pings.stamp)
        if now.start is not None:
            begin = now.start[0][0], now.start[1]
            now.sonar = SonarTrack(
                self._echoes, begin, self._settings.particles, self._rng, self._errors
            )
            now.start, now.at = None, self._odom
            now.reason = "has to drive a little"
            self._odom_in_map = pose_of(begin[0]) @ pings.robot_in_odom.inverse()
        if now.sonar is None:
            return
        now.sonar.listen(pings)
        if self._has_moved():
            motion = self._motion()
            self._place(now.sonar.take(motion, pings.robot_in_odom))
            self._watch_sonar()

    @property
    def odom_in_map(self) -> Pose2 | None:
        """The pose of odometry's frame on the map [m, rad]; `None` where nothing is known."""
        return self._odom_in_map

    @property
    def estimate(self) -> Estimate:
        """Where the robot is, as of the latest scan or pings."""
        now, at, odom = self._now, self._odom_in_map, self._odom
        estimate = Estimate(
            robot_in_map=None if at is None or odom is None else at @ odom,
            odom_in_map=at,
            covariance=now.fix.covariance,
            sure=now.stage == "sure",
            agreement=now.fix.agreement,
            stage=now.stage,
            reason=now.reason,
        )
        if estimate.sure and estimate.deviation > SURE_DEVIATION:
            words = f"knows its place within {estimate.deviation:.1f} m only"
            return replace(estimate, sure=False, stage="looking", reason=words)
        return estimate

    @property
    def wants_search(self) -> bool:
        """Whether a search is due."""
        now, hypotheses = self._now, self._now.hypotheses
        if self._beams is None or hypotheses is None:
            return self._beams is not None and now.stage == "lost"
        old = now.driven > now.searched + SEARCH_WAY
        return now.decided or (old and hypotheses.explained < self._settings.agreement)

    def search(self) -> GlobalSearch | None:
        """Return a search by the latest scans, for a thread to run; `None` without a scan."""
        beams, now = self._beams, self._now
        if beams is None:
            return None
        self._sought = now
        look, known, driven = self._look(beams), np.empty((0, 3)), 0.0
        if now.hypotheses is not None:
            assert now.at is not None
            since = now.at.inverse() @ beams.robot_in_odom
            known, driven = moved(now.hypotheses.poses, since), now.driven + hypot(since.x, since.y)
            last = now.looks[-1].robot_in_odom.inverse() @ beams.robot_in_odom
            look = replace(look, share=max(LOOK_SHARE, share_of(last)))
        return GlobalSearch(
            looks=[*now.looks, look],
            places=self._places,
            known=known,
            driven=driven,
            errors=self._errors,
        )

    def adopt(self, found: Candidates) -> None:
        """Go on with the result of a search; the robot may have driven since its scan.

        If somebody has told the place since, or the robot was carried away, nothing changes.
        """
        if self._sought is not self._now or self._now.laser is not None:
            return
        if found.hypotheses is None:
            self._now = _Progress(stage="lost", reason="no place of the map looks like this")
            return
        at = found.looks[-1].robot_in_odom
        self._now = _Progress(
            stage="looking",
            reason="compares the places that look like this",
            hypotheses=found.hypotheses,
            looks=[*found.looks],
            at=at,
            driven=found.driven,
            searched=found.driven,
        )
        best = found.hypotheses.poses[0]
        self._odom_in_map = pose_of(best) @ at.inverse()
        self._now.fix = Fix(best, found.hypotheses.covariance(), found.hypotheses.agreement)

    def _look(self, beams: Beams, share: float = 1.0) -> ComparedScan:
        likelihood = ScanLikelihood.of(self._walls, beams, COMPARED_BEAMS)
        return ComparedScan(likelihood, beams.robot_in_odom, share)

    @cached_property
    def _walls(self) -> WallField:
        return WallField.for_lasers(self.line_map)

    @cached_property
    def _echoes(self) -> EchoMap:
        return EchoMap.of(self.line_map)

    @cached_property
    def _places(self) -> CandidatePoses:
        return CandidatePoses.of(self._walls.field, self._model.width / 2 - 0.05)

    def _follow(self, odom: Pose2, stamp: float) -> None:
        """Take the robot's pose in odometry's frame; if that was set anew, the robot stands."""
        last, seconds = self._odom, max(0.0, stamp - self._stamp) + JUMP_DELAY
        self._odom, self._stamp = odom, stamp
        if last is None:
            return
        motion = last.inverse() @ odom
        far = hypot(motion.x, motion.y) > JUMP_SPEED * seconds
        if not far and abs(motion.theta) <= JUMP_TURN_RATE * seconds:
            return
        frame, self._now.way = odom @ last.inverse(), None
        if self._now.at is not None:
            self._now.at = frame @ self._now.at
        if self._odom_in_map is not None:
            self._odom_in_map = self._odom_in_map @ frame.inverse()

    def _has_moved(self) -> bool:
        assert self._odom is not None
        motion, settings = (self._now.at or self._odom).inverse() @ self._odom, self._settings
        return hypot(motion.x, motion.y) >= settings.way or abs(motion.theta) >= settings.turn

    def _learn_mounting(self, robot_in_map: Pose2) -> None:
        """Learn where the laser looks once the robot has driven a way."""
        assert self._odom is not None
        odom, here = self._now.way or (self._odom, robot_in_map)
        way = odom.inverse() @ self._odom
        if hypot(way.x, way.y) >= MOUNTING_WAY or abs(way.theta) > STRAIGHT_TURN:
            self.mounting.take(way, here.inverse() @ robot_in_map)
            odom, here = self._odom, robot_in_map
        self._now.way = odom, here

    def _whirls(self, beams: Beams) -> bool:
        """Whether the robot has turned fast since the last scan."""
        before = self._beams
        if before is None or beams.stamp <= before.stamp:
            return False
        turned = abs((before.robot_in_odom.inverse() @ beams.robot_in_odom).theta)
        return turned > WHIRL_RATE * (beams.stamp - before.stamp)

    def _motion(self) -> Pose2:
        """Return the motion since the last reading that counted; the present one does."""
        assert self._odom is not None
        motion = (self._now.at or self._odom).inverse() @ self._odom
        self._now.at = self._odom
        self._now.driven += hypot(motion.x, motion.y)
        return motion

    def _begin(self, beams: Beams, poses: Float, deviations: Float) -> None:
        """Look around `poses` (S, 3) that somebody told."""
        now = self._now
        guesses = poses[:, None] + deviations * self._rng.standard_normal((GUESSES, 3))
        around, look = np.vstack([poses, guesses.reshape(-1, 3)]), self._look(beams)
        hypotheses = Hypotheses.found(around, [look], self._errors)
        hypotheses.near(poses, deviations)
        now.hypotheses, now.start, now.at, now.looked = hypotheses, None, self._odom, beams.stamp
        now.looks = [look]
        self._compare(hypotheses, hypotheses.agreement)

    def _compare(self, hypotheses: Hypotheses, agreement: float) -> None:
        """Become sure of the best hypothesis, give all of them up, or go on."""
        now = self._now
        self._place(Fix(hypotheses.poses[0], hypotheses.covariance(), agreement))
        certain = hypotheses.is_certain or (
            now.told and deviation_of(now.fix.covariance) < AGREEING_PLACE / 2
        )
        agrees = min(agreement, hypotheses.explained) >= self._settings.agreement or (
            now.told
            and agreement >= self._settings.told_agreement
            and not self._sees_through(hypotheses.poses[0])
        )
        now.decided = certain and agrees and (now.told or now.driven >= SURE_WAY)
        # a search by one scan may have missed the place: one after some way is to agree
        confirmed = now.searched >= SURE_WAY and now.driven <= now.searched + SEARCH_WAY
        if now.decided and (now.told or confirmed):
            poses = hypotheses.drawn(self._settings.particles, self._rng)
            now.laser, now.hypotheses = LaserTrack(poses, self._rng, self._errors), None
            now.stage, now.reason, now.low = "sure", "sees what the map shows", 0
            return
        if not certain:
            now.reason = "more than one place looks like this"
        elif not agrees:
            now.reason = "sees things that the map does not show"
        elif not now.decided:
            now.reason = "has to drive a little"
        else:
            now.reason = "looks for other places that look like this"
        self._watch(contradicts=agreement < self._settings.contradiction)

    def _sees_through(self, pose: Float) -> bool:
        """Whether the latest scan sees through walls from a pose: things hide walls, no more."""
        assert self._beams is not None
        verdict = ScanLikelihood.of(self._walls, self._beams).judged(pose[None])
        return _share_through(verdict) >= THROUGH_SHARE

    def _look_again(self, beams: Beams) -> None:
        """Look whether the map still agrees with a robot that stands."""
        assert self._odom_in_map is not None
        now = self._now
        now.looked = beams.stamp
        pose = array_of(self._odom_in_map @ beams.robot_in_odom)
        likelihood = ScanLikelihood.of(self._walls, beams)
        if now.laser is not None:
            # it may have turned by less than counts, or have been pushed: a beam through a wall
            # tells of another place only if no pose nearby explains it
            held = self._uncounted
            pose = likelihood.refined(pose[None], held, LAST_SCALES, all_points=True)[0][0]
        verdict = likelihood.judged(pose[None])
        agreement = float(verdict.agreement[0])
        if now.hypotheses is not None and (now.told or now.decided):
            self._compare(now.hypotheses, agreement)
        elif now.laser is not None:
            now.fix = replace(now.fix, agreement=agreement)
            crowded = _share_through(verdict) < THROUGH_SHARE
            if _tells(verdict):
                self._watch(contradicts=agreement < self._settings.contradiction and not crowded)

    def _watch(self, *, contradicts: bool) -> None:
        """Give up a place that has contradicted the readings several times in turn."""
        now = self._now
        now.low = now.low + 1 if contradicts else 0
        if now.low >= CONTRADICTIONS:
            self._lose("the map does not show what the laser sees")

    def _watch_sonar(self) -> None:
        now = self._now
        if now.driven < SURE_WAY:
            return
        if now.fix.agreement < SONAR_CONTRADICTS:
            self._lose("the map does not show what the sonars hear")
        elif is_known(now.fix.covariance) and now.fix.agreement >= SONAR_AGREES:
            now.stage, now.reason = "sure", "hears what the map shows"

    def _lose(self, reason: str) -> None:
        self._now = _Progress(stage="lost", reason=reason)

    def _place(self, fix: Fix) -> None:
        assert self._odom is not None
        self._now.fix = fix
        self._odom_in_map = pose_of(fix.pose) @ self._odom.inverse()


def _share_through(verdict: Agreement) -> float:
    return float(verdict.through[0]) / max(1.0, _count(verdict))


def _tells(verdict: Agreement) -> bool:
    """Whether a scan has seen enough of anything to contradict the map."""
    return _count(verdict) >= FEWEST_BEAMS


def _count(verdict: Agreement) -> float:
    return float((verdict.agree + verdict.short + verdict.through)[0])
