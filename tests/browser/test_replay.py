"""Logs on the page: labelled, played by keys and by fingers, and nothing that drives is offered."""

import time
from collections.abc import AsyncIterator, Iterator
from contextlib import AsyncExitStack, asynccontextmanager
from pathlib import Path
from typing import Literal

import pytest
from playwright.sync_api import Page, expect

from pioneer3.log.index import LogIndex
from pioneer3.log.target import UserFolder
from pioneer3.log.writer import LogWriter
from pioneer3.models import load_model
from pioneer3.runtime.recording import RobotLog
from pioneer3.web.logs import PageLogs
from pioneer3.web.page import Page as WebPage
from pioneer3.web.replay.replay import LogPlayer
from pioneer3.web.server import serve
from tests.browser.support import Product, in_thread, until, wait_for_the_robot
from tests.browser.tabs import DESKTOP, Size, Tabs, no_complaints
from tests.browser.test_accessibility import faults
from tests.browser.test_sizes import CONTROLS, DESK, SIDEWAYS, UPRIGHT
from tests.browser.views import open_view
from tests.unit.web.replay.logs import BEGAN, SECOND, drive, snapshot
from tests.unit.web.replay.test_recorded import HALL

START = BEGAN / SECOND
DRIVES = "stop estop goto edit card-end mode-end reset lease-take speed turn wander-start"
"""Controls that the page of a robot has."""


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """Serve the replay of a robot that knows its place, and of one that does not."""
    paths = [drive(tmp_path / "alice.mcap", line_map=HALL), drive(tmp_path / "bob.mcap", begin=5)]

    @asynccontextmanager
    async def live() -> AsyncIterator[str]:
        page = WebPage()
        replay = LogPlayer([LogIndex(path) for path in paths], page.audiences)
        async with AsyncExitStack() as stack:
            await stack.enter_async_context(page.replaying(replay))
            yield (await stack.enter_async_context(serve(page, port=0))).http

    with in_thread(live()) as served:
        yield served


@pytest.fixture
def page(tabs: Tabs, address: str) -> Iterator[Page]:
    """Open the replay at desktop size; anything in the console fails the test."""
    with tabs.open(size=DESKTOP) as page, no_complaints(page):
        page.goto(address)
        wait_for_the_robot(page)
        yield page


def second(page: Page) -> float:
    """Return the time of the replay since its begin [s]."""
    return float(page.evaluate("window.pioneer3.state.replay")) - START


def is_at(page: Page, wanted: float) -> None:
    """Wait until a time since the begin is shown."""
    until(lambda: abs(second(page) - wanted) < 0.05)


def test_it_is_labelled_and_offers_nothing_that_drives(page: Page) -> None:
    expect(page.locator("#badge")).to_have_text("REPLAY")
    expect(page).to_have_title("REPLAY: alice")
    for view in ("robot", "plots", "modes"):
        open_view(page, view)
        for control in DRIVES.split():
            expect(page.locator(f"#{control}")).to_be_hidden()
        expect(page.locator("#badge")).to_be_visible()
    page.locator("#help-button").click()
    expect(page.locator("#view-help")).to_contain_text("nothing in it can be driven")
    for part in page.locator("#view-help :is(.for-robots, .for-drivers)").all():
        expect(part).to_be_hidden()


def test_keys_play_it_and_drive_nothing(page: Page) -> None:
    is_at(page, 0.0)
    for _ in range(2):
        page.keyboard.press("ArrowRight")
    is_at(page, 10.0)
    page.keyboard.press("Shift+ArrowLeft")
    is_at(page, 0.0)
    page.keyboard.press("End")
    is_at(page, 24.9)
    page.keyboard.press("Comma")
    expect(page.locator("#replay-mark")).to_contain_text("Link lost")
    is_at(page, 23.0)
    page.keyboard.press("Home")
    page.keyboard.press("Period")
    expect(page.locator("#replay-mark")).to_contain_text("alice: Wander began")
    is_at(page, 2.0)
    page.keyboard.press("ArrowUp")
    expect(page.locator("#replay-speed")).to_have_value("2")
    page.keyboard.press("Space")
    expect(page.locator("#replay-play")).to_have_attribute("aria-label", "Pause")
    until(lambda: second(page) > 3.5)
    page.keyboard.press("Space")
    expect(page.locator("#replay-play")).to_have_attribute("aria-label", "Play")
    for key in ("k", "w"):
        page.keyboard.press(key)
        expect(page.locator("#toast")).to_contain_text("This is a replay")
    page.keyboard.press("g")
    page.keyboard.press("e")
    expect(page.locator("#goto-card")).to_be_hidden()
    expect(page.locator("#editor")).to_be_hidden()


