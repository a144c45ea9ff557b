"""What holds for limiters and avoiders wherever things are."""

from dataclasses import replace
from math import inf, radians

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.behaviors.action import Action, Situation
from pioneer3.behaviors.actions import (
    AvoidFront,
    AvoidSide,
    DeceleratingLimiter,
    LimiterBackwards,
    LimiterForwards,
    RatioInput,
    TurnAway,
)
from pioneer3.geometry import Twist2
from tests.unit.behaviors.support import around, seen, value

DISTANCE, BEARING = st.floats(0.05, 5.0), st.floats(-3.1, 3.1)
ECHOES = st.lists(st.tuples(DISTANCE, BEARING), max_size=8)
SPEED = st.floats(-0.75, 0.75)
LIMITERS = [
    (LimiterForwards(), "v_max"),
    (LimiterForwards(0.3, 1.1, 0.4), "v_max"),
    (LimiterBackwards(), "back_max"),
    (DeceleratingLimiter(), "v_max"),
    (DeceleratingLimiter(backwards=True), "back_max"),
]


def place(echoes: list[tuple[float, float]], v: float = 0.0, w: float = 0.0) -> Situation:
    return seen(around=around(*echoes), twist=Twist2(v, w))


def limit(action: Action, channel: str, situation: Situation) -> float:
    found = value(action.decide(situation), channel)
    return inf if found is None else found


@pytest.mark.parametrize(("limiter", "channel"), LIMITERS)
@given(echoes=ECHOES, more=st.tuples(DISTANCE, BEARING), v=SPEED)
def test_one_thing_more_never_allows_more_speed(
    limiter: Action,
    channel: str,
    echoes: list[tuple[float, float]],
    more: tuple[float, float],
    v: float,
) -> None:
    without = limit(limiter, channel, place(echoes, v))
    assert limit(limiter, channel, place([*echoes, more], v)) <= without


@pytest.mark.parametrize(("limiter", "channel"), LIMITERS)
@given(distance=DISTANCE, nearer=st.floats(0.01, 1.0), v=SPEED)
def test_nearer_never_allows_more_speed(
    limiter: Action, channel: str, distance: float, nearer: float, v: float
) -> None:
    bearing = 0.0 if channel == "v_max" else 3.1
    far = limit(limiter, channel, place([(distance, bearing)], v))
    assert limit(limiter, channel, place([(distance * nearer, bearing)], v)) <= far


@given(ECHOES, SPEED)
def test_a_limiter_never_allows_more_than_can_be_stopped(
    echoes: list[tuple[float, float]], v: float
) -> None:
    # the nearest point ahead within the robot's width, from its front: v^2 <= 2 a d
    ahead = place(echoes, v).around.nearest_in_box(0.0, -0.2525, 16.0, 0.2525).distance - 0.313
    top = limit(DeceleratingLimiter(), "v_max", place(echoes, v))
    if v >= -0.1 and ahead < inf:
        assert min(top, 0.75) ** 2 <= 2 * 0.6 * max(0.0, ahead - 0.1) + 1e-9


CENTIMETRES, DEGREES = st.integers(5, 299), st.integers(1, 89)
IN_FRONT = st.lists(
    st.tuples(CENTIMETRES, DEGREES, st.sampled_from([1, -1])),
    min_size=1,
    max_size=8,
    unique_by=lambda echo: echo[0],
)
"""No two as far, none straight ahead: otherwise the side is a matter of convention."""


@pytest.mark.parametrize("make", [AvoidFront, AvoidSide, TurnAway])
@given(found=IN_FRONT, v=SPEED)
def test_what_lies_on_the_other_side_is_turned_away_from_to_the_other_side(
    make: type[AvoidFront | AvoidSide | TurnAway], found: list[tuple[int, int, int]], v: float
) -> None:
    # and of the two sides AvoidSide looks at the left one first
    echoes = [
        (cm / 100, radians(degrees + 0.5) * (1 if make is AvoidSide else side))
        for cm, degrees, side in found
    ]
    here, mirrored = place(echoes, v), place([(d, -b) for d, b in echoes], v)
    one, other = make().decide(here), make().decide(mirrored)
    assert value(one, "v") == value(other, "v")
    turn = value(one, "turn")
    assert value(other, "turn") == (None if turn is None else -turn)


@given(st.floats(-1, 1), st.floats(-1, 1), st.floats(0, 1), SPEED)
def test_ratios_never_ask_for_more_than_full_speed(
    drive: float, turn: float, throttle: float, v: float
) -> None:
    ratios, here = RatioInput(), place([], v)
    ratios.push(drive, turn, throttle)
    desire = ratios.decide(here)
    wanted_v, wanted_w = value(desire, "v"), value(desire, "w")
    assert wanted_v is not None
    assert wanted_w is not None
    assert -0.75 / 4 <= wanted_v <= 0.75
    assert abs(wanted_w) <= 0.873
    mirrored = RatioInput()
    mirrored.push(drive, -turn, throttle)
    assert value(mirrored.decide(replace(here)), "w") == -wanted_w
