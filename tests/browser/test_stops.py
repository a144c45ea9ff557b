"""STOP and E-STOP: by key, by button, by viewers, without a connection."""

from playwright.sync_api import Page, ViewportSize, expect

from pioneer3.web.access.sessions import Role
from pioneer3.web.client import Client
from tests.browser.sharing import needs_network, two
from tests.browser.support import SLACK, Product, later, speed, until
from tests.browser.tabs import Tabs
from tests.browser.views import drive, open_view, stopped_after

BAR = 0.7 + SLACK
SIZES: dict[str, ViewportSize] = {
    "desktop": {"width": 1440, "height": 900},
    "low desktop": {"width": 1280, "height": 720},
    "tablet": {"width": 820, "height": 1180},
    "phone": {"width": 390, "height": 844},
    "small phone": {"width": 320, "height": 568},
    "phone on its side": {"width": 844, "height": 390},
}


def latched(product: Product) -> bool:
    """Return whether the robot's emergency stop is."""
    return product.robot.supervisor.pilot.emergency


def hang_up(product: Product) -> None:
    """Close every page's connection, as a network does."""
    for client in product.web.clients.connected.values():
        assert isinstance(client, Client)
        client._hang_up(1013, "the network is gone")


def test_k_is_the_emergency_stop(page: Page, product: Product) -> None:
    drive(page, product)
    assert stopped_after(product, lambda: page.keyboard.press("k")) < BAR
    assert latched(product)
    expect(page.locator("#latched-words")).to_contain_text("EMERGENCY STOP")
    expect(page.locator("#latched-how")).to_contain_text("reset it")
    expect(page.locator("#estop")).to_have_attribute("aria-pressed", "true")
    page.keyboard.up("ArrowUp")
    page.locator("#reset").click()
    expect(page.locator("#alarm")).to_be_hidden()
    assert not latched(product)
    later(page, 3)
    assert not product.simulation.body.drive.powered  # the motors stay off
    drive(page, product)
    page.keyboard.up("ArrowUp")


ANYWHERE = ["#goto-x", "#mode-time", "#wander-start", "#speed", "#sheet-body", "#estop"]


def test_k_is_the_emergency_stop_wherever_the_focus_is(page: Page, product: Product) -> None:
    open_view(page, "modes")
    for focus in ANYWHERE:
        page.locator(focus).focus()
        page.keyboard.press("k")
        until(lambda: latched(product))
        assert product.robot.arbiter.mode is None
        page.locator("#reset").click()
        until(lambda: not latched(product))


def test_space_stops_wherever_the_focus_is_and_presses_no_button(
    page: Page, product: Product
) -> None:
    open_view(page, "modes")
    for focus in ANYWHERE:
        page.locator("#sheet-close").focus()
        drive(page, product)
        page.locator(focus).focus()
        assert stopped_after(product, lambda: page.keyboard.press("Space")) < BAR, focus
        later(page, 3)
        assert speed(product) == 0.0  # the arrow is still held
        assert product.robot.arbiter.mode is None
        assert not latched(product)
        page.keyboard.up("ArrowUp")


def test_the_keys_that_stop_are_letters_where_texts_are_written(
    page: Page, product: Product
) -> None:
    page.evaluate("document.body.append(Object.assign(document.createElement('input'),{id:'t'}))")
    page.locator("#t").focus()
    page.keyboard.type("a k")
    assert page.locator("#t").input_value() == "a k"
    later(page, 2)
    assert not latched(product)


def test_shortcuts_of_the_browser_are_no_emergency_stop(page: Page, product: Product) -> None:
    for modifier in ("Control", "Alt", "Meta"):
        page.keyboard.press(f"{modifier}+k")
    later(page, 2)
    assert not latched(product)


def test_a_held_k_stops_once_and_does_not_latch_again(page: Page, product: Product) -> None:
    page.keyboard.down("k")
    until(lambda: latched(product))
    page.locator("#reset").click()
    until(lambda: not latched(product))
    page.keyboard.down("k")  # a repeat of the key that is held
    later(page, 3)
    assert not latched(product)
    page.keyboard.up("k")


def test_space_ends_motion_and_mode_and_latches_nothing(page: Page, product: Product) -> None:
    open_view(page, "modes")
    page.locator("#wander-start").click()
    until(lambda: speed(product) > 0.1)
    page.keyboard.press("Space")
    until(lambda: speed(product) == 0.0)
    assert not latched(product)
    expect(page.locator("#view-modes .mode-state")).to_contain_text("stopped the robot")


