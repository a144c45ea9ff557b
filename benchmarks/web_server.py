"""The page of several robots, as a process of its own: `python -m benchmarks.web_server URL...`.

Prints the page's address as soon as all robots are connected. On SIGTERM it prints when each report
arrived at the driver [s, monotonic], by robot and number of the report. Without a URL it simulates
a robot itself, and prints when that came to a stand [s, monotonic] instead.
"""

import asyncio
import cProfile
import json
import os
import pstats
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import AsyncExitStack, contextmanager, suppress
from pathlib import Path

from pioneer3.sim.body import Body
from pioneer3.sim.server.start import simulator
from pioneer3.state import Snapshot
from pioneer3.tasks import running
from pioneer3.web.hosting import ConnectTarget, hosted
from pioneer3.web.messages import SnapshotMessage as SnapshotPart
from pioneer3.web.page import Page
from pioneer3.web.robot_view import ConnectedClients, RobotView
from pioneer3.web.scene import RobotScene
from pioneer3.web.server import serve

PROFILE = "PIONEER3_WEB_PROFILE"
"""Environment variable: where the server writes where its time went."""
LOOK = 0.005
"""Between two looks at a simulated robot [s]."""
Arrivals = dict[str, float]


class Server:
    """The process. It prints `lines`; `arrivals` are known when it has ended."""

    def __init__(self, process: "subprocess.Popen[str]", address: str) -> None:
        self.pid = process.pid
        self.address = address
        self.arrivals: Arrivals = {}
        assert process.stdout is not None
        self.lines = process.stdout
        self._process = process

    def end(self) -> None:
        """End it, and read what it has noted."""
        if self._process.poll() is None:
            self._process.terminate()
            self.arrivals = json.loads(self._process.communicate()[0].splitlines()[-1])


@contextmanager
def server_process(urls: Sequence[str], files: int | None = None) -> Iterator[Server]:
    """Run the server while the block lasts; it may open so many `files` at once."""
    command = [sys.executable, "-m", "benchmarks.web_server", *urls]
    if files is not None:
        command = ["sh", "-c", f'ulimit -n {files}; exec "$@"', "sh", *command]
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
    async with AsyncExitStack() as stack:
        targets = [ConnectTarget(url=url, scene=RobotScene()) for url in urls]
        if not targets:
            here = await stack.enter_async_context(simulator(port=0))
            targets = [ConnectTarget(url=here.url, scene=RobotScene.of(here, here.robots[0]))]
            await stack.enter_async_context(running(_note_stands(here.body)))
        await stack.enter_async_context(hosted(page, targets, lambda line: None))
        served = await stack.enter_async_context(serve(page, port=0))
        print(served.http, flush=True)
        await end.wait()
    print(json.dumps(arrivals))


async def _note_stands(body: Body) -> None:
    moves = False
    while True:
        moved, moves = moves, bool(body.drive.linear.velocity)
        if moved and not moves:
            print(time.monotonic(), flush=True)
        await asyncio.sleep(LOOK)


def _note_arrivals(arrivals: Arrivals) -> None:
    """Let every snapshot that is told to pages be noted on its way."""
    told = RobotView.snapshot

    def note(self: RobotView, snapshot: Snapshot, clients: ConnectedClients) -> SnapshotPart:
        arrivals[f"{self.number} {snapshot.sequence}"] = snapshot.stamp
        return told(self, snapshot, clients)

    RobotView.snapshot = note  # type: ignore[method-assign]


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
