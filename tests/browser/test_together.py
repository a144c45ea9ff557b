"""Several robots chosen on one page, in a real browser: they drive together."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Page, expect

from pioneer3.geometry import Pose2
from pioneer3.sim.worldfile import RobotSpec, WorldFile
from tests.browser.drawn import still
from tests.browser.support import Product, hold, running_product, until, wait_for_the_robot
from tests.browser.tabs import PHONE, Tabs

NAMES = ("alice", "bob", "carol")
THREE = WorldFile(
    name="three",
    map="empty",
    robots=tuple(
        RobotSpec(model="p3dx-sh", name=name, start=Pose2(0.0, 2.0 * number), port=0)
        for number, name in enumerate(NAMES)
    ),
)
SHIFT: list = ["Shift"]  # type: ignore[type-arg]


@pytest.fixture
def product() -> Iterator[Product]:
    """Run three robots beside each other."""
    with running_product(world=THREE) as product:
        yield product


def speeds(product: Product) -> list[float]:
    """Return how fast each robot really moves [m/s]."""
    return [abs(robot.body.speeds[0]) for robot in product.simulation.robots]


def chosen(page: Page) -> list[int]:
    """Return the numbers of the chosen robots, the selected one first."""
    numbers: list[int] = page.evaluate("window.pioneer3.state.chosen")
    return numbers


def test_arrows_drive_all_that_are_chosen_and_space_stops_them(
    page: Page, product: Product
) -> None:
    page.get_by_role("button", name="carol").click(modifiers=SHIFT)
    assert chosen(page) == [1, 3]
    expect(page.locator("#robots-all")).to_have_text("2 of 3")
    expect(page.locator("#why")).to_contain_text("You drive 2 of 2 chosen robots")
    hold(page, "ArrowUp", lambda: speeds(product)[0] > 0.25 and speeds(product)[2] > 0.25)
    assert speeds(product)[1] == 0.0
    expect(page.locator("#robots-row small")).to_have_text(["You drive", "Ready", "You drive"])
    page.keyboard.press("Space")
    until(lambda: speeds(product) == [0.0] * 3)
    page.keyboard.up("ArrowUp")
    hold(page, "ArrowUp", lambda: min(speeds(product)[::2]) > 0.25)
    page.keyboard.up("ArrowUp")
    until(lambda: speeds(product) == [0.0] * 3)


def test_choosing_one_more_lets_go_and_a_plain_click_chooses_one(
    page: Page, product: Product
) -> None:
    hold(page, "ArrowUp", lambda: speeds(product)[0] > 0.25)
    page.keyboard.press("Shift+Digit2")
    until(lambda: speeds(product) == [0.0] * 3)
    page.keyboard.up("ArrowUp")
    assert chosen(page) == [1, 2]
    page.keyboard.press("Shift+Digit1")  # the other one is selected then
    assert chosen(page) == [2]
    page.keyboard.press("Shift+Digit3")
    page.get_by_role("button", name="bob").click()
    assert chosen(page) == [2]


def test_a_robot_is_added_on_the_map_with_shift(page: Page, product: Product) -> None:
    still(page)
    box = page.locator("#canvas").bounding_box()
    pose = product.simulation.robots[2].body.robot_in_world
    at = page.evaluate("([x, y]) => window.pioneer3.toScreen(x, y)", [pose.x, pose.y])
    assert box is not None
    page.keyboard.down("Shift")
    page.mouse.click(box["x"] + at["x"], box["y"] + at["y"])
    page.keyboard.up("Shift")
    assert chosen(page) == [1, 3]


def test_a_chosen_robot_that_somebody_else_drives_is_left_to_them(
    page: Page, product: Product
) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    second.keyboard.press("2")
    second.locator("#driver").click()
    second.locator("#lease-take").click()
    expect(second.locator("#people-lease")).to_have_text("You have control of bob.")
    page.keyboard.press("Shift+Digit2")
    page.keyboard.press("Shift+Digit3")
    page.locator(".views [data-view=modes]").click()
    expect(page.locator("#group-who")).to_contain_text("3 robots: alice, bob, carol.")
    expect(page.locator("#group-who")).to_contain_text("has control of bob.")
    hold(page, "ArrowUp", lambda: min(speeds(product)[::2]) > 0.25)
    assert speeds(product)[1] == 0.0
    page.keyboard.up("ArrowUp")
    page.locator("#form-start").click()  # all of them begin, or none
    expect(page.locator("#toasts, #toast").first).to_contain_text("bob: ")
    assert [view.robot.arbiter.mode for view in product.web.robots.values()] == [None] * 3
    second.close()


def test_robots_form_up_behind_a_leader_that_the_keys_drive_and_stop_ends_it(
    page: Page, product: Product
) -> None:
    def modes() -> list[str | None]:
        running = [view.robot.arbiter.mode for view in product.web.robots.values()]
        return [mode.name if mode else None for mode in running]

    page.keyboard.press("2")
    page.keyboard.press("Shift+Digit1")
    page.keyboard.press("Shift+Digit3")
    page.locator(".views [data-view=modes]").click()
    page.select_option("#group-leader", label="bob")
    page.fill("#form-spacing", "1.5")
    page.locator("#form-start").click()
    until(lambda: modes() == ["form", None, "form"])
    until(lambda: chosen(page) == [2])  # the leader alone obeys the keys from now on
    page.locator("#sheet-close").click()
    hold(page, "ArrowUp", lambda: min(speeds(product)) > 0.1)
    page.keyboard.press("Space")  # and all others that this page drives
    until(lambda: speeds(product) == [0.0] * 3)
    page.keyboard.up("ArrowUp")
    assert modes() == [None] * 3


def test_who_leaves_the_page_leaves_no_robot_driving(page: Page, product: Product) -> None:
    second = page.context.new_page()
    second.goto(product.address)
    wait_for_the_robot(second)
    second.keyboard.press("Shift+Digit2")
    second.keyboard.press("Shift+Digit3")
    second.locator(".views [data-view=modes]").click()
    second.fill("#spread-apart", "5")
    second.locator("#spread-start").click()
    until(lambda: max(speeds(product)) > 0.1)
    second.close()
    until(lambda: speeds(product) == [0.0] * 3)


def test_a_phone_chooses_several_in_the_list(tabs: Tabs, product: Product) -> None:
    with tabs.open(product.address, size=PHONE, touch=True) as page:
        wait_for_the_robot(page)
        assert_several_are_chosen(page)


def assert_several_are_chosen(page: Page) -> None:
    """Choose robots in the list with a finger."""
    page.locator("#robots-all").tap()
    page.locator("#robots-several").tap()
    page.locator(".robot-list").get_by_role("button", name="bob").tap()
    page.locator(".robot-list").get_by_role("button", name="carol").tap()
    assert chosen(page) == [1, 2, 3]
    page.locator("#robots-several").tap()  # one again
    assert chosen(page) == [1]
    page.locator("#robots-all").tap()  # it went back to the controls
    page.locator("#robots-choose-all").tap()
    assert chosen(page) == [1, 2, 3]
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
