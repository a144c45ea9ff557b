"""Where somebody is, is a function of time."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest

from pioneer3.geometry import Pose2
from pioneer3.sim.worldfile import Person

CORNER = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0))


def at(person: Person, time: float) -> tuple[float, float, float]:
    pose = person.pose_at(time)
    return pose.x, pose.y, pose.theta


@pytest.mark.parametrize(
    ("time", "pose"),
    [
        (0.0, (0, 0, 0)),
        (1.0, (0.5, 0, 0)),
        (4.0, (2, 0, pi / 2)),
        (5.0, (2, 0.5, pi / 2)),
        (6.0, (2, 1, pi / 2)),
        (7.0, (2, 0.5, -pi / 2)),
        (9.0, (1.5, 0, pi)),
        (12.0, (0, 0, 0)),
        (12.0 * 1000 + 1.0, (0.5, 0, 0)),
    ],
)
def test_back_the_way_they_came(time: float, pose: tuple[float, float, float]) -> None:
    person = Person(path=CORNER, speed=0.5, loop=False)
    if time == 6.0:  # the turning point, where they face back already
        pose = (2, 1, -pi / 2)
    assert at(person, time) == pytest.approx(pose)


def test_a_loop_closes_straight() -> None:
    person = Person(path=((0, 0), (3, 0), (3, 4)), speed=1.0)
    assert at(person, 7.0 + 2.5) == pytest.approx((1.5, 2.0, np.arctan2(-4, -3)))
    assert at(person, 12.0 + 1.0) == pytest.approx((1.0, 0.0, 0.0))


def test_they_pause_at_every_point_and_face_on() -> None:
    person = Person(path=((0, 0), (1, 0)), speed=1.0, pause=2.0)
    assert at(person, 1.9) == pytest.approx((0, 0, 0))
    assert at(person, 2.5) == pytest.approx((0.5, 0, 0))
    assert at(person, 4.0) == pytest.approx((1, 0, pi))
    assert at(person, 5.5) == pytest.approx((0.5, 0, pi))
    assert at(person, 6.5) == pytest.approx((0, 0, 0))


@pytest.mark.parametrize("path", [((1.0, 2.0),), ((1.0, 2.0), (1.0, 2.0))])
@pytest.mark.parametrize("loop", [True, False])
def test_one_place_is_standing(path: tuple[tuple[float, float], ...], loop: bool) -> None:
    assert Person(path=path, loop=loop, pause=1.0).pose_at(7.7) == Pose2(1.0, 2.0)


def test_speed_is_constant_between_points() -> None:
    person = Person(path=CORNER, speed=0.8)
    poses = [person.pose_at(k * 0.01) for k in range(1000)]
    steps = [np.hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(poses)]
    assert max(steps) == pytest.approx(0.008)


def test_the_outline_is_a_closed_octagon_around_the_circle() -> None:
    person = Person(path=((1.0, 2.0),), radius=0.3)
    sides = person.outline_at(0.0)
    assert sides.shape == (8, 4)
    np.testing.assert_array_equal(sides[:, 2:], np.roll(sides[:, :2], -1, axis=0))
    middles = (sides[:, :2] + sides[:, 2:]) / 2 - (1.0, 2.0)
    np.testing.assert_allclose(np.hypot(*middles.T), 0.3)


def test_the_foot_on_the_ground_stands_still_while_the_other_one_swings() -> None:
    person = Person(path=((0, 0), (6, 0)), speed=0.5, loop=False)
    left = [person.pose_at(t / 10).x + person.stride_at(t / 10) for t in range(9, 100)]
    right = [person.pose_at(t / 10).x - person.stride_at(t / 10) for t in range(9, 100)]
    for a, b in zip(pairwise(left), pairwise(right), strict=True):
        steps = sorted((a[1] - a[0], b[1] - b[0]))
        # they change about in the middle of a step, which may lie between two looks
        assert sum(steps) == pytest.approx(2 * 0.05)
        assert -1e-9 <= steps[0] <= steps[1] <= 0.1 + 1e-9
    assert max(abs(a - b) for a, b in zip(left, right, strict=True)) == pytest.approx(0.3)


@pytest.mark.parametrize("time", [0.0, 1.9, 4.0, 5.0, 8.0])
def test_who_does_not_walk_has_both_feet_side_by_side(time: float) -> None:
    person = Person(path=((0, 0), (1, 0)), speed=0.5, pause=2.0, loop=False)
    assert person.stride_at(time) == pytest.approx(0.0, abs=1e-9)
    assert Person(path=((0, 0),)).stride_at(time) == 0.0
