"""Turning away from what is in front or beside. R = 0.5 m of a P3-AT."""

from math import inf, pi, radians

import pytest

from pioneer3.behaviors.action import Desire, Situation
from pioneer3.behaviors.actions import AvoidFront, AvoidSide
from pioneer3.behaviors.surroundings import NOTHING_SENSED
from pioneer3.geometry import Pose2
from pioneer3.models import load_model
from pioneer3.state import Inputs
from tests.unit.behaviors.support import above, around, seen, value

TURN = radians(15)
PEOPLEBOT = load_model("peoplebot-sh")
"""Its table sensors are low when triggered."""


def front(distance: float, bearing: float = -0.1, theta: float = 0.0) -> Situation:
    """Return a situation with something `distance` [m] from the robot's circle."""
    pose = Pose2(0, 0, theta)
    return seen(pose=pose, around=around((distance + 0.5, bearing), pose=pose))


def test_it_lets_be_what_is_far() -> None:
    assert AvoidFront().decide(front(0.46)) is None
    assert AvoidFront().decide(seen()) is None


def test_it_turns_away_from_what_is_near() -> None:
    # 0.36 m: 0.2 m/s * 0.36 / 0.45 = 0.16 m/s; on the right (-0.1 rad), so 15 degrees to the left
    desire = AvoidFront().decide(front(0.36))
    assert value(desire, "v") == pytest.approx(0.16)
    assert value(desire, "turn") == pytest.approx(TURN)
    assert desire is not None
    assert desire.reason == "0.36 m ahead at -6 deg"


def test_within_half_of_the_distance_it_stands_and_turns() -> None:
    # half of 0.45 m is 0.225 m
    assert value(AvoidFront().decide(front(0.226)), "v") == pytest.approx(0.2 * 0.226 / 0.45)
    assert value(AvoidFront().decide(front(0.224)), "v") == 0.0


@pytest.mark.parametrize(("bearing", "side"), [(0.1, -1), (-0.1, 1), (0.0, -1)])
def test_it_turns_to_the_other_side(bearing: float, side: int) -> None:
    assert value(AvoidFront().decide(front(0.3, bearing)), "turn") == pytest.approx(side * TURN)


@pytest.mark.parametrize(("bearing", "near"), [(69, True), (71, False), (-69, True), (180, False)])
def test_the_front_is_seventy_degrees_to_either_side(bearing: float, near: bool) -> None:
    assert (AvoidFront().decide(front(0.3, radians(bearing))) is not None) == near


def test_it_keeps_its_side_until_the_way_is_free_then_goes_straight_once() -> None:
    action = AvoidFront()
    assert value(action.decide(front(0.3, 0.1)), "turn") == pytest.approx(-TURN)
    assert value(action.decide(front(0.3, -0.1)), "turn") == pytest.approx(-TURN)
    free = action.decide(front(inf))
    assert (value(free, "turn"), value(free, "v")) == (0.0, None)
    assert action.decide(front(inf)) is None
    assert value(action.decide(front(0.3, -0.1)), "turn") == pytest.approx(TURN)


def test_it_chooses_anew_after_a_higher_priority_has_turned() -> None:
    action = AvoidFront()
    action.decide(front(0.3, 0.1))
    turned = seen(around=around((0.8, -0.1)), higher=above(Desire(turn=0.0)))
    assert value(action.decide(turned), "turn") == pytest.approx(TURN)


def test_all_four_quadrants_without_a_way_out_halve_the_turn() -> None:
    # 15, then 7.5 3.75 1.875 0.9375 degrees; 0.47 is less than the half degree that is carried out
    action, amounts = AvoidFront(), []
    for _ in range(6):
        for quarter in (0.1, 0.1 + pi / 2, 0.1 + pi, 0.1 - pi / 2):
            desire = action.decide(front(0.3, -0.1, quarter))
        amounts.append(value(desire, "turn"))
    degrees = (7.5, 3.75, 1.875, 0.9375, 15, 7.5)
    assert amounts == pytest.approx([radians(d) for d in degrees])


def test_without_range_sensors_it_stands() -> None:
    desire = AvoidFront().decide(seen(around=NOTHING_SENSED))
    assert desire == Desire(v=0.0, turn=0.0, lacks=True, reason="no range sensor works")


@pytest.mark.parametrize(("bits", "side"), [(0b10, 1), (0b01, -1), (0b00, 1)])
def test_a_table_is_turned_away_from(bits: int, side: int) -> None:
    at_table = seen(model=PEOPLEBOT, inputs=Inputs(digital_in=bits))
    desire = AvoidFront().decide(at_table)
    assert value(desire, "v") == 0.0
    assert value(desire, "turn") == pytest.approx(side * TURN)
    assert AvoidFront(use_table_sensor=False).decide(at_table) is None
    # the same bits of a robot that has no such sensors mean nothing
    assert AvoidFront().decide(seen(inputs=Inputs(digital_in=bits))) is None


def beside(left: float, right: float) -> Situation:
    return seen(around=around((left + 0.5, pi / 2), (right + 0.5, -pi / 2)))


@pytest.mark.parametrize(
    ("left", "right", "turn"),
    [(0.29, inf, -5), (inf, 0.29, 5), (0.29, 0.1, -5)],  # the left side is looked at first
)
def test_the_sides_are_turned_away_from(left: float, right: float, turn: float) -> None:
    desire = AvoidSide().decide(beside(left, right))
    assert value(desire, "v") == 0.0
    assert value(desire, "turn") == pytest.approx(radians(turn))


def test_free_sides_mean_straight_ahead_once_after_a_turn() -> None:
    action = AvoidSide()
    assert action.decide(beside(0.31, 0.31)) is None
    action.decide(beside(0.2, inf))
    assert value(action.decide(beside(inf, inf)), "turn") == 0.0
    assert action.decide(beside(inf, inf)) is None
