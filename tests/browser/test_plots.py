"""Plots: what was commanded and measured over the last minutes."""

import csv
from io import StringIO
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.browser.conftest import Product
from tests.browser.test_page import until
from tests.browser.views import drive, open_view

COLUMNS = [
    "time",
    "speed commanded [m/s]",
    "speed measured [m/s]",
    "turn rate commanded [rad/s]",
    "turn rate measured [rad/s]",
    "battery [V]",
    "nearest echo in front [m]",
]
INK = """(canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let inked = 0;
    for (let i = 3; i < data.length; i += 4) inked += data[i] > 0;
    return inked;
}"""


@pytest.fixture
def plots(page: Page, product: Product) -> Page:
    """Drive for a moment, then open the plots."""
    drive(page, product)
    page.wait_for_timeout(800)
    page.keyboard.up("ArrowUp")
    open_view(page, "plots")
    return page


def shown(page: Page, chart: int) -> list[str]:
    """Return the values above a chart."""
    return page.locator(".chart").nth(chart).locator(".key-of-line b").all_inner_texts()


def cell(page: Page, row: str, column: int) -> str:
    """Return a cell of the table."""
    line = page.locator("table.numbers tbody tr", has=page.locator(f"th:text-is('{row}')"))
    return line.locator("td").nth(column).inner_text()


def test_there_is_a_chart_for_each_with_lines_in_it(plots: Page) -> None:
    titles = plots.locator(".chart-title").all_inner_texts()
    assert [title.split()[0] for title in titles] == ["Speed", "Turn", "Battery", "Nearest"]
    for chart in range(4):
        canvas = plots.locator(".chart canvas").nth(chart)
        assert canvas.evaluate(INK) > 1000


def test_values_are_told_as_text_too(plots: Page) -> None:
    until(lambda: cell(plots, "Speed commanded [m/s]", 2) == "0.30")
    until(lambda: cell(plots, "Speed commanded [m/s]", 0) == "0.00")
    assert float(cell(plots, "Speed measured [m/s]", 2)) == pytest.approx(0.3, abs=0.03)
    label = plots.locator(".chart-picture").first.get_attribute("aria-label") or ""
    assert "Speed over the last five minutes" in label
    assert "between 0.00 and 0.30" in label


def test_the_mouse_shows_the_values_under_it_in_all_charts(plots: Page) -> None:
    plots.wait_for_timeout(500)
    before = [shown(plots, chart) for chart in range(4)]
    assert before[0][0] == "0.00"
    seen = set()
    box = plots.locator(".chart .u-over").first.bounding_box()
    assert box is not None
    for pixels in range(1, 30):  # the drive is in the last seconds: a few pixels
        plots.mouse.move(box["x"] + box["width"] - pixels, box["y"] + box["height"] / 2)
        seen.add(shown(plots, 0)[0])
    assert "0.30" in seen
    plots.mouse.move(10, 300)
    until(lambda: shown(plots, 0)[0] == "0.00")


def test_the_slider_shows_the_values_of_a_moment_without_a_mouse(
    plots: Page, product: Product
) -> None:
    slider = plots.locator("#plots-look")
    slider.focus()
    seen = set()
    for _ in range(6):
        plots.keyboard.press("ArrowLeft")
        seen.add(shown(plots, 0)[0])
    assert "0.30" in seen
    assert slider.get_attribute("aria-valuetext") == "of 6 seconds before"
    assert product.robot.supervisor.pilot.sent is not None  # arrows of the slider do not drive
    assert product.robot.supervisor.pilot.sent.is_zero
    plots.keyboard.press("End")
    until(lambda: shown(plots, 0)[0] == "0.00")


def test_a_pause_holds_the_picture_and_history_goes_on(plots: Page, product: Product) -> None:
    plots.locator("#plots-pause").click()
    expect(plots.locator("#plots-pause")).to_have_attribute("aria-pressed", "true")
    drive(plots, product)
    plots.wait_for_timeout(500)
    assert shown(plots, 0)[0] == "0.00"
    plots.keyboard.up("ArrowUp")
    plots.locator("#plots-pause").click()
    expect(plots.locator("#plots-pause")).to_have_text("Pause")
    until(lambda: shown(plots, 0)[1] != "\u2013")


def test_the_history_is_downloaded_as_csv(plots: Page, tmp_path: Path) -> None:
    with plots.expect_download() as downloading:
        plots.locator("#plots-save").click()
    download = downloading.value
    assert download.suggested_filename.startswith("MobileSim-")
    download.save_as(tmp_path / "plots.csv")
    rows = list(csv.reader(StringIO((tmp_path / "plots.csv").read_text())))
    assert rows[0] == COLUMNS
    assert len(rows) > 10
    assert max(float(row[1] or 0) for row in rows[1:]) == pytest.approx(0.3)
    times = [row[0] for row in rows[1:]]
    assert times == sorted(times)


def test_the_plots_follow_light_and_dark(plots: Page) -> None:
    def inks() -> str:
        return str(plots.locator(".chart canvas").first.evaluate("(c) => c.toDataURL()"))

    plots.locator("#plots-pause").click()
    plots.emulate_media(color_scheme="dark")
    plots.wait_for_timeout(300)
    dark = inks()
    plots.emulate_media(color_scheme="light")
    plots.wait_for_timeout(300)
    assert inks() != dark


def test_history_forgets_what_is_old_and_breaks_lines_where_nothing_was_heard(page: Page) -> None:
    counts = page.evaluate("""async () => {
        const { History } = await import("/static/panels/history.js");
        const history = new History();
        const robot = { sonars: [{ theta: 0 }, { theta: 3 }], sonar_max: 5 };
        const one = (v) => ({
            twist: { v, w: 0 }, commanded: null, battery: { voltage: 12 },
            sonar: { enabled: true, ranges: [2.5, 0.4] },
        });
        for (let i = 0; i < 20000; i += 1) history.add(one(i), robot, i / 10);
        const kept = history.length;
        history.add(one(1), robot, 2100);
        return {
            kept,
            first: history.columns[0][0],
            gap: history.columns[2].at(-2),
            front: history.columns[6].at(-1),
            battery: history.battery.length,
            none: history.summary(0, 0, 9999),
            mean: history.summary(4, 0, 9999).mean,
        };
    }""")
    assert 3000 <= counts["kept"] <= 3400
    assert counts["gap"] is None
    assert counts["front"] == 2.5  # what is behind does not count
    assert counts["battery"] == 201
    assert counts["none"] is None
    assert counts["mean"] == 12
