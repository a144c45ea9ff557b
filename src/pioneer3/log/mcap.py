"""One MCAP file while it is written; all of it that is flushed can be read, whatever comes then."""

import os
from collections.abc import Mapping, Sequence
from typing import IO, Any, Final, cast

from mcap.writer import CompressionType, Writer

from pioneer3 import __version__
from pioneer3.log.topics import LogTopic, pack_pieces
from pioneer3.state import Scan

PROFILE: Final = "pioneer3"
"""Profile of our files; readers know them by it."""
STEADY: Final = "steady"
"""Key in a channel's metadata: the name of the field that is kept there, beside the field."""
PIECES: Final = {
    "pieces": "times after one another [ticks], sizes, bytes; step: 0, or each byte is told by its"
    " difference to the one so many before; tick [ns], else 1000"
}
"""Metadata of a channel whose messages are bytes in pieces."""
SYNC: Final = getattr(os, "fdatasync", os.fsync)
"""Brings the content of a file to the disk, and its length; not the times of the file."""
MOST_CHANNELS: Final = 4096
"""Channels of one file, of which each value of a steady field has one; MCAP counts to 65535."""


class _Sink:
    """Writes to a file, whole or not at all; a call that fails leaves all before it in place."""

    def __init__(self, descriptor: int) -> None:
        self.descriptor, self.size, self.good = descriptor, 0, 0

    def write(self, data: bytes) -> int:
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(self.descriptor, rest) :]
        self.size += len(data)
        return len(data)

    def tell(self) -> int:
        return self.size

    def flush(self) -> None:
        self.good = self.size


class McapFile:
    """An MCAP file in an empty file that is open.

    Raises:
        OSError: It cannot be written, as does each method.
    """

    def __init__(self, descriptor: int) -> None:
        self._sink = _Sink(descriptor)
        self._writer = Writer(cast("IO[Any]", self._sink), compression=CompressionType.ZSTD)
        self._schemas: dict[type, int] = {bytes: 0, Scan: 0}
        self._channels: dict[tuple[str, bytes], int] = {}
        self._parts: dict[str, tuple[object, bytes]] = {}
        self._counts: dict[int, int] = {}
        self._writer.start(PROFILE, f"pioneer3 {__version__}")

    @property
    def size(self) -> int:
        """Bytes that are written."""
        return self._sink.size

    @property
    def is_crowded(self) -> bool:
        """Whether it is time for another file."""
        return len(self._channels) > MOST_CHANNELS

    def add_metadata(self, name: str, data: Mapping[str, str]) -> None:
        """Write texts by their names."""
        self._writer.add_metadata(name, dict(data))
        self._sink.flush()

    def add(self, topic: LogTopic[Any], messages: Sequence[tuple[int, Any]]) -> None:
        """Take messages of a topic, each of a time [ns since 1970]; the next flush writes them."""
        if topic.kind is bytes:
            self._add(topic, messages[0][0], b"", pack_pieces(messages, topic.tick))
            return
        for time, message in messages:
            self._add(topic, time, message, topic.encode(message))

    def _add(self, topic: LogTopic[Any], time: int, message: Any, data: bytes) -> None:
        channel = self._channel(topic, message)
        self._counts[channel] = number = self._counts.get(channel, 0) + 1
        self._writer.add_message(channel, time, data, time, number)

    def flush(self) -> None:
        """Write what was taken, as one chunk."""
        self._writer.flush()  # type: ignore[no-untyped-call]

    def sync(self) -> None:
        """Bring what is written to the disk, for a loss of power."""
        SYNC(self._sink.descriptor)

    def finish(self) -> None:
        """Write the index, and close the file."""
        self._writer.finish()  # type: ignore[no-untyped-call]
        os.close(self._sink.descriptor)

    def abandon(self) -> None:
        """Close the file after a failure; what was flushed stays, and no more."""
        try:
            os.ftruncate(self._sink.descriptor, self._sink.good)
        finally:
            os.close(self._sink.descriptor)

    def _channel(self, topic: LogTopic[Any], message: Any) -> int:
        part = self._steady_part(topic, message)
        channel = self._channels.get((topic.name, part))
        if channel is None:
            channel = self._channels[topic.name, part] = self._writer.register_channel(
                topic.name,
                topic.encoding,
                self._schema(topic),
                _told(topic, part),
            )
        return channel

    def _steady_part(self, topic: LogTopic[Any], message: Any) -> bytes:
        if not topic.steady:
            return b""
        value = getattr(message, topic.steady)
        known, part = self._parts.get(topic.name, (None, b""))
        if value is not known:
            part = topic.steady_part(message)
            self._parts[topic.name] = value, part
        return part

    def _schema(self, topic: LogTopic[Any]) -> int:
        found = self._schemas.get(topic.kind)
        if found is None:
            name = f"pioneer3.{topic.kind.__name__}"
            found = self._writer.register_schema(name, "jsonschema", topic.schema())
            self._schemas[topic.kind] = found
        return found


def _told(topic: LogTopic[Any], part: bytes) -> dict[str, str]:
    """Return the metadata of a channel."""
    if topic.kind is bytes:
        return PIECES
    return {STEADY: topic.steady, topic.steady: part.decode()} if topic.steady else {}
