"""The keyboard at the page: several keys, layouts, modifiers, repeats, fields to type in."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from tests.browser.support import Product, hold, later, speed, until
from tests.browser.visit import Visit, visit


@pytest.fixture
def desk(browser: Browser, product: Product) -> Iterator[Visit]:
    """Sit at a keyboard."""
    with visit(browser, product.address) as desk:
        yield desk


def held(desk: Visit) -> set[str]:
    """Return the directions that the page holds."""
    return set(desk.page.evaluate("window.pioneer3.state.held"))


def press(desk: Visit, code: str, key: str, **more: bool) -> None:
    """Tell of a key as a layout of its own would."""
    desk.page.evaluate(
        "(init) => dispatchEvent(new KeyboardEvent('keydown', { cancelable: true, ...init }))",
        {"code": code, "key": key, **more},
    )


def test_several_keys_make_a_curve_and_opposites_cancel(desk: Visit) -> None:
    keyboard = desk.page.keyboard
    keyboard.down("ArrowUp")
    keyboard.down("a")
    assert held(desk) == {"forward", "left"}
    keyboard.down("ArrowRight")
    assert held(desk) == {"forward"}
    keyboard.down("w")  # twice ahead is not twice as fast
    ahead = {"type": "drive", "v": 0.3, "w": 0, "input": "keyboard"}
    until(lambda: desk.drives()[-1] == ahead)
    keyboard.up("ArrowUp")
    assert held(desk) == {"forward"}
    for key in ("w", "a", "ArrowRight"):
        keyboard.up(key)
    assert held(desk) == set()


def test_keys_count_by_where_they_are_on_any_layout(desk: Visit) -> None:
    for key in ("z", ",", "ц"):
        press(desk, "KeyW", key)
        assert held(desk) == {"forward"}
        desk.page.evaluate("dispatchEvent(new KeyboardEvent('keyup', { code: 'KeyW' }))")
        assert held(desk) == set()


def test_shortcuts_of_the_browser_do_not_drive(desk: Visit) -> None:
    for modifier in ("ctrlKey", "altKey", "metaKey"):
        press(desk, "KeyD", "d", **{modifier: True})
        assert held(desk) == set()


def test_a_repeat_is_not_a_press(desk: Visit, product: Product) -> None:
    """The key went down elsewhere, and the page has the focus now."""
    press(desk, "ArrowUp", "ArrowUp", repeat=True)
    later(desk.page, 3)
    assert held(desk) == set()
    assert speed(product) == 0.0


def test_repeats_of_a_held_key_after_a_stop_do_not_drive(desk: Visit, product: Product) -> None:
    hold(desk.page, "ArrowUp", lambda: speed(product) > 0.25)
    desk.page.keyboard.press("Space")
    for _ in range(10):
        press(desk, "ArrowUp", "ArrowUp", repeat=True)
    until(lambda: speed(product) == 0.0)
    later(desk.page, 3)
    assert held(desk) == set()
    assert speed(product) == 0.0


def test_typing_does_not_drive(desk: Visit, product: Product) -> None:
    desk.page.evaluate("document.getElementById('speed').focus()")
    desk.page.keyboard.press("ArrowRight")
    assert held(desk) == set()
    assert desk.page.evaluate("document.getElementById('speed').valueAsNumber") > 0.3
    assert speed(product) == 0.0


def test_letting_go_sends_three_zeros_and_then_nothing(desk: Visit) -> None:
    desk.page.keyboard.down("ArrowUp")
    until(lambda: 8 <= desk.rate() <= 20)  # 15 where the machine is not busy
    before = len(desk.drives())
    desk.page.keyboard.up("ArrowUp")
    desk.sends_zeros("keyboard")
    later(desk.page)
    after = desk.drives()[before:]
    zeros = [m for m in after if m == {"type": "drive", "v": 0, "w": 0, "input": "keyboard"}]
    assert after[-3:] == zeros
    assert len(zeros) == 3
