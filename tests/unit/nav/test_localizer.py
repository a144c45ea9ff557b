"""Where a robot is on a map."""

from math import hypot, pi, radians

import numpy as np
import pytest

from pioneer3.geometry import ORIGIN, Pose2, arc
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.nav.hypotheses import ComparedScan, Hypotheses
from pioneer3.nav.likelihood import ScanLikelihood, WallField
from pioneer3.nav.localizer import Localizer
from pioneer3.nav.particles import MotionErrors, Particles, array_of, pose_of, rows_of
from tests.unit.nav.rooms import FLAT, SYMMETRICAL, beams, pings, room

MODEL = load_model("p3dx-sh")
BEGIN = Pose2(2.0, 1.5, 0.4)
BOX = (2.6, 1.3), (3.4, 1.3), (3.4, 2.4), (2.6, 2.4)
SYMMETRICAL_BUT_FOR_A_POST = LineMap(
    name="post", walls=np.vstack([SYMMETRICAL.walls, room((0.8, 1.5), (1.2, 1.5), (1.2, 1.9))])
)


class Drive:
    """A robot that drives as told, and its localizer."""

    def __init__(
        self, line_map: LineMap = FLAT, truth: Pose2 = BEGIN, *, slip: float = 0.0
    ) -> None:
        self.localizer = Localizer(line_map, MODEL, np.random.default_rng(3))
        self.truth, self.odom, self.slip = truth, Pose2(5.0, -3.0, 1.0), slip
        self.near, self.time, self.askew = np.inf, 0.0, 0.0
        self.world = line_map

    def look(self) -> None:
        """Take a scan."""
        self.time += 0.1
        from_here = self.truth @ Pose2(0.0, 0.0, self.askew)
        seen = beams(self.world, from_here, self.odom, stamp=self.time, near=self.near)
        self.localizer.take(seen)

    def listen(self) -> None:
        """Take pings."""
        self.localizer.take_sonar(pings(self.localizer.line_map, self.truth, self.odom))

    def go(self, way: float, turn: float = 0.0, *, sonar: bool = False) -> None:
        """Drive on an arc, and take a scan every 0.12 m or 0.12 rad."""
        steps = round(max(abs(way), abs(turn)) / 0.12)
        for _ in range(steps):
            self.odom = self.odom @ arc(way / steps, turn / steps, 1.0)
            self.truth = self.truth @ arc(way / steps, turn * (1 - self.slip) / steps, 1.0)
            if sonar:
                self.listen()
            else:
                self.look()

    def search(self) -> None:
        """Search, and adopt the result."""
        search = self.localizer.search()
        assert search is not None
        self.localizer.adopt(search.run())

    def find(self, way: float, turn: float = 0.0) -> None:
        """Drive on, and search as often as that is wanted."""
        for _ in range(round(10 * abs(way))):
            self.go(0.12 if way > 0 else -0.12, turn / abs(way) / 10)
            if self.localizer.wants_search:
                self.search()

    @property
    def off(self) -> float:
        """Distance of the estimate from the truth [m]."""
        estimate = self.localizer.estimate
        assert estimate.robot_in_map is not None
        off = self.truth.inverse() @ estimate.robot_in_map
        return hypot(off.x, off.y)


def test_a_start_known_roughly_becomes_a_place_known_exactly() -> None:
    drive = Drive()
    drive.localizer.start(BEGIN @ Pose2(0.25, -0.2, 0.1))
    assert not drive.localizer.estimate.sure
    drive.look()
    assert drive.localizer.estimate.sure
    assert drive.off < 0.01
    drive.go(1.0)
    assert drive.off < 0.01
    assert drive.localizer.estimate.agreement > 0.95
    assert drive.localizer.estimate.deviation < 0.05


