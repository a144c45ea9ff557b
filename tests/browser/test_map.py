"""What the map shows, layer by layer, and how the camera moves over it."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from msgspec import structs
from playwright.sync_api import Page, expect

from pioneer3.geometry import Pose2, Twist2
from pioneer3.maps.image import to_png
from pioneer3.state import Bumpers
from pioneer3.web.messages import Target, encode
from tests.browser.drawn import (
    colour,
    differing,
    fingerprint,
    keep,
    pixel,
    repaint,
    rest,
    settle,
    state,
)
from tests.browser.support import Product, later, running_product, until, wait_for_the_robot
from tests.browser.tabs import Tabs, no_complaints
from tests.browser.test_edit import drag, spot

LAYERS = (
    "map",
    "places",
    "zones",
    "things",
    "names",
    "trails",
    "paths",
    "targets",
    "sonar",
    "laser",
    "bumpers",
    "grid",
)
MAP = """2D-Map
Resolution: 500
Cairn: RobotHome 0 0 0 "" ICON "Home"
Cairn: GoalWithHeading 2000 0 90 "" ICON "Door"
Cairn: ForbiddenArea 0 0 0 "" ICON "off limits" -3000 1000 -1000 3000
Cairn: ForbiddenLine 0 0 0 "" ICON "" 1000 2000 3000 2000
LINES
-4000 -4000 4000 -4000
4000 -4000 4000 4000
4000 4000 -4000 4000
-4000 4000 -4000 -4000
DATA
-2000 -2000
-1500 -2000
"""


@pytest.fixture
def hall(tmp_path: Path) -> Iterator[Product]:
    """Run the product in a hall with everything that map files have."""
    path = tmp_path / "hall.map"
    path.write_text(MAP)
    with running_product(world=str(path)) as product:
        yield product


@contextmanager
def opened(tabs: Tabs, product: Product) -> Iterator[Page]:
    """Open the page with all of the map in view; anything in the console fails the test."""
    with tabs.open(size=(1280, 800), scheme="dark") as page, no_complaints(page):
        page.goto(product.address)
        wait_for_the_robot(page)
        rest(page)
        yield page


@pytest.fixture
def plan(tabs: Tabs, hall: Product) -> Iterator[Page]:
    """Return the page in the hall."""
    with opened(tabs, hall) as page:
        yield page


def put(product: Product, place: Pose2) -> None:
    """Put the robot somewhere."""
    product.call(lambda: setattr(product.simulation.body, "robot_in_world", place))


def say(product: Product, target: Target, mode: str | None = None) -> None:
    """Let the robot say that it drives a curve, hits something, and goes to `target` in `mode`."""
    (view,) = product.web.robots.values()
    snapshot = view.robot.snapshot
    assert snapshot is not None
    moment = replace(
        snapshot,
        odometry=replace(snapshot.odometry, twist=Twist2(0.4, 0.2)),
        bumpers=Bumpers(front=(True, True, False, False, False), rear=()),
    )
    told = structs.replace(view.snapshot(moment, product.web.clients), target=target, mode=mode)
    product.call(lambda: product.web.audiences.first.snapshots.put(view.number, encode(told)))


def freeze_with_everything(page: Page, product: Product) -> None:
    """Stop time in a moment in which there is something on every layer."""
    page.keyboard.press("l")
    page.locator("#layer-laser").check()
    until(lambda: state(page, "scans")[0] > 50)
    body = product.simulation.body
    for step in range(5):
        put(product, Pose2(body.home.x + 0.1 * step, body.home.y))
        later(page, 2)
    product.call(lambda: setattr(product.simulation.pace, "paused", True))
    until(lambda: bool(state(page, "clock.paused")))
    settle(page)

    say(product, Target(2.0, -1.0, 0.5, person=False))
    until(lambda: state(page, "snapshot.target") is not None)
    page.locator("#fit").click()
    settle(page)


def test_every_layer_is_switched_off_and_on(plan: Page, hall: Product) -> None:
    plan.keyboard.press("e")
    plan.locator("#tool-box").click()
    drag(plan, (1.0, -3.0), (2.0, -2.0))
    until(lambda: len(hall.simulation.world.obstacles) == 1)
    plan.keyboard.press("e")
    freeze_with_everything(plan, hall)
    full = fingerprint(plan)
    prints = {full}
    for layer in LAYERS:
        plan.locator(f"#layer-{layer}").uncheck()
        without = fingerprint(plan)
        assert without not in prints, layer
        prints.add(without)
        assert state(plan, "layers")[layer] is False
        plan.locator(f"#layer-{layer}").check()
        assert fingerprint(plan) == full, layer
    say(hall, Target(2.0, -1.0, None, person=True), mode="follow")
    until(lambda: bool(state(plan, "snapshot.target.person")))
    assert fingerprint(plan) not in prints
    expect(plan.locator("#card-going")).to_contain_text("Follows somebody")


def test_what_is_shown_is_remembered(page: Page) -> None:
    page.locator("#layers").click()
    page.get_by_label("Sonar").uncheck()
    page.get_by_label("Laser").check()
    page.reload()
    wait_for_the_robot(page)
    layers = state(page, "layers")
    assert (layers["sonar"], layers["laser"], layers["grid"]) == (False, True, True)
    until(lambda: state(page, "scans")[0] > 50)
    page.keyboard.press("l")
    expect(page.get_by_label("Sonar")).not_to_be_checked()


def test_the_legend_works_by_keys_alone(page: Page) -> None:
    page.keyboard.press("l")
    expect(page.locator("#layer-map")).to_be_focused()
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    until(lambda: state(page, "layers")["places"] is False)
    page.keyboard.press("Space")  # stops the robot, wherever the focus is
    assert state(page, "layers")["places"] is False
    page.keyboard.press("Escape")
    expect(page.locator("#legend")).to_be_hidden()
    expect(page.locator("#layers")).to_be_focused()


def test_the_legend_fits_a_phone(tabs: Tabs, product: Product) -> None:
    with tabs.open(product.address, size=(320, 640), touch=True, mobile=True) as page:
        wait_for_the_robot(page)
        assert_the_legend_fits(page)


def assert_the_legend_fits(page: Page) -> None:
    """Check that the legend is within 320 pixels, and easy to hit."""
    page.locator("#layers").tap()
    box = page.locator("#legend").bounding_box()
    assert box is not None
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= 320
    row = page.get_by_text("Goals, docks, homes")
    row.scroll_into_view_if_needed()
    size = row.bounding_box()
    assert size is not None
    assert size["height"] >= 40
    row.tap()
    until(lambda: state(page, "layers")["places"] is False)
    assert page.evaluate("document.documentElement.scrollWidth") <= 320


def test_every_tool_of_the_map_is_within_it(page: Page) -> None:
    for width, height in ((320, 640), (390, 844), (844, 390), (3840, 2160)):
        page.set_viewport_size({"width": width, "height": height})
        assert_tools_within(page)
        page.locator("#edit").click()
        assert_tools_within(page)
        page.locator("#edit").click()


def assert_tools_within(page: Page) -> None:
    """Check that no tool of the map reaches out of it."""
    stage = page.locator(".stage").bounding_box()
    assert stage is not None
    for tool in page.locator(".tools button:visible").all():
        box = tool.bounding_box()
        assert box is not None
        assert box["x"] >= stage["x"]
        assert box["y"] + box["height"] <= stage["y"] + stage["height"]


def test_the_laser_is_on_only_while_it_is_shown(page: Page, product: Product) -> None:
    laser = product.robot.devices.laser
    later(page)
    assert laser.latest is None
    page.keyboard.press("l")
    page.locator("#layer-laser").check()
    until(lambda: state(page, "scans")[0] > 100)
    page.locator("#layer-laser").uncheck()
    later(page)
    last = laser.latest
    later(page)
    assert laser.latest is last


def test_a_map_file_is_drawn_with_all_it_has(plan: Page) -> None:
    plan.keyboard.press("l")
    plan.locator("#layer-sonar").uncheck()
    plan.keyboard.press("Escape")
    repaint(plan)
    assert pixel(plan, -2.0, -2.0) == colour(plan, "--c-cell")
    assert pixel(plan, -1.5, -2.0) == colour(plan, "--c-cell")
    assert pixel(plan, -2.0, -1.5) != colour(plan, "--c-cell")
    assert pixel(plan, 4.0, 0.0) == colour(plan, "--c-wall")
    assert pixel(plan, -1.0, 2.0) == colour(plan, "--c-forbidden")
    assert pixel(plan, 3.0, 2.0) == colour(plan, "--c-forbidden")
    red, green, _ = pixel(plan, -2.0, 2.4)  # in the area, shaded
    assert red > green + 10
    assert pixel(plan, 2.0, 0.0) == colour(plan, "--c-goal")
    names = {place["name"]: place["role"] for place in state(plan, "places") if place["name"]}
    assert names == {"Home": "home", "Door": "goal", "off limits": "area"}


def test_a_picture_of_a_map_is_drawn_where_it_lies(tabs: Tabs, tmp_path: Path) -> None:
    grey = np.full((80, 80), 254, dtype=np.uint8)
    grey[0, :] = grey[-1, :] = grey[:, 0] = grey[:, -1] = 0
    grey[10:20, 60:70] = 0  # up and to the right of the middle
    grey[60:70, 10:20] = 205  # unknown
    (tmp_path / "m.png").write_bytes(to_png(grey))
    path = tmp_path / "m.yaml"
    path.write_text("image: m.png\nresolution: 0.1\norigin: [-4, -4, 0]\n")
    with (
        running_product(world=str(path)) as product,
        tabs.open(product.address, size=(1280, 800)) as page,
    ):
        wait_for_the_robot(page)
        until(lambda: pixel(page, 2.5, 2.5) == colour(page, "--c-cell"))
        page.locator("#layers").click()
        for layer in ("grid", "sonar"):
            page.locator(f"#layer-{layer}").uncheck()
        repaint(page)
        assert pixel(page, -2.55, -2.55) == colour(page, "--c-floor")
        assert pixel(page, 2.55, -2.55) != colour(page, "--c-floor")
        page.emulate_media(color_scheme="dark")
        until(lambda: pixel(page, 2.5, 2.5) == colour(page, "--c-cell"))


def test_another_theme_colours_the_map_anew(plan: Page) -> None:
    dark = pixel(plan, -2.0, -2.0)
    plan.emulate_media(color_scheme="light")
    until(lambda: pixel(plan, -2.0, -2.0) == colour(plan, "--c-cell"))
    assert pixel(plan, -2.0, -2.0) != dark


def test_a_picture_at_rest_is_not_drawn_again(page: Page, product: Product) -> None:
    product.call(lambda: setattr(product.simulation.pace, "paused", True))
    until(lambda: bool(state(page, "clock.paused")))

    def frames_of_a_second() -> int:
        before = state(page, "frames")
        page.wait_for_timeout(1000)
        return int(state(page, "frames") - before)

    until(lambda: frames_of_a_second() <= 2)  # the world says what time it is


def test_the_wheel_zooms_about_the_pointer_and_the_mouse_pans(page: Page) -> None:
    rest(page)
    x, y = spot(page, 12.0, 7.0)
    page.mouse.move(x, y)
    before = state(page, "camera.scale")
    page.mouse.wheel(0, -400)
    until(lambda: state(page, "camera.scale") > 1.5 * before)
    assert spot(page, 12.0, 7.0) == pytest.approx((x, y), abs=0.6)
    page.mouse.down()
    page.mouse.move(x - 100, y + 60, steps=4)
    page.mouse.up()
    assert spot(page, 12.0, 7.0) == pytest.approx((x - 100, y + 60), abs=0.6)
    assert state(page, "camera.mode") == "free"
    page.keyboard.press("f")
    assert state(page, "camera.mode") == "follow"


def test_the_picture_is_the_same_panned_and_drawn_anew(plan: Page, hall: Product) -> None:
    hall.call(lambda: setattr(hall.simulation.pace, "paused", True))
    until(lambda: bool(state(plan, "clock.paused")))
    plan.locator("#zoom-in").click()
    settle(plan)
    x, y = map(round, spot(plan, 0.5, -3.0))
    plan.mouse.move(x, y)
    plan.mouse.down()
    plan.mouse.move(x + 64, y - 48, steps=4)  # by whole pixels: from the kept picture
    plan.mouse.up()
    plan.mouse.move(5, 5)
    keep(plan)
    plan.keyboard.press("l")
    plan.locator("#layer-grid").uncheck()
    plan.locator("#layer-grid").check()  # draws it anew
    assert differing(plan) < 50
    plan.locator("#layer-grid").uncheck()
    assert differing(plan) > 1000


def test_the_place_under_the_pointer_is_said(page: Page) -> None:
    rest(page)
    page.mouse.move(*spot(page, 12.0, 7.0))
    expect(page.locator("#where")).to_have_text("12.00, 7.00 m")
    page.locator("#stop").hover()
    expect(page.locator("#where")).to_be_hidden()


def test_a_drained_battery_is_shown_and_filled_again(page: Page, product: Product) -> None:
    page.keyboard.press("e")
    page.locator("#thing").select_option(index=1)
    page.locator("#battery-charge").select_option("0.05")
    until(lambda: product.simulation.body.battery.charge < 0.06)
    expect(page.locator("#low")).to_be_visible()
    expect(page.locator("#battery-charge option").first).to_have_text("Battery 5 %")
    page.locator("#battery-charge").select_option("1")
    expect(page.locator("#low")).to_be_hidden()
