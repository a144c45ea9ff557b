"""Recording the bytes of a link, one line a chunk, and playing them back.

The format::

    # pioneer3 <version>, <begin of the recording, ISO 8601, UTC>
    <seconds> C>S|S>C <number of bytes> <hex>

`C>S` are bytes of the host, `S>C` of the robot; seconds count from the beginning. Lines that
start with # are comments; those of the form `# <seconds> <words>` are other events, such as
the reason for a motion. Older files have no heading, and restart at 0 s with each connection.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TextIO

from pioneer3 import __version__
from pioneer3.clock import Clock
from pioneer3.errors import ConfigError, PortNotFoundError, RecordingOverError
from pioneer3.links.base import Link, Opener

log = logging.getLogger(__name__)

FROM_HOST, FROM_ROBOT = "C>S", "S>C"


@dataclass(frozen=True, slots=True)
class Chunk:
    """Bytes on the wire: time [s] since the beginning, direction, data."""

    time: float
    way: str
    data: bytes


class WireRecording:
    """Writes bytes and events to an open file, one line each; a full disk ends it, no more.

    It began at `began` [s], or now. `failure` is the reason why it has ended by itself, or empty.
    """

    def __init__(self, file: TextIO, clock: Clock, began: float | None = None) -> None:
        self.failure = ""
        self._file = file
        self._clock = clock
        self._began = clock() if began is None else began

    def note(self, way: str, data: bytes) -> None:
        """Write bytes that pass now, in the direction :data:`FROM_HOST` or :data:`FROM_ROBOT`."""
        if data:
            seconds = self._clock() - self._began
            self.put(f"{seconds:.6f} {way} {len(data)} {data.hex()}")

    def remark(self, words: str) -> None:
        """Write a comment with its time."""
        self.put(f"# {self._clock() - self._began:.6f} {' '.join(words.split())}")

    def put(self, line: str) -> None:
        """Write one line."""
        if self.failure:
            return
        try:
            self._file.write(line + "\n")
        except OSError as error:
            self.failure = error.strerror or str(error)
            log.warning(
                "%s: the recording has ended, and nothing else: %s", self._file.name, self.failure
            )

    def close(self) -> None:
        """End the recording; a full disk does not take a line that was cut."""
        with suppress(OSError):
            self._file.close()


class TapLink:
    """A host's link that records all bytes; same contract as the link inside."""

    def __init__(self, link: Link, recording: WireRecording) -> None:
        self.url = link.url
        self.speeds = link.speeds
        self.round_trip = link.round_trip
        self._link = link
        self._recording = recording
        self._recording.put(f"# {link.url}")

    async def read(self) -> bytes:
        """Read from the link inside."""
        data = await self._link.read()
        self._recording.note(FROM_ROBOT, data)
        return data

    async def write(self, data: bytes) -> None:
        """Write to the link inside."""
        self._recording.note(FROM_HOST, data)
        await self._link.write(data)

    async def set_speed(self, baud: int) -> None:
        """Change the speed of the link inside."""
        self._recording.remark(f"{baud} baud")
        await self._link.set_speed(baud)

    async def close(self) -> None:
        """Close the link inside; the recording goes on."""
        await self._link.close()


class Recorder:
    """Records every link of an opener to one file, line by line."""

    def __init__(self, opener: Opener, recording: WireRecording) -> None:
        self._open = opener
        self._recording = recording
        self._began = False

    async def open(self) -> Link:
        """Open the link, and record it."""
        link = await self._open()
        self._began = True
        return TapLink(link, self._recording)

    def remark(self, words: str) -> None:
        """Write an event as a comment; before the first link, do nothing."""
        if self._began:
            self._recording.remark(words)


def begun(path: Path, clock: Clock) -> WireRecording:
    """Return a recording to a new file, with its heading.

    Raises:
        ConfigError: the file cannot be written; one that exists is left alone.
    """
    when = datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
    try:
        file = path.open("x", encoding="utf-8", buffering=1)
        file.write(f"# pioneer3 {__version__}, {when}\n")
    except OSError as error:
        raise ConfigError(f"{path}: cannot record there: {error.strerror}") from None
    return WireRecording(file, clock)


@contextmanager
def recorded(opener: Opener, path: Path, clock: Clock) -> Iterator[Recorder]:
    """Record every link that `opener` opens to one new file; errors as of :func:`begun`."""
    with closing(begun(path, clock)) as recording:
        yield Recorder(opener, recording)


class Replay:
    """Plays a robot's bytes from a recording, once, at the recorded times.

    Playback starts with the first byte that the host sends. It goes on while no link is open: the
    next link gets the later bytes, as with a robot.
    """

    def __init__(self, path: Path) -> None:
        self.url = f"replay:{path}"
        self._chunks: deque[Chunk] = deque()
        self._began: float | None = None
        offset = latest = 0.0
        for chunk in read_recording(path):
            if chunk.time + offset < latest:  # an older file: the time restarted
                offset = latest
            latest = chunk.time + offset
            if chunk.way == FROM_ROBOT:
                self._chunks.append(replace(chunk, time=latest))
        self._first = self._chunks[0].time if self._chunks else 0.0

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
        if not self._chunks:
            raise RecordingOverError(f"{self.url}: the recording is over")
        return self._began + self._chunks[0].time - self._first

    def take(self) -> bytes:
        """Return the next chunk."""
        return self._chunks.popleft().data


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


def read_recording(path: Path) -> Iterator[Chunk]:
    """Yield the chunks of a recording.

    Raises:
        PortNotFoundError: there is no such file.
        ConfigError: a line does not have the format; the message has file and line.
    """
    try:
        lines = path.read_text("utf-8").splitlines()
    except FileNotFoundError:
        raise PortNotFoundError(f"{path}: no such recording") from None
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
