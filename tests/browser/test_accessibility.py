"""Everybody can use it: axe, the keyboard alone, small and large screens."""

from importlib.resources import files
from typing import Literal

import pytest
from playwright.sync_api import Page, expect

from tests.browser.support import Product, later, until, wait_for_the_robot
from tests.browser.tabs import DESKTOP, PHONE, Size, Tabs
from tests.browser.views import VIEWS, open_view

AXE = (files("axe_playwright_python") / "axe.min.js").read_text()


def faults(page: Page) -> list[str]:
    """Return what axe finds: rule and first element."""
    if page.evaluate("!window.axe"):
        page.evaluate(AXE)
    found = page.evaluate("axe.run(document, { resultTypes: ['violations'] })")
    return [f"{one['id']}: {one['nodes'][0]['target']}" for one in found["violations"]]


@pytest.mark.parametrize(
    ("size", "scheme"),
    [
        pytest.param(DESKTOP, "light", id="desktop-light"),
        pytest.param(PHONE, "dark", id="phone-dark"),
        pytest.param(DESKTOP, "dark", id="desktop-dark", marks=pytest.mark.thorough),
        pytest.param(PHONE, "light", id="phone-light", marks=pytest.mark.thorough),
    ],
)
def test_axe_finds_no_fault_in_any_view(
    tabs: Tabs, product: Product, scheme: Literal["dark", "light"], size: Size
) -> None:
    with tabs.open(product.address, size=size, scheme=scheme) as page:
        wait_for_the_robot(page)
        assert_no_fault(page)


def assert_no_fault(page: Page) -> None:
    """Look at all views, cards and tools of the page."""
    assert faults(page) == []
    for view in VIEWS:
        open_view(page, view)
        if view == "robot":
            page.locator("#config-open").click()
            expect(page.locator("#config tbody tr")).not_to_have_count(0)
        later(page, 3)
        assert faults(page) == [], view
    page.locator("#wander-start").click()
    expect(page.locator("#card-end")).to_be_visible()
    assert faults(page) == []
    page.locator("#estop").click()
    expect(page.locator("#alarm")).to_be_visible()
    assert faults(page) == []
    page.locator("#reset").click()
    page.locator("#sheet-close").click()
    page.locator("#help-button").click()
    assert faults(page) == []
    page.locator("#sheet-close").click()
    page.locator("#driver").click()
    assert faults(page) == []
    page.locator("#people-close").click()
    page.locator("#edit").click()
    assert faults(page) == []
    page.locator("#edit-map").click()
    for tool in ("select", "place"):
        page.locator(f"#map-tool-{tool}").click()
        assert faults(page) == [], tool


def test_axe_finds_the_faults_that_there_are(page: Page) -> None:
    page.evaluate("document.getElementById('zoom-in').removeAttribute('aria-label')")
    page.evaluate("document.getElementById('zoom-in').removeAttribute('title')")
    page.evaluate("document.querySelectorAll('#zoom-in span').forEach((word) => word.remove())")
    assert faults(page) == ["button-name: ['#zoom-in']"]


def focused(page: Page) -> str:
    """Return what has the focus: its id, or else what it says."""
    return str(
        page.evaluate("""() => {
        const { id, dataset, textContent } = document.activeElement;
        return id || dataset.view || textContent.trim();
    }""")
    )


def test_every_control_is_reached_by_the_tab_key_and_seen(page: Page) -> None:
    reached: list[str] = []
    for view in VIEWS:
        open_view(page, view)
        page.evaluate("document.activeElement.blur()")
        page.evaluate("getSelection().removeAllRanges()")
        for _ in range(60):
            page.keyboard.press("Tab")
            name = focused(page)
            reached.append(name)
            if name == "estop":
                break
        outline = page.evaluate("getComputedStyle(document.activeElement).outlineStyle")
        assert outline == "solid"
    wanted = page.evaluate("""() => [...document.querySelectorAll("button, select, input, summary")]
        .filter((one) => one.id && one.tabIndex >= 0 && !one.disabled && one.offsetParent)
        .map(({ id }) => id)""")
    assert set(wanted) <= set(reached)
    assert {"config-open", "plots-pause", "plots-save", "plots-look", "wander-start"} <= set(
        reached
    )


def test_all_of_it_works_with_the_keyboard_alone(page: Page, product: Product) -> None:
    def press(selector: str) -> None:
        page.locator(selector).focus()
        page.keyboard.press("Enter")

    press(".views [data-view=modes]")
    expect(page.locator("#view-modes")).to_be_visible()
    page.locator("#wander-preset").focus()
    page.keyboard.press("ArrowDown")
    expect(page.locator("#wander-preset")).to_have_value("aria")
    page.locator("#goto-y").focus()
    page.keyboard.press("Enter")  # starts nothing by accident
    assert product.robot.arbiter.mode is None
    press("#wander-start")
    expect(page.locator("#card-end")).to_have_text("End wander")
    press("#card-end")
    until(lambda: product.robot.arbiter.mode is None)
    press("#motors-switch")
    press("#estop")
    expect(page.locator("#alarm")).to_be_visible()
    press("#reset")
    expect(page.locator("#alarm")).to_be_hidden()
    press(".views [data-view=plots]")
    press("#plots-pause")
    expect(page.locator("#plots-pause")).to_have_attribute("aria-pressed", "true")
    press("#sheet-close")
    expect(page.locator("#sheet")).to_be_hidden()


@pytest.mark.parametrize("width", [320, 3840])
def test_every_view_fits_the_smallest_and_the_largest_screen(
    tabs: Tabs, product: Product, width: int
) -> None:
    size = (width, width * 9 // 16 if width > 999 else 568)
    with tabs.open(product.address, size=size) as page:
        wait_for_the_robot(page)
        for view in VIEWS:
            open_view(page, view)
            for where in ("document.documentElement", "document.getElementById('sheet-body')"):
                wide, room = page.evaluate(f"[{where}.scrollWidth, {where}.clientWidth]")
                assert wide <= room, (view, where)


def test_a_screen_reader_is_alerted_and_told_how_to_go_on(page: Page) -> None:
    page.keyboard.press("k")
    alert = page.get_by_role("alert").filter(has_text="EMERGENCY STOP")
    expect(alert).to_contain_text("reset it")
    expect(page.get_by_role("button", name="Reset the emergency stop", exact=True)).to_be_enabled()
