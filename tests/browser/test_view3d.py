"""The 3-D view: it comes when it is opened, shows what the flat map shows, and leaves."""

from dataclasses import replace
from math import hypot, pi
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from pioneer3.geometry import Pose2
from pioneer3.sim.worldfile import RobotSpec, load_world
from tests.browser.drawn import state
from tests.browser.support import (
    Product,
    hold,
    running_product,
    speed,
    until,
    wait_for_the_robot,
)
from tests.browser.tabs import PHONE, Tabs, no_complaints

NO_WEBGL = """
const get = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  return kind.startsWith("webgl") ? null : get.call(this, kind, ...rest);
};
"""


@pytest.fixture
def page(page: Page) -> Page:
    """Make the page smaller: its solids are drawn by the processor."""
    page.set_viewport_size({"width": 900, "height": 640})
    return page


def open_3d(page: Page) -> None:
    page.locator("#in-3d").click()
    until(lambda: bool(state(page, "solid?.frames")))


def drawn(page: Page) -> Any:
    return state(page, "solid.robots[1]")


def test_three_js_is_loaded_only_when_the_view_is_opened(page: Page, product: Product) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.reload()
    wait_for_the_robot(page)
    assert not [url for url in asked if "three" in url or "/view3d/" in url or "/models/" in url]
    open_3d(page)
    until(lambda: any(url.endswith("/api/models/p3at-sh") for url in asked))
    assert any("three-0.187.0/three.js" in url for url in asked)
    assert all(url.startswith((product.address, "ws://")) for url in asked)
    expect(page.locator("#in-3d")).to_have_attribute("aria-pressed", "true")
    expect(page.locator("#canvas")).to_be_hidden()


def test_the_drawn_robot_and_its_wheels_follow_the_keys_and_space_stops(
    page: Page, product: Product
) -> None:
    open_3d(page)
    until(lambda: len(drawn(page)["wheels"]) == 4)
    eye, first = state(page, "solid.eye"), drawn(page)
    hold(page, "ArrowUp", lambda: speed(product) > 0.25)
    until(lambda: drawn(page)["x"] > first["x"] + 0.3)
    page.keyboard.press("Space")
    until(lambda: speed(product) == 0.0)
    page.keyboard.up("ArrowUp")
    until(lambda: hypot(drawn(page)["x"] - product.simulation.body.robot_in_world.x, 0.0) < 0.05)
    way = drawn(page)["x"] - first["x"]
    assert drawn(page)["wheels"][0] == pytest.approx(way / 0.111, rel=0.1)
    assert state(page, "solid.eye") == eye  # arrows drive, and do not move the camera


def test_the_emergency_stop_works_in_it(page: Page, product: Product) -> None:
    open_3d(page)
    hold(page, "ArrowUp", lambda: speed(product) > 0.2)
    page.keyboard.press("k")
    until(lambda: product.robot.supervisor.pilot.emergency)
    until(lambda: speed(product) == 0.0)
    expect(page.locator("#reset")).to_be_visible()


def test_the_camera_follows_and_sees_as_the_robot(page: Page, product: Product) -> None:
    open_3d(page)
    page.locator("#eyes").click()
    until(lambda: state(page, "solid.mode") == "eyes")
    here = product.simulation.body.robot_in_world
    until(
        lambda: (
            hypot(state(page, "solid.eye")[0] - here.x, state(page, "solid.eye")[1] - here.y) < 0.2
        )
    )
    page.locator("#follow").click()
    until(lambda: 1.0 < here.x - state(page, "solid.eye")[0] < 3.0)
    page.locator("#fit").click()
    until(lambda: state(page, "solid.eye")[2] > 5.0)


def test_a_click_on_the_floor_offers_a_place(page: Page) -> None:
    open_3d(page)
    box = page.locator("#canvas-3d").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    until(lambda: state(page, "proposal") is not None)
    bounds = state(page, "camera")  # the flat map is fitted too: its middle is that of the picture
    assert (
        hypot(state(page, "proposal.x") - bounds["x"], state(page, "proposal.y") - bounds["y"]) < 2
    )


def test_going_back_frees_it_and_the_choice_is_kept(page: Page) -> None:
    open_3d(page)
    page.reload()
    wait_for_the_robot(page)
    until(lambda: bool(state(page, "solid?.frames")))
    page.locator("#in-3d").click()
    expect(page.locator("#canvas-3d")).to_have_count(0)
    expect(page.locator("#canvas")).to_be_visible()
    assert state(page, "solid") is None
    open_3d(page)
    open_again = state(page, "solid.frames")
    assert open_again < 100


def test_editing_goes_back_to_the_flat_map(page: Page) -> None:
    open_3d(page)
    page.keyboard.press("e")
    expect(page.locator("#editor")).to_be_visible()
    expect(page.locator("#canvas")).to_be_visible()
    assert state(page, "solid") is None


def test_on_a_phone_the_controls_stay_on_top(tabs: Tabs, product: Product) -> None:
    with tabs.open(product.address, size=PHONE, touch=True) as page:
        wait_for_the_robot(page)
        open_3d(page)
        for name in ("#stop", "#estop", "#stick", "#in-3d", "#eyes", "#follow"):
            assert page.locator(name).evaluate(
                "(it) => { const { x, y, width, height } = it.getBoundingClientRect();"
                " return it.contains(document.elementFromPoint(x + width / 2, y + height / 2)); }"
            ), name


def test_solids_are_drawn_and_robots_stand_on_them(tabs: Tabs) -> None:
    world = replace(
        load_world("ramps"), robots=(RobotSpec(model="p3at-sh", start=Pose2(12.8, 1.0, pi)),)
    )
    with (
        running_product(world=world) as product,
        tabs.open() as page,
        no_complaints(page, console=False),
    ):
        page.goto(product.address)
        wait_for_the_robot(page)
        open_3d(page)
        assert state(page, "solid.solids") == 9
        until(lambda: bool(drawn(page)))
        assert drawn(page)["z"] == pytest.approx(0.25)
        product.call(lambda: setattr(product.simulation.body, "robot_in_world", Pose2(10.7, 1.0)))
        until(lambda: abs(drawn(page)["x"] - 10.7) < 0.01)
        assert drawn(page)["z"] == pytest.approx(0.125, abs=2e-3)
        product.call(lambda: setattr(product.simulation.body, "robot_in_world", Pose2(3.0, 2.0)))
        until(lambda: abs(drawn(page)["x"] - 3.0) < 0.01)
        assert drawn(page)["z"] == 0.0


def test_without_webgl_it_says_so_and_the_flat_map_stays(tabs: Tabs, product: Product) -> None:
    with tabs.open(scripts=NO_WEBGL) as page:
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url))
        page.goto(product.address)
        wait_for_the_robot(page)
        page.locator("#in-3d").click()
        expect(page.locator("#toast")).to_contain_text("no WebGL")
        expect(page.locator("#canvas")).to_be_visible()
        assert not [url for url in asked if "three" in url]
