"""How fast one may go. Of a P3-AT: L/2 = 0.313 m, W/2 = 0.2525 m, R = 0.5 m."""

from math import inf, pi, radians

import pytest

from pioneer3.behaviors.action import Desire
from pioneer3.behaviors.actions import LimiterBackwards, LimiterForwards, LimiterTableSensor
from pioneer3.behaviors.actions.limiters import CREEP
from pioneer3.behaviors.surroundings import NOTHING_SENSED
from pioneer3.models import load_model
from pioneer3.state import Inputs
from tests.unit.behaviors.support import around, looking_ahead, seen, value


@pytest.mark.parametrize(
    ("distance", "limit"),
    [
        (0.2, 0.0),  # nearer than 0.25
        (0.25, 0.0),  # 0.2 * (0.25 - 0.25) / 0.75
        (0.5, 0.2 / 3),  # 0.2 * (0.5 - 0.25) / (1.0 - 0.25)
        (0.999, 0.2 * 0.749 / 0.75),
        (1.01, None),
        (inf, None),
    ],
)
def test_forwards_less_is_allowed_the_nearer_something_is(
    distance: float, limit: float | None
) -> None:
    desire = LimiterForwards().decide(seen(around=around((distance + 0.313, 0.0))))
    assert value(desire, "v_max") == (limit if limit is None else pytest.approx(limit))


def test_forwards_only_the_width_of_the_robot_counts() -> None:
    # at 0.6 m ahead, 0.2525 m to the side is atan(0.2525 / 0.6) = 22.8 degrees
    def limited(ratio: float, degrees: float) -> bool:
        place = seen(around=around((0.65, radians(degrees))))
        return LimiterForwards(width_ratio=ratio).decide(place) is not None

    assert limited(1.0, 22.0)  # 0.65 * sin(22) = 0.243
    assert not limited(1.0, 24.0)  # 0.264
    assert limited(1.1, 24.0)  # 0.278 wide
    assert not limited(9.0, 95.0)  # behind the centre


def test_the_reason_says_where_it_is() -> None:
    desire = LimiterForwards().decide(seen(around=around((0.38 + 0.313, radians(-12)))))
    assert desire is not None
    assert desire.reason == "0.38 m ahead at -12 deg"


@pytest.mark.parametrize(
    ("distance", "limit"),
    [
        (0.2, 0.0),  # nearer than 0.25
        (0.4, 0.25 * 0.15 / 0.35),  # 0.107: the worked example of facts.md 7.6
        (0.59, 0.25 * 0.34 / 0.35),
        (0.7, 0.25),
        (inf, 0.25),
    ],
)
def test_backwards_too(distance: float, limit: float) -> None:
    desire = LimiterBackwards().decide(seen(around=around((distance + 0.5, pi))))
    assert value(desire, "back_max") == pytest.approx(limit)


def test_backwards_one_and_a_half_widths_count() -> None:
    # 1.5 * 0.2525 = 0.379 m: at 0.6 m that is 180 - asin(0.379 / 0.6) = 140.8 degrees
    for degrees, limit in ((142, 0.0), (140, 0.25), (-142, 0.0), (-140, 0.25)):
        desire = LimiterBackwards().decide(seen(around=around((0.6, radians(degrees)))))
        assert value(desire, "back_max") == limit


def test_nobody_moves_without_range_sensors() -> None:
    blind, why = seen(around=NOTHING_SENSED), "no range sensor works"
    assert LimiterForwards().decide(blind) == Desire(v_max=0.0, lacks=True, reason=why)
    assert LimiterBackwards().decide(blind) == Desire(back_max=0.0, lacks=True, reason=why)


@pytest.mark.parametrize(
    ("sonar", "reason"),
    [
        (False, "nothing looks behind: switch the sonars on"),
        (True, "nothing looks behind"),
    ],
)
def test_robots_creep_back_where_nothing_looks(sonar: bool, reason: str) -> None:
    place = looking_ahead(sonar=sonar)
    assert LimiterBackwards().decide(place) == Desire(back_max=CREEP, reason=reason)
    assert LimiterForwards().decide(place) is None


@pytest.mark.parametrize(
    ("bits", "reason"),
    [
        (0b1111, None),
        (0b1110, "a table on the left"),
        (0b1101, "a table on the right"),
        (0b1100, "a table on the left and right"),
        (0b0011, None),  # light beams are not tables
    ],
)
def test_a_table_stops_a_robot_that_can_see_it(bits: int, reason: str | None) -> None:
    inputs, peoplebot = Inputs(digital_in=bits), load_model("peoplebot-sh")
    desire = LimiterTableSensor().decide(seen(model=peoplebot, inputs=inputs))
    assert desire == (None if reason is None else Desire(v_max=0.0, reason=reason))
    assert LimiterTableSensor().decide(seen(inputs=inputs)) is None
