"""From a key in a real browser to the wire."""

import asyncio
import shutil
import time
from collections.abc import Iterator
from statistics import median

from playwright.async_api import Page, async_playwright

from benchmarks.simulator import simulator_process
from benchmarks.table import Row, percentile_99
from benchmarks.web_server import server_process
from benchmarks.web_wire import Wire, wire_to
from pioneer3.arcos import commands

KEYS = 60
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
NOW = "performance.timeOrigin + performance.now()"
LISTEN = """addEventListener("keydown", (event) => {
  window.pressedAt = performance.timeOrigin + event.timeStamp;
}, { capture: true })"""


async def _offset(page: Page) -> float:
    """Return the monotonic clock minus the browser's [s], from the quickest of some questions."""
    asked: list[tuple[float, float]] = []
    for _ in range(30):
        before = time.monotonic()
        there = await page.evaluate(NOW) / 1000
        after = time.monotonic()
        asked.append((after - before, (before + after) / 2 - there))
    return min(asked)[1]


async def _presses(page: Page, wire: Wire) -> list[float]:
    """Press and let go of a key; return how long each took to become a velocity [ms]."""
    took = []
    for number in range(KEYS):
        key = ("ArrowUp", "ArrowDown")[number % 2]
        arrival = wire.next(commands.Vel)
        await page.keyboard.down(key)
        at = await asyncio.wait_for(arrival, 5)
        pressed = await page.evaluate("window.pressedAt") / 1000 + await _offset(page)
        took.append((at - pressed) * 1000)
        await page.keyboard.up(key)
        await asyncio.sleep(0.4)
    return took


async def measure() -> list[float]:
    """Open the page in Chromium, and press."""
    with simulator_process() as url:
        async with wire_to(url) as wire, async_playwright() as playwright:
            context = server_process([wire.url])
            server = await asyncio.to_thread(context.__enter__)
            try:
                browser = await playwright.chromium.launch(
                    executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"]
                )
                page = await browser.new_page()
                await page.add_init_script(LISTEN)
                await page.goto(server.address)
                await asyncio.sleep(2)
                took = await _presses(page, wire)
                await browser.close()
            finally:
                await asyncio.to_thread(context.__exit__, None, None, None)
    return took


def rows_of_keys() -> Iterator[Row]:
    """Yield the figures; nothing where there is no Chromium."""
    if CHROMIUM is None:
        return
    took = asyncio.run(measure())
    yield Row("key in Chromium to velocity on the wire, median", median(took), "ms", 10)
    yield Row("key in Chromium to velocity on the wire, 99th", percentile_99(took), "ms", None)
