"""Holds a class of robots that pages and programs drive, and looks at it."""

import asyncio
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.async_api import Page

from docs.plots.studio import PHONE, Size, Studio, product, until
from pioneer3 import PioneerError, connect_async
from pioneer3.tasks import running

DESK: Size = (1280, 800)
NAMES = (
    *("Anna", "Ben", "Carla", "Dmitri", "Elif", "Fay", "Gustav", "Hana", "Ivo"),
    *("Jo", "Kim", "Lea", "Max", "Noor", "Olu", "Pia", "Quinn"),
)
ROBOTS = 20
PROGRAMS = (2, 7, 11)
"""Robots that programs drive."""
DRIVING = 12.0
"""Long enough for trails [s]."""

DRIVEN = "state.robots.filter(({ snapshot }) => snapshot?.by === 'program').length"
"""Number of robots that programs drive."""


async def classroom(studio: Studio) -> None:
    """Let students join a class, and drive robots by pages and programs."""
    with TemporaryDirectory() as folder:
        command = "class", "--students", str(ROBOTS), "--folder", folder
        async with product(*command, folder=Path(folder)) as address:
            desk = await studio.open(f"{address}/class", size=DESK)
            await until(desk, "state.class?.join_url", "the link to the class")
            await desk.click("#invitation-small")
            link = await desk.evaluate("window.pioneer3.state.class.join_url")
            pages = [await join(studio, link, name) for name in NAMES]
            await until(desk, f"state.class.seats.length === {ROBOTS}", "a seat for each robot")
            await desk.wait_for_timeout(1000)
            await studio.take(desk, "class-link")
            await desk.click("#projector-close")
            urls = await desk.evaluate("window.pioneer3.state.class.seats.map(({ url }) => url)")
            async with running(*(circle(urls[number - 1]) for number in PROGRAMS)):
                await wander([page for n, page in enumerate(pages, 1) if n not in PROGRAMS])
                await pages[0].click("#details")
                await pages[0].click("#recording-begin")
                await desk.wait_for_timeout(500 * DRIVING)
                await until(desk, f"{DRIVEN} >= {len(PROGRAMS)}", "robots that programs drive")
                await studio.take(desk, "class")
                await studio.take(pages[1], "class-phone")


async def join(studio: Studio, link: str, name: str) -> Page:
    """Join the class with a phone; return its page."""
    page = await studio.open(link, size=PHONE)
    await page.fill("#name", name)
    await page.click("#join")
    await page.wait_for_url("**/")
    return page


async def wander(pages: list[Page]) -> None:
    """Let every second of the robots wander, from its own page."""
    for page in pages[::2]:
        await page.evaluate("document.getElementById('wander-start').click()")
    await pages[0].wait_for_timeout(500 * DRIVING)


async def circle(url: str) -> None:
    """Drive in circles, as a student's program, until cancelled."""
    while True:
        with suppress(PioneerError):  # the robot touched something, or the computer is busy
            async with connect_async(url) as robot:
                async for _ in robot.snapshots():
                    robot.drive(0.15, 0.4)
        await asyncio.sleep(0.5)
