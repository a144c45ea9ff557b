"""A robot in a notebook: its cells, in a real kernel of Jupyter, against a simulator."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Any

import pytest
from jupyter_client.asynchronous.client import AsyncKernelClient
from jupyter_client.manager import AsyncKernelManager

from tests.e2e.test_ways_out import BYE, SOON, Site, running, said_goodbye

pytestmark = [pytest.mark.realtime, pytest.mark.thorough]
CONNECT = "from pioneer3 import connect\nrobot = connect({url!r})"


class Notebook:
    """A kernel, and the cells that run in it."""

    def __init__(self, manager: AsyncKernelManager, client: AsyncKernelClient) -> None:
        self.manager, self.client = manager, client
        self.heard: list[dict[str, Any]] = []

    async def run(self, cell: str) -> str:
        """Run a cell; return the name of the error that ended it, or nothing."""
        reply = self.client.execute_interactive(cell, output_hook=self.heard.append, timeout=SOON)
        return str((await reply)["content"].get("ename", ""))

    def shown(self, kind: str) -> list[str]:
        """Return the pictures in messages of a kind."""
        messages = (each for each in self.heard if each["msg_type"] == kind)
        return [each["content"]["data"].get("text/html", "") for each in messages]


@asynccontextmanager
async def notebook() -> AsyncIterator[Notebook]:
    manager = AsyncKernelManager(kernel_name="python3", transport="ipc")
    await manager.start_kernel()
    client = manager.client()
    client.start_channels()
    try:
        await client.wait_for_ready(timeout=60)
        yield Notebook(manager, client)
    finally:
        client.stop_channels()
        with suppress(RuntimeError):
            await manager.shutdown_kernel(now=True)


async def drives_on(site: Site, book: Notebook) -> None:
    assert await book.run("robot.start_move(9.0)") == ""
    await site.drives()


async def test_cells_that_end_badly_stop_the_robot_and_a_cell_may_run_again() -> None:
    async with running() as site, notebook() as book:
        connecting = CONNECT.format(url=site.url)
        assert await book.run(connecting) == ""
        await drives_on(site, book)
        assert await book.run("nothing_of_this_name") == "NameError"
        await site.stands()

        await drives_on(site, book)
        sleeping = asyncio.ensure_future(book.run("import time; time.sleep(60)"))
        await asyncio.sleep(0.5)
        await book.manager.interrupt_kernel()
        assert await sleeping == "KeyboardInterrupt"
        await site.stands()
        assert BYE not in site.firmware.heard

        await drives_on(site, book)
        assert await book.run(connecting) == ""  # the cell of before, once more
        assert site.firmware.heard.count(BYE) == 1
        assert await book.run("robot.move(0.2)") == ""

        await drives_on(site, book)
        await book.manager.shutdown_kernel()
        await said_goodbye(site)
        assert site.firmware.heard.count(BYE) == 2


async def test_a_robot_shows_itself_and_lives_until_its_view_is_closed() -> None:
    async with running() as site, notebook() as book:
        await book.run(CONNECT.format(url=site.url) + "\nrobot")
        (picture,) = book.shown("execute_result")
        assert 'class="robot"' in picture
        assert "MobileSim, Pioneer 3-AT" in picture

        assert await book.run("with robot.view():\n    robot.move(0.3)") == ""
        (first,) = book.shown("display_data")
        *moving, last = book.shown("update_display_data")
        assert "<polyline" not in first
        assert len(moving) >= 3
        assert "<polyline" in moving[-1]  # the way that it came
        assert last == f"{moving[-1]}<i>The view was closed.</i>"

        assert await book.run("robot.view()") == ""
        assert await book.run("robot.view(); robot.close(); robot") == ""
        assert book.shown("update_display_data")[-1].endswith("<i>The view was closed.</i>")
        assert "has been closed; connect again" in book.shown("execute_result")[-1]
        assert await book.run("robot.view()") == "RuntimeError"
        await said_goodbye(site)
