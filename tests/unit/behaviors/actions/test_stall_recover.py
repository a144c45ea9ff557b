"""Ten ways out of a stall. R = 0.5 m of a P3-AT."""

from math import pi, radians

import pytest

from pioneer3.behaviors.action import Desire, Situation, Weighted
from pioneer3.behaviors.actions import StallRecover
from pioneer3.behaviors.actions.recover import WAYS
from pioneer3.geometry import Pose2
from pioneer3.state import Motors
from tests.unit.behaviors.support import above, around, seen, value

FREE, BOTH = Motors(enabled=True), Motors(enabled=True, left_stalled=True, right_stalled=True)
LEFT, RIGHT = Motors(enabled=True, left_stalled=True), Motors(enabled=True, right_stalled=True)


def at(
    now: float,
    motors: Motors = FREE,
    theta: float = 0.0,
    *echoes: tuple[float, float],
    higher: Desire | None = None,
) -> Situation:
    pose = Pose2(0, 0, theta)
    return seen(
        now,
        pose=pose,
        motors=motors,
        around=around(*echoes, pose=pose),
        higher=above(higher) if higher else None,
    )


def recovery() -> StallRecover:
    """Return one that does not creep at first, as ARIA's."""
    return StallRecover(clear=0.0)


def test_it_does_nothing_while_the_wheels_turn() -> None:
    assert StallRecover().decide(at(0.0)) is None
    assert StallRecover(enabled=False).decide(at(0.0, BOTH)) is None


@pytest.mark.parametrize(
    ("motors", "echoes", "degrees"),
    [
        (LEFT, (), -45),  # only the left side is blocked: to the right
        (RIGHT, (), 45),
        (BOTH, ((0.7, -pi / 2), (0.9, pi / 2)), 45),  # the right side is nearer
        (BOTH, ((0.9, -pi / 2), (0.7, pi / 2)), -45),
        (BOTH, (), -45),
    ],
)
def test_it_backs_and_turns_away_first(
    motors: Motors, echoes: tuple[tuple[float, float], ...], degrees: float
) -> None:
    desire = recovery().decide(at(0.0, motors, 0.3, *echoes))
    assert desire is not None
    assert desire.answers_stall
    assert value(desire, "v") == -0.15
    assert value(desire, "heading") == pytest.approx(0.3 + radians(degrees))
    assert desire.reason == "stalled: back and turn"


def test_it_stops_turning_within_three_degrees_and_drives_on() -> None:
    action = recovery()
    action.decide(at(0.0, RIGHT))
    assert value(action.decide(at(1.0, FREE, radians(41.9))), "heading") is not None
    there = action.decide(at(1.1, FREE, radians(42.1)))
    assert (value(there, "v"), value(there, "heading"), value(there, "w")) == (-0.15, None, 0.0)


def test_it_ends_after_fifty_cycles() -> None:
    action = recovery()
    action.decide(at(0.0, BOTH))
    assert value(action.decide(at(4.9)), "v") == -0.15
    last = action.decide(at(5.0))
    assert (value(last, "v"), value(last, "w")) == (0.0, 0.0)
    assert action.decide(at(5.1)) is None


def test_after_half_of_the_time_it_minds_what_is_near() -> None:
    # nearer than 0.5 + 0.225 behind; in the first half it goes on all the same
    action, near = recovery(), (0.72, pi)
    action.decide(at(0.0, BOTH, 0.0, near))
    action.decide(at(2.0, FREE, radians(-45), near))  # has turned; only drives now
    assert value(action.decide(at(2.4, FREE, radians(-45), near)), "v") == -0.15
    assert value(action.decide(at(2.5, FREE, radians(-45), near)), "v") == 0.0
    assert action.decide(at(2.6)) is None


def trouble(action: StallRecover, now: float) -> Desire:
    """Let it begin at `now`, then run out of time."""
    first = action.decide(at(now, BOTH))
    action.decide(at(now + 5.0))
    assert first is not None
    return first


def test_trouble_soon_after_calls_for_the_next_way_round_and_round() -> None:
    action = recovery()
    wanted = [trouble(action, 9.0 * n) for n in range(11)]
    reasons = [f"stalled: {way.words}" for way in (*WAYS, WAYS[0])]
    assert [desire.reason for desire in wanted] == reasons
    # back, forward, back, forward, -, -, back, back, forward, forward
    speeds = [value(desire, "v") for desire in wanted[:10]]
    assert speeds == [-0.15, 0.15, -0.15, 0.15, 0.0, 0.0, -0.15, -0.15, 0.15, 0.15]
    turns = [value(desire, "heading") for desire in wanted[2:10]]
    a = pytest.approx(radians(45))
    b = pytest.approx(radians(-45))
    assert turns == [None, None, a, b, a, b, a, b]


def test_trouble_long_after_begins_with_the_first_way() -> None:
    action = StallRecover()
    trouble(action, 0.0)
    assert trouble(action, 10.1).reason == "stalled: back and turn"  # 5.1 s after the last step


@pytest.mark.parametrize("owner", [Desire(v=0.1), Desire(w=0.0), Desire(turn=0.1)])
def test_it_leaves_the_robot_to_a_higher_priority(owner: Desire) -> None:
    action = StallRecover()
    assert action.decide(at(0.0, BOTH, higher=owner)) is None
    action.decide(at(0.1, BOTH))
    assert action.decide(at(0.2, BOTH, higher=owner)) is None
    assert action.decide(at(0.3)) is None  # and does not take it up again


def test_half_a_wish_above_does_not_end_it() -> None:
    assert StallRecover().decide(at(0.0, BOTH, higher=Desire(v=Weighted(0.1, 0.5)))) is not None
    # nor do limits
    assert StallRecover().decide(at(0.0, BOTH, higher=Desire(v_max=0.0))) is not None


def test_it_creeps_first_because_no_sensor_saw_the_thing_it_met() -> None:
    """It backed at 0.09 m/s into the box that its rear corner touched."""
    action = StallRecover()
    first = action.decide(at(0.0, RIGHT))
    assert (value(first, "v"), value(first, "heading"), value(first, "w")) == (-0.035, None, 0.0)
    away = seen(1.0, pose=Pose2(-0.11, 0.0, 0.0), motors=FREE)
    then = action.decide(away)
    assert value(then, "v") == -0.15
    assert value(then, "heading") == pytest.approx(radians(45))


def test_no_corner_turns_faster_than_the_creep_where_it_stalled() -> None:
    action = StallRecover()
    for number in range(5):
        turn = trouble(action, 9.0 * number)
    assert turn.reason == "stalled: turn left"
    assert value(turn, "left_max") == pytest.approx(0.035 / seen().model.corner)
