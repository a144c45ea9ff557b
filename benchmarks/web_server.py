"""The page of several robots, as a process of its own: `python -m benchmarks.web_server URL...`.

Prints the page's address as soon as all robots are connected. On SIGTERM it prints when each report
arrived at the driver [s, monotonic], by robot and number of the report.
"""

import asyncio
import cProfile
import json
import os
import pstats
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from pioneer3.runtime.scene import Scene
from pioneer3.state import Snapshot
from pioneer3.web.hosting import Target, hosted
from pioneer3.web.page import Page
from pioneer3.web.server import serve
from pioneer3.web.station import Station

PROFILE = "PIONEER3_WEB_PROFILE"
"""Environment variable: where the server writes where its time went."""
Arrivals = dict[str, float]


class Server:
    """The process. `arrivals` are known when it has ended."""

    def __init__(self, process: "subprocess.Popen[str]", address: str) -> None:
        self.pid = process.pid
        self.address = address
        self.arrivals: Arrivals = {}
        self._process = process

    def end(self) -> None:
        """End it, and read what it has noted."""
        if self._process.poll() is None:
            self._process.terminate()
            self.arrivals = json.loads(self._process.communicate()[0])


@contextmanager
def server_process(urls: Sequence[str]) -> Iterator[Server]:
    """Run the server while the block lasts."""
    command = [sys.executable, "-m", "benchmarks.web_server", *urls]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        server = Server(process, process.stdout.readline().strip())
        try:
            yield server
        finally:
            server.end()


async def run(urls: Sequence[str]) -> None:
    """Serve until SIGTERM."""
    arrivals: Arrivals = {}
    _note_arrivals(arrivals)
    page, end = Page(), asyncio.Event()
    asyncio.get_running_loop().add_signal_handler(signal.SIGTERM, end.set)
    targets = [Target(url=url, scene=Scene()) for url in urls]
    async with hosted(page, targets, lambda line: None), serve(page, port=0) as served:
        print(served.http, flush=True)
        await end.wait()
    print(json.dumps(arrivals))


def _note_arrivals(arrivals: Arrivals) -> None:
    """Let every snapshot that is told to pages be noted on its way."""
    told = Station.snapshot

    def note(self: Station, snapshot: Snapshot, driver: dict[str, Any] | None) -> dict[str, Any]:
        arrivals[f"{self.number} {snapshot.sequence}"] = snapshot.stamp
        return told(self, snapshot, driver)

    Station.snapshot = note  # type: ignore[method-assign]


def main(urls: Sequence[str]) -> None:
    """Run, and say where the time went if somebody wants to know."""
    file = os.environ.get(PROFILE)
    if not file:
        asyncio.run(run(urls))
        return
    profile = cProfile.Profile()
    with suppress(asyncio.CancelledError):
        profile.runcall(asyncio.run, run(urls))
    with Path(file).open("w", encoding="utf-8") as out:
        pstats.Stats(profile, stream=out).sort_stats("tottime").print_stats(60)


if __name__ == "__main__":
    main(sys.argv[1:])
