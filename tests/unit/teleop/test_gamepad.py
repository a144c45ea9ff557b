"""What a gamepad asks for."""

from math import nan

import pytest

from pioneer3.geometry import STILL
from pioneer3.teleop.gamepad import SCHEME, Gamepad, response


def pushed(x: float, y: float) -> Gamepad:
    """Return a gamepad whose left stick is there: x to the right, y down."""
    gamepad = Gamepad()
    gamepad.axis(SCHEME.turn_axis, x)
    gamepad.axis(SCHEME.forward_axis, y)
    return gamepad


def test_the_scheme_is_clearpaths() -> None:
    assert (SCHEME.deadman, SCHEME.turbo, SCHEME.dead_zone) == (4, 5, 0.1)
    assert (SCHEME.speed, SCHEME.turbo_speed) == (0.4, 1.0)
    assert (SCHEME.turn_rate, SCHEME.turbo_turn_rate) == (0.6, 1.2)


def test_no_two_buttons_are_the_same() -> None:
    buttons = [SCHEME.deadman, SCHEME.turbo, SCHEME.stop, SCHEME.emergency_stop, SCHEME.reset]
    assert len(set(buttons)) == len(buttons)


def test_nothing_is_asked_for_without_the_deadman() -> None:
    gamepad = pushed(-1.0, -1.0)
    gamepad.button(SCHEME.turbo, pressed=True)
    assert gamepad.wanted == STILL


def test_the_stick_drives_while_the_deadman_is_held() -> None:
    gamepad = pushed(-1.0, -1.0)
    gamepad.button(SCHEME.deadman, pressed=True)
    assert (gamepad.wanted.v, gamepad.wanted.w) == (0.4, 0.6)
    gamepad.button(SCHEME.turbo, pressed=True)
    assert (gamepad.wanted.v, gamepad.wanted.w) == (1.0, 1.2)
    gamepad.button(SCHEME.turbo, pressed=False)
    gamepad.axis(SCHEME.forward_axis, 0.55)
    assert gamepad.wanted.v == pytest.approx(-0.2)
    gamepad.button(SCHEME.deadman, pressed=False)
    assert gamepad.wanted == STILL


def test_after_letting_go_only_a_fresh_press_counts() -> None:
    gamepad = pushed(0.0, -1.0)
    gamepad.button(SCHEME.deadman, pressed=True)
    gamepad.let_go()
    gamepad.button(SCHEME.deadman, pressed=True)  # told again, but never let go
    assert gamepad.wanted == STILL
    gamepad.button(SCHEME.deadman, pressed=False)
    gamepad.button(SCHEME.deadman, pressed=True)
    assert gamepad.wanted.v == 0.4


def test_turbo_keeps_its_ratio_to_other_speeds() -> None:
    slow = SCHEME.at(0.2, None)
    assert (slow.speed, slow.turbo_speed) == pytest.approx((0.2, 0.5))
    assert (slow.turn_rate, slow.turbo_turn_rate) == (0.6, 1.2)
    assert SCHEME.at(None, 0.3).turbo_turn_rate == pytest.approx(0.6)


@pytest.mark.parametrize(
    ("value", "out"),
    [(0.1, 0.0), (-0.1, 0.0), (0.55, 0.5), (-0.55, -0.5), (1.0, 1.0), (7.0, 1.0), (nan, 0.0)],
)
def test_the_response_is_in_proportion_beyond_the_dead_zone(value: float, out: float) -> None:
    assert response(value, 0.1) == pytest.approx(out)
