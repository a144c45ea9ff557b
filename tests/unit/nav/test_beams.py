"""Scans as arrays."""

from math import inf, nan, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.nav.beams import beams_of
from pioneer3.state import Scan

poses = st.builds(
    Pose2, st.floats(-20, 20), st.floats(-20, 20), st.floats(-pi, pi, exclude_min=True)
)
steps = st.builds(Pose2, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-0.3, 0.3))
ranges = st.lists(st.sampled_from([0.5, 3.0, 7.5, inf, -inf, nan]), min_size=1, max_size=20)


def scan(
    ranges: list[float],
    *,
    beam_time: float = 1e-3,
    robot_in_odom: Pose2 = ORIGIN,
    last_in_odom: Pose2 | None = None,
) -> Scan:
    return Scan(
        stamp=5.0,
        sequence=1,
        robot_in_odom=robot_in_odom,
        last_in_odom=last_in_odom,
        sensor_in_robot=Pose2(0.16, 0.0, 0.0),
        angles=tuple(np.linspace(-1.5, 1.5, len(ranges)).tolist()),
        ranges=tuple(ranges),
        beam_time=beam_time,
        far=30.0,
    )


@given(poses, steps, ranges, st.sampled_from([1e-3, -1e-3]))
def test_points_are_where_the_scan_says(
    begin: Pose2, step: Pose2, ranges: list[float], beam_time: float
) -> None:
    sweep = scan(ranges, beam_time=beam_time, robot_in_odom=begin, last_in_odom=begin @ step)
    beams = beams_of(sweep)
    here = beams.robot_in_odom
    c, s = np.cos(here.theta), np.sin(here.theta)
    seen = beams.points @ np.array([[c, s], [-s, c]]) + (here.x, here.y)
    wanted = np.array(sweep.points_in_odom()).reshape(-1, 2)
    assert seen == pytest.approx(wanted, abs=3e-3)  # the lever of the laser turns meanwhile


def test_the_last_reading_in_time_is_the_reference() -> None:
    begin, end = Pose2(1, 2, 0.1), Pose2(1.02, 2, 0.12)
    ahead = beams_of(scan([1.0, 2.0, 3.0], robot_in_odom=begin, last_in_odom=end))
    assert ahead.robot_in_odom == end
    assert ahead.stamp == pytest.approx(5.002)
    upside_down = scan([1.0, 2.0], beam_time=-1e-3, robot_in_odom=end, last_in_odom=begin)
    assert beams_of(upside_down).robot_in_odom == end
    assert beams_of(upside_down).stamp == 5.0


def test_where_nothing_echoed_the_way_is_clear_as_far_as_the_laser_sees() -> None:
    beams = beams_of(scan([inf, nan, -inf, 2.0]))
    assert len(beams.points) == len(beams.clear) == 1
    assert np.hypot(*(beams.clear[0] - beams.origin)) == pytest.approx(30.0)
