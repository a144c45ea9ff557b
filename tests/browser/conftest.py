"""The real page, served by the real server, in headless Chromium."""

import asyncio
import shutil
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from concurrent.futures import Future
from contextlib import (
    AbstractAsyncContextManager,
    AsyncExitStack,
    asynccontextmanager,
    contextmanager,
)
from dataclasses import dataclass
from typing import TypeVar

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from pioneer3.runtime.connect import connect_async
from pioneer3.runtime.robot import Robot
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import WorldFile
from pioneer3.web.live import PATIENT
from pioneer3.web.page import Page as WebPage
from pioneer3.web.scene import Scene
from pioneer3.web.server import serve

T = TypeVar("T")
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


@dataclass(frozen=True)
class Product:
    """A simulator, the driver and the page, in a thread of their own."""

    address: str
    simulation: RunningSimulation
    robot: Robot
    web: WebPage
    loop: asyncio.AbstractEventLoop

    def call(self, act: Callable[[], T]) -> T:
        """Return what `act` returns in the product's thread."""

        async def run() -> T:
            return act()

        return asyncio.run_coroutine_threadsafe(run(), self.loop).result(20)


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


@contextmanager
def running_product(
    *,
    editable: bool = True,
    host: str = "127.0.0.1",
    port: int = 0,
    world: WorldFile | str | None = None,
) -> Iterator[Product]:
    """Run the product while the block lasts; not editable, it is like one with a real robot.

    All robots of `world` are connected; in a map, of which it may be the name, and in the office,
    which is taken without one, there is a P3-AT.
    """

    @asynccontextmanager
    async def live() -> AsyncIterator[Product]:
        async with AsyncExitStack() as stack:
            running = await stack.enter_async_context(simulator(map_name=world or "office", port=0))
            web = WebPage()
            for one in running.robots:
                robot = await stack.enter_async_context(connect_async(one.url, timing=PATIENT))
                scene = Scene.of(running, one) if editable else Scene(running.world.map)
                name = one.name if len(running.robots) > 1 else ""
                await stack.enter_async_context(web.hosting(robot, scene, name))
            served = await stack.enter_async_context(serve(web, host=host, port=port))
            first = web.robots[1].robot
            yield Product(served.http, running, first, web, asyncio.get_running_loop())

    with in_thread(live()) as product:
        yield product


@contextmanager
def in_thread(live: AbstractAsyncContextManager[T]) -> Iterator[T]:
    """Enter `live` in a thread of its own, with a loop of its own, while the block lasts."""
    ready: Future[T] = Future()
    loop = asyncio.new_event_loop()
    leave = asyncio.Event()

    async def run() -> None:
        async with live as value:
            ready.set_result(value)
            await leave.wait()

    thread = threading.Thread(target=loop.run_until_complete, args=(run(),))
    thread.start()
    try:
        yield ready.result(20)
    finally:
        loop.call_soon_threadsafe(leave.set)
        thread.join()
        loop.close()


def wait_for_the_robot(page: Page) -> None:
    """Wait until the page shows a snapshot; by asking, for its CSP forbids injected pollers."""
    for _ in range(200):
        if page.evaluate("Boolean(window.pioneer3?.state.snapshot)"):
            return
        page.wait_for_timeout(50)
    raise AssertionError("the page shows no robot")


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Start Chromium once a file: while it runs, no other test can have an event loop."""
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
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
    assert complaints == []
