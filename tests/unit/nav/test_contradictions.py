"""Odometry that contradicts the scans of a map."""

import gzip
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise
from math import hypot

import numpy as np
import pytest

from benchmarks.nav_judge import trajectory_errors
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.beams import beams_of
from pioneer3.nav.carmen import read_carmen
from pioneer3.nav.contradictions import contradiction_of
from pioneer3.nav.logged import LoggedDamage, LoggedOdometry, LoggedScan
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.settings import AS_SHIPPED
from tests.unit.nav.halls import HALL, ROUND, look
from tests.unit.nav.test_logs import DATASETS

AHEAD = ROUND[:45]
THERE_AND_BACK = [*AHEAD, *AHEAD[-2:5:-1], *AHEAD[6:30]]
"""A way ahead, backwards, and ahead again."""

Wrong = Callable[[Pose2], Pose2]


def right(step: Pose2) -> Pose2:
    """Return odometry as it is."""
    return step


def unsigned(step: Pose2) -> Pose2:
    """Return odometry that tells ways backwards as ways ahead."""
    return Pose2(-step.x, -step.y, step.theta) if step.x < 0 else step


def dead(step: Pose2) -> Pose2:
    """Return odometry that knows of no turns."""
    return Pose2(step.x, step.y)


def long(step: Pose2) -> Pose2:
    """Return odometry with wheels that are 10 % smaller than it knows."""
    return Pose2(1.1 * step.x, 1.1 * step.y, step.theta)


def driven(
    wrong: Wrong, *, repair: bool, way: Sequence[Pose2] = THERE_AND_BACK
) -> tuple[Mapper, float]:
    """Return the mapper of a drive, and the largest error of a scan's place [m]."""
    rng, mapper, odometry = np.random.default_rng(2), Mapper(way[0], repair=repair), ORIGIN
    places = list[tuple[int, Pose2]]()
    for number, place in enumerate(way):
        if number:
            odometry @= wrong(way[number - 1].inverse() @ place)
        beams = look(HALL, place, odometry, noise=0.005, rng=rng, count=361)
        beams = replace(beams, stamp=float(number), points=beams.points[beams.points[:, 0] > 0])
        here = mapper.add(beams)
        survey = mapper.survey
        places.append((len(survey.poses) - 1, survey.poses[-1].inverse() @ here))
        if number % 10 == 0:
            mapper.improve()
    mapper.improve()
    found = [mapper.survey.poses[number] @ off for number, off in places]
    pairs = zip(found, way, strict=True)
    return mapper, max(hypot(pose.x - place.x, pose.y - place.y) for pose, place in pairs)


@pytest.mark.parametrize("repair", [False, True])
def test_ways_backwards_with_the_wrong_sign_are_told_and_repaired(*, repair: bool) -> None:
    mapper, error = driven(unsigned, repair=repair)
    assert error < 0.03
    told = contradiction_of(mapper.survey, AS_SHIPPED.mapper) or ""
    assert re.match(r"odometry contradicts the scans at 0:4\d to 1:2\d \(", told)
    assert "backwards" in told


@pytest.mark.parametrize("wrong", [right, long, dead])
def test_odometry_that_is_not_that_wrong_needs_no_repair(wrong: Wrong) -> None:
    for repair in (False, True):
        mapper, error = driven(wrong, repair=repair)
        assert error < 0.03
        if wrong is not dead:
            assert contradiction_of(mapper.survey, AS_SHIPPED.mapper) is None


def test_odometry_that_tells_no_turns_is_told() -> None:
    there_and_back = [place @ Pose2(0.0, 0.0, 0.4 * (k % 3)) for k, place in enumerate(ROUND)]
    mapper, error = driven(dead, repair=True, way=there_and_back)
    assert error < 0.05
    told = contradiction_of(mapper.survey, AS_SHIPPED.mapper) or ""
    assert told.startswith("odometry contradicts the scans")
    assert "backwards" not in told


def test_one_push_is_not_called_wrong_odometry() -> None:
    steps = [before.inverse() @ after for before, after in pairwise(ROUND[:60])]
    pushed = list(ROUND[:30])
    for step in (Pose2(0.2, 0.2, 0.6), Pose2(), *[Pose2(0.1, -0.02, -0.1)] * 8):
        pushed.append(pushed[-1] @ step)
    odometry = iter([*steps[:29], Pose2(), Pose2(), *[Pose2(0.1, -0.02, -0.1)] * 8])
    mapper, error = driven(lambda _: next(odometry), repair=False, way=pushed)
    assert error < 0.03
    assert contradiction_of(mapper.survey, AS_SHIPPED.mapper) is None


@pytest.mark.thorough
@pytest.mark.parametrize("wrong", [right, dead])
def test_the_log_of_a_real_robot_is_repaired_and_told_of(wrong: Wrong) -> None:
    path = DATASETS / "freiburg-101.log.gz"
    if not path.exists():
        pytest.skip(f"{path} is missing")
    mapper, seen, truth = Mapper(repair=True), list[tuple[int, Pose2]](), list[Pose2]()
    before, odometry = ORIGIN, ORIGIN
    with gzip.open(path, "rt") as lines:
        for entry in read_carmen(lines):
            assert not isinstance(entry, LoggedDamage)
            raw = entry.scan.robot_in_odom if isinstance(entry, LoggedScan) else entry.robot_in_odom
            odometry, before = odometry @ wrong(before.inverse() @ raw), raw
            if isinstance(entry, LoggedOdometry):
                mapper.move(odometry)
                continue
            here = mapper.add(beams_of(replace(entry.scan, robot_in_odom=odometry)))
            poses = mapper.survey.poses
            seen.append((len(poses) - 1, poses[-1].inverse() @ here))
            truth.append(entry.corrected or ORIGIN)
            mapper.improve()
    errors = trajectory_errors([mapper.survey.poses[k] @ off for k, off in seen], truth)
    assert errors.max() < 0.2
    told = contradiction_of(mapper.survey, AS_SHIPPED.mapper)
    assert (told is not None) == (wrong is dead)
