"""Sending the robot to a place of the map, with mouse, finger and keys."""

import asyncio
from collections.abc import Callable, Iterator
from functools import partial
from math import hypot, pi

import pytest
from playwright.sync_api import Page, expect

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject
from tests.browser.drawn import rest, state
from tests.browser.support import (
    Product,
    later,
    running_product,
    speed,
    until,
    wait_for_the_robot,
)
from tests.browser.tabs import PHONE, Tabs
from tests.browser.test_edit import drag, spot
from tests.browser.test_stops import hang_up
from tests.browser.views import open_view


@pytest.fixture
def office(page: Page) -> Page:
    """Return the page with all of the office in view, and at rest."""
    rest(page)
    return page


def away(product: Product, x: float, y: float) -> float:
    """Return how far the robot is from a place [m]."""
    here = product.simulation.body.robot_in_world
    return hypot(here.x - x, here.y - y)


def test_a_click_offers_a_place_and_moves_nothing(office: Page, product: Product) -> None:
    office.mouse.click(*spot(office, 4.2, 3.1))
    expect(office.locator("#goto-where")).to_have_text("Go to 4.20, 3.10 m?")
    later(office, 5)
    assert speed(product) == 0.0
    assert product.robot.arbiter.mode is None
    office.locator("#goto-close").click()
    expect(office.locator("#goto-card")).to_be_hidden()
    assert state(office, "proposal") is None


def test_a_moment_without_a_connection_takes_no_place_away(office: Page, product: Product) -> None:
    office.mouse.click(*spot(office, 4.2, 3.1))
    expect(office.locator("#goto-where")).to_contain_text("Go to 4.20, 3.10 m?")
    product.call(lambda: hang_up(product))
    until(lambda: not state(office, "connected"))
    until(lambda: bool(state(office, "live")))
    expect(office.locator("#goto-where")).to_contain_text("Go to 4.20, 3.10 m?")
    expect(office.locator("#goto-go")).to_be_enabled()


def test_the_robot_goes_there_and_the_page_says_so(office: Page, product: Product) -> None:
    office.mouse.click(*spot(office, 4.0, 3.4))
    office.locator("#goto-go").click()
    until(lambda: speed(product) > 0.1)
    expect(office.locator("#card-going")).to_contain_text("To 4.0")
    target = state(office, "snapshot.target")
    assert hypot(target["x"] - 4.0, target["y"] - 3.4) < 0.1
    until(lambda: state(office, "snapshot.mode") is None, 60.0)
    assert away(product, 4.0, 3.4) < 0.25
    expect(office.locator("#mode-card")).to_be_hidden()


