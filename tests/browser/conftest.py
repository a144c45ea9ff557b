"""The real page, served by the real server, in headless Chromium."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect, sync_playwright

from tests.browser.bench import Bench, bench_in, bench_tab, served
from tests.browser.support import PATIENCE, Product, running_product, until, wait_for_the_robot
from tests.browser.tabs import DESKTOP, Tabs, no_complaints

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser")
CHROMIUM = next(filter(None, map(shutil.which, NAMES)), None)
"""The shell has no window of its own: a page costs a third of the time."""
OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",  # WebGL by the processor, without a word in the console
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--disable-background-timer-throttling",
    "--disable-backgrounding-occluded-windows",
    "--disable-renderer-backgrounding",
    "--disable-ipc-flooding-protection",
    "--disable-features=HttpsUpgrades,HttpsFirstBalancedModeAutoEnable,PaintHolding",
    "--force-color-profile=srgb",
    "--hide-scrollbars",
    "--mute-audio",
    # a mouse, which headless browsers do not have: hover and fine pointer
    "--blink-settings=primaryHoverType=2,availableHoverTypes=2,"
    "primaryPointerType=4,availablePointerTypes=4",
)

HERE = Path(__file__).parent
UNTIL_END_OF_INPUT = '"$@" & read -r _; kill -s KILL -- -$$'
"""Runs a command until its input ends, which it does with this process, however that ends."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark all tests of the browser: pages, server and robot run in real time."""
    for item in items:
        if item.path.is_relative_to(HERE):
            item.add_marker(pytest.mark.realtime)


@pytest.fixture
def product() -> Iterator[Product]:
    """Run the product; every test gets its own."""
    with running_product() as product:
        yield product


@pytest.fixture
def shared() -> Iterator[Product]:
    """Run the product on every address."""
    with running_product(host="0.0.0.0") as product:
        yield product


@pytest.fixture(scope="session")
def chromium(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Run one Chromium for all tests of this process; return the address of its DevTools."""
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed")
    profile = tmp_path_factory.mktemp("chromium")
    options = (*OPTIONS, f"--user-data-dir={profile}", "--remote-debugging-port=0")
    command = ["sh", "-c", UNTIL_END_OF_INPUT, "sh", CHROMIUM, *options]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True
    ):
        port = profile / "DevToolsActivePort"
        until(lambda: _written(port))
        yield f"http://127.0.0.1:{port.read_text().splitlines()[0]}"


def _written(path: Path) -> bool:
    return path.exists() and path.read_text().count("\n") > 0


@pytest.fixture(scope="module")
def tabs(chromium: str) -> Iterator[Tabs]:
    """Connect to Chromium once a file: while connected, no other test can have an event loop."""
    expect.set_options(timeout=1000 * PATIENCE)
    with sync_playwright() as playwright:
        browser = playwright.chromium.connect_over_cdp(chromium)
        yield Tabs(browser)
        browser.close()


@pytest.fixture(scope="session")
def bench_address() -> Iterator[str]:
    """Serve the inputs of the page alone."""
    with served() as address:
        yield address


@pytest.fixture(scope="module")
def desk_tab(tabs: Tabs) -> Iterator[Page]:
    """Open a tab for :func:`desk_bench`."""
    with bench_tab(tabs, phone=False) as page:
        yield page


@pytest.fixture(scope="module")
def phone_tab(tabs: Tabs) -> Iterator[Page]:
    """Open a tab for :func:`phone_bench`."""
    with bench_tab(tabs, phone=True) as page:
        yield page


@pytest.fixture
def desk_bench(desk_tab: Page, bench_address: str) -> Iterator[Bench]:
    """Sit at the inputs of the page, with keyboard, mouse and a socket for gamepads."""
    with bench_in(desk_tab, bench_address) as bench:
        yield bench


@pytest.fixture
def phone_bench(phone_tab: Page, bench_address: str) -> Iterator[Bench]:
    """Hold a phone with the inputs of the page."""
    with bench_in(phone_tab, bench_address) as bench:
        yield bench


@pytest.fixture
def page(tabs: Tabs, product: Product) -> Iterator[Page]:
    """Open the page at desktop size; anything in the console fails the test."""
    with tabs.open(size=DESKTOP) as page, no_complaints(page):
        page.goto(product.address)
        wait_for_the_robot(page)
        yield page
