"""The keyboard at the page: several keys, layouts, modifiers, repeats, fields to type in."""

from tests.browser.bench import Bench

PERIOD = 66
"""Between two requests while a key is held [ms]."""
AHEAD = {"type": "drive", "v": 0.3, "w": 0, "input": "keyboard"}
ZERO = {"type": "drive", "v": 0, "w": 0, "input": "keyboard"}


def press(bench: Bench, code: str, key: str, **more: bool) -> None:
    """Tell of a key as a layout of its own would."""
    bench.page.evaluate(
        "(init) => dispatchEvent(new KeyboardEvent('keydown', { cancelable: true, ...init }))",
        {"code": code, "key": key, **more},
    )


def test_several_keys_make_a_curve_and_opposites_cancel(desk_bench: Bench) -> None:
    keyboard = desk_bench.page.keyboard
    keyboard.down("ArrowUp")
    keyboard.down("a")
    assert desk_bench.held == {"forward", "left"}
    keyboard.down("ArrowRight")
    assert desk_bench.held == {"forward"}
    keyboard.down("w")  # twice ahead is not twice as fast
    desk_bench.wait(PERIOD)
    assert desk_bench.sent[-1] == AHEAD
    keyboard.up("ArrowUp")
    assert desk_bench.held == {"forward"}
    for key in ("w", "a", "ArrowRight"):
        keyboard.up(key)
    assert desk_bench.held == set()


def test_keys_count_by_where_they_are_on_any_layout(desk_bench: Bench) -> None:
    for key in ("z", ",", "ц"):
        press(desk_bench, "KeyW", key)
        assert desk_bench.held == {"forward"}
        desk_bench.page.evaluate("dispatchEvent(new KeyboardEvent('keyup', { code: 'KeyW' }))")
        assert desk_bench.held == set()


def test_shortcuts_of_the_browser_do_not_drive(desk_bench: Bench) -> None:
    for modifier in ("ctrlKey", "altKey", "metaKey"):
        press(desk_bench, "KeyD", "d", **{modifier: True})
        assert desk_bench.held == set()


def test_a_repeat_is_not_a_press(desk_bench: Bench) -> None:
    """The key went down elsewhere, and the page has the focus now."""
    press(desk_bench, "ArrowUp", "ArrowUp", repeat=True)
    desk_bench.wait(300)
    assert desk_bench.held == set()
    assert desk_bench.sent == []


def test_repeats_of_a_held_key_after_a_stop_do_not_drive(desk_bench: Bench) -> None:
    desk_bench.page.keyboard.down("ArrowUp")
    desk_bench.wait(PERIOD)
    desk_bench.page.keyboard.press("Space")
    for _ in range(10):
        press(desk_bench, "ArrowUp", "ArrowUp", repeat=True)
    desk_bench.wait(300)
    assert desk_bench.held == set()
    assert desk_bench.sent[-1] == {"type": "stop", "robot": 1}


def test_typing_does_not_drive(desk_bench: Bench) -> None:
    page = desk_bench.page
    page.evaluate("document.getElementById('speed').focus()")
    page.keyboard.press("ArrowRight")
    assert desk_bench.held == set()
    assert page.evaluate("document.getElementById('speed').valueAsNumber") > 0.3
    assert desk_bench.sent == []


def test_a_held_key_sends_15_times_a_second_and_three_zeros_at_the_end(desk_bench: Bench) -> None:
    desk_bench.page.keyboard.down("ArrowUp")
    assert desk_bench.sent == [ZERO, AHEAD]  # at once; the zero marks it as fresh
    desk_bench.wait(15 * PERIOD)
    assert desk_bench.sent == [ZERO, *[AHEAD] * 16]
    desk_bench.page.keyboard.up("ArrowUp")
    desk_bench.wait(1000)
    assert desk_bench.sent == [ZERO, *[AHEAD] * 16, *[ZERO] * 3]
