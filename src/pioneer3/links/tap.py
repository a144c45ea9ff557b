"""Recording the bytes of links in a log, and playing them back.

The topics `wire/NAME/in` have the bytes that a host read of a link, `wire/NAME/out` those that it
wrote. Older recordings are texts, one line a chunk, which are still read::

    # pioneer3 <version>, <begin of the recording, ISO 8601, UTC>
    <seconds> C>S|S>C <number of bytes> <hex>

`C>S` are bytes of the host, `S>C` of the robot; seconds count from the beginning. Lines that
start with # are comments. The oldest have no heading, and restart at 0 s with each connection.
"""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from pathlib import Path
from typing import Final, Protocol

from pioneer3.errors import ConfigError, RecordingOverError
from pioneer3.links.base import HandingLink, Link, Opener
from pioneer3.log.reader import is_mcap, whole_log
from pioneer3.log.topics import EXACT, ROUGH, LogTopic, is_wire
from pioneer3.log.writer import LogWriter

FROM_HOST, FROM_ROBOT = "C>S", "S>C"
OPEN: Final = "open: "
"""Begin of the words about a link that was opened."""
WAYS: Final = {FROM_ROBOT: "in", FROM_HOST: "out"}
"""Directions, and the ends of their topics."""
ROBOT: Final = "robot"
"""Name of the link of a robot."""
OF_CHUNK: Final = 100
"""Memory that a chunk takes besides its bytes, about [bytes]."""


@dataclass(frozen=True, slots=True)
class Chunk:
    """Bytes on the wire: time [s] since the beginning, direction, data."""

    time: float
    way: str
    data: bytes


class WireTap(Protocol):
    """Takes the bytes of a link, and its events."""

    def now(self) -> float:
        """Return the time [s]."""

    def note(self, way: str, data: bytes, now: float) -> None:
        """Take bytes that pass `now`, in the direction :data:`FROM_HOST` or :data:`FROM_ROBOT`."""

    def remark(self, words: str) -> None:
        """Take an event of the link, in words."""


def tapped(opener: Opener, tap: WireTap) -> Opener:
    """Return an opener of the same links, whose bytes the tap takes."""

    async def open_link() -> Link:
        return TapLink(await opener(), tap)

    return open_link


class WireRecording:
    """Puts the bytes of a link into a log, and its events.

    Attributes:
        now: Returns the time for the log [s].
    """

    def __init__(self, log: LogWriter, name: str = ROBOT) -> None:
        self.name = name
        self.now = log.clock
        self._log = log
        # the driver of a robot tells the time of its bytes: log/verify needs it exactly
        tick = EXACT if name.rpartition("/")[2] == ROBOT else ROUGH
        self._put = {
            way: partial(log.put, LogTopic(f"wire/{name}/{end}", bytes, size=OF_CHUNK, tick=tick))
            for way, end in WAYS.items()
        }

    def note(self, way: str, data: bytes, now: float | None = None) -> None:
        """Put bytes that pass `now`, in the direction :data:`FROM_HOST` or :data:`FROM_ROBOT`."""
        if data:
            self._put[way](data, now)

    def remark(self, words: str) -> None:
        """Put an event of the link, in words."""
        self._log.event("link", f"{self.name}: {words}")


class TapLink:
    """A host's link whose bytes a tap takes; same contract as the link inside."""

    def __init__(self, link: Link, tap: WireTap) -> None:
        self.url = link.url
        self.speeds = link.speeds
        self.round_trip = link.round_trip
        self.read_at = -inf
        self._link = link
        self._tap = tap
        self._tap.remark(f"{OPEN}{link.url}")

    async def read(self) -> bytes:
        """Read from the link inside."""
        data = await self._link.read()
        self.read_at = now = self._tap.now()
        self._tap.note(FROM_ROBOT, data, now)
        return data

    def handing(self, take: Callable[[bytes], None]) -> AbstractContextManager[None]:
        """Record the bytes that the link inside hands over, then pass them on."""

        def tell(data: bytes) -> None:
            self.read_at = now = self._tap.now()
            self._tap.note(FROM_ROBOT, data, now)
            take(data)

        link = self._link
        return link.handing(tell) if isinstance(link, HandingLink) else nullcontext()

    def write(self, data: bytes) -> Awaitable[None]:
        """Write to the link inside, then tell it: what moves a robot does not wait for that."""
        now = self._tap.now()
        try:
            return self._link.write(data)
        finally:
            self._tap.note(FROM_HOST, data, now)

    async def set_speed(self, baud: int) -> None:
        """Change the speed of the link inside."""
        self._tap.remark(f"{baud} baud")
        await self._link.set_speed(baud)

    async def close(self) -> None:
        """Close the link inside; the recording goes on."""
        self._tap.remark("closed")
        await self._link.close()


