"""A part of a log, as a log of its own."""

import os
import struct
from pathlib import Path
from typing import Any

from pioneer3.errors import ConfigError
from pioneer3.log.folder import create
from pioneer3.log.mcap import PROFILE
from pioneer3.log.reader import OF_MESSAGE, RunLog


def write_excerpt(log: RunLog, path: Path, begin: int, end: int) -> int:
    """Write the messages from `begin` to `end` [ns since 1970] to a new file; return how many.

    Bytes of links are kept by the second.

    Raises:
        ConfigError: The log is damaged or has nothing then, or the file cannot be written.
    """
    try:
        descriptor = create(path)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {error.strerror}") from None
    written = 0
    try:
        with os.fdopen(descriptor, "wb") as file:
            written = _write(log, file, begin, end)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written: {error.strerror}") from None
    finally:
        if not written:
            path.unlink()
    if not written:
        raise ConfigError(f"{log.path}: nothing was logged then")
    return written


def _write(log: RunLog, file: Any, begin: int, end: int) -> int:
    from mcap.writer import Writer

    writer, written = Writer(file), 0
    schemas: dict[int, int] = {0: 0}
    channels: dict[int, int] = {}
    writer.start(PROFILE, f"an excerpt of {log.path.name}")
    for name, texts in log.info().texts.items():
        writer.add_metadata(name, dict(texts))
    for record in log.records(begin, end):
        if record.schema is not None and record.schema.id not in schemas:
            schema = record.schema
            schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, schema.data)
        if record.channel.id not in channels:
            channel = record.channel
            channels[channel.id] = writer.register_channel(
                channel.topic,
                channel.message_encoding,
                schemas[channel.schema_id],
                channel.metadata,
            )
        number, sequence, time, published = struct.unpack_from("<HIQQ", record.data)
        writer.add_message(channels[number], time, record.data[OF_MESSAGE:], published, sequence)
        written += 1
    writer.finish()  # type: ignore[no-untyped-call]
    return written
