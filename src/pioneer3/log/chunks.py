"""Finds the chunks of an MCAP file, with or without its end, and reads the messages in them.

It trusts no file: it compares each length with the size of the file, and unpacks no more than a
bound. An index that is wrong counts as none: the heads of all records are read then.
"""

import struct
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from io import BytesIO
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, Final

import msgspec

from pioneer3.log.cut import CHUNK, HEADER, MAGIC, MESSAGE, data_records

if TYPE_CHECKING:
    from mcap.data_stream import ReadDataStream
    from mcap.records import Channel, Schema

MOST_UNPACKED: Final = 64 * 1024 * 1024
"""A larger chunk is not unpacked [bytes]; ours have one MiB."""
MOST_RECORD: Final = 64 * 1024 * 1024
"""A larger record is not read [bytes]."""
MOST_CHUNKS: Final = 1_000_000
"""Chunks of one file at most; ours have 96,000 a day."""
NONE: Final = frozenset[int]()
"""Channels of a chunk of which none is known yet."""
MOST_LOOSE: Final = 1024 * 1024
"""Messages without chunks are read in parts of this size [bytes], or a message more."""
SCHEMA: Final = 0x03
"""Kind of a record; the others likewise."""
CHANNEL: Final = 0x04
MESSAGE_INDEX: Final = 0x07
"""Kind of a record: the places of the messages of one channel, behind their chunk."""
CHUNK_INDEX: Final = 0x08
"""Kind of a record of the summary."""
STATISTICS: Final = 0x0B
METADATA: Final = 0x0C
METADATA_INDEX: Final = 0x0D
SUMMARY_OFFSET: Final = 0x0E
FOOTER: Final = struct.Struct("<BQQQI8s")
"""Kind, length, begin of the summary and of its offsets, checksum; then the magic bytes."""
GROUP: Final = struct.Struct("<BQBQQ")
"""Kind, length; kind, begin and length of a group in the summary."""
OF_MESSAGE: Final = 22
"""Bytes of a message before its content."""
MESSAGE_HEAD: Final = struct.Struct("<HIQ")
"""Begin of a message: its channel, its number, its time [ns]."""
TIMES: Final = struct.Struct("<QQ")
"""Begin of a chunk: times of its first and last message [ns]."""
CHUNK_HEAD: Final = struct.Struct("<QQQII")
"""Begin of a chunk: these times, bytes when it is unpacked, their checksum, and the length of the
name of the packing."""
LENGTH: Final = 8
"""Bytes of the length of what is packed, which comes before it."""
UNTOLD: Final = -1
"""Length of what is packed by zstd where it does not tell it."""
PLACE: Final = struct.Struct("<QQQQI")
"""Begin of a chunk's index: times of its first and last message, place and length of the chunk's
record, and length of the list of its channels."""
OF_CHANNEL: Final = struct.Struct("<HQ")
"""Entry of that list: the channel, and the place of the record about its messages."""
DAMAGED: Final = (
    ValueError,
    KeyError,
    IndexError,
    TypeError,
    AttributeError,
    EOFError,
    MemoryError,
    OverflowError,
    RecursionError,
    struct.error,
    msgspec.MsgspecError,
)
"""Errors of readers about a damaged file."""


@dataclass(frozen=True, slots=True)
class LogRecord:
    """A message as it lies in a file, with its head, and what tells of it."""

    time: int
    channel: "Channel"
    schema: "Schema | None"
    data: bytes


