"""The correction that fits runs best, its spread, and whether it is better than chance."""

from math import inf, nan, pi, radians

import numpy as np
import pytest

from pioneer3.calibration.ends import MeasuredRun
from pioneer3.calibration.estimate import CorrectionEstimate, estimate, logarithms
from pioneer3.calibration.track import RawTrack
from pioneer3.geometry import Pose2
from pioneer3.models import OdometryCorrection
from pioneer3.models.odometry import UNCORRECTED

BASE = 0.33
TRUTH = OdometryCorrection(1.02, 0.98, 1.015)
TAPE, ANGLE = 0.003, radians(1)
LASER = Pose2(0.15, -0.02, radians(3))


def counted(*legs: tuple[float, float]) -> RawTrack:
    steps = [(way / 20, turn / 20) for way, turn in legs for _ in range(20)]
    return RawTrack(np.arange(len(steps) + 1.0), np.array(steps))


def square(sign: int, side: float = 1.2) -> RawTrack:
    return counted(*[(side, 0.0), (0.0, sign * pi / 2)] * 4)


def run(
    track: RawTrack, rng: np.random.Generator, truth: OdometryCorrection = TRUTH
) -> MeasuredRun:
    sigma = (TAPE, TAPE, ANGLE)
    end = track.poses(truth, BASE)[-1] + rng.normal(size=3) * sigma
    return MeasuredRun(track=track, end=end.tolist(), sigma=sigma)


def measured(seed: int, truth: OdometryCorrection = TRUTH) -> CorrectionEstimate:
    rng = np.random.default_rng(seed)
    tracks = (counted((1.2, 0.0)), square(1), square(-1), square(1), square(-1))
    return estimate([run(track, rng, truth) for track in tracks], BASE)


def test_exact_runs_tell_the_errors_exactly() -> None:
    tracks = counted((2.0, 0.0)), square(1), square(-1)
    runs = [
        MeasuredRun(
            track=track, end=track.poses(TRUTH, BASE)[-1].tolist(), sigma=(1e-5, 1e-5, 1e-5)
        )
        for track in tracks
    ]
    found = estimate(runs, BASE)
    assert logarithms(found.correction) == pytest.approx(logarithms(TRUTH), abs=2e-4)


def test_a_tape_makes_the_return_error_ten_times_smaller() -> None:
    for seed in range(20):
        found = measured(seed)
        truth = CorrectionEstimate(
            correction=TRUTH, before=UNCORRECTED, wheel_base=BASE, covariance=1e-12 * np.eye(3)
        )
        before, _ = truth.return_error(UNCORRECTED)
        after, _ = truth.return_error(found.correction)
        assert found.is_certain
        assert after < before / 10


def test_the_truth_is_within_the_spread() -> None:
    far = [
        (logarithms(found.correction) - logarithms(TRUTH)) / np.sqrt(np.diag(found.covariance))
        for found in map(measured, range(40))
    ]
    assert np.abs(far).max() < 4
    assert np.mean(np.abs(far) < 1) > 0.6


def test_a_robot_without_errors_is_not_corrected() -> None:
    certain = [measured(seed, UNCORRECTED).is_certain for seed in range(40)]
    assert sum(certain) <= 4


def test_what_no_run_tells_stays_as_it_is() -> None:
    before = OdometryCorrection(1.01, 1.03, 0.99)
    track = counted((2.0, 0.0))
    end = track.poses(TRUTH, BASE)[-1]
    found = estimate(
        [MeasuredRun(track=track, end=(float(end[0]), nan, nan), sigma=(TAPE, inf, inf))],
        BASE,
        before,
    )
    assert found.correction.scale == pytest.approx(TRUTH.scale, rel=0.01)
    assert found.correction.base_ratio == pytest.approx(before.base_ratio, rel=0.01)
    assert found.sigmas[1] > 0.1
    assert not found.is_known
    assert measured(0).is_known


def test_a_correction_in_force_is_measured_anew_from_raw_odometry() -> None:
    rng = np.random.default_rng(3)
    runs = [run(track, rng) for track in (counted((1.2, 0.0)), square(1), square(-1))]
    bare, corrected = estimate(runs, BASE), estimate(runs, BASE, OdometryCorrection(1.1, 0.9, 1.1))
    assert logarithms(corrected.correction) == pytest.approx(logarithms(bare.correction), abs=2e-3)


def test_several_full_turns_tell_the_base() -> None:
    track = counted((0.0, 6 * pi))
    turn = float(track.poses(TRUTH, BASE)[-1, 2])
    assert turn > 6 * pi
    found = estimate([MeasuredRun(track=track, end=(nan, nan, turn), sigma=(inf, inf, 0.01))], BASE)
    ratio = found.correction.scale / found.correction.base_ratio
    assert ratio == pytest.approx(TRUTH.scale / TRUTH.base_ratio, rel=2e-3)


def test_a_laser_tells_its_place_too() -> None:
    runs = []
    for track in (
        counted((0.0, pi / 2)),
        counted((0.0, -pi)),
        counted((1.2, 0.0)),
        square(1),
        square(-1),
    ):
        x, y, turn = track.poses(TRUTH, BASE)[-1].tolist()
        seen = LASER.inverse() @ Pose2(x, y, turn) @ LASER
        runs.append(
            MeasuredRun(
                track=track, end=(seen.x, seen.y, turn), sigma=(1e-4, 1e-4, 1e-4), of_laser=True
            )
        )
    said = Pose2(LASER.x + 0.05, LASER.y - 0.04, LASER.theta - radians(3))
    found = estimate(runs, BASE, laser=said)
    assert found.laser is not None
    assert (found.laser.x, found.laser.y) == pytest.approx((LASER.x, LASER.y), abs=0.002)
    assert found.laser.theta == pytest.approx(LASER.theta, abs=radians(0.1))
    assert logarithms(found.correction) == pytest.approx(logarithms(TRUTH), abs=2e-3)


def test_a_track_is_made_of_poses_and_makes_them_again() -> None:
    poses, here = [Pose2(1.0, 2.0, 3.0)], Pose2(1.0, 2.0, 3.0)
    for step in (Pose2(0.1, 0.0, 0.0), Pose2(0.0, 0.0, 0.5), Pose2(-0.2, 0.0, 0.0)) * 4:
        here = here @ step
        poses.append(here)
    track = RawTrack.of(range(len(poses)), poses)
    end = poses[0].inverse() @ poses[-1]
    assert track.poses(UNCORRECTED, BASE)[-1, :2] == pytest.approx((end.x, end.y))
    assert track.turn == pytest.approx(2.0)
