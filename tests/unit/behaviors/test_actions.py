"""Holding, moving and turning: snapshot and time in, desire out."""

from math import pi, radians, sqrt

import pytest

from pioneer3.behaviors.action import Desire, Situation, as_weighted
from pioneer3.behaviors.actions import Hold, Move, Turn
from pioneer3.behaviors.engine import MARGIN, SETTLE, approach
from pioneer3.geometry import ORIGIN, Pose2, Twist2
from pioneer3.stops import NO_STOP
from tests.unit.behaviors.support import seen


def at(now: float = 0.0, pose: Pose2 = ORIGIN, v: float = 0.0, w: float = 0.0) -> Situation:
    return seen(now, pose=pose, twist=Twist2(v, w))


def wanted(desire: Desire | None, channel: str) -> float:
    """Return what is wanted of a channel."""
    wish = as_weighted(getattr(desire, channel))
    assert wish is not None
    return wish.value


def move(distance: float) -> Move:
    return Move(distance=distance, speed=0.5, deceleration=0.3)


def turn(angle: float) -> Turn:
    return Turn(angle=angle, rate=1.0, deceleration=1.7)


@pytest.mark.parametrize(
    ("remaining", "speed"),
    [
        (100.0, 0.5),  # far away: the top speed
        (0.2, sqrt(2 * MARGIN * 0.3 * 0.2)),  # v^2 = 2 a s
        (0.01, 0.01 / SETTLE),  # near: proportional
        (-0.2, -sqrt(2 * MARGIN * 0.3 * 0.2)),
        (0.0, 0.0),
    ],
)
def test_an_approach_is_fast_far_away_and_gentle_near(remaining: float, speed: float) -> None:
    assert approach(remaining, 0.5, 0.3) == pytest.approx(speed)


def test_a_hold_lasts_as_long_as_it_was_set_for() -> None:
    hold = Hold("stick")
    assert hold.decide(at(0.0)) is None
    hold.set(Twist2(0.2, 0.1), 1.0, 0.5, NO_STOP)
    desire = hold.decide(at(1.49))
    assert desire is not None
    assert (desire.v, desire.w, desire.until) == (0.2, 0.1, 1.5)
    assert hold.decide(at(1.5)) is None


def test_a_released_hold_wants_nothing() -> None:
    hold = Hold("stick")
    hold.set(Twist2(0.2, 0.1), 1.0, 0.5, NO_STOP)
    hold.release()
    assert hold.decide(at(1.0)) is None


def test_a_move_goes_along_the_heading_at_its_start() -> None:
    action = move(1.0)
    start = Pose2(3.0, 2.0, pi / 2)
    first = action.decide(at(0.0, start))
    assert first is not None
    assert first.v == pytest.approx(0.5)
    assert first.w == 0.0
    there = action.decide(at(1.0, start @ Pose2(1.0, 0.3)))  # beside the line counts as there
    assert there is not None
    assert (there.v, there.w) == (0.0, 0.0)
    assert action.done


def test_a_move_is_done_only_when_the_robot_stands() -> None:
    action = move(1.0)
    action.decide(at(0.0))
    action.decide(at(1.0, Pose2(0.998), v=0.1))
    assert not action.done
    action.decide(at(1.1, Pose2(1.02)))
    assert not action.done
    action.decide(at(1.2, Pose2(1.003)))
    assert action.done


def test_a_move_that_went_too_far_comes_back() -> None:
    action = move(1.0)
    action.decide(at(0.0))
    desire = action.decide(at(1.0, Pose2(1.1)))
    assert desire is not None
    assert wanted(desire, "v") < 0


@pytest.mark.parametrize("off", [0.1, -0.1, 2 * pi - 0.1])
def test_a_move_keeps_its_heading(off: float) -> None:
    action = move(1.0)
    action.decide(at(0.0))
    desire = action.decide(at(0.1, Pose2(0.1, 0.0, off)))
    assert desire is not None
    assert desire.w == pytest.approx(-0.15 if off == 0.1 else 0.15)


@pytest.mark.parametrize("angle", [1.0, -1.0, 3 * pi, -5 * pi])
def test_a_turn_counts_every_radian_of_it(angle: float) -> None:
    action, theta, now = turn(angle), 0.0, 0.0
    sign = 1 if angle > 0 else -1
    while not action.done:
        desire = action.decide(at(now, Pose2(0, 0, theta)))
        assert desire is not None
        w = wanted(desire, "w")
        assert w * sign >= 0
        theta, now = theta + w * 0.1, now + 0.1
        assert now < 60
    assert theta == pytest.approx(angle, abs=radians(0.7))


def test_a_turn_never_asks_for_less_than_the_wheels_can_do() -> None:
    for sign in (1, -1):
        action = turn(sign * radians(0.3))
        action.tolerance = radians(0.1)
        desire = action.decide(at(0.0))
        assert desire is not None
        assert desire.w == pytest.approx(sign * radians(2))


def test_a_turn_is_done_only_when_the_robot_stands() -> None:
    action = turn(1.0)
    action.decide(at(0.0))
    action.decide(at(1.0, Pose2(0, 0, 1.0), w=0.3))
    assert not action.done
    action.decide(at(1.1, Pose2(0, 0, 1.0)))
    assert action.done
