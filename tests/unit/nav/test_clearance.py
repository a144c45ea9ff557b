"""The last check of a command, in places where it matters."""

from math import pi

import numpy as np
import pytest
from numpy.typing import NDArray

from pioneer3.geometry import STILL, Pose2, Twist2, arc
from pioneer3.limits import Limits
from pioneer3.nav.clearance import Clearance, Walls
from pioneer3.nav.particles import points_by
from tests.unit.nav.offices import AT

Float = NDArray[np.float64]
LIMITS = Limits(max_speed=0.75, max_turn_rate=1.7)
MARGIN, DT = 0.02, 0.1
SIDE, FRONT = AT.width / 2, AT.length_front
AHEAD, BACK = Twist2(0.3, 0.0), Twist2(-0.1, 0.0)
LEFT, RIGHT = Twist2(0.0, 0.4), Twist2(0.0, -0.4)


def clearance() -> Clearance:
    return Clearance(model=AT, limits=LIMITS, margin=MARGIN)


def passed(asked: Twist2, *walls: list[float], twist: Twist2 = STILL) -> Twist2:
    """Return what comes of a command beside walls, in the robot's frame."""
    around = np.pad(np.array(walls, dtype=np.float64).reshape(-1, 4), ((0, 0), (0, 1)))
    return clearance().limit(asked, twist, around, 0.0)


def beside(gap: float) -> list[float]:
    """Return a long wall to the left."""
    return [-3.0, SIDE + gap, 3.0, SIDE + gap]


def test_in_the_open_everything_passes() -> None:
    assert passed(Twist2(0.75, 1.7)) == Twist2(0.75, 1.7)
    assert passed(Twist2(0.75, 0.0), [5.0, -1.0, 5.0, 1.0]) == Twist2(0.75, 0.0)


@pytest.mark.parametrize("speed", [0.75, 0.1, -0.5])
def test_a_robot_that_is_driven_at_a_wall_stands_before_it(speed: float) -> None:
    """The wall is one long segment: no corner slips between the points of it."""
    wall, check = np.array([[1.5, -9.0, 1.5, 9.0], [-1.5, -9.0, -1.5, 9.0]]), clearance()
    at, v = Pose2(), 0.0
    for tick in range(150):
        ends = points_by(at.inverse(), wall.reshape(-1, 2)).reshape(-1, 4)
        ends = np.pad(ends, ((0, 0), (0, 1)))
        asked = check.limit(Twist2(speed, 0.0), Twist2(v, 0.0), ends, tick * DT).v
        step = (LIMITS.acceleration if abs(asked) > abs(v) else LIMITS.deceleration) * DT
        v = min(asked, v + step) if asked > v else max(asked, v - step)
        at = at @ arc(v, 0.0, DT)
    assert MARGIN - 1e-6 < 1.5 - FRONT - abs(at.x) < MARGIN + 0.02


def test_beside_a_wall_within_the_margin_it_drives_along_and_turns_neither_way() -> None:
    assert passed(AHEAD, beside(0.01)) == AHEAD
    assert passed(BACK, beside(0.01)) == BACK
    assert passed(LEFT, beside(0.01)) == passed(RIGHT, beside(0.01)) == STILL


def test_a_turn_that_gets_a_corner_away_from_a_wall_passes() -> None:
    at = Pose2(0.0, 0.0, 0.3)
    corner = at @ Pose2(FRONT, SIDE)
    wall = points_by(at.inverse(), np.array([[-3.0, corner.y + 0.005], [3.0, corner.y + 0.005]]))
    line = wall.reshape(-1).tolist()
    assert passed(RIGHT, line) == RIGHT
    assert passed(BACK, line) == BACK
    assert passed(LEFT, line) == STILL
    assert passed(AHEAD, line) == STILL


def test_a_robot_whose_map_says_that_it_is_in_a_wall_may_only_leave_it() -> None:
    line = [FRONT - 0.03, -1.0, FRONT - 0.03, 1.0]
    assert passed(BACK, line) == BACK
    assert passed(AHEAD, line) == STILL


def test_where_a_turn_is_refused_the_speed_remains() -> None:
    assert passed(Twist2(0.2, 0.4), beside(0.01)) == Twist2(0.2, 0.0)


def test_a_robot_that_something_has_come_too_near_to_brakes() -> None:
    assert passed(AHEAD, [FRONT + 0.03, -1.0, FRONT + 0.03, 1.0], twist=AHEAD) == STILL


def test_walls_are_found_wherever_a_piece_of_them_is_near() -> None:
    walls = Walls.of(np.array([[-50.0, 1.0, 50.0, 1.0], [20.0, 0.0, 20.0, 0.0]]))
    near = walls.near(30.25, 0.0, 1.2)
    assert len(near)
    assert len(near) < 6
    assert np.isclose(near[:, 1], 1.0).all()
    assert np.isclose(np.hypot(*(walls.pieces[:, 2:] - walls.pieces[:, :2]).T).sum(), 100.0)


def test_a_robot_turns_in_a_room_that_is_just_wide_enough() -> None:
    room = AT.corner + MARGIN + 0.01
    corners = [(room * sx, room * sy) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    sides = [[*a, *b] for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]
    assert passed(Twist2(0.0, pi / 2), *sides) == Twist2(0.0, pi / 2)


def test_people_are_as_wide_as_they_are() -> None:
    somebody = np.array([[FRONT + 0.28 + 0.1, 0.0, FRONT + 0.28 + 0.1, 0.0, 0.28]])
    near = somebody - (0.09, 0.0, 0.09, 0.0, 0.0)
    assert clearance().limit(Twist2(0.05, 0.0), STILL, somebody, 0.0).v > 0.0
    assert clearance().limit(Twist2(0.05, 0.0), STILL, near, 0.0).v == 0.0
    assert clearance().limit(BACK, STILL, near, 0.0) == BACK
