"""Editing the simulated world on the page: mouse, finger and keys, checked against the world."""

from collections.abc import Iterator
from contextlib import contextmanager
from math import hypot, pi
from typing import Any

import pytest
from playwright.sync_api import Locator, Page

from pioneer3.geometry import Pose2
from pioneer3.sim.worldfile import Box, Person
from tests.browser.drawn import rest
from tests.browser.support import (
    Product,
    hold,
    later,
    running_product,
    speed,
    until,
    wait_for_the_robot,
)
from tests.browser.tabs import Tabs, no_complaints

SIZES = {"desktop": (1280, 800), "phone": (390, 844), "phone on its side": (844, 390)}
LEAST_TARGET = 40
"""A finger hits what is so high [CSS px]."""


@contextmanager
def opened(tabs: Tabs, product: Product, size: str) -> Iterator[Page]:
    """Open the page at a size, in edit mode with all of the map in view."""
    touch = size != "desktop"
    with tabs.open(size=SIZES[size], touch=touch, mobile=touch) as page, no_complaints(page):
        page.goto(product.address)
        wait_for_the_robot(page)
        begin_editing(page)
        yield page


def begin_editing(page: Page) -> None:
    until(lambda: page.locator("#edit").is_visible())
    page.locator("#edit").click()
    page.locator("#fit").click()
    rest(page)


@pytest.fixture
def editor(page: Page) -> Page:
    """Return the page at desktop size in edit mode."""
    begin_editing(page)
    return page


def spot(page: Page, x: float, y: float) -> tuple[float, float]:
    """Return where a point of the map is in the window [CSS px]."""
    box = page.locator("#canvas").bounding_box()
    assert box is not None
    at = page.evaluate("([x, y]) => window.pioneer3.toScreen(x, y)", [x, y])
    return box["x"] + at["x"], box["y"] + at["y"]


