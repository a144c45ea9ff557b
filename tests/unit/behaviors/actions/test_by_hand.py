"""Shares of full speed by keys and sticks, and the input of programs."""

from math import inf, radians

import pytest

from pioneer3.behaviors.action import Desire, Situation
from pioneer3.behaviors.actions import Input, RatioInput
from pioneer3.geometry import Pose2, Twist2
from tests.unit.behaviors.support import above, seen, value


def at(reading: int = 1, v: float = 0.0, w: float = 0.0, higher: Desire | None = None) -> Situation:
    return seen(
        0.1 * reading,
        sequence=reading,
        twist=Twist2(v, w),
        higher=above(higher) if higher else None,
    )


@pytest.mark.parametrize(
    ("pushed", "measured", "v", "w"),
    [
        ((1.0, 0.0, 1.0), 0.0, 0.75, 0),  # the robot's limit
        ((0.5, 0.0, 0.5), 0.0, 0.1875, 0),  # 0.5 * 0.75 * 0.5
        ((-1.0, 0.0, 1.0), 0.0, -0.1875, 0),  # a quarter of it
        ((0.1, 0.05, 1.0), 0.0, 0.0, 0),  # inside the dead zones
        ((0.0, 1.0, 1.0), 0.0, 0.0, 50),  # at rest
        ((1.0, 1.0, 1.0), 0.75, 0.75, 25),  # at full speed
        ((1.0, -1.0, 1.0), 0.375, 0.75, -37.5),  # half way between: (25 - 50) * 0.5 + 50
        ((-1.0, 0.5, 0.5), -0.1875, -0.09375, 6.25),  # 0.5 * 25 * 0.5
    ],
)
def test_ratios_of_full_speed(
    pushed: tuple[float, float, float], measured: float, v: float, w: float
) -> None:
    ratios = RatioInput()
    ratios.push(*pushed)
    desire = ratios.decide(at(v=measured))
    assert desire.v == pytest.approx(v)
    assert desire.w == pytest.approx(radians(w))


def test_full_speeds_can_be_set() -> None:
    ratios = RatioInput(full_forwards=0.4, full_backwards=0.3)
    ratios.push(0.5, 0.0)
    assert ratios.decide(at()).v == pytest.approx(0.2)
    ratios.push(-0.5, 0.0)
    assert ratios.decide(at()).v == pytest.approx(-0.15)


def test_keys_go_by_twentieths_from_beyond_the_dead_zone() -> None:
    ratios = RatioInput()
    speeds = []
    for reading in range(4):
        speeds.append(ratios.decide(at(reading)).v)
        ratios.up()
    # 5 and 10 percent are inside, 15 percent of 0.75 m/s is 0.1125
    assert speeds == pytest.approx([0.0, 0.0, 0.0, 0.1125])
    for _ in range(50):
        ratios.down()
    assert ratios.decide(at(5)).v == pytest.approx(-0.1875)
    ratios.space()
    assert ratios.decide(at(6)).v == 0.0


def test_turning_keys_last_one_reading() -> None:
    ratios = RatioInput()
    ratios.left()
    assert [ratios.decide(at(n)).w for n in (1, 1, 2)] == pytest.approx([radians(50)] * 2 + [0])
    ratios.right()
    assert ratios.decide(at(2)).w == pytest.approx(radians(-50))


def test_a_turning_key_that_repeats_turns_without_a_gap() -> None:
    ratios = RatioInput()
    turned = []
    for reading in range(1, 6):
        turned.append(ratios.decide(at(reading)).w)  # when the reading comes
        if reading in {2, 3}:
            ratios.left()  # between this reading and the next
            turned.append(ratios.decide(at(reading)).w)
    rate = pytest.approx(radians(50))
    assert turned == [0, 0, rate, rate, rate, rate, 0]


def test_a_stick_comes_before_keys_and_ends_them() -> None:
    ratios = RatioInput()
    for _ in range(10):
        ratios.up()
    ratios.push(-1.0, 0.0)
    assert ratios.decide(at()).v == pytest.approx(-0.1875)
    ratios.release()
    assert ratios.decide(at(2)).v == 0.0


def test_a_stick_that_nobody_renews_is_let_go() -> None:
    ratios = RatioInput()
    ratios.push(1.0, 0.0, until=0.45)
    assert ratios.decide(at(4)).until == 0.45
    assert ratios.decide(at(5)) == Desire(v=0.0, w=0.0, until=inf, reason="no speed is set")


def test_a_stick_against_the_motion_brakes_harder() -> None:
    ratios = RatioInput()
    ratios.push(-0.51, 0.51)
    braking = ratios.decide(at(v=0.3, w=-0.2))
    # three times the 0.3 m/s^2 and 100 deg/s^2 that a P3-AT comes with
    assert braking.deceleration == pytest.approx(0.9)
    assert braking.turn_deceleration == pytest.approx(radians(300))
    ratios.push(-0.49, 0.51)
    gentle = ratios.decide(at(v=0.3, w=0.2))
    assert (gentle.deceleration, gentle.turn_deceleration) == (None, None)


@pytest.mark.parametrize(("drive", "turn", "throttle"), [(1.1, 0, 1), (0, -2, 1), (0, 0, -0.1)])
def test_shares_out_of_range_are_refused(drive: float, turn: float, throttle: float) -> None:
    with pytest.raises(ValueError, match="must be"):
        RatioInput().push(drive, turn, throttle)


def test_a_program_sets_what_it_wants_until_it_sets_something_else() -> None:
    given = Input()
    assert given.decide(at()) is None
    given.drive_at(0.2)
    given.turn_at(0.3)
    assert given.decide(at()) == Desire(v=0.2, w=0.3, reason="by program")
    given.face(1.0)
    assert given.decide(at()) == Desire(v=0.2, heading=1.0, reason="by program")
    given.clear()
    assert given.decide(at()) is None


def test_a_turn_by_an_angle_is_counted_from_where_it_began() -> None:
    given = Input()
    given.turn_by(0.5)
    for theta in (1.0, 1.2):
        desire = given.decide(seen(pose=Pose2(0, 0, theta)))
        assert value(desire, "heading") == pytest.approx(1.5)
