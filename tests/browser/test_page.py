"""What a person sees and does on the page, checked against the simulated world."""

from collections.abc import Callable
from itertools import product as pairs
from math import hypot

import pytest
from playwright.sync_api import Page, ViewportSize, expect

from tests.browser.drawn import rest
from tests.browser.support import (
    SLACK,
    Product,
    hold,
    hold_by,
    later,
    speed,
    until,
    wait_for_the_robot,
)
from tests.browser.tabs import Tabs


def test_the_page_says_in_capitals_that_it_is_a_simulator(page: Page) -> None:
    assert page.locator("#badge").inner_text() == "SIMULATOR"
    assert "Pioneer 3-AT" in page.content()


def test_the_robot_is_drawn_where_the_simulator_has_it(page: Page, product: Product) -> None:
    body = product.simulation.body
    hold(page, "ArrowUp", lambda: body.robot_in_world.x > body.home.x + 0.3)
    page.keyboard.up("ArrowUp")
    until(lambda: speed(product) == 0.0)
    later(page)
    rest(page)
    truth = body.robot_in_world
    expected = page.evaluate("([x, y]) => window.pioneer3.toScreen(x, y)", [truth.x, truth.y])
    drawn = page.evaluate("window.pioneer3.state.drawn")
    assert hypot(drawn["x"] - expected["x"], drawn["y"] - expected["y"]) < 2  # pixels
    assert drawn["theta"] == pytest.approx(truth.theta, abs=0.01)


def test_a_held_arrow_moves_and_letting_go_stops_within_300_ms(
    page: Page, product: Product
) -> None:
    body = product.simulation.body
    moves: dict[str, Callable[[], bool]] = {
        "ArrowUp": lambda: body.speeds[0] > 0.25,
        "ArrowDown": lambda: body.speeds[0] < -0.25,
        "ArrowLeft": lambda: body.speeds[1] > 0.5,
        "ArrowRight": lambda: body.speeds[1] < -0.5,
    }
    for key, moving in moves.items():
        hold(page, key, moving)
        page.keyboard.up(key)
        took = until(lambda: body.speeds == (0.0, 0.0))
        assert took < 0.3 + SLACK, key


def test_a_pressed_button_drives_until_it_is_let_go(page: Page, product: Product) -> None:
    page.locator("#pad-forward").hover()
    hold_by(page, page.mouse.up, page.mouse.down, lambda: speed(product) > 0.25)
    page.mouse.up()
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK


def test_space_stops_while_an_arrow_is_still_held(page: Page, product: Product) -> None:
    hold(page, "ArrowUp", lambda: speed(product) > 0.25)
    page.keyboard.press("Space")
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK
    later(page)
    assert speed(product) == 0.0


def test_the_big_button_stops_what_somebody_else_drives(page: Page, product: Product) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    hold(second, "ArrowUp", lambda: speed(product) > 0.25)
    page.locator("#stop").click()
    assert until(lambda: speed(product) < 0.05) < 0.3 + SLACK


def test_closing_the_tab_stops_the_robot_within_700_ms(page: Page, product: Product) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    hold(second, "ArrowUp", lambda: speed(product) > 0.25)
    second.close()
    assert until(lambda: speed(product) == 0.0) < 0.7 + SLACK


def test_losing_the_page_stops_the_robot(page: Page, product: Product) -> None:
    for event in ("blur", "pagehide", "pointercancel", "touchcancel"):
        hold(page, "ArrowUp", lambda: speed(product) > 0.25)
        page.evaluate("(name) => window.dispatchEvent(new Event(name))", event)
        assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK, event
        page.keyboard.up("ArrowUp")


def test_a_page_that_freezes_is_outlived_by_half_a_second(page: Page, product: Product) -> None:
    hold(page, "ArrowUp", lambda: speed(product) > 0.25)
    page.evaluate("setTimeout(() => { const t = Date.now(); while (Date.now() - t < 2500); }, 0)")
    assert until(lambda: speed(product) == 0.0) < 1.0 + SLACK


