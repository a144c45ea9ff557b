"""A scan and its surroundings: contradictions, and the one place that fits."""

from math import pi

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.nav.frames import KeyFrame
from pioneer3.nav.mapper import LOST_CONTRADICTION
from pioneer3.nav.matching import Cloud
from pioneer3.nav.relocalization import CONTRADICTED, Vicinity
from tests.unit.nav.halls import HALL, look

BEFORE = Pose2(2.0, 1.5)
"""Where the only other scan was taken."""
SQUARE = np.array([[0, 0, 6, 0], [6, 0, 6, 6], [6, 6, 0, 6], [0, 6, 0, 0]], dtype=np.float64)
"""Walls that look the same from four sides [m]."""


def around(walls: np.ndarray, *places: Pose2) -> Vicinity:
    beams = [look(walls, place) for place in places]
    return Vicinity([KeyFrame.of(one, Cloud.of(one), 0.0, 0.0) for one in beams], places)


@pytest.mark.parametrize("place", [Pose2(2.3, 1.6, 0.4), Pose2(10.0, 1.5, 1.0), Pose2(10.0, 6.0)])
def test_what_is_seen_from_another_place_is_no_contradiction(place: Pose2) -> None:
    assert around(HALL, BEFORE).contradiction(look(HALL, place), place) < CONTRADICTED / 8


@pytest.mark.parametrize("move", [Pose2(0.0, 0.0, 0.7), Pose2(0.0, 0.0, -2.5), Pose2(1.5, 0.5)])
def test_what_is_seen_from_elsewhere_is_one(move: Pose2) -> None:
    place = BEFORE @ move
    assert around(HALL, BEFORE).contradiction(look(HALL, place), BEFORE) > CONTRADICTED


def test_somebody_who_has_come_is_no_reason_to_be_elsewhere() -> None:
    scan = look(HALL, BEFORE)
    near = np.abs(np.arctan2(scan.points[:, 1], scan.points[:, 0]) - 0.3) < 0.25
    scan.points[near] *= (0.8 / np.hypot(*scan.points[near].T))[:, None]
    assert around(HALL, BEFORE).contradiction(scan, BEFORE) < CONTRADICTED / 2


def test_a_crowd_in_half_of_the_view_begins_no_piece() -> None:
    scan = look(HALL, BEFORE)
    near = np.abs(np.arctan2(scan.points[:, 1], scan.points[:, 0])) < 1.4
    scan.points[near] *= (0.8 / np.hypot(*scan.points[near].T))[:, None]
    assert 0.2 < around(HALL, BEFORE).contradiction(scan, BEFORE) < LOST_CONTRADICTION


def test_a_place_is_found_whatever_the_heading() -> None:
    place = BEFORE @ Pose2(0.5, -0.4, 2.8)
    scan = look(HALL, place)
    match = around(HALL, BEFORE).find(Cloud.of(scan), scan, BEFORE, way=1.0, fit=0.6)
    assert match is not None
    off = place.inverse() @ match.pose
    assert (off.x, off.y, off.theta) == pytest.approx((0, 0, 0), abs=0.01)


def test_of_headings_that_look_the_same_none_is_taken() -> None:
    middle = Pose2(3.0, 3.0)
    scan = look(SQUARE, middle @ Pose2(0.0, 0.0, pi / 2))
    assert around(SQUARE, middle).find(Cloud.of(scan), scan, middle, way=1.0, fit=0.6) is None
