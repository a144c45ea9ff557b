"""Take the pictures of the page for docs/images: `python docs/plots/page.py docs/images`."""

import asyncio
import shutil
import sys
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from math import pi
from pathlib import Path

from playwright.async_api import Browser, ViewportSize, async_playwright

from pioneer3.geometry import Pose2
from pioneer3.navigation.connect import connect_async
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import RobotSpec, WorldFile, parse_equipment
from pioneer3.web.page import Page
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import serve

DESKTOP: ViewportSize = {"width": 1440, "height": 900}
PHONE: ViewportSize = {"width": 390, "height": 844}
ONE = WorldFile(name="office", map="office", robots=(RobotSpec(port=0),))
THREE = WorldFile(
    name="three",
    map="office",
    robots=(
        RobotSpec(model="p3at-sh", name="ann", port=0),
        RobotSpec(model="p3dx-sh", name="bob", start=Pose2(2.6, 7.0), port=0),
        RobotSpec(model="p3dx-sh", name="cid", start=Pose2(16.0, 7.4, pi), port=0),
    ),
)
WITH_LASER = WorldFile(
    name="office",
    map="office",
    robots=(RobotSpec(port=0, equipment=parse_equipment("laser=utm-30lx")),),
)
PLACES = (7.0, 5.1), (9.0, 7.05), (18.0, 7.0)
"""Where each of three is sent [m]."""
EXPLORING = 90.0
"""A few rooms have to be on the map [s]."""
WANDERING = 45.0
"""Something has to be seen in the plots [s]."""


async def pictures(folder: Path) -> None:
    """Look at one robot that wanders in the simulated office, and at three on their ways."""
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        async with serving(ONE) as address:
            await look(browser, address, folder)
        async with serving(WITH_LASER) as address:
            await look_at_the_laser(browser, address, folder)
        async with serving(ONE) as address:
            await look_at_a_map_that_is_made(browser, address, folder)
        async with serving(THREE) as address:
            await look_at_the_map(browser, address, folder)
        await browser.close()


@asynccontextmanager
async def serving(world: WorldFile) -> AsyncIterator[str]:
    """Run the world and its page; yield the address."""
    async with AsyncExitStack() as stack:
        running = await stack.enter_async_context(simulator(map_name=world, port=0))
        page, several = Page(), len(world.robots) > 1
        for one in running.robots:
            lasers = [one.laser.url] if one.laser else []
            robot = await stack.enter_async_context(connect_async(one.url, lasers=lasers))
            await stack.enter_async_context(
                page.hosting(robot, RobotScene.of(running, one), one.name if several else "")
            )
        served = await stack.enter_async_context(serve(page, port=0))
        yield served.http


async def look_at_the_map(browser: Browser, address: str, folder: Path) -> None:
    """Send two robots to places, and offer one to the third."""
    desk = await browser.new_page(viewport=DESKTOP, color_scheme="dark")
    await desk.goto(address)
    await desk.wait_for_timeout(2000)
    await desk.click("#layers")
    await desk.check("#layer-laser")
    await desk.click("#legend-close")
    canvas = desk.locator("#canvas")
    for number, (x, y) in enumerate(PLACES, start=1):
        await desk.keyboard.press(str(number))
        place = await desk.evaluate("([x, y]) => window.pioneer3.toScreen(x, y)", [x, y])
        await canvas.click(position=place)
        if number < len(PLACES):
            await desk.click("#goto-go")
    await desk.wait_for_timeout(4000)
    await canvas.screenshot(path=folder / "map.png")


async def look_at_the_laser(browser: Browser, address: str, folder: Path) -> None:
    """Take a picture of the map with the scan of a laser."""
    desk = await browser.new_page(viewport=DESKTOP, color_scheme="dark")
    await desk.goto(address)
    await desk.wait_for_timeout(3000)
    await desk.screenshot(path=folder / "page-laser.png")


async def look_at_a_map_that_is_made(browser: Browser, address: str, folder: Path) -> None:
    """Let the robot explore, and take a picture of what it has seen."""
    desk = await browser.new_page(viewport=DESKTOP, color_scheme="dark")
    await desk.goto(address)
    await desk.wait_for_timeout(2000)
    await desk.click(".views [data-view=modes]")
    await desk.click("#map-begin")
    await desk.wait_for_timeout(3000)
    await desk.click("#map-explore")
    await desk.wait_for_timeout(1000 * EXPLORING)
    await desk.screenshot(path=folder / "page-making-a-map.png")
    await desk.click("#map-discard")


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