@dataclass(slots=True)
class LogChunk:
    """A chunk: the times of its first and last message [ns], its place, and its channels.

    One that is not packed is a part of a file that has messages without chunks.
    """

    file: "LogFile"
    begin: int
    end: int
    offset: int
    length: int
    channels: frozenset[int]
    is_packed: bool = True

    @property
    def topics(self) -> set[str]:
        """Topics that have messages in it."""
        return {self.file.channels[channel].topic for channel in self.channels}

    def records(self, wanted: Callable[[str], bool] = lambda topic: True) -> list[LogRecord]:
        """Read the messages of the topics that are wanted, as they lie there."""
        found = list[LogRecord]()
        with self.file.path.open("rb") as file:
            content = _content(file, self.offset, self.length)
        for kind, data in unpacked(content) if self.is_packed else split(content):
            if kind == MESSAGE:
                number, _, time = MESSAGE_HEAD.unpack_from(data)
                channel = self.file.channels[number]
                if wanted(channel.topic):
                    schema = self.file.schemas.get(channel.schema_id)
                    found.append(LogRecord(time, channel, schema, data))
        return found


class LogFile:
    """One of the files of a log, with its channels and schemas by their numbers."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.channels: dict[int, Channel] = {}
        self.schemas: dict[int, Schema] = {}
        self._sets: dict[frozenset[int], frozenset[int]] = {}

    def chunks(self) -> list[LogChunk]:
        """Return its chunks."""
        with self.path.open("rb") as file:
            try:
                found = self._indexed(file)
            except DAMAGED:
                found = []
            found = found or self._scanned(file)
        for chunk in found:
            if not chunk.channels <= self.channels.keys():
                raise ValueError("a message is of no topic")
        return found

    def _note(self, kind: int, content: bytes) -> None:
        """Note a channel or a schema."""
        from mcap.records import Channel, Schema

        if kind == CHANNEL:
            channel = Channel.read(stream(content))
            self.channels[channel.id] = channel
        elif kind == SCHEMA:
            schema = Schema.read(stream(content))
            self.schemas[schema.id] = schema

    def _indexed(self, file: BinaryIO) -> list[LogChunk]:
        """Return the chunks by the index at the end of a file; none if it has none."""
        found: list[LogChunk] = []
        size = file.seek(0, 2)
        for _, data in summary_groups(file, size, {SCHEMA, CHANNEL, CHUNK_INDEX}):
            for kind, content in split(data):
                self._note(kind, content)
                if kind == CHUNK_INDEX:
                    found.append(self._chunk(content, size))
        found.sort(key=attrgetter("offset"))
        ends = [0, *(chunk.offset + chunk.length for chunk in found)]
        for chunk, before in zip(found, ends, strict=False):
            known = chunk.channels and chunk.channels <= self.channels.keys()
            if chunk.offset < before or not known:
                raise ValueError("its index is wrong")
        return found

    def _chunk(self, content: bytes, size: int) -> LogChunk:
        begin, end, offset, length, told = PLACE.unpack_from(content)
        listed = content[PLACE.size : PLACE.size + told]
        if len(listed) != told or offset + length > size or begin > end:
            raise ValueError("its index is wrong")
        channels = self._same(channel for channel, _ in OF_CHANNEL.iter_unpack(listed))
        return LogChunk(self, begin, end, offset + HEADER, length - HEADER, channels)

    def _same(self, channels: Iterable[int]) -> frozenset[int]:
        """Return the one set of these channels: most chunks have the same."""
        found = frozenset(channels)
        return self._sets.setdefault(found, found)

    def _scanned(self, file: BinaryIO) -> list[LogChunk]:
        """Return the chunks by the heads of all records; messages without one are chunks, too."""
        found: list[LogChunk] = []
        last: LogChunk | None = None
        for kind, at, length, head in data_records(file):
            if kind == CHUNK and length >= TIMES.size:
                begin, end = TIMES.unpack(head)
                last = LogChunk(self, begin, end, at, length, NONE)
                found.append(last)
            elif kind == MESSAGE_INDEX and last is not None:
                number = int.from_bytes(head[:2], "little")
                if number not in last.channels:
                    last.channels = self._same((*last.channels, number))
            elif kind == MESSAGE and length >= OF_MESSAGE:
                number, _, time = MESSAGE_HEAD.unpack_from(head)
                if last is None or last.is_packed or last.length > MOST_LOOSE:
                    last = LogChunk(self, time, time, at - HEADER, 0, NONE, is_packed=False)
                    found.append(last)
                last.begin, last.end = min(last.begin, time), max(last.end, time)
                last.length = at + length - last.offset
                if number not in last.channels:
                    last.channels = self._same((*last.channels, number))
            elif kind in {SCHEMA, CHANNEL}:
                self._note(kind, _content(file, at, length))
            if len(found) > MOST_CHUNKS:
                raise ValueError(f"more than {MOST_CHUNKS} chunks")
        for chunk in found:
            if chunk.is_packed and not (chunk.channels and chunk.channels <= self.channels.keys()):
                chunk.channels = self._same(
                    self._seen_in(_content(file, chunk.offset, chunk.length))
                )
        return [chunk for chunk in found if chunk.channels]

    def _seen_in(self, content: bytes) -> Iterator[int]:
        """Yield the channel of each message of a chunk, and note all that it tells of them."""
        for kind, data in unpacked(content):
            self._note(kind, data)
            if kind == MESSAGE:
                yield int.from_bytes(data[:2], "little")


def summary_groups(file: BinaryIO, size: int, kinds: set[int]) -> Iterator[tuple[int, bytes]]:
    """Yield the groups of some kinds in the index at the end of a file; none if it has none."""
    at = size - FOOTER.size
    if at < len(MAGIC):
        return
    file.seek(at)
    *_, summary, offsets, _, magic = FOOTER.unpack(file.read(FOOTER.size))
    if magic != MAGIC or not 0 < summary < offsets < at:
        return
    file.seek(offsets)
    for group, begin, length in _groups(file.read(min(at - offsets, 100 * GROUP.size))):
        if group in kinds:
            if not summary <= begin <= begin + length <= offsets or length > MOST_RECORD:
                raise ValueError("its index is wrong")
            file.seek(begin)
            yield group, file.read(length)


def split(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the records in some bytes."""
    at = 0
    while at + HEADER <= len(data):
        length = int.from_bytes(data[at + 1 : at + HEADER], "little")
        if at + HEADER + length > len(data):
            raise ValueError("a record is longer than what holds it")
        yield data[at], data[at + HEADER : at + HEADER + length]
        at += HEADER + length


