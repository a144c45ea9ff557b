"""Driving by itself, from the page."""

import pytest
from playwright.sync_api import Page, expect

from pioneer3.web.control import SILENCE
from tests.browser.support import SLACK, Product, hold, later, speed, until, wait_for_the_robot
from tests.browser.views import open_view, stopped_after


@pytest.fixture
def modes(page: Page) -> Page:
    """Open the modes, and wait for the first snapshot that they show."""
    open_view(page, "modes")
    expect(page.locator("#view-modes .mode-state").first).not_to_be_empty()
    return page


def running(product: Product) -> str | None:
    """Return which mode runs."""
    mode = product.call(lambda: product.robot.arbiter.mode)
    return mode.name if mode else None


@pytest.mark.parametrize("preset", ["lab", "aria", "explore"])
def test_wander_is_started_shown_and_ended(modes: Page, product: Product, preset: str) -> None:
    expect(modes.locator("#view-modes .mode-state")).to_have_text("No mode runs.")
    expect(modes.locator("#mode-note")).to_contain_text("close it")
    modes.locator("#wander-preset").select_option(preset)
    modes.locator("#wander-start").click()
    until(lambda: speed(product) > 0.1)
    expect(modes.locator("#view-modes .mode-state")).to_have_text("Wander, started by you.")
    expect(modes.locator("#view-modes .lines-of-text").first).to_contain_text("m/s")
    expect(modes.locator("#card-title")).to_have_text("Wander, started by you")
    modes.locator("#mode-end").click()
    until(lambda: speed(product) == 0.0)
    expect(modes.locator("#view-modes .mode-state")).to_have_text("Wander ended: laptop ended it.")
    expect(modes.locator("#toast")).to_contain_text("Wander ended")
    expect(modes.locator("#mode-card")).to_be_hidden()


def test_a_mode_goes_on_while_the_browser_delays_the_timers_of_its_page(
    modes: Page, product: Product
) -> None:
    modes.evaluate("for (let one = setTimeout(() => {}); one > 0; one--) clearInterval(one)")
    modes.locator("#wander-start").click()
    until(lambda: running(product) == "wander")
    began = product.simulation.world.time
    until(lambda: product.simulation.world.time > began + 2 * SILENCE)
    assert running(product) == "wander"


def test_the_card_on_the_map_ends_a_mode(modes: Page, product: Product) -> None:
    modes.locator("#wander-start").click()
    until(lambda: speed(product) > 0.1)
    modes.locator("#sheet-close").click()
    modes.locator("#card-end").click()
    until(lambda: speed(product) == 0.0)


@pytest.mark.parametrize("rule", ["tracking", "lab"])
def test_follow_is_started_with_its_rule_and_distance(
    modes: Page, product: Product, rule: str
) -> None:
    modes.locator("#follow-rule").select_option(rule)
    modes.locator("#follow-keep").fill("0.5")
    modes.locator("#follow-start").click()
    until(lambda: running(product) == "follow")
    actions = product.robot.arbiter.mode.actions if product.robot.arbiter.mode else ()
    assert any(rule in type(ranked.action).__name__.lower() for ranked in actions)
    modes.locator("#mode-end").click()
    until(lambda: running(product) is None)


def test_a_distance_that_is_none_starts_nothing(modes: Page, product: Product) -> None:
    modes.locator("#follow-keep").fill("-1")
    modes.locator("#follow-start").click()
    expect(modes.locator("#toast")).to_be_visible()
    expect(modes.locator("#follow-keep")).to_be_focused()
    later(modes, 3)
    assert running(product) is None


def test_goto_drives_to_a_point_of_the_map_and_says_that_it_is_there(
    modes: Page, product: Product
) -> None:
    home = product.simulation.body.robot_in_world
    modes.locator("#goto-here").click()
    expect(modes.locator("#goto-x")).to_have_value(f"{home.x:.2f}")
    modes.locator("#goto-x").fill(str(home.x + 0.6))
    modes.locator("#goto-heading").fill("")

    def goes() -> bool:
        if (
            running(product) is None
        ):  # or no longer: a busy machine may leave the robot without news
            modes.locator("#goto-start").click()
            later(modes, 2)
        return running(product) == "goto"

    until(goes)
    expect(modes.locator("#view-modes .mode-state")).to_have_text("Arrived.", timeout=20_000)
    assert product.simulation.body.robot_in_world.x == pytest.approx(home.x + 0.6, abs=0.15)


