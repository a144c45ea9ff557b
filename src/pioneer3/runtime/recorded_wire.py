"""The connections of a link in a log, opened again: bytes come at the very times of the log."""

import asyncio
from collections.abc import Iterator
from dataclasses import dataclass
from heapq import merge
from itertools import dropwhile
from operator import attrgetter
from typing import Final

from pioneer3.errors import ConfigError, RecordingOverError
from pioneer3.links import Link
from pioneer3.log.reader import LogMessage, RunLog
from pioneer3.log.topics import EVENT, LogEvent
from pioneer3.text import wrong

LONGEST_PAUSE: Final = 14 * 86_400.0
"""A driver that waits for its link for longer [s] tries that for ever, in no time of its own."""
SOON: Final = 60.0
"""No message is told so long after a later one [s]."""


@dataclass(frozen=True, slots=True)
class _Step:
    """A step of a link in a log, at a time [s]: it opens or closes, or bytes pass it."""

    at: float
    opens: bool = False
    closes: bool = False
    writes: bool = False
    data: bytes = b""


def opens(link: str, event: LogEvent) -> bool:
    """Whether an event tells that a link was opened."""
    return event.kind == "link" and event.text.startswith(f"{link}: open: ")


class RecordedWire:
    """Opens the recorded connections of a link one after the other, each at its time."""

    def __init__(
        self, log: RunLog, link: str, late: float = 0.0, longer: float | None = None
    ) -> None:
        """Bytes come `late` [s]; their `read_at` is that of the log.

        A driver that waits for bytes `longer` [s] than it did gives up when it did: before the next
        that it wrote or read. `None`: at a time of its own.
        """
        self.link, self.late, self.longer = link, late, longer
        self.speeds: tuple[int, ...] = ()
        self.url = f"replay:{log.path}#{link}"
        facts = log.info().texts.get("program", {})
        try:
            self.begin = float(facts["clock"])
            self._offset = round(self.begin * 1e9) - int(facts["began_ns"])
        except (KeyError, ValueError, OverflowError):
            raise ConfigError(
                f"{log.path}: it lacks the exact times of bytes: recorded by an older version?"
            ) from None
        steps = self._of(log, link)
        if longer is not None:
            written = map(self._write, log.messages(f"wire/{link}/out".__eq__))
            steps = merge(steps, written, key=lambda step: step.at + late * (not step.writes))
        self._steps = dropwhile(attrgetter("writes"), steps)
        self.next = next(self._steps, None)
        if self.next is None or not self.next.opens:
            raise ConfigError(
                f"{log.path}: its connection began before: verify the log that this is a part of"
            )

    def _of(self, log: RunLog, link: str) -> Iterator[_Step]:
        read, before = f"wire/{link}/in", self.begin
        for message in log.messages(lambda topic: topic in {read, EVENT.name}):
            at = self.seconds(message.time)
            if not -SOON < at - before < LONGEST_PAUSE:
                raise wrong(log.path, " is damaged: its bytes are weeks apart")
            before = at
            if message.topic == read:
                yield _Step(at, data=message.data)
                continue
            event = log.decoded(message, EVENT)
            if opens(link, event):
                yield _Step(at, opens=True)
            elif event.kind == "link" and event.text == f"{link}: closed":
                yield _Step(at, closes=True)

    def _write(self, message: LogMessage) -> _Step:
        return _Step(self.seconds(message.time), writes=True)

    def seconds(self, time: int) -> float:
        """Return a time [ns since 1970] of the clock of the recording, as it was read then.

        The operating system counts nanoseconds, of which Python makes seconds.
        """
        return (time + self._offset) / 1e9

    def take(self) -> None:
        """Go on to the next step."""
        self.next = next(self._steps, None)

    async def until_next(self) -> None:
        """Wait for the time of the next step."""
        if self.next is None:
            raise RecordingOverError(f"{self.url}: the recording is over")
        late = self.late + (self.longer or 0.0) * self.next.writes
        await asyncio.sleep(self.next.at + late - asyncio.get_running_loop().time())

    async def open(self) -> Link:
        """Return the next connection."""
        while self.next is not None and not self.next.opens:
            self.take()
        await self.until_next()
        self.take()
        return _RecordedLink(self)


class _RecordedLink:
    """One connection; `read_at` is when the last bytes were read, as the log has it [s]."""

    round_trip = 0.0

    def __init__(self, wire: RecordedWire) -> None:
        self.url, self.read_at, self.speeds = wire.url, wire.begin, wire.speeds
        self._wire = wire

    async def read(self) -> bytes:
        """Return the next bytes at their time, none once the connection was closed."""
        step = await self._next()
        while step.writes:
            self._wire.take()
            step = await self._next()
        if step.opens or step.closes:
            return b""
        self._wire.take()
        self.read_at = step.at
        return step.data

    async def _next(self) -> _Step:
        try:
            await self._wire.until_next()
        except asyncio.CancelledError:
            if self._wire.longer is not None:
                await self._wire.until_next()
            raise
        assert self._wire.next is not None
        return self._wire.next

    async def write(self, data: bytes) -> None:
        """Do nothing: the log has the answers."""

    async def set_speed(self, baud: int) -> None:
        """Do nothing."""

    async def close(self) -> None:
        """Do nothing."""
