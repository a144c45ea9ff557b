"""A part of a log, as a log of its own."""

import os
import struct
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO, Final

from pioneer3.errors import ConfigError
from pioneer3.log.chunks import OF_MESSAGE, LogRecord
from pioneer3.log.folder import create, create_log, pin
from pioneer3.log.index import LogIndex
from pioneer3.log.mcap import PROFILE
from pioneer3.log.reader import messages_of
from pioneer3.log.topics import EXCERPT, TOTALS, totals

TOLD_ONCE: Final = {"map", "estimate", "way", "standing", "limits", "model"}
"""Topics of a robot that are told when they change: the newest before an excerpt begins it."""
SAVED: Final = "saved"
"""Title of an excerpt among the user's logs."""
NOTE: Final = "note"
"""Metadata of an excerpt: why somebody kept it."""
END: Final = {"why": EXCERPT}
"""End of an excerpt."""


def write_excerpt(log: LogIndex, path: Path, begin: int, end: int) -> int:
    """Write the messages from `begin` to `end` [ns since 1970] to a new file; return how many.

    Bytes of links, snapshots and scans are kept by the second.

    Raises:
        ConfigError: The log is damaged or has nothing then, or the file cannot be written.
    """
    with _created(path, lambda: (path, create(path))) as (_, file):
        return _write(log, file, begin, end, {})


def save_excerpt(
    log: LogIndex, folder: Path, begin: int, end: int, note: Mapping[str, str]
) -> Path:
    """Write such an excerpt to the user's logs, pinned, with a note; return its path.

    Raises:
        ConfigError: As of :func:`write_excerpt`.
    """
    with _created(folder, lambda: create_log(folder, SAVED, end / 1e9)) as (path, file):
        _write(log, file, begin, end, {NOTE: note})
        with suppress(OSError):  # a file system without modes
            pin(path, on=True)
        return path


@contextmanager
def _created(where: Path, make: Callable[[], tuple[Path, int]]) -> Iterator[tuple[Path, BinaryIO]]:
    """Open a new file during the block, and remove it if that fails."""
    try:
        path, descriptor = make()
    except OSError as error:
        raise ConfigError(f"{where}: cannot be written: {error.strerror}") from None
    try:
        with os.fdopen(descriptor, "wb") as file:
            yield path, file
    except OSError as error:
        path.unlink(missing_ok=True)
        raise ConfigError(f"{path}: cannot be written: {error.strerror}") from None
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def _write(
    log: LogIndex, file: BinaryIO, begin: int, end: int, texts: Mapping[str, Mapping[str, str]]
) -> int:
    """Write an excerpt with more metadata; return how many messages it has."""
    from mcap.writer import Writer

    writer, counts, ended = Writer(file), Counter[str](), 0
    schemas: dict[object, int] = {None: 0}
    channels: dict[object, int] = {}
    writer.start(PROFILE, f"an excerpt of {log.path.name}")
    for name, told in {**log.info().texts, "end": END, **texts}.items():
        writer.add_metadata(name, dict(told))

    def add(record: LogRecord, time: int) -> int:
        schema, channel = record.schema, record.channel  # numbers differ from file to file
        kind = schema and (schema.name, schema.encoding, schema.data)
        if schema is not None and kind not in schemas:
            schemas[kind] = writer.register_schema(schema.name, schema.encoding, schema.data)
        key = channel.topic, channel.message_encoding, kind, *sorted(channel.metadata.items())
        if key not in channels:
            channels[key] = writer.register_channel(
                channel.topic, channel.message_encoding, schemas[kind], channel.metadata
            )
        with log.damage_told():
            _, sequence, _, published = struct.unpack_from("<HIQQ", record.data)
            told = messages_of([record])
        writer.add_message(channels[key], time, record.data[OF_MESSAGE:], published, sequence)
        counts[channel.topic] += len(told)
        return told[-1].time if told else time

    for record in log.records(begin, end):
        if not ended:
            for told_before in _told_before(log, begin):
                add(told_before, begin)
        ended = max(ended, add(record, record.time))
    if not ended:
        raise ConfigError(f"{log.path}: nothing was logged then")
    writer.add_metadata(TOTALS, totals(counts, ended))
    writer.finish()  # type: ignore[no-untyped-call]
    return counts.total()


def _told_before(log: LogIndex, begin: int) -> Iterator[LogRecord]:
    """Yield the newest messages before a time of the topics that are told once."""
    for topic in sorted(log.topics):
        newest = log.newest(topic, begin - 1) if topic.rpartition("/")[2] in TOLD_ONCE else None
        if newest is not None:
            same = log.records(newest.time, newest.time)
            yield from [each for each in same if each.channel.topic == topic][-1:]
