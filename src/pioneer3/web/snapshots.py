"""The robots' snapshots on their way to the pages: joined, paced, and encoded once for all."""

import asyncio
from collections.abc import Callable

PERIOD = 0.04
"""Least time between two frames [s]."""
GATHER = 0.003
"""How long the first snapshot after a pause waits for those of other robots [s]."""
START, END = '{"type":"robots","snapshots":[', "]}"


class Snapshots:
    """The newest snapshot of each robot, in one frame for all who are equally up to date.

    `flushed` is called when there is a new frame, which begins with `start`.
    """

    def __init__(self, flushed: Callable[[], None], start: str = START) -> None:
        self.version = 0
        self._start = start
        self._flushed = flushed
        self._parts: dict[int, tuple[int, str]] = {}
        self._frames: dict[int, list[str]] = {}
        self._loop = asyncio.get_running_loop()
        self._flushed_at = float("-inf")
        self._due: asyncio.TimerHandle | None = None

    def put(self, robot: int, text: str) -> None:
        """Take a robot's newest snapshot; it goes out within :data:`PERIOD`."""
        self._parts[robot] = self.version + 1, text
        self._frames.clear()
        if self._due is None:
            at = max(self._loop.time() + GATHER, self._flushed_at + PERIOD)
            self._due = self._loop.call_at(at, self._flush)

    def forget(self, robot: int) -> None:
        """Tell nothing more of a robot that is gone."""
        self._parts.pop(robot, None)
        self._frames.clear()

    def since(self, seen: int) -> list[str]:
        """Return a frame with what is newer than version `seen`; nothing if nothing is."""
        frame = self._frames.get(seen)
        if frame is None:
            newer = [text for version, text in self._parts.values() if version > seen]
            frame = [f"{self._start}{','.join(newer)}{END}"] if newer else []
            self._frames[seen] = frame
        return frame

    def _flush(self) -> None:
        self._due = None
        self._flushed_at = self._loop.time()
        self.version += 1
        self._flushed()
