"""Driving along ways: a robot without errors, that obeys at once but for its accelerations."""

from dataclasses import replace
from math import atan2, cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pioneer3.geometry import Pose2, Twist2, arc, wrap
from pioneer3.limits import Limits
from pioneer3.maps import LineMap
from pioneer3.maps.grid import samples
from pioneer3.nav.follower import GOAL_MARGIN, MARGIN, Follower
from pioneer3.nav.manoeuvre import gaps_at
from pioneer3.nav.planner import Way, plan
from tests.unit.nav.offices import AT, NO_OBSTACLES, costs, room, two_rooms

Float = NDArray[np.float64]
LIMITS = Limits(max_speed=0.75, max_turn_rate=1.7)
DT = 0.1


def follower(line_map: LineMap, start: Pose2, goal: tuple[float, float, float | None]) -> Follower:
    way = plan(costs(line_map), (start.x, start.y), goal[:2])
    assert isinstance(way, Way), way
    return Follower(AT, LIMITS, goal, way.cost_to_go)


def gap(at: Pose2, points: Float) -> float:
    """Return the distance of the robot's outline from the nearest of `points` (N, 2)."""
    c, s = cos(at.theta), sin(at.theta)
    dx, dy = points[:, 0] - at.x, points[:, 1] - at.y
    x, y = c * dx + s * dy, c * dy - s * dx
    off_x = np.maximum(np.maximum(x - AT.length_front, -AT.length_rear - x), 0)
    return float(np.hypot(off_x, np.maximum(np.abs(y) - AT.width / 2, 0)).min())


def towards(now: float, wanted: float, step: float) -> float:
    return min(wanted, now + step) if wanted > now else max(wanted, now - step)


def drive(
    by: Follower, start: Pose2, walls: Float, seconds: float = 60.0
) -> tuple[Pose2, float, float]:
    """Drive; return where it ended, the least gap to walls, and how long it took."""
    at, v, w, least = start, 0.0, 0.0, 9.0
    obstacles = np.pad(walls, ((0, 0), (0, 3)))
    for tick in range(round(seconds / DT)):
        step = by.step(at, Twist2(v, w), obstacles)
        if step.arrived:
            return at, least, tick * DT
        v = towards(v, step.v, LIMITS.acceleration * DT)
        w = towards(w, step.w, LIMITS.turn_acceleration * DT)
        at = at @ arc(v, w, DT)
        least = min(least, gap(at, walls))
    return at, least, seconds


@settings(deadline=None, max_examples=15)
@given(
    st.tuples(st.floats(0.6, 4.2), st.floats(0.6, 5.4), st.floats(-3, 3)),
    st.tuples(st.floats(5.8, 9.4), st.floats(0.6, 5.4), st.floats(-3, 3)),
)
def test_it_goes_through_the_door_and_arrives(
    start: tuple[float, float, float], goal: tuple[float, float, float]
) -> None:
    line_map = two_rooms(0.9)
    walls = samples(line_map.walls, 0.05)
    begin = Pose2(*start)
    at, least, took = drive(follower(line_map, begin, goal), begin, walls)
    assert hypot(at.x - goal[0], at.y - goal[1]) < 0.03
    assert abs(wrap(at.theta - goal[2])) < 0.03
    assert least > 0.01
    assert took < 45


def test_without_a_heading_it_stays_as_it_arrives() -> None:
    begin = Pose2(1.0, 3.0, 0.0)
    at, _, _ = drive(follower(room(), begin, (6.0, 3.0, None)), begin, np.array([[0.0, 0.0]]))
    assert abs(at.theta) < 0.2


def test_it_turns_first_where_its_way_is_behind_it() -> None:
    begin = Pose2(5.0, 3.0, pi)
    step = follower(room(), begin, (9.0, 3.0, None)).step(begin, Twist2(), NO_OBSTACLES)
    assert step.v == 0.0
    assert abs(step.w) > 0.3