def test_the_emergency_stop_acts_when_it_is_pressed_not_when_it_is_let_go(
    page: Page, product: Product
) -> None:
    page.locator("#estop").hover()
    page.mouse.down()
    until(lambda: latched(product))
    page.mouse.up()


def test_enter_presses_the_emergency_stop(page: Page, product: Product) -> None:
    page.locator("#estop").focus()
    page.keyboard.press("Enter")
    until(lambda: latched(product))


@needs_network
def test_a_viewer_stops_everything_and_cannot_reset(tabs: Tabs, shared: Product) -> None:
    with two(tabs, shared, Role.VIEWER, "Vera") as (ann, vera):
        drive(ann, shared)
        assert stopped_after(shared, lambda: vera.keyboard.press("k")) < BAR
        expect(vera.locator("#latched-how")).to_have_text("A driver can reset it.")
        expect(vera.locator("#reset")).to_be_hidden()
        expect(ann.locator("#alarm [role=alert]")).to_contain_text("EMERGENCY STOP")
        ann.locator("#reset").click()
        for page in (ann, vera):
            expect(page.locator("#alarm")).to_be_hidden()
        ann.keyboard.up("ArrowUp")
        drive(ann, shared)
        assert stopped_after(shared, lambda: vera.keyboard.press("Space")) < BAR
        assert not latched(shared)


def test_nothing_covers_the_reset(page: Page, product: Product) -> None:
    reset = page.locator("#reset")
    top_one = """(button) => {
      const { left, right, top, bottom } = button.getBoundingClientRect();
      return [0.1, 0.5, 0.9].every((part) => button.contains(
        document.elementFromPoint(left + part * (right - left), (top + bottom) / 2)));
    }"""
    for name, size in SIZES.items():
        page.set_viewport_size(size)
        open_view(page, "robot")
        page.keyboard.press("k")
        expect(reset).to_be_visible()
        assert reset.evaluate(top_one), name
        reset.click()
        until(lambda: not latched(product))
        expect(reset).to_be_hidden()


def test_map_and_stops_are_always_there(page: Page) -> None:
    for size in SIZES.values():
        page.set_viewport_size(size)
        assert_in_reach(page, size)
        for view in ("robot", "modes"):
            open_view(page, view)
            assert_in_reach(page, size)
        page.locator("#sheet-close").click()


def assert_in_reach(page: Page, room: ViewportSize) -> None:
    """Check that map and stops are within the screen, and nothing lies over the stops."""
    assert page.evaluate("document.documentElement.scrollWidth") <= room["width"]
    for name, least in (("#stop", 44), ("#estop", 56), ("#canvas", 100)):
        box = page.locator(name).bounding_box()
        assert box is not None
        assert box["height"] >= least
        assert box["x"] >= 0
        assert box["y"] >= 0
        assert box["x"] + box["width"] <= room["width"]
        assert box["y"] + box["height"] <= room["height"]
        middle = [box["x"] + box["width"] / 2, box["y"] + box["height"] / 2]
        if name != "#canvas":  # nothing lies over them
            there = "([x, y]) => document.elementFromPoint(x, y).closest('button')?.id"
            assert f"#{page.evaluate(there, middle)}" == name


def test_a_stop_that_cannot_be_sent_says_so_and_goes_out_first_on_reconnection(
    page: Page, product: Product
) -> None:
    page.evaluate("""() => {
        const send = WebSocket.prototype.send;
        window.said = [];
        WebSocket.prototype.send = function (text) {
            window.said.push(text);
            send.call(this, text);
        };
        const unsent = document.getElementById("unsent");
        window.alerts = [];
        new MutationObserver(() => window.alerts.push(unsent.textContent))
            .observe(unsent, { childList: true });
    }""")
    product.call(lambda: hang_up(product))
    until(lambda: not page.evaluate("window.pioneer3.state.connected"))
    page.evaluate("window.said.length = 0")
    page.keyboard.press("k")
    until(lambda: latched(product))
    assert "STOP NOT SENT" in page.evaluate("window.alerts[0]")
    expect(page.locator("#unsent")).to_have_attribute("role", "alert")
    assert page.evaluate("JSON.parse(window.said[0]).type") == "emergency_stop"
    expect(page.locator("#toast")).to_have_text("The stop has arrived, late.")
    expect(page.locator("#unsent")).to_be_empty()


def test_a_stop_that_nobody_answers_is_said_to_be_in_doubt(page: Page, product: Product) -> None:
    page.evaluate("() => { WebSocket.prototype.send = () => undefined; }")
    page.keyboard.press("Space")
    expect(page.locator("#unsent")).to_contain_text("NOT CONFIRMED")
