"""Take the pictures of the page for docs/images: `python docs/plots/page.py docs/images`."""

import asyncio
import shutil
import sys
from contextlib import AsyncExitStack
from pathlib import Path

from playwright.async_api import Browser, ViewportSize, async_playwright

from pioneer3.runtime.connect import connect_async
from pioneer3.runtime.simulation import simulator
from pioneer3.web.page import Page
from pioneer3.web.server import serve

DESKTOP: ViewportSize = {"width": 1440, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}
WANDERING = 45.0
"""Something has to be seen in the plots [s]."""


async def pictures(folder: Path) -> None:
    """Wander in the simulated office, and look."""
    async with AsyncExitStack() as stack:
        running = await stack.enter_async_context(simulator(port=0))
        robot = await stack.enter_async_context(connect_async(running.url))
        page = Page()
        await stack.enter_async_context(page.hosting(robot, running.scene))
        served = await stack.enter_async_context(serve(page, port=0))
        playwright = await stack.enter_async_context(async_playwright())
        browser = await playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        await look(browser, served.http, folder)
        await browser.close()


async def look(browser: Browser, address: str, folder: Path) -> None:
    """Open the views one after another, and take a picture of each."""
    desk = await browser.new_page(viewport=DESKTOP, color_scheme="dark")
    await desk.goto(address)
    await desk.wait_for_timeout(2000)
    await desk.screenshot(path=folder / "page.png")
    await desk.click(".views [data-view=modes]")
    await desk.select_option("#wander-preset", "aria")
    await desk.click("#wander-start")
    await desk.wait_for_timeout(3000)
    await desk.screenshot(path=folder / "page-modes.png")
    await desk.click(".views [data-view=plots]")
    await desk.wait_for_timeout(1000 * WANDERING)
    await desk.screenshot(path=folder / "page-plots.png")
    await desk.click(".views [data-view=robot]")
    await desk.wait_for_timeout(1500)
    await desk.screenshot(path=folder / "page-robot.png")
    phone = await browser.new_page(viewport=PHONE, color_scheme="light", has_touch=True)
    await phone.goto(address)
    await phone.wait_for_timeout(2000)
    await desk.keyboard.press("k")
    await phone.click("#details")
    await phone.wait_for_timeout(1500)
    await phone.screenshot(path=folder / "page-phone-stopped.png")


if __name__ == "__main__":
    asyncio.run(pictures(Path(sys.argv[1])))