def test_it_stops_for_a_thing_right_ahead_that_nobody_planned_for() -> None:
    begin = Pose2(1.0, 3.0, 0.0)
    by = follower(two_rooms(0.9), begin, (8.0, 3.0, None))
    plug = np.array([[5.0, y] for y in np.arange(2.5, 3.55, 0.05)])
    walls = np.concatenate([samples(two_rooms(0.9).walls, 0.05), plug])
    at, least, _ = drive(by, begin, walls, seconds=25.0)
    assert at.x < 5.0 - AT.length_front
    assert least > 0.01


def test_a_robot_beside_a_thing_is_not_frozen() -> None:
    begin = Pose2(3.0, 3.0, 0.0)
    beside = np.array([[3.0, 3.0 + AT.width / 2 + MARGIN / 2, 0.0, 0.0, 0.0]])
    step = follower(room(), begin, (8.0, 3.0, None)).step(begin, Twist2(), beside)
    assert step.v > 0.0


def test_a_robot_in_the_way_of_somebody_unseen_does_not_touch_a_wall() -> None:
    """A person who may be where the robot is says nothing about walls."""
    line_map = room([4.0, 2.6, 8.0, 2.6])
    walls = np.pad(samples(line_map.walls, 0.05), ((0, 0), (0, 3)))
    unseen = np.array([[5.1, 3.4, 0.0, 0.0, 0.36]])
    for theta in np.linspace(-pi, pi, 9):
        at, v, w = Pose2(5.0, 3.05, float(theta)), 0.0, 0.0
        by = follower(room(), at, (5.0, 1.0, None))
        for _ in range(100):
            step = by.step(at, Twist2(v, w), np.concatenate([walls, unseen]))
            v = towards(v, step.v, LIMITS.acceleration * DT)
            w = towards(w, step.w, LIMITS.turn_acceleration * DT)
            before = gap(at, walls[:, :2])
            at = at @ arc(v, w, DT)
            now = gap(at, walls[:, :2])
            assert now > 0.005 or now >= before - 1e-3


def test_it_lets_a_person_pass_who_walks_into_its_way() -> None:
    begin = Pose2(3.0, 3.0, 0.0)
    by = follower(room(), begin, (8.0, 3.0, None))
    free = by.step(begin, Twist2(0.7, 0.0), NO_OBSTACLES)
    walking = np.array([[4.3, 3.9, 0.0, -0.9, 0.0]])
    crossed = by.step(begin, Twist2(0.7, 0.0), walking)
    assert (crossed.v, crossed.w) != (free.v, free.w)


def test_no_faster_than_asked() -> None:
    begin = Pose2(1.0, 3.0, 0.0)
    step = follower(room(), begin, (8.0, 3.0, None)).step(begin, Twist2(0.2, 0), NO_OBSTACLES, 0.2)
    assert 0 < step.v <= 0.2


def test_it_does_not_turn_into_somebody_who_stands_beside_it() -> None:
    begin = Pose2(6.0, 3.0, 0.0)
    by = follower(room(), begin, (6.0, 3.0, pi / 2))
    beside = np.array([[6.0, 3.0 + AT.width / 2 + 0.05 + 0.28, 0.0, 0.0, 0.28]])
    assert by.step(begin, Twist2(), NO_OBSTACLES).w > 0.0
    step = by.step(begin, Twist2(), beside)
    assert (step.v, step.w) == (0.0, 0.0)
    assert step.blocked


