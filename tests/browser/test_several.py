"""Several robots on one page, in a real browser."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import product as combinations

import pytest
from playwright.sync_api import Page, expect

from pioneer3.geometry import Pose2
from pioneer3.sim.worldfile import RobotSpec, WorldFile
from tests.browser.drawn import repaint, still
from tests.browser.support import Product, hold, later, running_product, until, wait_for_the_robot
from tests.browser.tabs import Size, Tabs

NAMES = ("alice", "bob", "carol")
THREE = WorldFile(
    name="three",
    map="empty",
    robots=tuple(
        RobotSpec(model="p3dx-sh", name=name, start=Pose2(0.0, 2.0 * number), port=0)
        for number, name in enumerate(NAMES)
    ),
)
KEEP_SOCKETS = """
window.sockets = [];
window.WebSocket = class extends WebSocket {
  constructor(...args) {
    super(...args);
    window.sockets.push(this);
  }
};
"""
TELL_OF = """(count) => {
  const { hello } = window.pioneer3.state;
  const robots = Array.from({ length: count }, (_, i) => (
    { ...hello.robots[0], id: i + 1, name: `robot-${String(i + 1).padStart(2, "0")}` }));
  const data = JSON.stringify({ ...hello, robots });
  window.sockets.at(-1).dispatchEvent(new MessageEvent("message", { data }));
}"""
"""Lets the page believe that so many robots are there."""
WIDTHS = """(all) => all.map((one) => one.getBoundingClientRect())
  .map(({ width, right }) => [width, right])"""
SIZES = [(1440, 900), (390, 844), (320, 568), (740, 360)]


@pytest.fixture
def product() -> Iterator[Product]:
    """Run three robots beside each other."""
    with running_product(world=THREE) as product:
        yield product


def speeds(product: Product) -> list[float]:
    """Return how fast each robot really moves [m/s]."""
    return [abs(robot.body.speeds[0]) for robot in product.simulation.robots]


@contextmanager
def opened(tabs: Tabs, product: Product, size: Size, touch: bool = False) -> Iterator[Page]:
    """Open the page on a screen of this size."""
    with tabs.open(product.address, size=size, touch=touch, scripts=KEEP_SOCKETS) as page:
        wait_for_the_robot(page)
        yield page


def stops(product: Product) -> list[int]:
    """Return how often alice and carol were stopped by anything."""
    robots = [product.web.robots[number].robot for number in (1, 3)]
    return [robot.supervisor.pilot.last_stop.number for robot in robots]


def chosen(page: Page) -> list[str]:
    """Return the names of the robots that are shown as selected."""
    return page.locator("#robots-row [aria-pressed=true] strong").all_inner_texts()


def test_the_robots_are_in_a_row_and_the_first_is_selected(page: Page) -> None:
    expect(page.locator("#robots-row strong")).to_have_text(list(NAMES))
    expect(page.locator("#robots-row small")).to_have_text(["Ready"] * 3)
    assert chosen(page) == ["alice"]
    expect(page.locator("#name")).to_have_text("alice")


def test_with_one_robot_there_is_nothing_to_pick(tabs: Tabs) -> None:
    with running_product() as one, tabs.open(one.address) as page:
        wait_for_the_robot(page)
        expect(page.locator("#robots")).to_be_hidden()


def test_keys_drive_the_robot_that_is_selected(page: Page, product: Product) -> None:
    page.get_by_role("button", name="bob").click()
    expect(page.locator("#name")).to_have_text("bob")
    hold(page, "ArrowUp", lambda: speeds(product)[1] > 0.25)
    expect(page.locator("#robots-row small")).to_have_text(["Ready", "You drive", "Ready"])
    assert speeds(product)[::2] == [0.0, 0.0]
    page.keyboard.up("ArrowUp")
    until(lambda: speeds(product) == [0.0] * 3)


def test_selecting_another_robot_lets_go_of_the_one_before(page: Page, product: Product) -> None:
    hold(page, "ArrowUp", lambda: speeds(product)[0] > 0.25)
    page.keyboard.press("3")
    assert chosen(page) == ["carol"]
    until(lambda: speeds(product)[0] == 0.0)
    later(page)
    assert speeds(product) == [0.0] * 3  # the key is still down, and does not drive carol
    page.keyboard.up("ArrowUp")
    hold(page, "ArrowUp", lambda: speeds(product)[2] > 0.25)
    page.keyboard.up("ArrowUp")


def test_a_held_key_does_not_go_over_to_another_robot_when_its_own_is_gone(
    page: Page, product: Product
) -> None:
    page.keyboard.press("3")
    hold(page, "ArrowUp", lambda: speeds(product)[2] > 0.25)
    gone = product.call(lambda: product.web.robots.pop(3))
    product.call(product.web._publish_robots)
    expect(page.get_by_role("button", name="carol")).to_have_count(0)
    later(page, 7)  # of alice, who is selected now
    product.call(lambda: product.web.robots.update({3: gone}))
    assert speeds(product)[:2] == [0.0, 0.0]
    assert page.evaluate("window.pioneer3.state.source") is None
    page.keyboard.up("ArrowUp")


def test_everything_can_be_picked_by_keyboard(page: Page) -> None:
    page.keyboard.press("PageDown")
    assert chosen(page) == ["bob"]
    page.keyboard.press("PageUp")
    assert chosen(page) == ["alice"]
    page.keyboard.press("PageUp")
    assert chosen(page) == ["alice"]
    page.get_by_role("button", name="carol").focus()
    page.keyboard.press("Enter")
    assert chosen(page) == ["carol"]


def test_a_robot_is_picked_on_the_map(page: Page, product: Product) -> None:
    still(page)
    box = page.locator("#canvas").bounding_box()
    pose = product.simulation.robots[2].body.robot_in_world
    at = page.evaluate("([x, y]) => window.pioneer3.toScreen(x, y)", [pose.x, pose.y])
    assert box is not None
    page.mouse.click(box["x"] + at["x"], box["y"] + at["y"])
    assert chosen(page) == ["carol"]


def test_the_emergency_stop_is_for_all_and_the_reset_for_one(page: Page, product: Product) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    second.keyboard.press("2")
    hold(second, "ArrowUp", lambda: speeds(product)[1] > 0.25)
    page.locator("#estop").click()
    until(lambda: speeds(product) == [0.0] * 3)
    expect(page.locator("#robots-row small")).to_have_text(["E-stop"] * 3)
    second.keyboard.up("ArrowUp")
    page.locator("#reset").click()
    expect(page.locator("#robots-row small")).to_have_text(["Ready", "E-stop", "E-stop"])
    second.close()


def test_control_that_is_taken_is_the_selected_robots(page: Page, product: Product) -> None:
    page.keyboard.press("2")
    page.locator("#driver").click()
    page.locator("#lease-take").click()
    expect(page.locator("#people-lease")).to_have_text("You have control of bob.")
    assert [view.control.holder is not None for view in product.web.robots.values()] == [
        False,
        True,
        False,
    ]
    page.keyboard.press("1")
    expect(page.locator("#people-lease")).to_have_text("Nobody has control of alice.")


def test_a_lost_robot_is_seen_at_a_glance_and_the_others_go_on(
    page: Page, product: Product
) -> None:
    product.call(product.simulation.robots[1].port.faults.unplug)
    state = page.locator("#robots-row small").nth(1)
    until(lambda: state.inner_text() in {"Lost", "Connecting", "No news"})
    hold(page, "ArrowUp", lambda: speeds(product)[0] > 0.25)
    page.keyboard.up("ArrowUp")
    product.call(product.simulation.robots[1].port.faults.plug_in)
    expect(state).to_have_text("Ready", timeout=20_000)


def test_the_row_fits_every_size(tabs: Tabs, product: Product) -> None:
    with opened(tabs, product, SIZES[0], touch=True) as page:
        assert_the_row_fits(page)


def assert_the_row_fits(page: Page) -> None:
    """Pick a robot at each size."""
    for robot, (width, height) in zip(("carol", "bob") * 2, SIZES, strict=True):
        page.set_viewport_size({"width": width, "height": height})
        repaint(page)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        page.locator("#robots-all").tap()
        page.locator(".robot-list").get_by_role("button", name=robot).tap()
        if page.locator("#sheet").is_visible():
            page.locator("#sheet-close").tap()
        assert chosen(page) == [robot]
        for name in ("#stop", "#estop", "#stick"):
            box = page.locator(name).bounding_box()
            assert box is not None
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= width
            assert box["y"] + box["height"] <= height


SCREENS = [(1440, 900), (1024, 768), (390, 844), (844, 390)]


def test_any_number_of_robots_fits_every_screen_and_is_found_in_the_list(
    tabs: Tabs, product: Product
) -> None:
    with opened(tabs, product, SCREENS[0]) as page:
        assert_all_fit_and_are_found(page)


def assert_all_fit_and_are_found(page: Page) -> None:
    """Tell the page of ever more robots on ever other screens, and search for the last one."""
    for count, (width, height) in combinations((1, 2, 5, 20, 40), SCREENS):
        page.set_viewport_size({"width": width, "height": height})
        page.evaluate(TELL_OF, count)
        if count == 1:
            expect(page.locator("#robots")).to_be_hidden()
        else:
            expect(page.locator("#robots-row .robot")).to_have_count(count)
        repaint(page)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        if count == 1:
            continue
        shown = page.locator("#robots-row .robot:visible")
        assert 1 <= shown.count() <= count
        if count <= 5 and width >= 1024:
            assert shown.count() == count  # the lab's own number, at a desk
        for narrow, right in shown.evaluate_all(WIDTHS):
            assert narrow >= 80  # none is cut off
            assert right <= width
        page.locator("#robots-all").click()
        page.fill("#robots-search", "")
        expect(page.locator(".robot-list li:visible")).to_have_count(count)
        page.fill("#robots-search", f"robot-{count:02d}")
        expect(page.locator(".robot-list li:visible")).to_have_count(1)
        page.keyboard.press("Enter")
        assert page.evaluate("window.pioneer3.state.robot") == count
        assert chosen(page) == [f"robot-{count:02d}"]  # it is in the row, too
        if page.locator("#sheet").is_visible():
            page.locator("#sheet-close").click()


def test_who_begins_to_search_lets_go_of_the_robot(page: Page, product: Product) -> None:
    hold(page, "ArrowUp", lambda: speeds(product)[0] > 0.25)
    page.keyboard.press("/")
    until(lambda: speeds(product)[0] == 0.0)
    page.keyboard.up("ArrowUp")
    page.keyboard.type("bob")
    page.keyboard.press("Enter")  # the focus leaves the field: keys drive and stop again
    hold(page, "ArrowUp", lambda: speeds(product)[1] > 0.25)
    page.keyboard.press("Space")
    until(lambda: speeds(product)[1] == 0.0)
    page.keyboard.up("ArrowUp")


def test_the_list_says_how_each_robot_is_and_who_drives_it(page: Page, product: Product) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    second.keyboard.press("2")
    hold(second, "ArrowUp", lambda: speeds(product)[1] > 0.25)
    page.keyboard.press("/")
    expect(page.locator("#robots-search")).to_be_focused()
    rows = page.locator(".robot-list button")
    expect(rows.nth(0)).to_contain_text("Ready")
    expect(rows.nth(1)).to_contain_text("laptop 2 drives")
    expect(rows.nth(0)).to_contain_text(re.compile(r"1\d\.\d V, \d+ %"))
    before = stops(product)
    page.keyboard.type("drives k ")  # words, no stops: not even of alice, who stands
    expect(page.locator(".robot-list li:visible")).to_have_count(0)
    hold(second, "ArrowUp", lambda: speeds(product)[1] > 0.25)
    assert stops(product) == before
    page.fill("#robots-search", "drives")
    expect(page.locator(".robot-list li:visible")).to_have_count(1)
    second.keyboard.up("ArrowUp")
    page.keyboard.press("Escape")  # empties the field, then closes the list
    page.keyboard.press("Escape")
    expect(page.locator("#sheet")).to_be_hidden()
    expect(page.locator("#robots-all")).to_be_focused()
    second.close()


def test_the_banner_of_the_emergency_stop_fits(page: Page) -> None:
    page.locator("#estop").click()
    expect(page.locator("#reset-all")).to_be_visible()
    for width, height in ((390, 844), (320, 568), (844, 390)):
        page.set_viewport_size({"width": width, "height": height})
        banner = page.locator("#alarm").bounding_box()
        assert banner is not None
        for name in ("#reset", "#reset-all"):
            box = page.locator(name).bounding_box()
            assert box is not None
            assert banner["x"] <= box["x"]
            assert box["x"] + box["width"] <= banner["x"] + banner["width"]
            assert box["y"] + box["height"] <= banner["y"] + banner["height"]
    page.locator("#reset-all").click()


def test_space_stops_the_selected_robot_and_all_others_that_the_user_drives(
    page: Page, product: Product
) -> None:
    def wander(of: Page, key: str) -> None:
        of.keyboard.press(key)
        of.locator(".views [data-view=modes]").click()
        of.locator("#wander-start").click()
        of.locator("#sheet-close").click()

    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    wander(second, "3")
    wander(page, "1")
    until(lambda: speeds(product)[0] > 0.1 and speeds(product)[2] > 0.1)
    page.keyboard.press("2")
    page.keyboard.press("Space")
    until(lambda: speeds(product)[0] == 0.0)
    later(page, 3)
    assert speeds(product)[2] > 0.1  # carol is somebody else's, and not selected
    page.keyboard.press("3")
    page.keyboard.press("Space")
    until(lambda: speeds(product)[2] == 0.0)
    second.close()


def test_k_latches_all_robots_and_they_are_reset_one_by_one_or_at_once(
    page: Page, product: Product
) -> None:
    def latched() -> list[bool]:
        return [one.robot.supervisor.pilot.emergency for one in product.web.robots.values()]

    page.keyboard.press("k")
    until(lambda: latched() == [True] * 3)
    expect(page.locator("#latched-words")).to_contain_text("alice, bob, carol")
    page.get_by_role("button", name="Reset the emergency stop", exact=True).click()
    until(lambda: latched() == [False, True, True])
    expect(page.locator("#alarm")).to_be_hidden()
    page.get_by_role("button", name="carol").click()
    page.locator("#reset-all").click()
    until(lambda: latched() == [False] * 3)
    later(page, 3)
    assert not any(robot.body.drive.powered for robot in product.simulation.robots)


def test_the_views_show_the_robot_that_is_selected(page: Page, product: Product) -> None:
    page.locator(".views [data-view=robot]").click()
    address = page.locator("#view-robot dt:text-is('Address') + dd")
    for name, robot in zip(NAMES, product.simulation.robots, strict=True):
        page.get_by_role("button", name=name).click()
        expect(address).to_have_text(robot.url)
    page.locator(".views [data-view=modes]").click()
    page.locator("#wander-start").click()
    until(lambda: speeds(product)[2] > 0.1)
    assert speeds(product)[:2] == [0.0, 0.0]
    page.get_by_role("button", name="bob").click()
    expect(page.locator("#mode-card")).to_be_hidden()
    page.get_by_role("button", name="carol").click()
    page.locator("#card-end").click()
    until(lambda: speeds(product)[2] == 0.0)
