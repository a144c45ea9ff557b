"""The lab's rule: v = (d - 0.3) / 1.2 from -0.3 to 0.5 m/s, w = bearing / 1.2, 40 deg / 1.2 s."""

from dataclasses import replace
from math import inf, nan, radians

import pytest

from pioneer3.behaviors.action import Desire
from pioneer3.behaviors.actions.follow import FollowLab
from pioneer3.state import Sonar
from tests.unit.behaviors.support import P3AT, seen, value


def decided(ranges: dict[int, float], *, keep: float = 0.3) -> Desire | None:
    """Return the decision when these transducers hear so much, the others nothing."""
    sonar = Sonar(ranges=tuple(ranges.get(i, inf) for i in range(16)), enabled=True)
    place = seen()
    return FollowLab(keep=keep).decide(
        replace(place, snapshot=replace(place.snapshot, sonar=sonar))
    )


@pytest.mark.parametrize(
    ("distance", "speed"),
    [
        (0.3, 0.0),
        (0.6, 0.25),  # 0.3 / 1.2
        (0.9, 0.5),  # 0.6 / 1.2
        (1.0, 0.5),  # 0.7 / 1.2 = 0.58, bounded
        (0.18, -0.1),  # -0.12 / 1.2
        (0.0, -0.25),  # -0.3 / 1.2
    ],
)
def test_the_speed_is_the_difference_over_1_2_s(distance: float, speed: float) -> None:
    desire = decided({3: distance})
    assert value(desire, "v") == pytest.approx(speed)
    assert value(desire, "w") == 0.0


def test_backwards_it_is_bounded_to_0_3() -> None:
    # (0.1 - 0.7) / 1.2 = -0.5
    assert value(decided({4: 0.1}, keep=0.7), "v") == -0.3


@pytest.mark.parametrize(("number", "sign"), [(1, 1), (2, 1), (3, 0), (4, 0), (5, -1), (6, -1)])
def test_it_turns_to_the_side_that_the_transducer_looks_at(number: int, sign: int) -> None:
    # 40 degrees / 1.2 s = 33.3 degrees/s; left is positive
    assert value(decided({number: 0.5}), "w") == pytest.approx(sign * radians(40) / 1.2)
    assert sign == 0 or P3AT.sonars[number].theta * sign > 0


def test_the_nearest_counts() -> None:
    assert value(decided({1: 0.8, 3: 0.9, 5: 0.6}), "w") == pytest.approx(-radians(40) / 1.2)


@pytest.mark.parametrize("ranges", [{}, {3: 1.01}, {0: 0.5, 7: 0.5}, {3: nan}, {9: 0.4}])
def test_it_stands_still_when_nothing_is_near_in_front(ranges: dict[int, float]) -> None:
    desire = decided(ranges)
    assert desire is not None
    assert (value(desire, "v"), value(desire, "w")) == (0.0, 0.0)
    assert desire.reason == "looks for somebody"


def test_a_robot_without_sonars_stands_still() -> None:
    assert value(FollowLab().decide(seen()), "v") == 0.0