def test_a_point_without_numbers_starts_nothing(modes: Page, product: Product) -> None:
    modes.locator("#goto-x").fill("")
    modes.locator("#goto-start").click()
    expect(modes.locator("#toast")).to_contain_text("number")
    assert running(product) is None


def test_the_motors_are_switched_on_and_off(modes: Page, product: Product) -> None:
    modes.locator("#motors-switch").click()
    until(lambda: product.simulation.body.drive.powered)
    expect(modes.locator("#motors-switch")).to_have_text("Switch the motors off")
    modes.locator("#motors-switch").click()
    until(lambda: not product.simulation.body.drive.powered)


def test_a_mode_does_not_outlive_its_page(page: Page, product: Product) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    open_view(second, "modes")
    second.locator("#wander-start").click()
    until(lambda: speed(product) > 0.1)
    assert stopped_after(product, second.close) < 0.7 + SLACK
    open_view(page, "modes")
    expect(page.locator("#view-modes .mode-state")).to_contain_text("ended")


def test_a_mode_goes_on_when_the_window_loses_the_focus(modes: Page, product: Product) -> None:
    modes.locator("#wander-start").click()
    until(lambda: speed(product) > 0.1)
    modes.evaluate("window.dispatchEvent(new Event('blur'))")
    later(modes)
    assert running(product) == "wander"


def test_an_arrow_that_is_held_comes_before_the_mode_which_goes_on_afterwards(
    modes: Page, product: Product
) -> None:
    modes.locator("#wander-start").click()
    until(lambda: speed(product) > 0.1)
    hold(modes, "ArrowDown", lambda: product.simulation.body.speeds[0] < -0.2)
    modes.keyboard.up("ArrowDown")
    until(lambda: product.simulation.body.speeds[0] > 0.1)
    assert running(product) == "wander"


def test_a_second_page_sees_who_started_it_and_can_only_end_it(
    modes: Page, product: Product
) -> None:
    second = modes.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    modes.locator("#wander-start").click()
    until(lambda: speed(product) > 0.1)
    expect(second.locator("#card-title")).to_have_text("Wander, started by laptop")
    open_view(second, "modes")
    second.locator("#follow-start").click()
    expect(second.locator("#toast")).to_contain_text("has control")
    assert running(product) == "wander"
    expect(second.locator("#card-end")).to_have_text("End wander")
    second.locator("#card-end").click()
    until(lambda: running(product) is None)


def test_nothing_starts_while_the_emergency_stop_is_latched(modes: Page, product: Product) -> None:
    modes.keyboard.press("k")
    for name in ("wander", "follow", "goto"):
        expect(modes.locator(f"#{name}-start")).to_be_disabled()
    expect(modes.locator("#motors-switch")).to_be_disabled()


def test_a_stop_ends_a_step_of_a_calibration(modes: Page, product: Product) -> None:
    state = modes.locator("#calibration-state")
    if modes.locator("#calibration-by").is_visible():
        modes.locator("#calibration-by").select_option("tape")
    modes.locator("#calibration-begin").click()
    expect(state).to_contain_text("Step 1 of")
    while "square" not in (words := state.inner_text()):
        modes.locator("#calibration-skip").click()
        expect(state).not_to_have_text(words)
    modes.locator("#calibration-drive").click()
    until(lambda: speed(product) > 0.05)
    expect(modes.locator("#card-title")).to_have_text("Calibrating, started by you")
    modes.locator("#stop").click()
    until(lambda: speed(product) == 0.0)
    expect(modes.locator("#calibration-note")).not_to_be_empty()
    expect(modes.locator("#calibration-drive")).to_be_enabled()
    modes.locator("#calibration-end").click()
    expect(modes.locator("#calibration-begin")).to_be_visible()
