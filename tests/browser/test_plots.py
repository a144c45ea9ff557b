"""Plots: what was commanded and measured over the last minutes."""

import csv
from io import StringIO
from math import exp
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.browser.bench import Bench
from tests.browser.drawn import repaint
from tests.browser.support import Product, hold, later, until
from tests.browser.views import drive, open_view

COLUMNS = [
    "time",
    "elapsed [s]",
    "x [m]",
    "y [m]",
    "heading [rad]",
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
    body = product.simulation.body
    hold(page, "ArrowUp", lambda: body.robot_in_world.x > body.home.x + 0.25)
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
    assert "Speed over the last 10 seconds" in label
    assert "between 0.00 and 0.30" in label


def test_the_mouse_shows_the_values_under_it_in_all_charts(plots: Page) -> None:
    until(lambda: shown(plots, 0)[0] == "0.00")
    seen = set()
    box = plots.locator(".chart .u-over").first.bounding_box()
    assert box is not None
    for pixels in range(1, int(box["width"]), 4):
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
    later(plots)
    assert shown(plots, 0)[0] == "0.00"
    plots.keyboard.up("ArrowUp")
    plots.locator("#plots-pause").click()
    expect(plots.locator("#plots-pause")).to_have_text("Pause")
    until(lambda: shown(plots, 0)[1] != "\u2013")


def test_the_history_is_downloaded_as_csv(plots: Page, product: Product, tmp_path: Path) -> None:
    with plots.expect_download() as downloading:
        plots.locator("#plots-save").click()
    download = downloading.value
    assert download.suggested_filename.startswith("Pioneer-3-AT-")
    download.save_as(tmp_path / "plots.csv")
    rows = list(csv.reader(StringIO((tmp_path / "plots.csv").read_text())))
    assert rows[0] == COLUMNS
    assert len(rows) > 10
    columns = {
        name: [float(row[at] or 0) for row in rows[1:]] for at, name in enumerate(COLUMNS) if at
    }
    assert max(columns["speed commanded [m/s]"]) == pytest.approx(0.3)
    truth, home = product.simulation.body.robot_in_world, product.simulation.body.home
    assert columns["x [m]"][0] == pytest.approx(home.x, abs=0.01)
    assert columns["x [m]"][-1] == pytest.approx(truth.x, abs=0.02)
    assert columns["x [m]"][-1] > home.x + 0.1
    assert columns["y [m]"][-1] == pytest.approx(truth.y, abs=0.02)
    assert columns["heading [rad]"][-1] == pytest.approx(truth.theta, abs=0.02)
    assert columns["elapsed [s]"][0] == 0
    assert columns["elapsed [s]"] == sorted(columns["elapsed [s]"])
    assert all(len(value) < 12 for row in rows[1:] for value in row[1:])  # no digits of noise
    times = [row[0] for row in rows[1:]]
    assert times == sorted(times)


def test_the_time_axis_grows_with_the_data(desk_bench: Bench) -> None:
    page = desk_bench.page
    spans = page.evaluate("""async () => {
        const { TimeAxis } = await import("/static/panels/time_axis.js");
        const axis = new TimeAxis(() => {});
        return [0, 3, 15, 45, 100, 200, 4000].map((age) => (axis.note(1e6 + age, 1e6), axis.span));
    }""")
    assert spans == [10, 10, 20, 60, 120, 300, 300]


def test_the_time_axis_is_zoomed_and_moved_by_buttons(plots: Page) -> None:
    slider = plots.locator("#plots-look")
    expect(slider).to_have_attribute("min", "-10")
    for name in ("later", "all"):
        expect(plots.locator(f"#plots-{name}")).to_be_disabled()
    plots.locator("#plots-in").press("Enter")
    expect(slider).to_have_attribute("min", "-5")
    plots.locator("#plots-in").press("Enter")
    expect(slider).to_have_attribute("min", "-2")
    plots.locator("#plots-earlier").press("Enter")
    expect(plots.locator("#plots-later")).to_be_enabled()
    plots.locator("#plots-later").press("Enter")
    plots.locator("#plots-later").press("Enter")
    expect(plots.locator("#plots-later")).to_be_disabled()
    plots.locator("#plots-out").press("Enter")
    expect(slider).to_have_attribute("min", "-5")
    plots.locator("#plots-all").press("Enter")
    expect(slider).to_have_attribute("min", "-10")


AXIS = """async () => {
  const { TimeAxis } = await import("/static/panels/time_axis.js");
  const box = document.createElement("div");
  const plot = document.createElement("div");
  plot.className = "u-over";
  Object.assign(box.style, { position: "fixed", inset: "100px auto auto 100px", zIndex: 9 });
  Object.assign(plot.style, { width: "300px", height: "100px", touchAction: "pan-y" });
  box.append(plot);
  document.body.append(box);
  window.axis = new TimeAxis(() => {});
  window.axis.listen(box);
  window.axis.note(1000, 0);
}"""
"""A time axis of 300 s, a second a pixel, from 700 at 100 px to 1000 at 400 px."""


def shown_times(page: Page) -> list[float]:
    """Return the first and the last time of :data:`AXIS` [s]."""
    times: list[float] = page.evaluate("[window.axis.from, window.axis.to]")
    return times


def test_the_mouse_moves_and_zooms_the_time_axis(desk_bench: Bench) -> None:
    page = desk_bench.page
    page.evaluate(AXIS)
    page.mouse.move(250, 150)
    page.mouse.down()
    page.mouse.move(350, 150, steps=4)
    page.mouse.up()
    assert shown_times(page) == pytest.approx([600, 900], abs=1)
    page.mouse.move(200, 150)
    page.mouse.wheel(0, -100)  # alone it scrolls
    desk_bench.wait(100)
    assert shown_times(page) == pytest.approx([600, 900], abs=1)
    page.keyboard.down("Control")
    page.mouse.wheel(0, -500)
    page.keyboard.up("Control")
    until(lambda: shown_times(page)[0] > 601)
    first, last = shown_times(page)
    assert last - first == pytest.approx(300 * exp(-1), rel=0.01)
    assert first + (last - first) / 3 == pytest.approx(700, abs=1)  # under the mouse
    page.mouse.wheel(60, 0)
    until(lambda: shown_times(page)[0] == pytest.approx(first + 60 * exp(-1), abs=1))
    page.mouse.dblclick(250, 150)
    assert shown_times(page) == [700, 1000]


def test_fingers_move_and_zoom_the_time_axis(desk_bench: Bench) -> None:
    page = desk_bench.page
    page.evaluate(AXIS)

    def touch(kind: str, *xs: float) -> None:
        desk_bench.touch(kind, *((x, 150) for x in xs))

    touch("touchStart", 200)
    for x in (220, 260, 300):  # the browser keeps the first pixels to itself
        touch("touchMove", x)
    touch("touchEnd")
    assert shown_times(page) == pytest.approx([600, 900], abs=25)
    page.evaluate("window.axis.reset()")
    touch("touchStart", 200)
    touch("touchStart", 200, 300)
    for by in (20, 40, 50):
        touch("touchMove", 200 - by, 300 + by)
    touch("touchEnd")
    first, last = shown_times(page)
    assert last - first == pytest.approx(150, rel=0.2)
    assert (first + last) / 2 == pytest.approx(850, abs=15)


def test_the_plots_follow_light_and_dark(plots: Page) -> None:
    def inks() -> str:
        return str(plots.locator(".chart canvas").first.evaluate("(c) => c.toDataURL()"))

    plots.locator("#plots-pause").click()
    plots.emulate_media(color_scheme="dark")
    repaint(plots)
    dark = inks()
    plots.emulate_media(color_scheme="light")
    until(lambda: inks() != dark)


def test_history_forgets_what_is_old_and_breaks_lines_where_nothing_was_heard(
    desk_bench: Bench,
) -> None:
    page = desk_bench.page
    counts = page.evaluate("""async () => {
        const { History } = await import("/static/panels/history.js");
        const history = new History();
        const robot = { sonars: [{ theta: 0 }, { theta: 3 }], sonar_max: 5 };
        const one = (v) => ({
            twist: { v, w: 0 }, commanded: null, battery: { voltage: 12 },
            sonar: { enabled: true, ranges: [2.5, 0.4] }, robot_in_map: { x: 1, y: 2, theta: 0 },
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
