"""Each state of the page at four sizes: axe, targets for fingers, and STOP in reach."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Literal

import numpy as np
import pytest
from msgspec.structs import replace
from playwright.sync_api import Page, expect

from pioneer3.nav.changes import MapChange
from pioneer3.web.messages import Mapping, Navigation, encode
from pioneer3.web.world import map_message
from tests.browser.support import Product, until, wait_for_the_robot
from tests.browser.tabs import Size, Tabs
from tests.browser.test_accessibility import faults
from tests.browser.views import open_view

Scheme = Literal["dark", "light"]
DESK, WIDE, UPRIGHT, SIDEWAYS = (1280, 800), (1920, 1080), (390, 844), (844, 390)
CONTROLS = """() => {
  const hits = (control, x, y) => {
    const hit = document.elementFromPoint(x, y);
    return [control, ...(control.labels ?? [])].some((one) => one.contains(hit));
  };
  const all = [...document.querySelectorAll("button, select, input, summary")];
  return all.filter((one) => one.offsetParent && !one.disabled).map((one) => {
    const scrolled = one.closest("#sheet-body, #people, #legend");
    if (scrolled) one.scrollIntoView({ block: "center" });
    const { x, y, width, height } = one.getBoundingClientRect();
    const at = (dx, dy) => hits(one, x + width / 2 + dx, y + height / 2 + dy);
    const name = one.id || one.textContent.trim() || one.ariaLabel;
    const far = 21;
    return { name, scrolled: scrolled !== null, there: at(0, 0),
      wide: at(-far, 0) && at(far, 0) && at(0, -far) && at(0, far) };
  });
}"""
"""Whether a finger meets each control in its middle, and 21 px beside it, so that it has 44 px."""


@contextmanager
def doubted(product: Product) -> Iterator[None]:
    """Let the page believe that the robot does not know its place, while the block lasts."""
    navigation = product.web.robots[1].navigation
    publish = navigation._publish
    told = Navigation(1, sure=False, reason="it looks like several places", problem="")

    def tell(*, sure: bool) -> None:
        navigation._publish = publish if sure else lambda _: publish(told)
        publish(replace(told, sure=sure))

    product.call(lambda: tell(sure=False))
    yield
    product.call(lambda: tell(sure=True))


@contextmanager
def asked(product: Product) -> Iterator[None]:
    """Let the page ask which map is kept, while the block lasts."""
    mapping, used = product.web.robots[1].mapping, product.simulation.world.map
    publish = mapping._publish
    cells = np.array([[4.0, 3.0], [4.2, 3.4]])
    changes = [MapChange(x=4.1, y=3.2, area=0.1, gone=gone, cells=cells) for gone in (True, False)]
    told = Mapping(1, making=True, updates="office.map", asks=True)

    def tell(*, asks: bool) -> None:
        mapping._publish = (lambda _: publish(told)) if asks else publish
        mapping._publish(told if asks else Mapping(1, making=False))
        shown = encode(map_message(used, changes=changes if asks else ()))
        for audience in product.web.audiences:
            audience.put("map", shown)

    product.call(lambda: tell(asks=True))
    yield
    product.call(lambda: tell(asks=False))


def states(page: Page, product: Product) -> Iterator[str]:
    """Bring the page into one state after the other; yield the name of each."""
    yield "first"
    page.keyboard.press("g")
    page.locator("#goto-place").select_option(label="Lab")
    expect(page.locator("#goto-where")).to_contain_text("about")
    yield "way"
    page.keyboard.press("Escape")
    with doubted(product):
        expect(page.locator("#unsure")).to_be_visible()
        yield "unsure"
        page.locator("#unsure-place").click()
        expect(page.locator("#goto-tell")).to_be_focused()
        yield "placing"
        page.keyboard.press("Escape")
    expect(page.locator("#unsure")).to_be_hidden()
    with asked(product):
        expect(page.locator("#changes-title")).to_contain_text("1 gone, 1 new. Which map")
        yield "asks"
    expect(page.locator("#changes-card")).to_be_hidden()
    page.keyboard.press("l")
    yield "legend"
    page.keyboard.press("l")
    page.locator("#driver").click()
    yield "people"
    page.locator("#people-close").click()
    for view in ("robot", "modes"):
        open_view(page, view)
        yield view
    page.locator("#wander-start").click()
    page.keyboard.press("Escape")
    expect(page.locator("#card-end")).to_be_visible()
    yield "mode"
    page.keyboard.press("k")
    expect(page.locator("#reset")).to_be_visible()
    yield "latched"
    page.locator("#reset").click()
    expect(page.locator("#why")).to_contain_text("The emergency stop was pressed.")
    yield "stopped"


@pytest.mark.parametrize(
    ("size", "scheme"),
    [
        pytest.param(UPRIGHT, "light", id="upright"),
        pytest.param(SIDEWAYS, "dark", id="sideways"),
        pytest.param(DESK, "dark", id="desk"),
        pytest.param(WIDE, "light", id="wide"),
    ],
)
def test_every_state_is_right_at_every_size(
    tabs: Tabs, product: Product, size: Size, scheme: Scheme
) -> None:
    phone = size in (UPRIGHT, SIDEWAYS)
    with tabs.open(product.address, size=size, scheme=scheme, touch=phone, mobile=phone) as page:
        wait_for_the_robot(page)
        for state in states(page, product):
            assert faults(page) == [], state
            assert_in_reach(page, state, fingers=phone)


def assert_in_reach(page: Page, state: str, *, fingers: bool) -> None:
    """See that nothing covers STOP, nor what else stands still, and that fingers find targets."""
    controls = page.evaluate(CONTROLS)
    there = {one["name"] for one in controls if one["there"]}
    assert {"stop", "estop"} <= there, state
    if state in {"first", "way", "unsure", "placing", "asks", "stopped"}:
        assert [one["name"] for one in controls if not one["there"]] == [], state
    if fingers:
        assert [one["name"] for one in controls if one["there"] and not one["wide"]] == [], state


def test_a_robot_that_is_not_sure_is_placed_and_not_sent(tabs: Tabs, product: Product) -> None:
    navigation = product.web.robots[1].navigation
    with tabs.open(product.address, size=UPRIGHT, touch=True, mobile=True) as page:
        wait_for_the_robot(page)
        with doubted(product):
            page.locator("#unsure-place").click()
            expect(page.locator("#goto-where")).to_contain_text("it looks like several places")
            expect(page.locator("#goto-go")).to_be_hidden()
            expect(page.locator("#goto")).to_be_hidden()
            page.locator("#goto-tell").click()
            expect(page.locator("#goto-card")).to_be_hidden()
            until(lambda: navigation._navigator is not None)
        expect(page.locator("#goto")).to_be_visible()


def test_a_phone_shows_the_whole_way_above_the_card(tabs: Tabs, product: Product) -> None:
    with tabs.open(product.address, size=SIDEWAYS, touch=True, mobile=True) as page:
        wait_for_the_robot(page)
        before = page.evaluate("pioneer3.state.camera.mode")
        page.locator("#goto").click()
        page.locator("#goto-place").select_option(label="Kitchen")
        until(lambda: bool(page.evaluate("pioneer3.state.proposal?.way?.length")))
        until(lambda: bool(page.evaluate(ALL_OF_THE_WAY)))
        expect(page.locator("#why")).to_be_hidden()
        page.locator("#goto-close").click()
        assert page.evaluate("pioneer3.state.camera.mode") == before


ALL_OF_THE_WAY = """(() => {
  const { proposal, toScreen, drawn } = pioneer3.state;
  const boxOf = (id) => document.getElementById(id).getBoundingClientRect();
  const [{ width, top }, card] = [boxOf("canvas"), boxOf("goto-card")];
  const points = [drawn, ...proposal.way.map(([x, y]) => toScreen(x, y))];
  return points.every(({ x, y }) => x > 0 && x < width && y > 0 && y + top < card.top);
})()"""