def test_the_line_is_scrubbed_and_shows_what_was(page: Page) -> None:
    box = page.locator("#replay-time").bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 12, middle)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], middle, steps=5)
    page.mouse.up()
    until(lambda: abs(second(page) - 12.45) < 0.3)
    expect(page.locator("#alarm")).to_be_visible()
    expect(page.locator("#latched-words")).to_contain_text("EMERGENCY STOP")
    expect(page.locator("#connection")).to_have_text("Connected")
    page.keyboard.press("End")
    expect(page.locator("#overlay-text")).to_have_text("The log tells nothing of it then")
    page.keyboard.press("Home")
    expect(page.locator("#alarm")).to_be_hidden()


def test_a_mark_tells_its_text_under_the_mouse(page: Page) -> None:
    box = page.locator("#replay-time").bounding_box()
    assert box is not None
    expect(page.locator("#replay-marks i[data-kind=emergency]").first).to_be_visible()
    x = box["x"] + 12 + 12.0 / 24.9 * (box["width"] - 24)
    page.mouse.move(x, box["y"] + box["height"] / 2)
    expect(page.locator("#replay-mark")).to_contain_text("alice: Emergency stop by ann")
    page.mouse.click(x, box["y"] + box["height"] / 2)
    is_at(page, 12.0)


def test_plots_are_of_the_time_that_is_shown(page: Page) -> None:
    open_view(page, "plots")
    page.keyboard.press("ArrowRight")
    is_at(page, 5.0)
    page.keyboard.press("Space")
    until(lambda: second(page) > 7.0)
    page.keyboard.press("Space")
    numbers = page.locator("#view-plots .numbers tr", has_text="Speed measured")
    until(lambda: "0.20" in (numbers.text_content() or ""))


@pytest.mark.parametrize(
    ("size", "scheme"),
    [
        pytest.param(DESK, "dark", id="desk"),
        pytest.param(UPRIGHT, "light", id="upright"),
        pytest.param(SIDEWAYS, "dark", id="sideways"),
        pytest.param((320, 568), "dark", id="smallest"),
    ],
)
def test_it_is_right_at_every_size(
    tabs: Tabs, address: str, size: Size, scheme: Literal["dark", "light"]
) -> None:
    phone = size != DESK
    with tabs.open(address, size=size, scheme=scheme, touch=phone, mobile=phone) as page:
        wait_for_the_robot(page)
        expect(page.locator("#replay-mark")).not_to_contain_text("Looking")
        assert faults(page) == []
        controls = page.evaluate(CONTROLS)
        assert [one["name"] for one in controls if not one["there"]] == []
        if phone:
            assert [one["name"] for one in controls if not one["wide"]] == []
        page.locator("#replay-play").click()
        until(lambda: second(page) > 1.0)
        page.locator("#replay-after").click()
        expect(page.locator("#replay-mark")).to_contain_text("Wander began")
        for view in ("robot", "modes"):
            open_view(page, view)
            assert faults(page) == [], view
            expect(page.locator("#badge")).to_be_in_viewport()
            expect(page.locator("#replay-play")).to_be_in_viewport()
        wide, room = page.evaluate(
            "[document.documentElement.scrollWidth, document.documentElement.clientWidth]"
        )
        assert wide <= room


def test_logs_are_saved_listed_and_replayed_from_the_page(
    tabs: Tabs, product: Product, tmp_path: Path
) -> None:
    def record() -> LogWriter:
        clock = product.loop.time
        product.web.logs = PageLogs(product.web.clients, tmp_path)
        writer = LogWriter(UserFolder(tmp_path, "run", 10**9, time.time), clock)
        product.web.clients.log = writer
        RobotLog(writer).snapshot(snapshot(0.0), load_model("p3dx-sh"))
        return writer

    drive(tmp_path / "2026-03-01T09-30-00Z-drive.mcap")
    writer = product.call(record)
    with tabs.open(product.address, size=UPRIGHT, touch=True, mobile=True) as page:
        wait_for_the_robot(page)
        open_view(page, "plots")
        page.locator("#logs summary").click()
        rows = page.locator(".logs-list li")
        expect(rows).to_have_count(2)
        expect(rows.nth(0)).to_contain_text("goes on")
        expect(rows.nth(0).get_by_role("link")).to_have_count(1)
        page.locator("#log-note").fill("stuck at the door")
        page.locator("#log-save").click()
        expect(rows).to_have_count(3)
        expect(rows.filter(has_text="stuck at the door")).to_contain_text("kept")
        assert faults(page) == []
        controls = page.evaluate(CONTROLS)
        assert [one["name"] for one in controls if one["scrolled"] and not one["wide"]] == []
        link = rows.filter(has_text="0:19 min").get_by_role("link", name="Replay")
        page.goto(product.address + (link.get_attribute("href") or ""))
        expect(page.locator("#badge")).to_have_text("REPLAY")
        expect(page.locator("#stop")).to_be_hidden()
        wait_for_the_robot(page)
    product.call(lambda: writer.close("done"))
