"""A phone that is turned."""

import pytest

from pioneer3.teleop.keyboard import FLICK_RATE, Key, key_of_rotation


@pytest.mark.parametrize(
    ("turns", "key"),
    [
        ((3.1, 0.0, 0.0), Key.FORWARD),
        ((-3.1, 0.0, 0.0), Key.BACK),
        ((0.0, 0.0, 3.1), Key.LEFT),
        ((0.0, 0.0, -3.1), Key.RIGHT),
        ((0.0, 3.1, 0.0), Key.STOP),
        ((0.0, -3.1, 0.0), Key.STOP),
        ((FLICK_RATE, -FLICK_RATE, FLICK_RATE), None),
        ((float("nan"), 0.0, 0.0), None),
    ],
)
def test_a_flick_is_a_key(turns: tuple[float, float, float], key: Key | None) -> None:
    assert key_of_rotation(*turns) is key
