"""Take the pictures of a class for docs/images: `python docs/plots/classroom.py docs/images`."""

import asyncio
import re
import shutil
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.async_api import Browser, Page, ViewportSize, async_playwright

from pioneer3 import PioneerError, connect_async
from pioneer3.tasks import running

DESKTOP: ViewportSize = {"width": 1280, "height": 800}
PHONE: ViewportSize = {"width": 390, "height": 844}
NAMES = (
    *("Anna", "Ben", "Carla", "Dmitri", "Elif", "Fay", "Gustav", "Hana", "Ivo"),
    *("Jo", "Kim", "Lea", "Max", "Noor", "Olu", "Pia", "Quinn"),
)
ROBOTS = 20
PROGRAMS = (2, 7, 11)
"""Robots that programs drive."""
DRIVING = 12.0
"""Long enough for trails [s]."""


async def pictures(folder: Path) -> None:
    """Hold a class, and look at it."""
    async with class_of(ROBOTS) as address, async_playwright() as playwright:
        browser = await playwright.chromium.launch(
            executable_path=shutil.which("chromium-headless-shell") or shutil.which("chromium"),
            args=["--no-sandbox", "--disable-gpu"],
        )
        desk = await browser.new_page(viewport=DESKTOP, color_scheme="dark")
        await desk.goto(f"{address}/class")
        await desk.click("#invitation-small")
        link = await desk.evaluate("window.pioneer3.state.class.join_url")
        pages = [await join(browser, link, name) for name in NAMES]
        await desk.wait_for_timeout(1000)
        await desk.screenshot(path=folder / "class-link.png")
        await desk.click("#projector-close")
        urls = await desk.evaluate("window.pioneer3.state.class.seats.map(({ url }) => url)")
        async with running(*(drive(urls[number - 1]) for number in PROGRAMS)):
            await wander([page for n, page in enumerate(pages, 1) if n not in PROGRAMS])
            await record(pages[0])
            await desk.wait_for_timeout(500 * DRIVING)
            await desk.screenshot(path=folder / "class.png")
            await pages[1].screenshot(path=folder / "class-phone.png")
        await browser.close()


@asynccontextmanager
async def class_of(robots: int) -> AsyncIterator[str]:
    """Run a class; yield the address of its pages."""
    with TemporaryDirectory() as folder:
        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "pioneer3", "class", "--students", str(robots)),
            *("--web-port", "0", "--sim-port", "0", "--folder", folder),
            stdout=asyncio.subprocess.PIPE,
        )
        assert process.stdout is not None
        try:
            async for line in process.stdout:
                if found := re.search(r"(http://\S+)/class", line.decode()):
                    yield found[1]
                    break
        finally:
            process.terminate()
            await process.wait()


async def join(browser: Browser, link: str, name: str) -> Page:
    """Join the class with a phone; return its page."""
    context = await browser.new_context(viewport=PHONE, color_scheme="light", has_touch=True)
    page = await context.new_page()
    await page.goto(link)
    await page.fill("#name", name)
    await page.click("#join")
    await page.wait_for_url("**/")
    return page


async def wander(pages: list[Page]) -> None:
    """Let every second of the robots wander, from its own page."""
    for page in pages[::2]:
        await page.evaluate("document.getElementById('wander-start').click()")
    await pages[0].wait_for_timeout(500 * DRIVING)


async def record(page: Page) -> None:
    """Begin to record."""
    await page.click("#details")
    await page.click("#recording-begin")


async def drive(url: str) -> None:
    """Drive in circles, as a student's program, until cancelled."""
    while True:
        with suppress(PioneerError):  # the robot touched something, or the computer is busy
            async with connect_async(url) as robot:
                async for _ in robot.snapshots():
                    robot.drive(0.15, 0.4)


if __name__ == "__main__":
    asyncio.run(pictures(Path(sys.argv[1])))
