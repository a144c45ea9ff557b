"""The simulator, the driver and the page in a thread, and waits for what they do."""

import asyncio
import os
import threading
import time
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

from playwright.sync_api import Error, Page

from pioneer3.errors import PortBusyError
from pioneer3.navigation.connect import connect_async
from pioneer3.runtime.robot import Robot
from pioneer3.sim.server.running import RunningSimulation
from pioneer3.sim.server.start import simulator
from pioneer3.sim.worldfile import WorldFile
from pioneer3.web.live import PATIENT
from pioneer3.web.page import Page as WebPage
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import Served, serve

T = TypeVar("T")
SLACK = 0.25
"""A shared machine may lose this much [s] on top of a limit."""
LOOK = 0.01
"""Time between two looks at a condition [s]."""
PATIENCE = 30.0
"""How long a busy machine may take for anything without a limit [s]."""


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


@contextmanager
def running_product(
    *,
    editable: bool = True,
    host: str = "127.0.0.1",
    port: int | None = None,
    world: WorldFile | str | None = None,
) -> Iterator[Product]:
    """Run the product while the block lasts; not editable, it is like one with a real robot.

    All robots of `world` are connected; in a map, of which it may be the name, and in the office,
    which is taken without one, there is a P3-AT. Their lasers are connected too. Without a `port`,
    all products of this process have the same, so that browsers need not load all of it anew.
    """

    @asynccontextmanager
    async def live() -> AsyncIterator[Product]:
        async with AsyncExitStack() as stack:
            running = await stack.enter_async_context(simulator(map_name=world or "office", port=0))
            web = WebPage()
            for one in running.robots:
                lasers = [one.laser.url] if one.laser else []
                robot = await stack.enter_async_context(
                    connect_async(
                        one.url,
                        timing=PATIENT,
                        lasers=lasers,
                        camera=one.camera.url if one.camera else None,
                    )
                )
                scene = RobotScene.of(running, one) if editable else RobotScene(running.world.map)
                name = one.name if len(running.robots) > 1 else ""
                await stack.enter_async_context(web.hosting(robot, scene, name))
            served = await _served(stack, web, host, port)
            first = web.robots[1].robot
            yield Product(served.http, running, first, web, asyncio.get_running_loop())

    with in_thread(live()) as product:
        yield product


async def _served(stack: AsyncExitStack, web: WebPage, host: str, port: int | None) -> Served:
    own = 20_000 + os.getpid() % 10_000  # below those that connections take
    try:
        return await stack.enter_async_context(serve(web, host=host, port=port or own))
    except PortBusyError:
        if port is not None:
            raise
        return await stack.enter_async_context(serve(web, host=host, port=0))


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


def speed(product: Product) -> float:
    """Return how fast the simulated robot really moves [m/s]."""
    return abs(product.simulation.body.speeds[0])


def until(condition: Callable[[], bool], patience: float = PATIENCE) -> float:
    """Wait for `condition`; return how long that took [s].

    The time for which a busy machine let this test wait for its turn does not count.
    """
    began = time.monotonic()
    lost = 0.0
    while not condition():
        asleep = time.monotonic()
        assert asleep - began < patience
        time.sleep(LOOK)
        lost += time.monotonic() - asleep - LOOK
    return time.monotonic() - began - lost


def hold(page: Page, key: str, moving: Callable[[], bool]) -> None:
    """Press a key and hold it until the robot is `moving`.

    A page that has no news from the robot for a second, as on a busy machine, refuses the press or
    releases the key: it is pressed again then.
    """
    hold_by(page, lambda: page.keyboard.up(key), lambda: page.keyboard.down(key), moving)


def hold_by(
    page: Page, release: Callable[[], None], press: Callable[[], None], moving: Callable[[], bool]
) -> None:
    """Hold any input of the page as :func:`hold` does a key."""

    def held() -> bool:
        if page.evaluate("window.pioneer3.state.source") is None:
            release()
            press()
        return moving()

    until(held)


def wait_for_the_robot(page: Page) -> None:
    """Wait until the page shows a snapshot; by asking, for its CSP forbids injected pollers."""

    def has_snapshot() -> bool:
        try:
            return bool(page.evaluate("Boolean(window.pioneer3?.state.snapshot)"))
        except Error:  # the page is just being replaced
            return False

    until(has_snapshot)


def later(page: Page, reports: int = 4) -> None:
    """Wait until the robot has reported so often again, ten times a second when all is well.

    What was asked of it before has had its effect by then.
    """
    count = "window.pioneer3.state.snapshot.link.reports"
    first = page.evaluate(count)
    until(lambda: bool(page.evaluate(count) >= first + reports))
