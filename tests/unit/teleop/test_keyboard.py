"""From key presses to a velocity."""

from math import inf, nan, nextafter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pioneer3.errors import ConfigError
from pioneer3.geometry import STILL, Twist2
from pioneer3.teleop.keyboard import HOLD, PATIENCE, STEP, Key, Keyboard

MOVING = {
    Key.FORWARD: Twist2(0.5, 0.0),
    Key.BACK: Twist2(-0.5, 0.0),
    Key.LEFT: Twist2(0.0, 0.4),
    Key.RIGHT: Twist2(0.0, -0.4),
}
OTHERS = [key for key in Key if key not in MOVING and key is not Key.STOP]
SPEEDS = st.floats(0.01, 2.0)
PRESSES = st.lists(st.tuples(st.sampled_from(list(Key)), st.floats(0.0, 1.0)), max_size=30)


def board(*, latch: bool = False) -> Keyboard:
    return Keyboard(speed=0.5, turn_rate=0.4, latch=latch)


def test_an_untouched_keyboard_wants_nothing() -> None:
    assert board().wanted(0.0) == (STILL, 0.0)


@pytest.mark.parametrize(("key", "twist"), [*MOVING.items()])
def test_a_moving_key_acts_for_exactly_its_hold(key: Key, twist: Twist2) -> None:
    keyboard = board()
    keyboard.press(key, 10.0)
    assert keyboard.wanted(10.0)[0] == twist
    assert keyboard.wanted(10.0)[1] == pytest.approx(HOLD)
    assert keyboard.wanted(nextafter(10.0 + HOLD, 0))[0] == twist
    assert keyboard.wanted(10.0 + HOLD) == (STILL, 0.0)


def test_a_repeat_extends_the_key() -> None:
    keyboard = board()
    keyboard.press(Key.FORWARD, 0.0)
    keyboard.press(Key.FORWARD, 0.5)
    assert keyboard.wanted(0.5 + HOLD - 1e-9)[0] == MOVING[Key.FORWARD]
    assert keyboard.wanted(0.5 + HOLD)[0] == STILL


def test_two_keys_drive_a_curve_until_the_first_of_them_ends() -> None:
    keyboard = board()
    keyboard.press(Key.FORWARD, 0.0)
    keyboard.press(Key.LEFT, 0.25)
    assert keyboard.wanted(0.25)[0] == Twist2(0.5, 0.4)
    assert keyboard.wanted(0.25)[1] == pytest.approx(HOLD - 0.25)
    assert keyboard.wanted(HOLD)[0] == Twist2(0.0, 0.4)
    assert keyboard.wanted(HOLD)[1] == pytest.approx(0.25)


@pytest.mark.parametrize(
    ("first", "second"), [(Key.FORWARD, Key.BACK), (Key.LEFT, Key.RIGHT), (Key.RIGHT, Key.LEFT)]
)
def test_the_opposite_key_takes_over_at_once(first: Key, second: Key) -> None:
    keyboard = board()
    keyboard.press(first, 0.0)
    keyboard.press(second, 0.1)
    assert keyboard.wanted(0.1)[0] == MOVING[second]


@pytest.mark.parametrize("latch", [False, True])
def test_stop_ends_both_axes(*, latch: bool) -> None:
    keyboard = board(latch=latch)
    keyboard.press(Key.FORWARD, 0.0)
    keyboard.press(Key.LEFT, 0.0)
    keyboard.press(Key.STOP, 0.1)
    assert keyboard.wanted(0.1) == (STILL, 0.0)


@pytest.mark.parametrize("key", OTHERS)
def test_keys_that_are_not_about_moving_move_nothing(key: Key) -> None:
    keyboard = board()
    keyboard.press(key, 0.0)
    assert keyboard.wanted(0.0) == (STILL, 0.0)


def test_faster_and_slower_are_a_tenth_and_undo_each_other() -> None:
    keyboard = board()
    keyboard.press(Key.FASTER, 0.0)
    assert (keyboard.speed, keyboard.turn_rate) == pytest.approx((0.5 * STEP, 0.4 * STEP))
    keyboard.press(Key.SLOWER, 0.0)
    assert (keyboard.speed, keyboard.turn_rate) == pytest.approx((0.5, 0.4))


def test_a_held_key_follows_a_change_of_speed() -> None:
    keyboard = board()
    keyboard.press(Key.FORWARD, 0.0)
    keyboard.press(Key.FASTER, 0.1)
    assert keyboard.wanted(0.1)[0] == Twist2(0.5 * STEP, 0.0)


