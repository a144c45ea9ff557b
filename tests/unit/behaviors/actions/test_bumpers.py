"""Backing off from what a bumper has touched."""

from math import radians

import pytest

from pioneer3.behaviors.action import Situation
from pioneer3.behaviors.actions import Bumpers
from pioneer3.geometry import Pose2, Twist2
from pioneer3.state import Bumpers as Segments
from tests.unit.behaviors.support import seen, value

NOTHING = (False,) * 5


def hit(*numbers: int) -> tuple[bool, ...]:
    return tuple(n in numbers for n in range(5))


def at(
    now: float,
    v: float = 0.0,
    front: tuple[bool, ...] = NOTHING,
    rear: tuple[bool, ...] = NOTHING,
    theta: float = 0.0,
) -> Situation:
    bumpers = Segments(front=front, rear=rear)
    return seen(now, pose=Pose2(0, 0, theta), twist=Twist2(v, 0.0), bumpers=bumpers)


@pytest.mark.parametrize(
    ("segments", "degrees"),
    [
        # segment i of n = 5 is at i * 27 + 13.5 - 67.5 degrees: -54 -27 0 27 54
        ((0,), -13.5),  # -(67.5 - 54)
        ((1,), -40.5),
        ((2,), 67.5),
        ((3,), 40.5),
        ((0, 1), -27.0),  # mean -40.5: -(67.5 - 40.5)
        ((1, 2, 3), 67.5),  # mean 0
    ],
)
def test_it_turns_the_more_the_nearer_to_the_middle_it_was_hit(
    segments: tuple[int, ...], degrees: float
) -> None:
    desire = Bumpers().decide(at(0.0, 0.1, front=hit(*segments), theta=0.5))
    assert value(desire, "v") == -0.1
    assert value(desire, "heading") == pytest.approx(0.5 + radians(degrees))
    behind = Bumpers().decide(at(0.0, -0.1, rear=hit(*segments), theta=0.5))
    assert value(behind, "v") == 0.1
    assert value(behind, "heading") == pytest.approx(0.5 - radians(degrees))


def test_it_backs_off_then_turns_then_lets_go() -> None:
    action = Bumpers()
    action.decide(at(0.0, 0.1, front=hit(1)))  # to -40.5 degrees
    backing = action.decide(at(2.9, -0.1))
    assert (value(backing, "v"), value(backing, "turn")) == (-0.1, 0.0)
    turning = action.decide(at(3.0))
    assert value(turning, "v") == 0.0
    assert value(turning, "heading") == pytest.approx(radians(-40.5))
    assert action.decide(at(3.5, theta=radians(-37.4))) is not None
    assert action.decide(at(3.6, theta=radians(-37.6))) is None  # within 3 degrees


def test_a_turn_that_does_not_end_is_given_up() -> None:
    action = Bumpers()
    action.decide(at(0.0, 0.1, front=hit(1)))
    assert action.decide(at(5.9)) is not None
    assert action.decide(at(6.0)) is None


def test_it_does_not_back_into_something_else() -> None:
    action = Bumpers()
    action.decide(at(0.0, 0.1, front=hit(1)))
    stuck = action.decide(at(1.0, front=hit(1), rear=hit(2)))
    assert (value(stuck, "v"), value(stuck, "turn")) == (0.0, 0.0)


def test_only_the_bumper_of_the_way_it_moves_counts() -> None:
    assert Bumpers().decide(at(0.0, 0.1, rear=hit(1))) is None
    assert Bumpers().decide(at(0.0, -0.1, front=hit(1))) is None
    assert Bumpers().decide(at(0.0, 0.024, front=hit(1))) is None  # 25 mm/s is standing


def test_who_was_stopped_by_what_it_hit_was_moving_a_moment_ago() -> None:
    action = Bumpers()
    assert action.decide(at(0.0, 0.1)) is None
    assert value(action.decide(at(0.1, 0.0, front=hit(2))), "v") == -0.1
    late = Bumpers()
    late.decide(at(0.0, 0.1))
    assert late.decide(at(1.1, 0.0, front=hit(2))) is None
