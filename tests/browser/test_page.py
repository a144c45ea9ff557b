"""What a person sees and does on the page, checked against the simulated world."""

import time
from collections.abc import Callable
from math import hypot

import pytest
from playwright.sync_api import Browser, Page, ViewportSize, expect

from tests.browser.conftest import Product, wait_for_the_robot

SLACK = 0.25
"""A shared machine may lose this much [s] on top of a limit."""


def speed(product: Product) -> float:
    """Return how fast the simulated robot really moves [m/s]."""
    return abs(product.simulation.body.drive.linear.velocity)


def until(condition: Callable[[], bool], patience: float = 10.0) -> float:
    """Wait for `condition`; return how long that took [s]."""
    began = time.monotonic()
    while not condition():
        assert time.monotonic() - began < patience
        time.sleep(0.005)
    return time.monotonic() - began


def test_the_page_says_in_capitals_that_it_is_a_simulator(page: Page) -> None:
    assert page.locator("#badge").inner_text() == "SIMULATOR"
    assert "Pioneer 3-AT" in page.content()


def test_the_robot_is_drawn_where_the_simulator_has_it(page: Page, product: Product) -> None:
    page.keyboard.down("ArrowUp")
    page.wait_for_timeout(1500)
    page.keyboard.up("ArrowUp")
    until(lambda: speed(product) == 0.0)
    page.wait_for_timeout(400)
    truth = product.simulation.body.robot_in_world
    expected = page.evaluate("([x, y]) => window.pioneer3.toScreen(x, y)", [truth.x, truth.y])
    drawn = page.evaluate("window.pioneer3.state.drawn")
    assert truth.x > product.simulation.body.home.x + 0.2
    assert hypot(drawn["x"] - expected["x"], drawn["y"] - expected["y"]) < 2  # pixels
    assert drawn["theta"] == pytest.approx(truth.theta, abs=0.01)


@pytest.mark.parametrize(
    ("key", "sign_v", "sign_w"),
    [("ArrowUp", 1, 0), ("ArrowDown", -1, 0), ("ArrowLeft", 0, 1), ("ArrowRight", 0, -1)],
)
def test_a_held_arrow_moves_and_letting_go_stops_within_300_ms(
    page: Page, product: Product, key: str, sign_v: int, sign_w: int
) -> None:
    drive = product.simulation.body.drive
    page.keyboard.down(key)
    until(lambda: drive.linear.velocity * sign_v > 0.25 or drive.angular.velocity * sign_w > 0.5)
    page.keyboard.up(key)
    took = until(lambda: drive.linear.velocity == drive.angular.velocity == 0.0)
    assert took < 0.3 + SLACK


def test_a_pressed_button_drives_until_it_is_let_go(page: Page, product: Product) -> None:
    page.locator("#pad-forward").hover()
    page.mouse.down()
    until(lambda: speed(product) > 0.25)
    page.mouse.up()
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK


def test_space_stops_while_an_arrow_is_still_held(page: Page, product: Product) -> None:
    page.keyboard.down("ArrowUp")
    until(lambda: speed(product) > 0.25)
    page.keyboard.press("Space")
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK
    page.wait_for_timeout(700)
    assert speed(product) == 0.0


def test_the_big_button_stops_what_somebody_else_drives(page: Page, product: Product) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    second.keyboard.down("ArrowUp")
    until(lambda: speed(product) > 0.25)
    page.locator("#stop").click()
    assert until(lambda: speed(product) < 0.05) < 0.3 + SLACK


def test_closing_the_tab_stops_the_robot_within_700_ms(page: Page, product: Product) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    second.keyboard.down("ArrowUp")
    until(lambda: speed(product) > 0.25)
    second.close()
    assert until(lambda: speed(product) == 0.0) < 0.7 + SLACK


@pytest.mark.parametrize("event", ["blur", "pagehide", "pointercancel", "touchcancel"])
def test_losing_the_page_stops_the_robot(page: Page, product: Product, event: str) -> None:
    page.keyboard.down("ArrowUp")
    until(lambda: speed(product) > 0.25)
    page.evaluate("(name) => window.dispatchEvent(new Event(name))", event)
    assert until(lambda: speed(product) == 0.0) < 0.3 + SLACK


def test_a_page_that_freezes_is_outlived_by_half_a_second(page: Page, product: Product) -> None:
    page.keyboard.down("ArrowUp")
    until(lambda: speed(product) > 0.25)
    page.evaluate("setTimeout(() => { const t = Date.now(); while (Date.now() - t < 2500); }, 0)")
    assert until(lambda: speed(product) == 0.0) < 1.0 + SLACK


def test_the_emergency_stop_latches_until_it_is_reset(page: Page, product: Product) -> None:
    page.keyboard.down("ArrowUp")
    until(lambda: speed(product) > 0.25)
    page.locator("#estop").click()
    until(lambda: not product.simulation.body.drive.powered)
    page.keyboard.up("ArrowUp")
    page.keyboard.down("ArrowUp")
    page.wait_for_timeout(500)
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
    browser: Browser, product: Product, touch: bool, hint: str
) -> None:
    context = browser.new_context(has_touch=touch, is_mobile=touch)
    page = context.new_page()
    page.goto(product.address)
    wait_for_the_robot(page)
    expect(page.locator("#why")).to_have_text(hint)
    assert "fault" not in (page.locator("#why").get_attribute("class") or "")
    if not touch:
        page.keyboard.down("ArrowUp")
        until(lambda: speed(product) > 0.25)
        page.keyboard.up("ArrowUp")
        until(lambda: speed(product) == 0.0)
        expect(page.locator("#why")).to_be_empty()  # known by now
    product.call(lambda: setattr(product.simulation.body, "stop_button", True))
    expect(page.locator("#why")).to_contain_text("stop button")
    expect(page.locator("#why")).to_have_class("why fault")
    context.close()


@pytest.mark.parametrize("size", [(1440, 900), (1024, 768), (390, 844), (844, 390)])
def test_help_opens_beside_the_map_and_closes(page: Page, size: tuple[int, int]) -> None:
    page.set_viewport_size({"width": size[0], "height": size[1]})
    ways: list[Callable[[], None]] = [
        lambda: page.get_by_role("button", name="Close this view").click(),
        lambda: page.keyboard.press("Escape"),
        lambda: page.keyboard.press("?"),
        lambda: page.locator("#help-button").click(),
    ]
    for close in ways:
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
    page.wait_for_timeout(500)
    assert not product.simulation.body.drive.powered
    assert product.simulation.body.robot_in_world == product.simulation.body.home


def test_the_page_fits_a_phone_380_pixels_wide(browser: Browser, product: Product) -> None:
    phone: ViewportSize = {"width": 380, "height": 780}
    context = browser.new_context(viewport=phone, has_touch=True, is_mobile=True)
    page = context.new_page()
    page.goto(product.address)
    wait_for_the_robot(page)
    assert page.evaluate("document.documentElement.scrollWidth") <= phone["width"]
    for name in ("#stop", "#estop", "#stick", "#way-keys", "#way-tilt", "#badge"):
        box = page.locator(name).bounding_box()
        assert box is not None
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= phone["width"]
        assert box["y"] + box["height"] <= phone["height"]
    context.close()
