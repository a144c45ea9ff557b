"""Driving to a place."""

from math import inf, pi, radians, sqrt

import pytest

from pioneer3.behaviors.action import Desire, Situation
from pioneer3.behaviors.actions import Goto, TurnAway
from pioneer3.geometry import Pose2, Twist2
from tests.unit.behaviors.support import above, around, seen, value


def at(
    x: float = 0.0, theta: float = 0.0, v: float = 0.0, w: float = 0.0, v_max: float | None = None
) -> Situation:
    higher = above(Desire(v_max=v_max)) if v_max is not None else None
    return seen(pose=Pose2(x, 0.0, theta), twist=Twist2(v, w), higher=higher)


@pytest.mark.parametrize(
    ("distance", "speed"),
    [
        (3.0, 0.4),  # sqrt(400 * 3000) = 1095 mm/s, but 400 at most
        (0.3, sqrt(0.4 * 0.3)),  # sqrt(400 * 300) = 346 mm/s
        (0.099, 0.0),  # close
    ],
)
def test_it_slows_down_towards_the_goal(distance: float, speed: float) -> None:
    desire = Goto(distance, 0.0).decide(at(v=0.1))
    assert value(desire, "v") == pytest.approx(speed)
    assert value(desire, "heading") == pytest.approx(0.0)


def test_it_turns_to_the_goal() -> None:
    assert value(Goto(0.0, 2.0).decide(at()), "heading") == pytest.approx(pi / 2)


def test_it_has_arrived_when_it_stands_close_by() -> None:
    goto = Goto(1.0, 0.0)
    assert goto.decide(at(0.95, v=0.006)) is not None
    assert not goto.done
    assert goto.decide(at(0.95, v=-0.2)) is not None  # ARIA's counts as standing
    assert not goto.done
    there = goto.decide(at(0.95, v=0.004))
    assert (value(there, "v"), value(there, "turn")) == (0.0, 0.0)
    assert goto.done
    assert goto.decide(at(0.95)) is None


def test_it_turns_to_the_final_heading_where_it_stands() -> None:
    goto = Goto(1.0, 0.0, pi / 2)
    assert value(goto.decide(at(0.95)), "turn") == pytest.approx(pi / 2)
    assert value(goto.decide(at(0.85, radians(86.9))), "turn") == pytest.approx(radians(3.1))
    assert not goto.done
    goto.decide(at(0.95, radians(87.1), w=0.1))
    assert not goto.done
    goto.decide(at(0.95, radians(87.1)))
    assert goto.done


def test_another_goal_begins_anew_the_same_does_not() -> None:
    goto = Goto(1.0, 0.0)
    goto.decide(at(0.95))
    goto.aim(1.004, 0.0)
    assert goto.done
    goto.aim(1.0, 0.006)
    assert not goto.done


def test_it_turns_away_while_something_limits_the_speed_and_then_passes_by() -> None:
    goto = Goto(3.0, 0.0)
    assert value(goto.decide(at(v_max=0.14)), "turn") == pytest.approx(radians(7))
    assert value(goto.decide(at(v_max=0.15)), "heading") == pytest.approx(0.0)
    # free again, 7 degrees to the left of the goal: 0 - (7 - 7) = 0 is less than 3.5
    assert value(goto.decide(at(theta=radians(7))), "turn") == pytest.approx(radians(-7))
    # at 14 degrees: |0 - (14 - 7)| = 7 is more
    assert value(goto.decide(at(theta=radians(14))), "heading") == pytest.approx(0.0)


def test_a_goal_behind_changes_the_side_once() -> None:
    goto = Goto(3.0, 0.0)
    behind = [goto.decide(at(theta=radians(121), v_max=0.1)) for _ in range(3)]
    assert [value(desire, "turn") for desire in behind] == pytest.approx([radians(-7)] * 3)
    goto.decide(at(theta=0.0, v_max=0.1))
    again = goto.decide(at(theta=radians(121), v_max=0.1))
    assert value(again, "turn") == pytest.approx(radians(7))


@pytest.mark.parametrize(
    ("v", "degrees"), [(0.05, 15.0), (0.15, 7.5), (0.19, 1.5), (0.2, 0.0), (0.21, None)]
)
def test_turning_away_the_more_the_slower(v: float, degrees: float | None) -> None:
    # 15 * (0.2 - v) / 0.1 between 0.1 and 0.2 m/s
    desire = TurnAway().decide(seen(twist=Twist2(v, 0.0)))
    wanted = None if degrees is None else pytest.approx(radians(degrees), abs=1e-9)
    assert value(desire, "turn") == wanted


@pytest.mark.parametrize(
    ("distance", "bearing", "side"), [(2.9, 0.5, -1), (2.9, -0.5, 1), (3.1, 0.5, 1), (inf, 0, 1)]
)
def test_turning_away_from_what_is_nearest_else_left(
    distance: float, bearing: float, side: int
) -> None:
    desire = TurnAway().decide(seen(around=around((distance, bearing))))
    assert value(desire, "turn") == pytest.approx(side * radians(15))


def test_turning_away_keeps_its_side_until_fast_again() -> None:
    action = TurnAway()
    left, right = (around((1.0, 0.5)), around((1.0, -0.5)))
    turns = [
        value(action.decide(seen(around=around_, twist=Twist2(v, 0.0))), "turn")
        for around_, v in ((left, 0.0), (right, 0.0), (right, 0.3), (right, 0.0))
    ]
    assert turns == [pytest.approx(-radians(15)), pytest.approx(-radians(15)), None,
                     pytest.approx(radians(15))]  # fmt: skip
