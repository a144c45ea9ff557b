"""A table as comma-separated values (RFC 4180), with the head that the page's files have, too."""

import csv
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Final, Self

from pioneer3.log.columns import Cell, TableColumn

TIME: Final = "time"
"""Name of the first column: UTC, as ISO 8601 has it."""
ELAPSED: Final = "elapsed [s]"
"""Name of the second column: since the log began."""
FORMULA: Final = ("=", "+", "-", "@", "\t", "\r", "\n")
"""A spreadsheet takes a text for a formula that begins so."""
SECOND: Final = 10**9
"""Second [ns]."""


class CsvFile:
    """A file with a table that is being written."""

    def __init__(self, path: Path, columns: Sequence[TableColumn]) -> None:
        self._file = path.open("w", encoding="utf-8", newline="")
        self._writer = csv.writer(self._file)
        self._writer.writerow([TIME, ELAPSED, *(harmless(column.name) for column in columns)])
        self._words = [i for i, column in enumerate(columns) if column.kind in {str, bool}]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def add(self, time: int, elapsed: float, cells: Sequence[Cell]) -> None:
        """Add a row of a time [ns since 1970], so long after the log began [s]."""
        row = [*cells]
        for place in self._words:
            row[place] = _text(row[place])
        self._writer.writerow([written(time), round(elapsed, 6), *row])


def written(time: int) -> str:
    """Return a time [ns since 1970] as text, to the microsecond."""
    seconds, rest = divmod(time, SECOND)
    return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%dT%H:%M:%S}.{rest // 1000:06}Z"


def harmless(text: str) -> str:
    """Return a text that no spreadsheet takes for a formula: with an apostrophe before it."""
    return f"'{text}" if text.startswith(FORMULA) else text


def _text(cell: Cell) -> Cell:
    if isinstance(cell, str):
        return harmless(cell)
    return str(cell).lower() if isinstance(cell, bool) else cell