class Replay:
    """Plays the bytes of a link from a recording, once, at the recorded times.

    Playback starts with the first byte that the host sends. It goes on while no link is open: the
    next link gets the later bytes, as with a robot.
    """

    def __init__(self, path: Path, link: str = ROBOT) -> None:
        self.url = f"replay:{path}" if link == ROBOT else f"replay:{path}#{link}"
        self._chunks = _of_robot(read_recording(path, link))
        self._next = next(self._chunks, None)
        self._began: float | None = None
        self._first = self._next.time if self._next else 0.0

    async def open(self) -> Link:
        """Return a link to the recorded robot; it goes on where the previous link ended."""
        return ReplayLink(self)

    def begin(self) -> None:
        """Start playback, unless it has started."""
        if self._began is None:
            self._began = asyncio.get_running_loop().time()

    def due(self) -> float:
        """Return the time of the next chunk [s, loop time]; RecordingOverError if there is none."""
        assert self._began is not None
        if self._next is None:
            raise RecordingOverError(f"{self.url}: the recording is over")
        return self._began + self._next.time - self._first

    def take(self) -> bytes:
        """Return the next chunk."""
        assert self._next is not None
        data, self._next = self._next.data, next(self._chunks, None)
        return data


def _of_robot(chunks: Iterator[Chunk]) -> Iterator[Chunk]:
    """Yield the chunks of a robot, in time that does not go back: in older files it restarted."""
    offset = latest = 0.0
    for chunk in chunks:
        if chunk.time + offset < latest:
            offset = latest
        latest = chunk.time + offset
        if chunk.way == FROM_ROBOT:
            yield replace(chunk, time=latest)


class ReplayLink:
    """A link to a recorded robot, which ignores all commands."""

    speeds: tuple[int, ...] = ()
    round_trip = 0.0

    def __init__(self, recording: Replay) -> None:
        self.url = recording.url
        self._recording = recording
        self._started = asyncio.Event()
        self._closed = asyncio.Event()

    async def read(self) -> bytes:
        """Return the next recorded chunk at its time; RecordingOverError if there is none."""
        await self._started.wait()
        if self._closed.is_set():
            return b""
        try:
            async with asyncio.timeout_at(self._recording.due()):
                await self._closed.wait()
        except TimeoutError:
            return self._recording.take()
        return b""

    async def write(self, data: bytes) -> None:
        """Start playback; the data are ignored."""
        self._recording.begin()
        self._started.set()

    async def set_speed(self, baud: int) -> None:
        """Do nothing: a recording has no line speed."""

    async def close(self) -> None:
        """End the playback."""
        self._closed.set()
        self._started.set()


def read_recording(path: Path, link: str = ROBOT) -> Iterator[Chunk]:
    """Yield the chunks of a link in a recording, in all its files; an older one has only one.

    Raises:
        PortNotFoundError: there is no such file.
        ConfigError: it is damaged, or has no such link; of an old one the message has the line.
    """
    return _read_log(path, link) if is_mcap(path) else _read_text(path)


def recorded_links(path: Path) -> list[str]:
    """Return the names of the links in a recording; errors as of :func:`read_recording`."""
    if not is_mcap(path):
        return [ROBOT]
    topics = whole_log(path).topics()
    found = {topic.removeprefix("wire/").rpartition("/")[0] for topic in topics if is_wire(topic)}
    return sorted(found)


def _read_log(path: Path, link: str) -> Iterator[Chunk]:
    topics = {f"wire/{link}/{end}": way for way, end in WAYS.items()}
    began = None
    for message in whole_log(path).messages(topics.__contains__):
        began = message.time if began is None else began
        yield Chunk((message.time - began) / 1e9, topics[message.topic], message.data)
    if began is None:
        there = ", ".join(f"replay:{path}#{other}" for other in recorded_links(path))
        raise ConfigError(f"{path}: no bytes of the link {link!r}; there are: {there or 'none'}")


def _read_text(path: Path) -> Iterator[Chunk]:
    try:
        lines = path.read_text("utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: not a readable recording: {error}") from error
    for number, line in enumerate(lines, 1):
        if not line or line.startswith("#"):
            continue
        try:
            seconds, way, count, text = line.split()
            chunk, size = Chunk(float(seconds), way, bytes.fromhex(text)), int(count)
        except ValueError:
            raise ConfigError(
                f"{path}:{number}: expected `<seconds> C>S|S>C <bytes> <hex>`"
            ) from None
        if way not in {FROM_HOST, FROM_ROBOT} or size != len(chunk.data):
            raise ConfigError(f"{path}:{number}: the way or the number of bytes is wrong")
        yield chunk