def test_the_transform_of_odometry_goes_on_between_scans_that_count() -> None:
    drive = Drive()
    drive.localizer.start(BEGIN)
    drive.look()
    before = drive.localizer.estimate.odom_in_map
    drive.odom, drive.truth = drive.odom @ Pose2(0.05), drive.truth @ Pose2(0.05)
    drive.look()
    assert drive.localizer.estimate.odom_in_map == before
    assert drive.off < 0.01


@pytest.mark.parametrize("degrees", [-2, 0, 2])
def test_it_finds_out_that_a_laser_is_mounted_askew(degrees: float) -> None:
    drive = Drive()
    drive.askew = radians(degrees)
    drive.localizer.start(BEGIN)
    drive.look()
    for _ in range(24):
        drive.go(1.2)
        drive.odom = Pose2(5.0, -3.0, 1.0)  # what was set anew is no way
        drive.go(-1.2)
    mounting = drive.localizer.mounting
    assert drive.localizer.estimate.sure
    assert mounting.angle == pytest.approx(radians(degrees), abs=radians(0.5))
    assert (mounting.remark(ORIGIN) is not None) == (degrees != 0)


@pytest.mark.parametrize("sonar", [False, True])
def test_odometry_that_is_set_anew_moves_nothing_on_the_map(sonar: bool) -> None:
    drive = Drive()
    sense = drive.listen if sonar else drive.look
    drive.localizer.start(BEGIN)
    sense()
    drive.go(0.5, sonar=sonar)
    before = drive.off
    drive.odom = ORIGIN
    sense()
    drive.go(0.5, sonar=sonar)
    assert drive.off == pytest.approx(before, abs=0.05)


def test_an_unknown_start_is_found_by_a_search_and_a_little_driving() -> None:
    drive = Drive()
    assert drive.localizer.search() is None
    drive.look()
    assert drive.localizer.wants_search
    assert drive.localizer.estimate.robot_in_map is None
    drive.search()
    assert drive.localizer.estimate.stage == "looking"
    drive.find(0.5)
    assert not drive.localizer.estimate.sure
    drive.find(1.2, 0.6)
    drive.find(1.2, -0.6)
    assert drive.localizer.estimate.sure
    assert drive.off < 0.02


def test_one_search_by_one_scan_does_not_make_a_robot_sure() -> None:
    drive = Drive()
    drive.look()
    drive.search()
    drive.go(1.7, 0.6)
    drive.go(1.2, -0.6)
    assert not drive.localizer.estimate.sure
    assert drive.localizer.estimate.reason == "looks for other places that look like this"
    assert drive.localizer.wants_search
    drive.search()
    drive.go(0.12)
    assert drive.localizer.estimate.sure


def test_a_place_that_is_told_during_a_search_stays() -> None:
    drive = Drive()
    drive.look()
    search = drive.localizer.search()
    assert search is not None
    drive.localizer.start(BEGIN)
    drive.look()
    drive.localizer.adopt(search.run())
    assert drive.localizer.estimate.sure


def test_furniture_that_was_carried_off_hides_nothing() -> None:
    drive = Drive(LineMap(name="boxes", walls=np.vstack([FLAT.walls, room(*BOX)])))
    drive.world = FLAT
    drive.localizer.start(BEGIN)
    drive.look()
    drive.go(2.0)  # across the place of the box
    assert drive.localizer.estimate.sure
    assert drive.off < 0.02


def test_a_search_weighs_what_was_seen_on_the_way() -> None:
    walls, errors = WallField.for_lasers(SYMMETRICAL_BUT_FOR_A_POST), MotionErrors()
    here, there = Pose2(2.0, 2.0, 0.5), Pose2(2.0, 2.0, -2.8)
    turned = Pose2(5.0, 2.0, 0.5 - pi), Pose2(5.0, 2.0, pi - 2.8)
    looks = [
        ComparedScan(ScanLikelihood.of(walls, beams(SYMMETRICAL_BUT_FOR_A_POST, at, at)), at)
        for at in (here, there)
    ]
    both = rows_of([turned[0], here])
    assert not Hypotheses.found(both, looks[:1], errors).is_certain  # looks away from the post
    found = Hypotheses.found(rows_of([turned[1], there]), looks, errors)
    back = Hypotheses.found(both, looks[::-1], errors)
    assert found.poses[0] == pytest.approx(array_of(there), abs=0.01)
    assert back.poses[0] == pytest.approx(array_of(here), abs=0.01)
    assert found.logs[0] - found.logs[1] == pytest.approx(back.logs[0] - back.logs[1], abs=0.3)
    assert found.logs[0] - found.logs[1] > 1.0


