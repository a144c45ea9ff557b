"""Logs of CARMEN."""

from itertools import pairwise
from math import cos, hypot, inf, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.carmen import carmen_sources, read_carmen
from pioneer3.nav.logged import LoggedOdometry, LoggedScan

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


def test_in_a_corrected_log_a_stamp_that_is_right_by_chance_is_none() -> None:
    lines = [odom(ORIGIN, 0.0)]
    for x, stamp in ((1.0, 6.9), (2.0, 1e-86), (3.0, -0.06)):
        lines += [odom(Pose2(x - 0.3), 0.0), flaser([1.0, 2.0], Pose2(x), Pose2(x), 0.0)]
        lines += [odom(Pose2(x), stamp), "NEFF 14.3"]
    scans = scans_of(lines)
    assert [scan.corrected for scan in scans] == [Pose2(1.0), Pose2(2.0), Pose2(3.0)]
    assert [scan.scan.robot_in_odom.x for scan in scans] == pytest.approx([0.7, 1.4, 2.1])


@pytest.mark.parametrize("meaningless", [(9.0, 9.0, 9.0), (0.4, 9.0, 0.0), (9.0, 0.4, 9.0)])
def test_a_corrected_log_without_odometry_between_scans_moves_by_its_corrected_poses(
    meaningless: tuple[float, float, float],
) -> None:
    lines = [odom(ORIGIN, 0.0)]
    for x, stamp in zip((1.0, 2.0, 3.0), meaningless, strict=True):
        lines += [flaser([1.0, 2.0], Pose2(x), Pose2(x), 0.0), odom(Pose2(x), stamp)]
    ways = [scan.scan.robot_in_odom.x for scan in scans_of(lines)]
    assert [after - before for before, after in pairwise(ways)] == [1.0, 1.0]


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


def directed(word: str, ranges: str, poses: str = "", stamp: float = 1.0, begin: str = "") -> str:
    begin = begin or f"0 -2.35619 4.71239 1.570796 30.0 0.03 0 {len(ranges.split())}"
    return f"{word} {begin} {ranges} 2 7 8 {poses} {stamp} host {stamp}"


def test_a_scan_with_directions_has_its_own_range_and_place() -> None:
    robot = Pose2(1.0, 2.0, pi / 2)
    laser = robot @ Pose2(0.25, 0.05, 0.1)
    poses = " ".join(f"{p.x!r} {p.y!r} {p.theta!r}" for p in (laser, robot)) + " 0.3 0.1 0 0 0"
    lines = [odom(ORIGIN, 0.5), directed("ROBOTLASER1", "1 8.19 30 0", poses, 0.9)]
    assert carmen_sources(lines).lasers == ("ROBOTLASER1",)
    (scan,) = (e.scan for e in read_carmen(lines, "ROBOTLASER1") if isinstance(e, LoggedScan))
    assert scan.angles == pytest.approx((-0.75 * pi, -pi / 4, pi / 4, 0.75 * pi), abs=1e-4)
    assert scan.ranges == (1.0, 8.19, inf, -inf)
    mount = scan.sensor_in_robot
    assert (mount.x, mount.y, mount.theta) == pytest.approx((0.25, 0.05, 0.1))
    assert scan.robot_in_odom == robot
    assert scan.stamp == 0.9


@pytest.mark.parametrize(
    ("begin", "last"),
    [
        ("0 -1.570796 3.141593 0.785398 81.9 0.01 0 5", pi / 2),
        ("0 -1.570796 3.141593 0.785398 81.9 0.01 0 4", pi / 4),
        ("0 -1.570796 3.141593 360 81.9 0.01 0 5", pi / 2),
    ],
)
def test_the_step_counts_if_it_fills_the_field_of_view(begin: str, last: float) -> None:
    line = directed("RAWLASER1", " ".join(["1.0"] * int(begin[-1])), begin=begin)
    entries = read_carmen([odom(ORIGIN, 1.0), line], "RAWLASER1")
    (scan,) = (entry.scan for entry in entries if isinstance(entry, LoggedScan))
    assert scan.angles[-1] == pytest.approx(last, abs=1e-4)


def test_a_scan_without_poses_has_the_odometry_of_its_time_and_the_place_in_the_parameters() -> (
    None
):
    lines = [
        "PARAM robot_frontlaser_offset 0.18 host 0",
        "PARAM robot_frontlaser_side_offset -0.02 host 0",
        directed("RAWLASER1", "1 1", stamp=0.5),
        odom(ORIGIN, 1.0),
        directed("RAWLASER1", "1 1", stamp=1.25),
        directed("RAWLASER2", "1 1", stamp=1.25),
        odom(Pose2(1.0, 0.0, 0.4), 2.0),
        directed("RAWLASER1", "1 1", stamp=2.5),
    ]
    found = [e for e in read_carmen(lines, "RAWLASER1") if isinstance(e, LoggedScan)]
    headings = [entry.scan.robot_in_odom.theta for entry in found]
    assert headings == pytest.approx([0.0, 0.1, 0.4])
    assert [entry.scan.robot_in_odom.x for entry in found] == [0.0, 0.25, 1.0]
    assert found[0].scan.sensor_in_robot == Pose2(0.18, -0.02)
    (rear,) = (e for e in read_carmen(lines, "RAWLASER2") if isinstance(e, LoggedScan))
    assert rear.scan.sensor_in_robot.theta == pi


@given(st.lists(st.text(max_size=60), max_size=5))
def test_damaged_lines_are_skipped(lines: list[str]) -> None:
    damaged = ["FLASER", "FLASER x", "FLASER 5 1 2", "ODOM 1 2", "ODOM nan 0 0 0 0 0 1 h 1"]
    damaged += ["FLASER 1e300 1", "ODOM 1e30 0 0 0 0 0 1 h 1", "PARAM robot_front_laser_max nan"]
    good = odom(Pose2(cos(1.0), sin(1.0)), 1.0)
    entries = list(read_carmen([*damaged, *lines, good]))
    assert isinstance(entries[-1], LoggedOdometry)
