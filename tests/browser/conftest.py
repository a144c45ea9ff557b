"""The real page, served by the real server, in headless Chromium."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from tests.browser.support import Product, running_product, until, wait_for_the_robot

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

OF_THE_RENDERER = "GL Driver Message"
"""Part of the console's warnings that WebGL by the processor reads pixels slowly."""
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
def browser(chromium: str) -> Iterator[Browser]:
    """Connect to Chromium once a file: while connected, no other test can have an event loop."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.connect_over_cdp(chromium)
        yield browser
        browser.close()


@pytest.fixture
def page(browser: Browser, product: Product) -> Iterator[Page]:
    """Open the page at desktop size; anything in the console fails the test."""
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    page = context.new_page()
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(product.address)
    wait_for_the_robot(page)
    yield page
    context.close()
    assert [text for text in complaints if OF_THE_RENDERER not in text] == []