def drag(page: Page, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag with the mouse from one point of the map to another."""
    page.mouse.move(*spot(page, *start))
    page.mouse.down()
    page.mouse.move(*spot(page, *end), steps=5)
    page.mouse.up()


def drag_by_finger(page: Page, start: tuple[float, float], end: tuple[float, float]) -> None:
    """Drag with a finger from one point of the map to another."""
    session = page.context.new_cdp_session(page)
    (x0, y0), (x1, y1) = spot(page, *start), spot(page, *end)
    way = [(x0 + (x1 - x0) * k / 6, y0 + (y1 - y0) * k / 6) for k in range(7)]
    for name, (x, y) in zip(["touchStart", *["touchMove"] * 6], way, strict=True):
        points = [{"x": x, "y": y}]
        session.send("Input.dispatchTouchEvent", {"type": name, "touchPoints": points})
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def things(page: Page, kind: str) -> list[dict[str, Any]]:
    """Return what the page knows of a kind."""
    every: list[dict[str, Any]] = page.evaluate("window.pioneer3.state.things")
    return [thing for thing in every if thing["kind"] == kind]


def rounded(pose: Pose2) -> tuple[float, float]:
    return round(pose.x, 1), round(pose.y, 1)


def test_a_box_put_before_the_driving_robot_stops_it(editor: Page, product: Product) -> None:
    body = product.simulation.body
    start = body.robot_in_world
    hold(editor, "ArrowUp", lambda: speed(product) > 0.25)
    editor.locator("#tool-box").click()
    ahead = body.robot_in_world.x + 1.3
    drag(editor, (ahead, start.y - 1.0), (ahead + 0.5, start.y + 1.0))
    until(lambda: len(product.simulation.world.obstacles) == 1)
    hold(editor, "ArrowUp", lambda: min(product.simulation.world.sonar(body)) < 0.4)
    until(lambda: speed(product) < 0.01)
    editor.keyboard.up("ArrowUp")
    (box,) = product.simulation.world.obstacles
    assert body.robot_in_world.x + body.model.length_front < box.pose.x - box.sizes[0] + 0.02
    assert box.sizes == pytest.approx((0.25, 0.25, 1.0, 0.0), abs=0.05)
    echoes = [r for r in editor.evaluate("window.pioneer3.state.snapshot.sonar.ranges") if r]
    assert min(echoes) < 0.5


def test_the_robot_is_dragged_and_turned(editor: Page, product: Product) -> None:
    body = product.simulation.body
    home = body.robot_in_world
    drag(editor, (home.x, home.y), (home.x + 0.9, home.y + 1.2))
    until(lambda: rounded(body.robot_in_world) == (round(home.x + 0.9, 1), round(home.y + 1.2, 1)))
    assert body.robot_in_odom == Pose2()  # the wheels have not noticed
    now = body.robot_in_world
    front = body.model.length_front + 30 / editor.evaluate("window.pioneer3.state.camera.scale")
    until(
        lambda: (
            hypot(*(things(editor, "robot")[0]["pose"][k] - getattr(now, k) for k in "xy")) < 0.01
        )
    )
    drag(editor, (now.x + front, now.y), (now.x, now.y + 1.0))
    until(lambda: abs(body.robot_in_world.theta - pi / 2) < 0.01)
    until(lambda: abs(editor.evaluate("window.pioneer3.state.pose.theta") - pi / 2) < 0.01)


def test_a_robot_is_not_dragged_into_a_wall_and_the_page_says_why(
    editor: Page, product: Product
) -> None:
    body = product.simulation.body
    home = body.robot_in_world
    drag(editor, (home.x, home.y), (home.x, 0.1))
    until(lambda: editor.locator("#toast").is_visible())
    assert "something stands at" in editor.locator("#toast").inner_text()
    assert product.simulation.has_room(
        body.model, body.robot_in_world, product.simulation.robots[0]
    )


def test_lifting_the_robot_while_it_drives_stops_it(editor: Page, product: Product) -> None:
    body = product.simulation.body
    hold(editor, "ArrowUp", lambda: speed(product) > 0.25)
    here = body.robot_in_world
    drag(editor, (here.x + 0.1, here.y), (here.x + 0.5, here.y + 1.0))
    until(lambda: speed(product) == 0.0)
    lifted = body.robot_in_world
    later(editor, 6)
    assert body.robot_in_world == lifted
    editor.keyboard.up("ArrowUp")


@pytest.mark.parametrize("size", ["desktop", "phone"])
def test_a_robot_is_added_moved_and_removed(tabs: Tabs, product: Product, size: str) -> None:
    simulation = product.simulation
    with opened(tabs, product, size) as page:
        press = page.locator("#tool-robot")
        press.tap() if size == "phone" else press.click()
        page.locator("#model").select_option("amigo-sh")
        place = spot(page, 12.0, 7.2)
        page.touchscreen.tap(*place) if size == "phone" else page.mouse.click(*place)
        until(lambda: len(simulation.robots) == 2)
        added = simulation.robots[1]
        assert added.model.name == "amigo-sh"
        assert rounded(added.body.robot_in_world) == pytest.approx((12.0, 7.2), abs=0.11)
        until(lambda: page.locator("#hint").inner_text().startswith(f"AmigoBot at {added.url}"))
        here = added.body.robot_in_world
        (drag_by_finger if size == "phone" else drag)(page, (here.x, here.y), (10.0, 7.4))
        until(lambda: added.body.robot_in_world.x == pytest.approx(10.0, abs=0.2))
        page.locator("#remove").click()
        until(lambda: len(simulation.robots) == 1)
        until(lambda: len(things(page, "robot")) == 1)
        assert page.locator("#thing").input_value() == ""


def test_people_are_added_who_stand_and_who_walk(editor: Page, product: Product) -> None:
    world = product.simulation.world
    editor.locator("#tool-person").click()
    editor.mouse.click(*spot(editor, 8.0, 7.4))
    until(lambda: len(world.obstacles) == 1)
    editor.locator("#tool-walker").click()
    editor.mouse.click(*spot(editor, 3.0, 7.0))
    assert editor.locator("#hint").inner_text() == "Now tap where they turn back."
    editor.mouse.click(*spot(editor, 6.0, 7.0))
    until(lambda: len(things(editor, "person")) == 2)
    stands, walks = world.obstacles
    assert (stands.walks, walks.walks) == (False, True)
    first = things(editor, "person")[1]["pose"]["x"]
    until(lambda: abs(things(editor, "person")[1]["pose"]["x"] - first) > 0.3)


def test_keys_alone_add_move_turn_and_remove(page: Page, product: Product) -> None:
    world = product.simulation.world
    until(lambda: page.locator("#edit").is_visible())
    page.keyboard.press("e")
    page.locator("#tool-box").focus()
    page.keyboard.press("Enter")
    until(lambda: page.evaluate("window.pioneer3.state.selected") is not None)
    before = world.obstacles[0].pose
    for key in ("Shift+ArrowUp", "Shift+ArrowUp", "Shift+ArrowRight", "["):
        page.keyboard.press(key)
    until(lambda: world.obstacles[0].pose.theta == pytest.approx(pi / 12))
    after = world.obstacles[0].pose
    assert (after.x - before.x, after.y - before.y) == pytest.approx(
        (0.1, 0.2), abs=0.002
    )  # the page knows millimetres
    assert speed(product) == 0.0
    page.keyboard.press("Delete")
    until(lambda: not world.obstacles)
    page.keyboard.press("e")
    assert page.locator("#editor").is_hidden()


def test_time_is_paused_and_stepped_without_losing_the_robot(
    editor: Page, product: Product
) -> None:
    world = product.simulation.world
    editor.locator("#pause").click()
    until(lambda: product.simulation.pace.paused)
    editor.wait_for_timeout(2500)  # longer than a real robot may be silent
    stopped = world.time
    assert editor.locator("#why").inner_text() == "Simulated time is paused."
    assert editor.locator("#overlay").is_hidden()
    editor.locator("#single").click()
    until(lambda: world.time == pytest.approx(stopped + 0.1))
    home = product.simulation.body.robot_in_world
    drag(editor, (home.x, home.y), (home.x + 0.6, home.y))
    until(lambda: abs(editor.evaluate("window.pioneer3.state.pose.x") - home.x - 0.6) < 0.05)
    editor.locator("#pause").click()
    editor.locator("#world-speed").select_option("2")
    until(lambda: world.time > stopped + 1.0)
    assert product.simulation.pace.speed == 2.0
    hold(editor, "ArrowUp", lambda: speed(product) > 0.25)
    editor.keyboard.up("ArrowUp")
    assert editor.evaluate("window.pioneer3.state.snapshot.link.sessions") == 1


def test_stop_button_and_cable_are_at_hand(editor: Page, product: Product) -> None:
    (robot,) = product.simulation.robots
    editor.locator("#thing").select_option(index=1)
    editor.locator("#press").click()
    until(lambda: editor.locator("#motors-alarm").inner_text() == "Stop button")
    editor.locator("#press").click()
    until(lambda: not robot.body.stop_button)
    editor.locator("#cable").click()
    until(lambda: editor.locator("#overlay-title").inner_text() == "Cable unplugged")
    editor.locator("#cable").click()
    until(lambda: editor.locator("#overlay").is_hidden(), 20.0)
    until(lambda: editor.evaluate("window.pioneer3.state.snapshot.link.sessions") == 2)


def test_everybody_sees_what_one_changes(editor: Page, product: Product) -> None:
    second = editor.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    editor.locator("#tool-box").click()
    editor.mouse.click(*spot(editor, 8.0, 7.4))
    until(lambda: all(len(things(page, "box")) == 1 for page in (editor, second)))
    box = things(second, "box")[0]
    drag(editor, (8.0, 7.4), (9.0, 7.0))
    until(lambda: things(second, "box")[0]["pose"] != box["pose"])
    assert second.locator("#editor").is_hidden()
    second.close()


@pytest.mark.parametrize("size", SIZES)
def test_the_whole_toolbar_is_in_reach(tabs: Tabs, product: Product, size: str) -> None:
    product.simulation.world.add_obstacle(Box(pose=Pose2(5.0, 3.0), size=(0.6, 0.6)))
    product.simulation.world.add_obstacle(Person(path=((8.0, 7.4),)))
    width, height = SIZES[size]
    with opened(tabs, product, size) as page:
        page.locator("#thing").select_option(index=1)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        for name in (
            "#thing",
            "#press",
            "#pause",
            "#world-speed",
            "#tool-robot",
            "#edit",
            "#stop",
            "#estop",
        ):
            assert_in_reach(page.locator(name), width, height)
        page.locator("#tool-robot").click()
        assert_in_reach(page.locator("#model"), width, height)
        canvas = page.locator("#canvas").bounding_box()
        assert canvas is not None
        assert canvas["height"] > 0.4 * height


def assert_in_reach(locator: Locator, width: int, height: int) -> None:
    box = locator.bounding_box()
    assert box is not None
    assert box["x"] >= 0
    assert box["y"] >= 0
    assert box["x"] + box["width"] <= width
    assert box["y"] + box["height"] <= height
    assert box["height"] >= LEAST_TARGET - 2


def test_a_finger_drags_the_robot_and_two_zoom(tabs: Tabs, product: Product) -> None:
    body = product.simulation.body
    with opened(tabs, product, "phone") as page:
        home = body.robot_in_world
        drag_by_finger(page, (home.x, home.y), (home.x + 1.2, home.y + 0.9))
        until(lambda: body.robot_in_world.x == pytest.approx(home.x + 1.2, abs=0.2))
        scale = page.evaluate("window.pioneer3.state.camera.scale")
        stood = body.robot_in_world
        (x, y), session = spot(page, stood.x, stood.y), page.context.new_cdp_session(page)
        for name, gap in (("touchStart", 40), ("touchMove", 60), ("touchMove", 100)):
            points = [{"x": x, "y": y, "id": 0}, {"x": x + gap, "y": y, "id": 1}]
            session.send("Input.dispatchTouchEvent", {"type": name, "touchPoints": points})
        session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        assert page.evaluate("window.pioneer3.state.camera.scale") > 1.5 * scale
        assert body.robot_in_world == stood


def test_the_world_of_a_real_robot_has_nothing_to_edit(tabs: Tabs) -> None:
    with running_product(editable=False) as product, tabs.open(product.address) as page:
        wait_for_the_robot(page)
        page.keyboard.press("e")
        later(page, 3)
        assert page.locator("#map-tool-wall").is_visible()  # the map can be edited
        assert page.locator("#edit-what").is_hidden()
        assert page.locator("#tool-box").is_hidden()
        assert page.evaluate("window.pioneer3.state.things") == []
