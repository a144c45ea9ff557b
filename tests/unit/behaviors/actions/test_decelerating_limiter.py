"""Stopping in time. Of a P3-AT: L/2 = 0.313 m, W/2 = 0.2525 m; own deceleration 1.5 m/s^2."""

from math import atan2, hypot, inf, pi, sqrt

import pytest

from pioneer3.behaviors.action import Desire, Situation
from pioneer3.behaviors.actions import DeceleratingLimiter
from pioneer3.behaviors.surroundings import NOTHING_SENSED
from pioneer3.geometry import Twist2
from tests.unit.behaviors.support import around, looking_ahead, seen, value


def ahead(distance: float, v: float = 0.0, bearing: float = 0.0) -> Situation:
    """Return a situation with something `distance` [m] from the centre, at speed `v` [m/s]."""
    return seen(twist=Twist2(v, 0.0), around=around((distance, bearing)))


def test_from_rest_the_speed_is_what_the_room_allows() -> None:
    # d = 0.8 - (0.313 + 0.1 + 0.05) = 0.337; 0.7 s at 0.342 m/s and 0.342^2 / 1.2 are as much
    desire = DeceleratingLimiter().decide(ahead(0.8))
    assert value(desire, "v_max") == pytest.approx(0.6 * (sqrt(0.49 + 0.337 / 0.3) - 0.7))
    assert value(desire, "v_max") == pytest.approx(0.342, abs=0.001)
    prompt = DeceleratingLimiter(reaction=0.0).decide(ahead(0.8))
    assert value(prompt, "v_max") == pytest.approx(sqrt(2 * 0.6 * 0.337))
    assert desire is not None
    assert desire.reason == "0.49 m ahead at 0 deg"


def test_the_padding_grows_with_the_speed() -> None:
    # at 0.6 m/s, half way between 0.2 and 1: padding (0.05 + 0.3) / 2 = 0.175
    # d = 0.8 - (0.313 + 0.1 + 0.175) = 0.212
    desire = DeceleratingLimiter().decide(ahead(0.8, 0.6))
    assert value(desire, "v_max") == pytest.approx(0.6 * (sqrt(0.49 + 0.212 / 0.3) - 0.7))


def test_the_width_grows_with_the_speed() -> None:
    # slow 0.2525 + 0.05 = 0.3025 wide, at 0.6 m/s 0.2525 + 0.225 = 0.4775
    distance, bearing = hypot(0.6, 0.4), atan2(0.4, 0.6)
    assert DeceleratingLimiter().decide(ahead(distance, 0.2, bearing)) is None
    assert DeceleratingLimiter().decide(ahead(distance, 0.6, bearing)) is not None


def test_who_can_stop_from_top_speed_is_free() -> None:
    # 0.75 m/s: d >= 0.75 * 0.7 + 0.75^2 / 1.2 = 0.994, so from 0.994 + 0.463 = 1.457 m on
    assert DeceleratingLimiter().decide(ahead(1.46)) is None
    assert DeceleratingLimiter().decide(ahead(1.45)) is not None
    assert DeceleratingLimiter().decide(ahead(inf)) is None


def test_in_the_padding_it_may_not_go_on() -> None:
    # d = 0.45 - 0.463 < 0, but 0.45 - 0.413 = 0.037 m outside of the clearance
    desire = DeceleratingLimiter().decide(ahead(0.45))
    assert (value(desire, "v_max"), value(desire, "v")) == (0.0, None)


def test_in_the_clearance_it_is_stopped() -> None:
    # 0.4 - 0.413 < 0.001
    desire = DeceleratingLimiter().decide(ahead(0.4, 0.2))
    assert (value(desire, "v_max"), value(desire, "v")) == (0.0, 0.0)
    assert value(desire, "deceleration") == 1.5
    emergency = DeceleratingLimiter(emergency_decel=1.8).decide(ahead(0.4, 0.2))
    assert value(emergency, "deceleration") == 1.8
    assert value(DeceleratingLimiter().decide(ahead(0.4, 0.05)), "deceleration") is None


@pytest.mark.parametrize(
    ("distance", "emergency", "brake"),
    [
        # 0.6 m/s: padding 0.175, so d = 0.8 - 0.588 = 0.212 and 0.36 / 0.424 = 0.85 < 1.5
        (0.8, 0.0, None),
        # d = 0.112: 0.36 / 0.224 = 1.61 > 1.5; dIn = 0.7 - 0.413 = 0.287: 0.36 / 0.574 = 0.627
        (0.7, 0.0, 0.36 / 0.574),
        # dIn = 0.037: 0.36 / 0.074 = 4.9, harder than any Pioneer brakes
        (0.45, 0.0, 2.0),
        (0.7, 1.9, 1.9),
    ],
)
def test_it_brakes_harder_where_the_robot_would_not_do(
    distance: float, emergency: float, brake: float | None
) -> None:
    action = DeceleratingLimiter(emergency_decel=emergency)
    wanted = value(action.decide(ahead(distance, 0.6)), "deceleration")
    assert wanted == (None if brake is None else pytest.approx(brake))


def test_each_looks_its_way_only() -> None:
    back = DeceleratingLimiter(backwards=True)
    behind = ahead(0.8, 0.0, pi)
    assert value(back.decide(behind), "back_max") == pytest.approx(0.342, abs=0.001)
    assert DeceleratingLimiter().decide(behind) is None
    assert back.decide(ahead(0.8)) is None


def test_who_moves_the_other_way_is_not_asked() -> None:
    assert DeceleratingLimiter().decide(ahead(0.4, -0.11)) is None
    assert DeceleratingLimiter().decide(ahead(0.4, -0.09)) is not None
    assert DeceleratingLimiter(backwards=True).decide(ahead(0.4, 0.11, pi)) is None


def test_without_range_sensors_there_is_no_motion() -> None:
    blind, why = seen(around=NOTHING_SENSED), "no range sensor works"
    assert DeceleratingLimiter().decide(blind) == Desire(v_max=0.0, lacks=True, reason=why)
    backwards = DeceleratingLimiter(backwards=True).decide(blind)
    assert backwards == Desire(back_max=0.0, lacks=True, reason=why)


def test_backwards_it_creeps_where_nothing_looks() -> None:
    back = DeceleratingLimiter(backwards=True)
    reason = "nothing looks behind: switch the sonars on"
    assert back.decide(looking_ahead()) == Desire(back_max=0.035, reason=reason)
    assert value(back.decide(looking_ahead((0.4, pi))), "back_max") == 0.0  # remembered
    assert DeceleratingLimiter().decide(looking_ahead()) is None