def test_faster_ends_at_the_limits() -> None:
    keyboard = Keyboard(speed=0.5, turn_rate=0.4, max_speed=0.7, max_turn_rate=0.41)
    for _ in range(20):
        keyboard.press(Key.FASTER, 0.0)
    assert (keyboard.speed, keyboard.turn_rate) == (0.7, 0.41)


@pytest.mark.parametrize("patience", [PATIENCE, 2.5])
@pytest.mark.parametrize(("key", "twist"), [*MOVING.items()])
def test_a_latched_key_ends_when_no_other_comes(key: Key, twist: Twist2, patience: float) -> None:
    keyboard = Keyboard(speed=0.5, turn_rate=0.4, latch=True, patience=patience)
    keyboard.press(key, 100.0)
    assert keyboard.wanted(100.0) == (twist, patience)
    assert keyboard.wanted(nextafter(100.0 + patience, 0))[0] == twist
    assert not keyboard.has_run_out(nextafter(100.0 + patience, 0))
    assert keyboard.wanted(100.0 + patience) == (STILL, 0.0)
    assert keyboard.has_run_out(100.0 + patience)


@pytest.mark.parametrize("key", OTHERS)
def test_any_key_shows_that_hands_are_near_but_brings_back_nothing(key: Key) -> None:
    keyboard = board(latch=True)
    keyboard.press(Key.FORWARD, 0.0)
    keyboard.press(key, 9.0)
    assert keyboard.wanted(9.0)[1] == PATIENCE
    keyboard.press(key, 9.0 + PATIENCE)
    assert keyboard.wanted(9.0 + PATIENCE) == (STILL, 0.0)


@pytest.mark.parametrize("patience", [0.0, -1.0, nextafter(PATIENCE, inf), inf, nan])
def test_patience_can_be_made_shorter_only(patience: float) -> None:
    with pytest.raises(ConfigError, match="at most 10 s"):
        Keyboard(latch=True, patience=patience)


@given(PRESSES)
def test_nothing_latched_outlives_the_last_key_by_more_than_its_patience(
    presses: list[tuple[Key, float]],
) -> None:
    keyboard, now = board(latch=True), 0.0
    for key, pause in presses:
        now += pause
        keyboard.press(key, now)
    assert keyboard.wanted(now)[1] <= PATIENCE + 1e-9
    assert keyboard.wanted(now + PATIENCE) == (STILL, 0.0)


@pytest.mark.parametrize("first", [*MOVING])
@pytest.mark.parametrize("second", [*MOVING])
def test_a_latched_key_replaces_the_one_before(first: Key, second: Key) -> None:
    keyboard = board(latch=True)
    keyboard.press(first, 0.0)
    keyboard.press(second, 1.0)
    assert keyboard.wanted(1.0)[0] == MOVING[second]


@given(SPEEDS, SPEEDS, st.booleans(), PRESSES)
def test_nothing_wanted_ever_exceeds_the_speeds(
    speed: float,
    turn_rate: float,
    latch: bool,
    presses: list[tuple[Key, float]],
) -> None:
    keyboard = Keyboard(
        speed=speed, turn_rate=turn_rate, latch=latch, max_speed=2.0, max_turn_rate=2.0
    )
    now = 0.0
    for key, pause in presses:
        now += pause
        keyboard.press(key, now)
        twist, seconds = keyboard.wanted(now)
        assert abs(twist.v) <= keyboard.speed <= 2.0
        assert abs(twist.w) <= keyboard.turn_rate <= 2.0
        assert seconds >= 0.0
        assert twist.is_zero == (seconds == 0.0)


@given(PRESSES)
def test_without_latch_nothing_outlives_the_last_press_by_more_than_its_hold(
    presses: list[tuple[Key, float]],
) -> None:
    keyboard, now = board(), 0.0
    for key, pause in presses:
        now += pause
        keyboard.press(key, now)
    assert keyboard.wanted(now)[1] <= HOLD + 1e-9
    assert keyboard.wanted(now + HOLD) == (STILL, 0.0)


@given(PRESSES, st.floats(0.0, 1.0))
def test_the_twist_holds_for_as_long_as_promised(
    presses: list[tuple[Key, float]], share: float
) -> None:
    keyboard, now = board(), 0.0
    for key, pause in presses:
        now += pause
        keyboard.press(key, now)
    twist, seconds = keyboard.wanted(now)
    if seconds > 1e-6:
        assert keyboard.wanted(now + share * (seconds - 1e-6))[0] == twist
        assert keyboard.wanted(now + seconds + 1e-6)[0] != twist
