"""The keyboard at the page: several keys, layouts, modifiers, repeats, fields to type in."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from tests.browser.conftest import Product
from tests.browser.hands import Visit, visit
from tests.browser.test_page import speed, until


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
    desk.page.wait_for_timeout(200)
    assert desk.drives()[-1] == {"type": "drive", "v": 0.3, "w": 0, "input": "keyboard"}
    keyboard.up("ArrowUp")
    assert held(desk) == {"forward"}
    for key in ("w", "a", "ArrowRight"):
        keyboard.up(key)
    assert held(desk) == set()


@pytest.mark.parametrize(("code", "key"), [("KeyW", "z"), ("KeyW", ","), ("KeyW", "ц")])
def test_keys_count_by_where_they_are_on_any_layout(desk: Visit, code: str, key: str) -> None:
    press(desk, code, key)
    assert held(desk) == {"forward"}
    desk.page.evaluate("(code) => dispatchEvent(new KeyboardEvent('keyup', { code }))", code)
    assert held(desk) == set()


@pytest.mark.parametrize("modifier", ["ctrlKey", "altKey", "metaKey"])
def test_shortcuts_of_the_browser_do_not_drive(desk: Visit, modifier: str) -> None:
    press(desk, "KeyD", "d", **{modifier: True})
    assert held(desk) == set()


def test_a_repeat_is_not_a_press(desk: Visit, product: Product) -> None:
    """The key went down elsewhere, and the page has the focus now."""
    press(desk, "ArrowUp", "ArrowUp", repeat=True)
    desk.page.wait_for_timeout(300)
    assert held(desk) == set()
    assert speed(product) == 0.0


def test_repeats_of_a_held_key_after_a_stop_do_not_drive(desk: Visit, product: Product) -> None:
    desk.page.keyboard.down("ArrowUp")
    until(lambda: speed(product) > 0.25)
    desk.page.keyboard.press("Space")
    for _ in range(10):
        press(desk, "ArrowUp", "ArrowUp", repeat=True)
        desk.page.wait_for_timeout(30)
    until(lambda: speed(product) == 0.0)
    desk.page.wait_for_timeout(300)
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
    assert 8 <= desk.rate() <= 20  # 15 where the machine is not busy
    before = len(desk.drives())
    desk.page.keyboard.up("ArrowUp")
    desk.page.wait_for_timeout(800)
    after = desk.drives()[before:]
    assert after[-3:] == [{"type": "drive", "v": 0, "w": 0, "input": "keyboard"}] * 3
    assert len(after) <= 4  # one more may have been on its way
