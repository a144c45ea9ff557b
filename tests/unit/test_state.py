"""Snapshots: what they derive from what they hold."""

from dataclasses import FrozenInstanceError
from math import inf, nan

import pytest

from pioneer3.state import Battery, Motors, Sonar


def test_the_nearest_echo_ignores_what_was_not_read() -> None:
    assert Sonar(ranges=(nan, 2.0, inf, 0.7)).nearest == 0.7
    assert Sonar(ranges=(nan, inf)).nearest == inf
    assert Sonar().nearest == inf


@pytest.mark.parametrize("left", [False, True])
@pytest.mark.parametrize("right", [False, True])
def test_one_blocked_side_is_a_stall(left: bool, right: bool) -> None:
    assert Motors(left_stalled=left, right_stalled=right).stalled == (left or right)


def test_nobody_can_change_a_snapshot() -> None:
    with pytest.raises(FrozenInstanceError):
        Battery(voltage=12.0).voltage = 13.0  # type: ignore[misc]
