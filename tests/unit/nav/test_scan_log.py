"""Scan logs of ARIA."""

from math import inf, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.geometry import Pose2
from pioneer3.nav.logged import LoggedPlace, LoggedScan
from pioneer3.nav.scan_log import read_scan_log, scan_log_sources
from pioneer3.state import Scan

OLD = """LaserOdometryLog
#Created by ARIA's ArSickLogger
version: 2
sick1pose: 160 7 0.00
sick1conf: -90 90 181
#Scan 1
scan1Id: 1
time: 0.5
#rawRobot: 0 0 0.00 0 0
robot: 1000 -500 90.00 120 3
"""
NEW = """LaserOdometryLog
#Created by ArLaserLogger
version: 4
sick1pose: 160 0 180.00
sick1conf: -90.00 90.00 3
sick1name: lms2xx_1
scan1pose: 160 0 400 180.00
sick2pose: -200 0 0.00
locationTypes: robot robotGlobal robotRaw
logTime: 2.500
velocities: 0.00 0.00 0.00
scanId: 0
robot: 100 200 45.00
robotGlobal: 5100 200 45.00
robotRaw: 90 210 44.00
scan2: 0 -700  700 0
scanId: 1
robot: 100 200 45.00
robotGlobal: 5100 200 45.00
robotRaw: 90 210 44.00
reflector1: 0 0 0
scan1: 0 -1000  0 0  2000 0  0 3000
"""


def scans(text: str, laser: str = "scan1", pose: str = "robot") -> list[Scan]:
    entries = read_scan_log(text.splitlines(), laser, pose)
    return [entry.scan for entry in entries if isinstance(entry, LoggedScan)]


@pytest.mark.parametrize(("count", "last"), [(181, pi / 2), (180, pi / 2 - pi / 180)])
def test_ranges_go_from_right_to_left_over_the_directions_that_are_told(
    count: int, last: float
) -> None:
    (scan,) = scans(OLD + "sick1: 8191 0 " + "2500 " * (count - 2) + "\n")
    assert scan.ranges[:3] == (inf, -inf, 2.5)
    assert (scan.angles[0], scan.angles[-1]) == pytest.approx((-pi / 2, last))
    assert scan.robot_in_odom == Pose2(1.0, -0.5, pi / 2)
    assert scan.sensor_in_robot == Pose2(0.16, 0.007)
    assert scan.stamp == 0.5


def test_points_are_seen_from_the_laser_and_those_of_no_reading_are_left_out() -> None:
    (scan,) = scans(NEW)
    assert scan.angles == pytest.approx((-pi / 2, 0.0, pi / 2))
    assert scan.ranges == (1.0, 2.0, 3.0)
    assert scan.sensor_in_robot == Pose2(0.16, 0.0, pi)


def test_points_of_a_laser_that_looks_back_were_turned_as_the_robot_before_version_4() -> None:
    (scan,) = scans(NEW.replace("version: 4", "version: 3"))
    assert scan.sensor_in_robot == Pose2(0.16, 0.0)


def test_another_laser_and_another_pose_are_read_by_their_names() -> None:
    sources = scan_log_sources(NEW.splitlines())
    assert (sources.lasers, sources.odometry) == (
        ("scan1", "scan2"),
        ("robot", "robotRaw", "robotGlobal"),
    )
    (scan,) = scans(NEW, "scan2", "robotGlobal")
    assert scan.ranges == (0.7, 0.7)
    assert (scan.robot_in_odom.x, scan.sensor_in_robot.x) == (5.1, -0.2)


def test_goals_that_were_marked_are_places_and_other_tags_are_skipped() -> None:
    tags = 'robot: 1 2 3\nloop: start 1\ncairn: GoalWithHeading "" ICON_GOALWITHHEADING "goal 1"\n'
    places = [
        each for each in read_scan_log((OLD + tags).splitlines()) if isinstance(each, LoggedPlace)
    ]
    assert places == [LoggedPlace("GoalWithHeading", "goal 1")]


@given(st.lists(st.text(max_size=60), max_size=5))
def test_damaged_lines_are_skipped(lines: list[str]) -> None:
    damaged = ["robot: nan 0 0", "robot: 1e30 0 0", "robot: 1 2", "sick1:", "sick1: 1 2 x 4 5"]
    damaged += ["sick1conf: -1e308 1e308 3", "sick1pose: 1e30 0 0", "version: x", "cairn: Goal"]
    text = "\n".join([OLD, *damaged, *lines, "robot: 1 2 3", "sick1: 1000 1000 1000 inf"])
    good = "robot: 1000 0 0\nsick1: " + "1000 " * 181
    scan = scans(f"{text}\n{good}")[-1]
    assert (scan.ranges[0], scan.angles[0]) == pytest.approx((1.0, -pi / 2))
    assert scan.sensor_in_robot.x < 1.0
