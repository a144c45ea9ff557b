"""Logs of CARMEN."""

from math import cos, hypot, inf, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.carmen import LoggedOdometry, LoggedScan, read_carmen

poses = st.builds(
    Pose2, st.floats(-50, 50), st.floats(-50, 50), st.floats(-pi, pi, exclude_min=True)
)
steps = st.builds(Pose2, st.floats(0.01, 0.5), st.floats(-0.1, 0.1), st.floats(-0.5, 0.5))


def odom(pose: Pose2, stamp: float) -> str:
    return f"ODOM {pose.x!r} {pose.y!r} {pose.theta!r} 0 0 0 {stamp} host {stamp}"


def flaser(ranges: list[float], laser: Pose2, robot: Pose2, stamp: float) -> str:
    values = " ".join(map(repr, ranges))
    places = " ".join(f"{p.x!r} {p.y!r} {p.theta!r}" for p in (laser, robot))
    return f"FLASER {len(ranges)} {values} {places} {stamp} host {stamp}"


def scans_of(lines: list[str]) -> list[LoggedScan]:
    return [entry for entry in read_carmen(lines) if isinstance(entry, LoggedScan)]


@given(poses, st.lists(st.tuples(steps, poses), min_size=1, max_size=5))
def test_a_corrected_log_gives_raw_odometry_and_the_corrected_poses_apart(
    begin: Pose2, ways: list[tuple[Pose2, Pose2]]
) -> None:
    lines, raw, stamp = [odom(begin, 1.0)], [ORIGIN], 1.0
    at = begin
    for step, corrected in ways:
        at, stamp = at @ step, stamp + 5.0
        raw.append(raw[-1] @ step)
        lines += [odom(at, stamp), flaser([1.0, 2.0], corrected, corrected, stamp)]
        lines += [odom(corrected, 0.0), "NEFF 14.3"]
        at = corrected
    scans = scans_of(lines)
    assert [scan.corrected for scan in scans] == [corrected for _, corrected in ways]
    for scan, wanted in zip(scans, raw[1:], strict=True):
        off = wanted.inverse() @ scan.scan.robot_in_odom
        assert hypot(off.x, off.y) + abs(off.theta) < 1e-6


def test_a_stamp_that_was_never_written_does_not_let_the_answer_leak() -> None:
    corrected = Pose2(7.0, 8.0, 0.5)
    lines = [
        odom(ORIGIN, 100.0),
        flaser([1.0, 2.0], corrected, corrected, 100.0),
        odom(corrected, 1.13),
        odom(corrected @ Pose2(1.0), 101.0),
    ]
    entries = list(read_carmen(lines))
    assert entries[-1].robot_in_odom.x == pytest.approx(1.0)  # type: ignore[union-attr]
    assert len(entries) == 3


def test_in_a_raw_log_odometry_goes_on_at_scans_and_the_laser_is_where_they_say() -> None:
    robot = Pose2(1.0, 0.0, pi / 2)
    lines = [
        "PARAM robot_frontlaser_offset 0.2 nohost 0",
        odom(ORIGIN, 1.0),
        flaser([1.0, 2.0], robot @ Pose2(0.2), robot, 1.1),
        odom(robot, 1.2),
    ]
    scan = scans_of(lines)[0]
    assert scan.corrected is None
    assert scan.scan.robot_in_odom == robot
    assert scan.scan.sensor_in_robot.x == pytest.approx(0.2)


@pytest.mark.parametrize(("count", "step"), [(180, 1.0), (181, 1.0), (360, 0.5), (361, 0.5)])
def test_a_half_circle_may_lack_its_last_reading(count: int, step: float) -> None:
    scan = scans_of([flaser([1.0] * count, ORIGIN, ORIGIN, 1.0)])[0].scan
    assert scan.angles[0] == pytest.approx(-pi / 2)
    assert scan.angles[1] - scan.angles[0] == pytest.approx(step * pi / 180)


@pytest.mark.parametrize("nothing", [51.16, 81.83, 81.91, 8.183, 8.19, 16.38])
def test_codes_mean_that_nothing_came_back(nothing: float) -> None:
    scan = scans_of([flaser([1.0, nothing, 7.9], ORIGIN, ORIGIN, 1.0)])[0].scan
    assert scan.ranges == (1.0, inf, 7.9)


@given(st.lists(st.text(max_size=60), max_size=5))
def test_damaged_lines_are_skipped(lines: list[str]) -> None:
    damaged = ["FLASER", "FLASER x", "FLASER 5 1 2", "ODOM 1 2", "ODOM nan 0 0 0 0 0 1 h 1"]
    good = odom(Pose2(cos(1.0), sin(1.0)), 1.0)
    entries = list(read_carmen([*damaged, *lines, good]))
    assert isinstance(entries[-1], LoggedOdometry)
