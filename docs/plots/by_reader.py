"""Lets the reader of the book take the pictures of the tutorial, as it does what that says."""

import asyncio
import sys
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from docs.plots.studio import Studio


def reading(page: str) -> "Callable[[Studio], Awaitable[None]]":
    """Return the scene of a page of the tutorial: its reader follows it on a computer alone."""

    async def read(studio: "Studio") -> None:
        from docs.plots.studio import ROOT, PictureError

        process = await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "tests.book.reader", "--pictures", "docs/images/tutorial"),
            f"docs/tutorial/{page}.md",
            cwd=ROOT,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
        )
        said, _ = await process.communicate()
        if process.returncode:
            raise PictureError(f"docs/tutorial/{page}.md: {said.decode()[-2000:]}")
        for name in studio.missing:
            if name.startswith(f"tutorial/{page}-"):
                studio.kept(name)

    return read


async def by_hand(studio: "Studio") -> None:
    """Keep the drawing, which is made by hand."""
    studio.kept("tutorial/real-robot-cable")