def test_a_robot_may_drive_during_a_search() -> None:
    drive = Drive()
    drive.look()
    search = drive.localizer.search()
    assert search is not None
    drive.go(0.4, 0.3)
    drive.localizer.adopt(search.run())
    assert drive.off < 0.3
    drive.find(1.2, 0.6)
    assert drive.localizer.estimate.sure
    assert drive.off < 0.02


def test_a_robot_in_a_symmetrical_room_never_becomes_sure() -> None:
    drive = Drive(SYMMETRICAL, Pose2(2.0, 1.2, 0.3))
    drive.look()
    drive.search()
    for _ in range(3):
        drive.go(1.5, 1.0)
        drive.go(-1.5, 0.8)
        estimate = drive.localizer.estimate
        assert not estimate.sure
        assert estimate.reason == "more than one place looks like this"


def test_a_post_that_is_gone_does_not_make_the_other_end_of_a_symmetrical_room_the_right_one() -> (
    None
):
    post = [[1.0, 2.6, 1.12, 2.6]]
    drive = Drive(
        LineMap(name="post", walls=np.vstack([SYMMETRICAL.walls, post])), Pose2(2.0, 1.2, 0.3)
    )
    drive.world = SYMMETRICAL
    drive.look()
    drive.search()
    for _ in range(4):
        drive.go(1.5, 1.0)
        drive.go(-1.5, 0.8)
        assert not drive.localizer.estimate.sure


def test_a_robot_that_was_told_which_end_of_a_symmetrical_room_knows_it() -> None:
    drive = Drive(SYMMETRICAL, Pose2(2.0, 1.2, 0.3))
    drive.localizer.start(Pose2(2.2, 1.3, 0.2))
    drive.look()
    assert drive.localizer.estimate.sure
    drive.go(1.0, 0.5)
    assert drive.off < 0.01


def test_a_robot_that_was_carried_away_notices_and_finds_itself() -> None:
    drive = Drive()
    drive.localizer.start(BEGIN)
    drive.look()
    drive.truth = Pose2(5.5, 3.0, -2.0)
    drive.go(0.6)
    estimate = drive.localizer.estimate
    assert (estimate.stage, estimate.sure) == ("lost", False)
    assert estimate.reason == "the map does not show what the laser sees"
    drive.search()
    drive.find(1.5, 0.6)
    assert drive.localizer.estimate.sure
    assert drive.off < 0.02


def test_a_robot_that_stands_notices_too_within_seconds() -> None:
    drive = Drive()
    drive.localizer.start(BEGIN)
    drive.look()
    drive.truth = Pose2(5.5, 3.0, -2.0)
    for _ in range(31):
        drive.look()
    assert drive.localizer.estimate.stage == "lost"


def test_a_crowd_is_no_reason_to_be_lost() -> None:
    drive = Drive()
    drive.localizer.start(BEGIN)
    drive.look()
    drive.near = 0.4  # half of all beams
    drive.go(1.0)
    for _ in range(40):
        drive.look()
    assert drive.localizer.estimate.sure
    assert drive.off < 0.02


@pytest.mark.parametrize("near", [0.4, np.inf])
def test_a_turn_on_the_spot_that_odometry_missed_is_no_reason_to_be_lost(near: float) -> None:
    drive = Drive()
    drive.localizer.start(BEGIN)
    drive.look()
    drive.go(1.0)
    drive.near = near
    drive.truth @= Pose2(0.0, 0.0, 0.16)
    for _ in range(40):
        drive.look()
    assert drive.localizer.estimate.sure
    drive.near = np.inf
    drive.go(1.0)
    assert drive.localizer.estimate.sure
    assert drive.off < 0.02