def test_the_card_stays_while_navigation_is_compiled_and_tells_the_reason(
    office: Page, product: Product, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def prepare(in_thread: object, tell: Callable[[str], None]) -> None:
        tell("compiling navigation, once")
        await asyncio.sleep(2.0)
        raise ConfigError("the extra `nav` is missing")

    monkeypatch.setattr("pioneer3.web.navigation.prepare_navigation", prepare)
    office.mouse.click(*spot(office, 7.0, 5.1))
    office.locator("#goto-go").click()
    expect(office.locator("#goto-note")).to_contain_text("Compiling navigation, once.")
    expect(office.locator("#goto-where")).to_have_text("No way to Lab: the extra nav is missing.")
    expect(office.locator("#goto-where code")).to_have_text("nav")
    assert speed(product) == 0.0


def test_ending_it_stops_the_robot(office: Page, product: Product) -> None:
    office.mouse.click(*spot(office, 7.0, 5.1))
    expect(office.locator("#goto-where")).to_have_text("Go to Lab?")
    office.locator("#goto-go").click()
    until(lambda: speed(product) > 0.1)
    expect(office.locator("#card-going")).to_contain_text("To Lab")
    office.locator("#card-end").click()
    until(lambda: speed(product) == 0.0)
    assert product.robot.arbiter.mode is None


def test_somebody_else_may_end_it_too(tabs: Tabs, office: Page, product: Product) -> None:
    office.mouse.click(*spot(office, 7.0, 5.1))
    office.locator("#goto-go").click()
    until(lambda: speed(product) > 0.1)
    with tabs.open(product.address) as other:
        wait_for_the_robot(other)
        expect(other.locator("#card-end")).to_have_text("End the drive")
        other.locator("#card-end").click()
        until(lambda: speed(product) == 0.0)
        expect(office.locator("#toast")).to_contain_text("laptop 2 stopped the robot")


def test_the_knob_turns_the_heading(office: Page, product: Product) -> None:
    office.mouse.click(*spot(office, 4.0, 3.1))
    offer = state(office, "proposal")
    assert offer["heading"] is None
    arm = 46 / state(office, "camera.scale")
    drag(office, (offer["x"] + arm, offer["y"]), (offer["x"], offer["y"] + 2 * arm))
    expect(office.locator("#goto-where")).to_contain_text("heading 90°")
    office.locator("#goto-any").click()
    assert state(office, "proposal.heading") is None
    drag(office, (offer["x"] + arm, offer["y"]), (offer["x"], offer["y"] + 3 * arm))
    office.locator("#goto-go").click()
    until(lambda: state(office, "snapshot.mode") == "goto")
    until(lambda: state(office, "snapshot.mode") is None, 60.0)
    assert product.simulation.body.robot_in_world.theta == pytest.approx(pi / 2, abs=0.2)


def test_a_double_click_follows_the_robot_and_offers_nothing(office: Page) -> None:
    office.mouse.dblclick(*spot(office, 4.2, 3.1))
    assert state(office, "camera.mode") == "follow"
    assert state(office, "proposal") is None


def is_said(page: Page, place: tuple[float, float], why: str) -> bool:
    """Click at a place, and return whether the page says why the robot cannot go there.

    It cannot say so while the robot is not sure where it is, as without news on a busy machine.
    """
    page.mouse.click(*place)
    later(page, 5)
    return why in page.locator("#goto-where").inner_text()


def test_what_the_map_forbids_is_said(office: Page, product: Product) -> None:
    area = MapObject(
        kind="ForbiddenArea",
        name="acid",
        pose=Pose2(),
        outline=((4.0, 2.6), (5.0, 2.6), (5.0, 3.6), (4.0, 3.6)),
    )
    office.set_viewport_size({"width": 1440, "height": 900})  # with room beside the map
    rest(office)
    world = product.simulation.world
    changed = LineMap(name="changed", walls=world.map.walls, objects=(area,))
    product.call(lambda: world.change_map(changed))
    until(lambda: len(state(office, "places")) == 1)
    for x, y, why in (
        (4.5, 3.1, "the goal is in a forbidden area, acid."),
        (30.0, 3.1, "the goal is outside of the map."),
    ):
        until(partial(is_said, office, spot(office, min(x, 20.6), y), why))
        expect(office.locator("#goto-go")).to_be_disabled()
    later(office)
    assert speed(product) == 0.0


def test_keys_alone_send_the_robot(office: Page, product: Product) -> None:
    office.keyboard.press("g")
    expect(office.locator("#goto-go")).to_be_focused()
    office.locator("#goto-place").select_option(label="Lab")
    until(lambda: state(office, "proposal.name") == "Lab")
    office.locator("#goto-go").focus()
    for key in ("Shift+ArrowLeft", "Shift+ArrowDown", "["):
        office.keyboard.press(key)
    offer = state(office, "proposal")
    assert (offer["x"], offer["y"]) == pytest.approx((6.9, 5.0))
    assert offer["heading"] is not None
    assert speed(product) == 0.0
    office.keyboard.press("Enter")
    until(lambda: speed(product) > 0.1)
    office.keyboard.press("Space")
    until(lambda: speed(product) == 0.0)
    office.keyboard.press("g")
    office.keyboard.press("Escape")
    expect(office.locator("#goto-card")).to_be_hidden()


@pytest.fixture
def phone(tabs: Tabs, product: Product) -> Iterator[Page]:
    """Open the page on a phone."""
    with tabs.open(product.address, size=PHONE, touch=True, mobile=True) as page:
        wait_for_the_robot(page)
        rest(page)
        yield page


def test_a_finger_that_stays_offers_a_place_and_turns_the_heading(
    phone: Page, product: Product
) -> None:
    session = phone.context.new_cdp_session(phone)

    def touch(name: str, *place: float) -> None:
        points = [{"x": place[0], "y": place[1]}] if place else []
        session.send("Input.dispatchTouchEvent", {"type": name, "touchPoints": points})

    x, y = spot(phone, 4.2, 3.1)
    phone.touchscreen.tap(x, y)
    assert state(phone, "proposal") is None
    phone.wait_for_timeout(400)  # else it is a double tap
    touch("touchStart", x, y)
    until(lambda: state(phone, "proposal") is not None)
    touch("touchMove", x, y - 40)
    touch("touchMove", x, y - 60)
    touch("touchEnd")
    assert state(phone, "proposal.heading") == pytest.approx(pi / 2, abs=0.05)
    for button in ("#goto-go", "#goto-close", "#goto-any"):
        box = phone.locator(button).bounding_box()
        assert box is not None
        assert box["height"] >= 40
        assert box["x"] + box["width"] <= 390
    phone.locator("#goto-go").tap()
    until(lambda: speed(product) > 0.1)
    phone.locator("#card-end").tap()
    until(lambda: speed(product) == 0.0)


def test_a_finger_that_moves_pans_and_offers_nothing(phone: Page) -> None:
    session = phone.context.new_cdp_session(phone)
    x, y = spot(phone, 4.0, 3.1)
    for name, dx in (("touchStart", 0), ("touchMove", 20), ("touchMove", 40)):
        points = [{"x": x + dx, "y": y}]
        session.send("Input.dispatchTouchEvent", {"type": name, "touchPoints": points})
    phone.wait_for_timeout(700)  # longer than a finger must stay
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    assert state(phone, "proposal") is None
    assert state(phone, "camera.mode") == "free"


def test_leaving_the_page_ends_what_it_started(office: Page, product: Product) -> None:
    other = office.context.new_page()
    other.goto(product.address)
    wait_for_the_robot(other)
    rest(other)
    other.mouse.click(*spot(other, 7.0, 5.1))
    other.locator("#goto-go").click()
    until(lambda: speed(product) > 0.1)
    other.close()
    until(lambda: speed(product) == 0.0)
    assert product.robot.arbiter.mode is None


def test_without_navigation_nothing_offers_to_send_the_robot(
    tabs: Tabs, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pioneer3.web.navigation.installed", lambda: False)
    with running_product() as product, tabs.open(product.address) as page:
        wait_for_the_robot(page)
        rest(page)
        expect(page.locator("#goto")).to_be_hidden()
        page.mouse.click(*spot(page, 7.0, 5.1))
        expect(page.locator("#toast")).to_contain_text("navigation is not installed")
        expect(page.locator("#goto-card")).to_be_hidden()
        open_view(page, "modes")
        expect(page.locator("#wander-start")).to_be_visible()
        expect(page.locator("#goto-start")).to_be_hidden()
        expect(page.locator("#view-modes")).to_contain_text("Navigation is not installed")