def test_the_emergency_stop_latches_until_it_is_reset(page: Page, product: Product) -> None:
    hold(page, "ArrowUp", lambda: speed(product) > 0.25)
    page.locator("#estop").click()
    until(lambda: not product.simulation.body.drive.powered)
    page.keyboard.up("ArrowUp")
    page.keyboard.down("ArrowUp")
    later(page)
    assert speed(product) == 0.0
    assert "EMERGENCY STOP" in page.locator("#alarm").inner_text()
    page.keyboard.up("ArrowUp")


@pytest.mark.parametrize(
    ("touch", "hint"),
    [
        (False, "Hold an arrow key to drive. Space stops."),
        (True, "Hold the stick to drive; let go to stop."),
    ],
)
def test_the_first_screen_says_how_to_drive_and_warns_of_nothing(
    tabs: Tabs, product: Product, touch: bool, hint: str
) -> None:
    with tabs.open(product.address, touch=touch, mobile=touch) as page:
        wait_for_the_robot(page)
        expect(page.locator("#why")).to_have_text(hint)
        page.evaluate(BOOK)
        assert_only_faults_are_warned_of(page, product, touch)
        link = page.locator("#why a")
        link.click(trial=True)
        assert (link.get_attribute("href") or "").endswith("/book/troubleshooting/emergency-stop/")


BOOK = "document.head.insertAdjacentHTML('beforeend', '<link rel=\"help\" href=\"/book/\">')"
"""Names the book, as the server does where it is built."""


def assert_only_faults_are_warned_of(page: Page, product: Product, touch: bool) -> None:
    """Drive unless by `touch`, and press the robot's stop button."""
    assert "fault" not in (page.locator("#why").get_attribute("class") or "")
    if not touch:
        hold(page, "ArrowUp", lambda: speed(product) > 0.25)
        page.keyboard.up("ArrowUp")
        until(lambda: speed(product) == 0.0)
        expect(page.locator("#why")).to_be_empty()  # known by now
    product.call(lambda: setattr(product.simulation.body, "stop_button", True))
    expect(page.locator("#why")).to_contain_text("stop button")
    expect(page.locator("#why")).to_have_class("why fault")


def test_help_opens_beside_the_map_and_closes(page: Page) -> None:
    ways: list[Callable[[], None]] = [
        lambda: page.get_by_role("button", name="Close this view").click(),
        lambda: page.keyboard.press("Escape"),
        lambda: page.keyboard.press("?"),
        lambda: page.locator("#help-button").click(),
    ]
    sizes: list[ViewportSize] = [
        {"width": 1440, "height": 900},
        {"width": 1024, "height": 768},
        {"width": 390, "height": 844},
        {"width": 844, "height": 390},
    ]
    for size, close in pairs(sizes, ways):
        page.set_viewport_size(size)
        page.locator("#help-button").click()
        expect(page.locator("#view-help")).to_be_visible()
        expect(page.locator("#sheet-title")).to_have_text("Help")
        canvas, sheet = (
            page.locator("#canvas").bounding_box(),
            page.locator("#sheet").bounding_box(),
        )
        assert canvas is not None
        assert sheet is not None
        beside = canvas["x"] + canvas["width"] <= sheet["x"] + 1
        assert beside or canvas["y"] + canvas["height"] <= sheet["y"] + 1
        expect(page.locator("#estop")).to_be_visible()
        close()
        expect(page.locator("#sheet")).to_be_hidden()


def test_loading_the_page_moves_nothing(page: Page, product: Product) -> None:
    later(page)
    assert not product.simulation.body.drive.powered
    assert product.simulation.body.robot_in_world == product.simulation.body.home


def test_the_page_fits_a_phone_380_pixels_wide(tabs: Tabs, product: Product) -> None:
    width, height = 380, 780
    with tabs.open(product.address, size=(width, height), touch=True, mobile=True) as page:
        wait_for_the_robot(page)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        for name in ("#stop", "#estop", "#stick", "#way-keys", "#way-tilt", "#badge"):
            box = page.locator(name).bounding_box()
            assert box is not None
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= width
            assert box["y"] + box["height"] <= height
