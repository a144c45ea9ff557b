"""Of a P3-AT: ends at 0.313 m, sides at 0.2525 m; corners at 0.402 m, 38.9 degrees."""

from math import atan2, hypot, inf, pi, radians, sqrt

import pytest

from pioneer3.behaviors.action import Desire
from pioneer3.behaviors.actions import LimiterSweep
from pioneer3.behaviors.surroundings import Surroundings
from pioneer3.geometry import Twist2
from tests.unit.behaviors.support import around, looking_ahead, seen, value

CORNER = atan2(0.2525, 0.313)
CREEP = 0.035 / hypot(0.313, 0.2525)
"""Turn rate at which a corner moves at 0.035 m/s [rad/s]."""


@pytest.mark.parametrize(
    ("gap", "limit"),
    [
        (0.45, sqrt(2 * 0.3 * 0.40)),  # 0.05 m is kept
        (0.1, sqrt(2 * 0.3 * 0.05)),
        (0.05, 0.035),  # never less than a creep
        (-0.1, 0.035),  # memory is wrong about what is inside of the robot
        (1.0, None),  # 0.755 m/s: more than the robot can do
        (inf, None),
    ],
)
def test_it_may_go_as_fast_as_it_can_stop(gap: float, limit: float | None) -> None:
    desire = LimiterSweep().decide(seen(around=around((0.313 + gap, 0.0))))
    assert value(desire, "v_max") == (limit if limit is None else pytest.approx(limit))


def test_the_width_and_a_margin_count() -> None:
    # 0.2525 + 0.05 = 0.3025 m to either side
    for y, limited in ((0.30, True), (-0.30, True), (0.31, False)):
        place = seen(around=around((hypot(0.5, y), atan2(y, 0.5))))
        assert (value(LimiterSweep().decide(place), "v_max") is not None) == limited


def test_what_is_remembered_counts() -> None:
    place = seen(around=Surroundings(seen().pose, (), [(0.413, 0.0)]))
    assert value(LimiterSweep().decide(place), "v_max") == pytest.approx(sqrt(2 * 0.3 * 0.05))


@pytest.mark.parametrize(
    ("off", "left", "right"),
    [
        # to the left of the front left corner by 40 degrees: it may turn (40 - 20) degrees / 1.2 s;
        # the rear left corner is 180 - 38.9 - 38.9 - 40 = 62.2 degrees away, from the other side
        (40, radians(20) / 1.2, radians(42.2) / 1.2),
        # within 20 degrees: it may be there already, or on the other side of the corner
        (15, CREEP, CREEP),
        (-15, CREEP, CREEP),
        (25, CREEP, radians(57.2) / 1.2),
    ],
)
def test_a_corner_does_not_swing_into_something(off: float, left: float, right: float) -> None:
    desire = LimiterSweep().decide(seen(around=around((0.42, CORNER + radians(off)))))
    assert value(desire, "left_max") == pytest.approx(left, abs=1e-3)
    assert value(desire, "right_max") == pytest.approx(right, abs=1e-3)
    mirrored = LimiterSweep().decide(seen(around=around((0.42, -CORNER - radians(off)))))
    assert value(mirrored, "right_max") == pytest.approx(left, abs=1e-3)
    assert value(mirrored, "left_max") == pytest.approx(right, abs=1e-3)


def test_what_no_corner_reaches_does_not_count() -> None:
    assert LimiterSweep().decide(seen(around=around((0.46, pi / 2)))) is None
    assert LimiterSweep().decide(seen()) is None


def test_a_corner_turns_slowly_away_from_what_may_be_on_its_other_side() -> None:
    at_corner = seen(around=around((0.41, CORNER + radians(1))))
    desire = LimiterSweep(creep=0.0).decide(at_corner)
    assert value(desire, "left_max") == 0.0
    assert value(desire, "right_max") == pytest.approx(CREEP)


@pytest.mark.parametrize(
    ("x", "y", "limit"),
    [
        (-0.763, 0.0, sqrt(2 * 0.3 * 0.40)),  # 0.45 m behind the rear end; 0.05 m is kept
        (-0.34, 0.2, 0.0),
        (-0.34, 0.26, None),  # it passes beside it
        (-0.31, 0.25, None),  # beside the corner, not behind it
    ],
)
def test_what_is_behind_slows_it_down_on_its_way_back(
    x: float, y: float, limit: float | None
) -> None:
    desire = LimiterSweep().decide(seen(around=around((hypot(x, y), atan2(y, x)))))
    assert value(desire, "v_max") is None
    assert value(desire, "back_max") == (None if limit is None else pytest.approx(limit))


@pytest.mark.parametrize(("v", "least"), [(0.0, 0.035), (-0.02, 0.015), (0.03, 0.01), (0.2, 0.01)])
def test_the_creep_is_of_driving_and_turning_together(v: float, least: float) -> None:
    """Backing at 0.018 m/s while it turned, a corner met a person at 0.055 m/s."""
    place = seen(around=around((0.42, CORNER)), twist=Twist2(v))
    desire = LimiterSweep().decide(place)
    assert value(desire, "left_max") == pytest.approx(least / hypot(0.313, 0.2525))


def test_backwards_it_creeps_where_nothing_looks() -> None:
    desire = LimiterSweep().decide(looking_ahead())
    reason = "nothing looks behind: switch the sonars on"
    assert desire == Desire(back_max=0.035, reason=reason)
    assert value(LimiterSweep(creep=0.0).decide(looking_ahead()), "back_max") == 0.0
    assert value(LimiterSweep().decide(looking_ahead((0.34, pi))), "back_max") == 0.0  # remembered
