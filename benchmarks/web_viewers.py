"""Many viewers in a process of its own: `python -m benchmarks.web_viewers ADDRESS COUNT SECONDS`.

Prints a line when all look; then when some of them heard of each report [s, monotonic], by robot
and number of the report, and how many frames all of them got.
"""

import asyncio
import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AsyncExitStack, contextmanager
from dataclasses import dataclass

import msgspec
from websockets.asyncio.client import ClientConnection, connect

from pioneer3.tasks import running

CLOSE_LOOKERS = 5
"""Viewers that read what is in the frames; the others only count them."""
SETTLE = 1.0
"""From when all are connected to when they count [s]."""


class Told(msgspec.Struct):
    """What is needed of a snapshot."""

    robot: int
    sequence: int


class Frame(msgspec.Struct):
    """What is needed of any message."""

    type: str
    snapshots: list[Told] = []


@dataclass(frozen=True, slots=True)
class Seen:
    """What the viewers saw; one entry of `heard` for each viewer that reads."""

    heard: list[dict[str, float]]
    frames: int


class Viewer:
    """Reads all the time; `closely` also what is in the frames."""

    def __init__(self, socket: ClientConnection, *, closely: bool) -> None:
        self.heard: dict[str, float] = {}
        self.frames = 0
        self._socket = socket
        self._closely = closely

    async def look(self) -> None:
        """Read until the server closes, or cancelled."""
        decode = msgspec.json.Decoder(Frame).decode
        while True:
            text = await self._socket.recv(decode=False)
            now = time.monotonic()
            self.frames += 1
            if self._closely:
                for told in decode(text).snapshots:
                    self.heard.setdefault(f"{told.robot} {told.sequence}", now)


async def view(address: str, count: int, seconds: float) -> Seen:
    """Look with `count` viewers; print a line when all are there."""
    url = f"{address.replace('http', 'ws', 1)}/ws"
    async with AsyncExitStack() as stack:
        viewers = []
        for number in range(count):
            socket = await stack.enter_async_context(connect(url))
            assert not socket.protocol.extensions, "frames are compressed"
            viewers.append(Viewer(socket, closely=number < CLOSE_LOOKERS))
            await stack.enter_async_context(running(viewers[-1].look()))
        await asyncio.sleep(SETTLE)
        for viewer in viewers:
            viewer.heard.clear()
            viewer.frames = 0
        print("looking", flush=True)
        await asyncio.sleep(seconds)
        heard = [viewer.heard.copy() for viewer in viewers[:CLOSE_LOOKERS]]
        return Seen(heard, sum(viewer.frames for viewer in viewers))


@contextmanager
def viewers_process(address: str, count: int, seconds: float) -> Iterator[Callable[[], Seen]]:
    """Look from another process; yield, once all are there, what waits for what they saw."""
    arguments = [address, str(count), str(seconds)]
    command = [sys.executable, "-m", "benchmarks.web_viewers", *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        process.stdout.readline()
        try:
            yield lambda: Seen(**json.loads(process.communicate()[0]))
        finally:
            process.kill()


def main(address: str, count: str, seconds: str) -> None:
    """Look, and print."""
    seen = asyncio.run(view(address, int(count), float(seconds)))
    print(json.dumps({"heard": seen.heard, "frames": seen.frames}))


if __name__ == "__main__":
    main(*sys.argv[1:])
