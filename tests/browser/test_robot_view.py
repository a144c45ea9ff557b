"""Everything about one robot, in words."""

import pytest
from playwright.sync_api import Page, expect

from tests.browser.bench import Bench
from tests.browser.support import Product, later, until
from tests.browser.views import drive, open_view


@pytest.fixture
def view(page: Page) -> Page:
    """Open the robot's view."""
    open_view(page, "robot")
    return page


def value(page: Page, name: str) -> str:
    """Return the value beside a name."""
    return page.locator(f"#view-robot dt:text-is('{name}') + dd").inner_text()


def test_it_says_why_the_robot_does_not_move(view: Page, product: Product) -> None:
    why = view.locator("#view-robot .why-words")
    expect(why).to_contain_text("Nothing is asked of it")
    product.call(lambda: setattr(product.simulation.body, "stop_button", True))
    expect(why).to_contain_text("stop button on the robot is pressed")
    until(lambda: value(view, "Stop button") == "PRESSED")


def test_it_shows_what_is_commanded_and_measured(view: Page, product: Product) -> None:
    drive(view, product)
    until(lambda: value(view, "Commanded") == "0.30 m/s, 0.00 rad/s")
    until(lambda: value(view, "Measured").startswith("0.3"))
    until(lambda: value(view, "Left, right wheel").startswith("0.3"))
    expect(view.locator("#view-robot .why-words")).to_have_text("It moves.")
    view.keyboard.up("ArrowUp")


def test_it_says_who_decides(view: Page, product: Product) -> None:
    open_view(view, "modes")
    view.locator("#wander-start").click()
    open_view(view, "robot")
    expect(view.locator("#view-robot .lines-of-text")).to_contain_text("constant velocity")


def test_stalls_and_battery_are_words_not_colours_alone(view: Page, product: Product) -> None:
    until(lambda: value(view, "Left wheels") == "free")
    until(lambda: value(view, "Battery").endswith(" V"))
    until(lambda: "°C" in value(view, "Motor temperature"))


def test_bumpers_are_drawn_by_segment_and_told_in_words(desk_bench: Bench) -> None:
    """The page's part of it: a robot with bumpers is made up."""
    page = desk_bench.page
    page.evaluate("""async () => {
        const { BumperDrawing } = await import("/static/panels/widgets.js");
        const drawing = new BumperDrawing();
        drawing.show({ front: [false, true, false, false, true], rear: [false, false] });
        drawing.element.id = "made-up";
        document.body.prepend(drawing.element);
    }""")
    made_up = page.locator("#made-up")
    expect(made_up.locator(".hit")).to_have_count(2)
    expect(made_up.locator(".free")).to_have_count(5)
    expect(made_up.locator("p")).to_have_text(
        "Front: segment 2, 5 of 5 PRESSED, counted from the left. Rear: 2 segments, all free."
    )


def test_all_lines_of_the_controller_are_shown(view: Page, product: Product) -> None:
    expect(view.locator("[aria-label='Digital inputs'] li")).to_have_count(32)
    expect(view.locator("[aria-label='Digital outputs'] li")).to_have_count(8)
    first = view.locator("[aria-label='Digital outputs'] li").first
    lines = product.robot.devices.lines
    product.call(lambda: lines.set_output(0, high=False))
    expect(first.locator("b")).to_have_text("0")
    product.call(lambda: lines.set_output(0, high=True))
    expect(first.locator("b")).to_have_text("1")
    expect(view.locator("#view-robot")).to_contain_text("The robot has no gyro")


def test_the_link_is_judged_in_words(view: Page, product: Product) -> None:
    advice = view.locator("[aria-label='Advice about the link']")
    expect(advice).to_contain_text("reports/s of 10", timeout=10_000)
    expect(advice).to_contain_text("all good")
    product.simulation.robots[0].port.faults.corrupt = 0.01
    expect(advice).to_contain_text("Bytes change or vanish", timeout=15_000)
    expect(advice.locator("[data-level=fail], [data-level=warn]").first).to_be_visible()


def test_config_is_asked_for_when_it_is_opened(view: Page, product: Product) -> None:
    table = view.locator("#config")
    expect(table.locator("tbody tr")).to_have_count(0)
    view.locator("#config-open").focus()
    view.keyboard.press("Enter")
    expect(table.locator("tbody tr")).to_have_count(67)
    row = table.locator("tr", has=view.locator("th:text-is('sip_cycle')"))
    expect(row).to_contain_text("100 ms")
    expect(row).to_contain_text("between two information packets")
    view.locator("#config-again").click()
    expect(table.locator("[role=status]")).to_have_text("67 fields.")


def test_nothing_is_asked_of_the_robot_while_nobody_looks(page: Page, product: Product) -> None:
    station = next(iter(product.web.robots.values()))
    later(page, 6)
    assert station.details.channel.version == 0
    open_view(page, "robot")
    until(lambda: station.details.channel.version > 2)
    page.locator("#sheet-close").click()
    later(page, 6)
    version = station.details.channel.version
    later(page, 10)
    assert station.details.channel.version == version


def test_the_views_close_by_escape_and_give_the_focus_back(page: Page) -> None:
    opener = page.locator(".views [data-view=robot]")
    opener.focus()
    page.keyboard.press("Enter")
    expect(page.locator("#sheet")).to_be_visible()
    page.locator("#sheet-body").focus()
    page.keyboard.press("Escape")
    expect(page.locator("#sheet")).to_be_hidden()
    expect(opener).to_be_focused()