def _groups(data: bytes) -> Iterator[tuple[int, ...]]:
    """Yield the places of the groups of an index."""
    for at in range(0, len(data) - GROUP.size + 1, GROUP.size):
        if data[at] != SUMMARY_OFFSET:
            return
        yield GROUP.unpack_from(data, at)[2:]


def unpacked(content: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield the records in a chunk."""
    *_, size, _, told = CHUNK_HEAD.unpack_from(content)
    packed_by = bytes(content[CHUNK_HEAD.size : CHUNK_HEAD.size + told])
    at = CHUNK_HEAD.size + told + LENGTH
    data = content[at : at + int.from_bytes(content[at - LENGTH : at], "little")]
    if size > MOST_UNPACKED:
        raise ValueError(f"a chunk of {size} bytes")
    if packed_by == b"zstd":
        import zstandard

        if zstandard.frame_content_size(data) not in {size, UNTOLD}:
            raise ValueError("a chunk has another length than it says")
        unpacker = zstandard.ZstdDecompressor(max_window_size=MOST_UNPACKED)
        data = unpacker.decompress(data, max_output_size=size) if size else b""
    elif packed_by:
        raise ValueError(f"packed by {packed_by.decode()!r}: `mcap recompress` packs it by zstd")
    if len(data) != size:
        raise ValueError("a chunk is shorter than it says")
    yield from split(data)


def stream(data: bytes) -> "ReadDataStream":
    from mcap.data_stream import ReadDataStream

    return ReadDataStream(BytesIO(data))


def _content(file: BinaryIO, at: int, length: int) -> bytes:
    if not 0 <= length <= MOST_RECORD:
        raise ValueError(f"a record has {length} bytes")
    file.seek(at)
    return file.read(length)
