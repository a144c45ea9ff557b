"""`pioneer3 replay`: logs, and the page that shows them, in one loop."""

import asyncio
from collections.abc import Callable, Sequence
from contextlib import AsyncExitStack
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.log.index import LogIndex
from pioneer3.log.reader import whole_log
from pioneer3.web.access.certificate import certificate_for
from pioneer3.web.live import pairing_lines
from pioneer3.web.page import Page
from pioneer3.web.replay.replay import LogPlayer
from pioneer3.web.server import serve


async def replay(
    paths: Sequence[Path],
    tell: Callable[[str], None],
    *,
    port: int,
    host: str = "127.0.0.1",
    show_tokens: bool = False,
) -> int:
    """Serve a page with the logs until cancelled; `tell` is called with each line of output.

    Raises:
        PioneerError: A log cannot be read, or the page not served; the message says what to do.
    """
    twice = next((path for path in paths if paths.count(path) > 1), None)
    if twice is not None:
        raise ConfigError(f"{twice}: given twice")
    page = Page()
    logs = dict.fromkeys(whole_log(path).files for path in paths)
    shown = LogPlayer([LogIndex(*files) for files in logs], page.audiences)
    async with AsyncExitStack() as stack:
        await stack.enter_async_context(page.replaying(shown))
        certificate = certificate_for(host, None, None)
        serving = serve(page, host=host, port=port, certificate=certificate)
        served = await stack.enter_async_context(serving)
        tell(f"The replay: {served.http}   (Ctrl-C ends)")
        for line in pairing_lines(page, host, show_tokens=show_tokens):
            tell(line)
        await asyncio.get_running_loop().create_future()
    return 0
