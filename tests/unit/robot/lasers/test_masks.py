"""Learning the sectors in which a laser sees its robot."""

from math import inf, nan, radians

import pytest

from pioneer3.geometry import ORIGIN
from pioneer3.robot.lasers.mounting import learned, words
from pioneer3.robot.lasers.spec import parse_mask
from pioneer3.state import Scan

POST = {30, 31, 32}
"""Directions of a post [deg]."""


def scan(near: set[int], *, metres: float = 0.1, count: int = 181) -> Scan:
    """Return a scan of 1 degree a step with things at `metres` in these directions."""
    degrees = range(-(count // 2), count // 2 + 1)
    return Scan(
        stamp=0.0,
        sequence=1,
        robot_in_odom=ORIGIN,
        sensor_in_robot=ORIGIN,
        angles=tuple(radians(d) for d in degrees),
        ranges=tuple(metres if d in near else 3.0 for d in degrees),
    )


def sectors(scans: list[Scan], nearer_than: float = 0.3) -> list[tuple[float, float]]:
    """Return what is learned, in degrees."""
    found = learned(scans, nearer_than)
    return [(s.first / radians(1), s.last / radians(1)) for s in found]


def test_a_post_becomes_a_sector_with_a_margin() -> None:
    assert sectors([scan(POST)] * 20) == [pytest.approx((29.0, 33.0))]


def test_several_posts_stay_apart() -> None:
    found = sectors([scan(POST | {-60, -10, -9})] * 20)
    assert found == [
        pytest.approx((-61.0, -59.0)),
        pytest.approx((-11.0, -8.0)),
        pytest.approx((29.0, 33.0)),
    ]


def test_somebody_who_walks_by_is_no_part_of_the_robot() -> None:
    passing = [scan(POST | {number}) for number in range(-80, 0)]
    assert sectors(passing) == [pytest.approx((29.0, 33.0))]


def test_a_post_that_is_missed_now_and_then_is_learned() -> None:
    scans = [scan(POST)] * 19 + [scan(set())]
    assert sectors(scans) == [pytest.approx((29.0, 33.0))]
    assert sectors([scan(POST)] * 17 + [scan(set())] * 3) == []


def test_things_too_near_to_measure_count_and_invalid_readings_do_not() -> None:
    assert sectors([scan(POST, metres=-inf)] * 9) == [pytest.approx((29.0, 33.0))]
    assert sectors([scan(POST, metres=nan)] * 9) == []
    assert sectors([scan(POST, metres=0.31)] * 9) == []


def test_without_anything_near_or_any_scan_nothing_is_learned() -> None:
    assert sectors([scan(set())] * 9) == []
    assert sectors([]) == []


def test_scans_of_another_shape_are_left_out() -> None:
    assert sectors([scan(set(), count=91)] * 30 + [scan(POST)] * 9) == [pytest.approx((29.0, 33.0))]


def test_the_words_are_an_option_and_a_line_of_a_file() -> None:
    found = learned([scan(POST | {-60})] * 9, 0.3)
    option, line = words(found)
    assert option == "--laser-mask=-61.0:-59.0,29.0:33.0"
    assert line == "masked_deg = [[-61.0, -59.0], [29.0, 33.0]]"
    read = parse_mask(option.partition("=")[2])
    assert [tuple(s) for s in read] == [pytest.approx(tuple(s)) for s in found]