def test_a_robot_that_looks_out_into_the_open_is_not_lost() -> None:
    walls = [[0.0, -3.0, 0.0, 3.0], [0.0, 3.0, 3.0, 3.0], [0.0, -3.0, 3.0, -3.0]]
    drive = Drive(LineMap(name="open", walls=np.array(walls)), Pose2(2.0, 0.0, pi))
    drive.localizer.start(drive.truth)
    drive.look()
    drive.go(0.0, pi)
    drive.go(3.0)
    estimate = drive.localizer.estimate
    assert estimate.sure, estimate.reason
    assert drive.off < 0.1


def test_slip_of_every_turn_is_followed() -> None:
    drive = Drive(slip=0.05)
    drive.localizer.start(BEGIN)
    drive.look()
    drive.go(0.0, 6 * pi)
    assert drive.localizer.estimate.sure
    assert drive.off < 0.02


def test_a_search_without_a_place_leaves_the_robot_lost() -> None:
    empty = LineMap(name="empty", walls=np.array([[0.0, 0.0, 0.1, 0.0]]))
    drive = Drive(empty)
    drive.localizer.take(beams(FLAT, BEGIN, drive.odom))
    drive.search()
    drive.localizer.take(beams(FLAT, BEGIN, drive.odom))
    assert drive.localizer.estimate.stage != "sure"


def test_sonars_follow_a_start_known_roughly() -> None:
    drive = Drive()
    drive.localizer.start(BEGIN @ Pose2(0.3, -0.2, 0.1), 0.3, 0.15)
    drive.listen()
    assert not drive.localizer.estimate.sure
    drive.go(0.8, sonar=True)
    drive.go(-1.0, 0.6, sonar=True)
    drive.go(1.2, -0.6, sonar=True)
    assert drive.localizer.estimate.sure
    assert drive.off < 0.1


def test_sonars_do_not_find_an_unknown_start() -> None:
    drive = Drive()
    drive.go(1.0, sonar=True)
    assert drive.localizer.estimate.stage == "lost"
    assert not drive.localizer.wants_search


def test_hypotheses_that_are_one_place_count_once() -> None:
    likelihood = ScanLikelihood.of(WallField.for_lasers(FLAT), beams(FLAT, BEGIN, ORIGIN))
    around = array_of(BEGIN) + 0.05 * np.random.default_rng(0).standard_normal((50, 3))
    found = Hypotheses.found(around, [ComparedScan(likelihood, ORIGIN)], MotionErrors())
    assert len(found.poses) == 1
    assert found.is_certain
    assert found.poses[0] == pytest.approx(array_of(BEGIN), abs=0.01)
    drawn = found.drawn(300, np.random.default_rng(1))
    assert drawn.mean(axis=0) == pytest.approx(array_of(BEGIN), abs=0.02)


def test_particles_move_weigh_and_are_drawn_again() -> None:
    rng, errors = np.random.default_rng(4), MotionErrors()
    particles = Particles.around(np.zeros(3), np.full(3, 0.1), 2000, rng, errors)
    particles.move(Pose2(1.0, 0.0, 0.5))
    mean, covariance = particles.mean()
    off = pose_of(mean)
    assert (off.x, off.y, off.theta) == pytest.approx((1.0, 0.0, 0.5), abs=0.03)
    assert covariance[1, 1] > covariance[0, 0]  # the heading's error leads aside
    particles.weigh(50 * (particles.poses[:, 1] - 0.1) ** 2)
    assert particles.mean()[0][1] > 0.04
    particles.resample(500)
    assert len(particles.poses) == 500
    assert particles.weights == pytest.approx(np.full(500, 1 / 500))
    assert particles.mean()[0][1] > 0.04
