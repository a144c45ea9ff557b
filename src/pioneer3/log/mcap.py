"""One MCAP file while it is written; all of it that is flushed can be read, whatever comes then."""

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from itertools import groupby
from typing import IO, Any, Final, cast

from mcap.writer import CompressionType, Writer

from pioneer3 import __version__
from pioneer3.log.differences import best_step
from pioneer3.log.rows import fields_of, pack_rows
from pioneer3.log.topics import (
    COLUMNS,
    END,
    PIECES,
    STEADY,
    TOTALS,
    LogTopic,
    pack_pieces,
    totals,
)

PROFILE: Final = "pioneer3"
"""Profile of our files; readers know them by it."""
OF_PIECES: Final = {
    PIECES: "times after one another [ticks], sizes, bytes; step: 0, or each byte is told by its"
    " difference to the one so many before; tick [ns], else 1000; planes: 0, or every so many bytes"
    " lie together, the first ones first"
}
"""Metadata of a channel whose messages are bytes in pieces."""
SYNC: Final = getattr(os, "fdatasync", os.fsync)
"""Brings the content of a file to the disk, and its length; not the times of the file."""
SAME_STEP: Final = 10
"""Messages of one laser's bytes in a row with the same step of differences."""
MOST_CHANNELS: Final = 4096
"""Channels of one file, of which each value of a steady field has one; MCAP counts to 65535."""
CLOSED: Final = -1
"""No descriptor: another file may have that of one that is closed."""


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

    def rewind(self) -> None:
        os.ftruncate(self.descriptor, self.good)
        self.size = os.lseek(self.descriptor, self.good, os.SEEK_SET)

    def close(self) -> None:
        descriptor, self.descriptor = self.descriptor, CLOSED
        os.close(descriptor)


class McapFile:
    """An MCAP file in an empty file that is open.

    Raises:
        OSError: It cannot be written, as does each method.
    """

    def __init__(self, descriptor: int) -> None:
        self._sink = _Sink(descriptor)
        self._writer = Writer(cast("IO[Any]", self._sink), compression=CompressionType.ZSTD)
        self._schemas: dict[type, int] = {}
        self._channels: dict[tuple[str, ...], int] = {}
        self._parts: dict[str, tuple[object, bytes]] = {}
        self._steps: dict[str, tuple[int, int]] = {}
        self._sequences = Counter[int]()
        self._counts = Counter[str]()
        self._ended = 0
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
        self._counts[topic.name] += len(messages)
        self._ended = max(self._ended, messages[-1][0])
        if topic.kind is bytes:
            data = pack_pieces(messages, topic.tick, partial(self._step, topic.name))
            self._add(topic, messages[0][0], OF_PIECES, data)
        elif topic.in_rows:
            self._add_rows(topic, messages)
        else:
            for time, message in messages:
                self._add(topic, time, {}, topic.encode(message))

    def _step(self, topic: str, data: bytes) -> int:
        """Return the step of differences for bytes, which is looked for now and then."""
        step, left = self._steps.get(topic, (0, 0))
        if not left:
            step, left = best_step(data), SAME_STEP
        self._steps[topic] = step, left - 1
        return step

    def _add_rows(self, topic: LogTopic[Any], messages: Sequence[tuple[int, Any]]) -> None:
        """Take messages as columns; those with another steady field are another message."""
        for part, group in groupby(messages, lambda each: self._steady_part(topic, each[1])):
            times, values = zip(*group, strict=True)
            fields = fields_of(values)
            fields.pop(topic.steady, None)
            shape, data = pack_rows(times, fields)
            told = {COLUMNS: shape.decode()}
            if topic.steady:
                told |= {STEADY: topic.steady, topic.steady: part.decode()}
            self._add(topic, times[0], told, data)

    def _add(self, topic: LogTopic[Any], time: int, told: dict[str, str], data: bytes) -> None:
        channel = self._channel(topic, told)
        self._sequences[channel] += 1
        self._writer.add_message(channel, time, data, time, self._sequences[channel])

    def flush(self) -> None:
        """Write what was taken, as one chunk."""
        self._writer.flush()  # type: ignore[no-untyped-call]

    def sync(self) -> None:
        """Bring what is written to the disk, for a loss of power."""
        SYNC(self._sink.descriptor)

    def finish(self, why: str = "") -> None:
        """Write the reason for the end, if there is one, and the index; close the file."""
        try:
            self._end(why)
            self.add_metadata(TOTALS, totals(self._counts, self._ended))
            self._writer.finish()  # type: ignore[no-untyped-call]
        except OSError:
            self.abandon(why)
            raise
        self._sink.close()

    def abandon(self, why: str = "") -> None:
        """Close the file after a failure: what was flushed stays, with the reason if it fits."""
        try:
            self._sink.rewind()
            with suppress(OSError):
                self._end(why)
            self._sink.rewind()
        finally:
            self._sink.close()

    def _end(self, why: str) -> None:
        if why:
            self.add_metadata(END, {"why": why})

    def _channel(self, topic: LogTopic[Any], told: dict[str, str]) -> int:
        """Return the channel of a topic with some metadata."""
        key = topic.name, *told.values()
        if key not in self._channels:
            schema = self._schema(topic)
            self._channels[key] = self._writer.register_channel(
                topic.name, topic.encoding, schema, told
            )
        return self._channels[key]

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
        if topic.encoding != "json":
            return 0
        found = self._schemas.get(topic.kind)
        if found is None:
            name = f"pioneer3.{topic.kind.__name__}"
            found = self._writer.register_schema(name, "jsonschema", topic.schema())
            self._schemas[topic.kind] = found
        return found