def test_beside_somebody_who_blocks_its_way_it_stands_rather_than_turn_to_and_fro() -> None:
    begin = Pose2(6.0, 3.0, 0.0)
    by = follower(room(), begin, (9.0, 3.0, None))
    ahead = 6.0 + AT.length_front + 0.05 + 0.28
    crowd = np.array(
        [[ahead, 3.0 + side, 0.0, 0.0, 0.28] for side in (-0.7, -0.35, 0.0, 0.35, 0.7)]
    )
    assert by.step(begin, Twist2(), crowd).w != 0.0
    step = by.step(begin, Twist2(), crowd, gently=True)
    assert (step.v, step.w) == (0.0, 0.0)
    assert step.blocked
    free = by.step(begin, Twist2(), crowd + np.array([1.5, 0.0, 0.0, 0.0, 0.0]), gently=True)
    assert free.v > 0.0
    assert not free.blocked


@pytest.mark.parametrize("gap_", [0.05, GOAL_MARGIN, 0.01])
def test_it_creeps_no_nearer_to_somebody_than_their_place_is_known(gap_: float) -> None:
    at, radius = Pose2(5.0, 3.0, 0.0), 0.28
    by = follower(room(), at, (5.25, 3.08, None))
    somebody = np.array([[5.0 + AT.length_front + gap_ + radius, 3.2, 0.0, 0.0, radius]])
    twist, least = Twist2(), gap_
    for _ in range(100):
        step = by.step(at, twist, somebody, gently=True)
        twist = Twist2(towards(twist.v, step.v, 0.03), towards(twist.w, step.w, 0.15))
        at = at @ arc(twist.v, twist.w, 0.1)
        least = min(least, float(gaps_at(at, AT, somebody).min()))
    assert least >= min(gap_, GOAL_MARGIN) - 0.005


@pytest.mark.parametrize("radius", [0.0, 0.28])
@pytest.mark.parametrize(("off", "begin"), [(0.2, 0.3), (0.25, 0.3), (0.32, 0.4)])
def test_near_its_goal_it_stops_before_what_has_come_into_its_way(
    off: float, begin: float, radius: float
) -> None:
    at, twist = Pose2(5.0, 3.0, 0.0), Twist2(begin)
    by = follower(room(), at, (5.34, 3.0, None))
    thing = np.array([[5.0 + AT.length_front + off + radius, 3.0, 0.0, 0.0, radius]])
    for _ in range(40):
        step = by.step(at, twist, thing, gently=True)
        twist = Twist2(towards(twist.v, step.v, 0.03), towards(twist.w, step.w, 0.15))
        at = at @ arc(twist.v, twist.w, 0.1)
        assert gaps_at(at, AT, thing).min() > 0.0


def test_it_goes_all_the_way_to_a_goal_with_a_wall_beyond_it() -> None:
    line_map, heading = room(), -atan2(AT.width, 2 * AT.length_front)
    goal = Pose2(10.0 - AT.corner - 0.1, 3.0, heading)
    by = follower(line_map, goal, (goal.x, goal.y, None))
    by.limits = replace(LIMITS, deceleration=1.5)  # it may arrive fast, yet not from where it is
    walls = np.pad(samples(line_map.walls, 0.05), ((0, 0), (0, 3)))
    assert by.step(goal @ Pose2(-0.04), Twist2(), walls).v > 0.0


def test_a_robot_in_whose_outline_somebody_is_taken_to_stand_may_drive_on() -> None:
    by = follower(room(), Pose2(5.0, 3.0), (9.0, 3.0, None))
    inside = np.array([[4.9, 3.1, 0.0, 0.0, 0.28]])
    assert by.step(Pose2(5.0, 3.0), Twist2(), inside, gently=True).v > 0.0


def test_it_turns_at_its_goal_though_somebody_comes_who_will_stop() -> None:
    at = Pose2(6.0, 3.0, 0.0)
    by = follower(room(), at, (6.0, 3.0, pi / 2))
    comes = np.array([[7.5, 3.0, -0.8, 0.0, 0.28]])
    assert by.step(at, Twist2(), comes).w > 0.0
    near = np.array([[6.0, 3.0 + AT.width / 2 + 0.28 + 0.05, 0.0, -0.8, 0.28]])
    assert by.step(at, Twist2(), near).w == 0.0
