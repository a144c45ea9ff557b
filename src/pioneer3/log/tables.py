"""Tables of a log, one a topic: its messages as rows, in files of a folder."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from enum import StrEnum
from itertools import islice
from pathlib import Path
from typing import Any, Final, Protocol, Self

import msgspec

from pioneer3.log.chunks import DAMAGED
from pioneer3.log.columns import Cell, TableColumn, ValueShape
from pioneer3.log.csv_file import CsvFile
from pioneer3.log.output import new_output
from pioneer3.log.parquet_file import ParquetFile
from pioneer3.log.progress import Tell, followed
from pioneer3.log.reader import LogMessage, RunLog
from pioneer3.log.topics import LogTopic, is_scan, is_wire
from pioneer3.names import free_name
from pioneer3.state import Scan
from pioneer3.text import one_line, wrong

ANGLES: Final = "angles"
"""Field of scans that hardly ever changes: it has a table of its own, a row for each change."""
MOST_TABLES: Final = 900
"""Tables at most: each is an open file, of which a program has 1024."""


class TableKind(StrEnum):
    """Kinds of tables."""

    CSV = "csv"
    PARQUET = "parquet"


class TableFile(Protocol):
    """A file with a table that is being written; it closes at the end of its block."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *_: object) -> None: ...

    def add(self, time: int, elapsed: float, cells: Sequence[Cell]) -> None:
        """Add a row of a time [ns since 1970], so long after the log began [s]."""


OPEN: Final[Mapping[TableKind, Callable[[Path, Sequence[TableColumn]], TableFile]]] = {
    TableKind.CSV: CsvFile,
    TableKind.PARQUET: ParquetFile,
}
"""Makes a new file."""


@dataclass(frozen=True, slots=True)
class Row:
    """A message as a row of a table, with its time [ns since 1970]."""

    table: str
    time: int
    value: Mapping[str, Any]


def write_tables(
    log: RunLog, path: Path, kind: TableKind, *, tell: Tell = lambda share: None
) -> Mapping[str, int]:
    """Write a table of each topic to a new folder; return their rows by the names of their files.

    The log is read twice: first for the columns.

    Raises:
        ConfigError: The log is damaged or empty, pyarrow is missing, or a file cannot be written.
    """
    known = log.info()
    messages = followed(log.messages(), known, lambda share: tell(share / 2))
    shapes, count = _shapes(log, _rows(log, messages))
    if not shapes:
        raise wrong(log.path, " has no messages: there is nothing to convert")
    with new_output(path) as folder, ExitStack() as stack:
        folder.mkdir()
        names = _file_names(shapes, kind)
        files: dict[str, TableFile] = {}
        for table, shape in shapes.items():
            place, columns = folder / names[table], list(shape.columns())
            files[table] = stack.enter_context(OPEN[kind](place, columns))
        counts = dict.fromkeys(names.values(), 0)
        messages = followed(log.messages(), known, lambda share: tell(0.5 + share / 2))
        for row in islice(_rows(log, messages), count):  # one that goes on has more by now
            elapsed = (row.time - known.began) / 1e9
            try:
                files[row.table].add(row.time, elapsed, shapes[row.table].cells(row.value))
            except DAMAGED as error:
                problem = f" has a message of {row.table} that fits in no table: {one_line(error)}"
                raise wrong(log.path, problem) from error
            counts[names[row.table]] += 1
    return counts


def _shapes(log: RunLog, rows: Iterable[Row]) -> tuple[dict[str, ValueShape], int]:
    """Return the shapes of messages by tables, and the number of rows."""
    shapes: dict[str, ValueShape] = {}
    count = 0
    for row in rows:
        try:
            shapes.setdefault(row.table, ValueShape()).see(row.value)
        except ValueError as error:
            raise wrong(log.path, f" fits in no table: {row.table} has {error}") from None
        if len(shapes) > MOST_TABLES:
            raise wrong(log.path, f" has more than {MOST_TABLES} topics, too many for tables")
        count += 1
    return shapes, count


def _rows(log: RunLog, messages: Iterator[LogMessage]) -> Iterator[Row]:
    angles: dict[str, bytes] = {}
    for message in messages:
        topic = message.topic
        if is_wire(topic):
            yield Row(topic, message.time, {"bytes": message.data.hex(" ")})
        elif is_scan(topic):
            scan = log.decoded(message, LogTopic(topic, Scan))
            value = msgspec.to_builtins(scan)
            turned = value.pop(ANGLES)
            if angles.get(topic) != message.steady[1]:
                angles[topic] = message.steady[1]
                yield Row(f"{topic}/{ANGLES}", message.time, {ANGLES: turned})
            yield Row(topic, message.time, value)
        else:
            yield Row(topic, message.time, log.decoded(message, LogTopic(topic, dict)))


def _file_names(tables: Mapping[str, ValueShape], kind: TableKind) -> dict[str, str]:
    """Return a name of a file for each table that any system takes, and no two have."""
    names: dict[str, str] = {}
    for table in tables:
        plain = re.sub(r"[^\w]+", "-", table, flags=re.ASCII).strip("-")[:100] or "topic"
        taken = {name.lower() for name in names.values()}
        name = free_name(plain.lower(), {each.removesuffix(f".{kind}") for each in taken}, "-")
        names[table] = f"{plain}{name[len(plain) :]}.{kind}"
    return names
