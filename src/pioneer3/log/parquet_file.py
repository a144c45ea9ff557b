"""A table as Parquet, where pyarrow is installed."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, Self

from pioneer3.distribution import how_to_add
from pioneer3.errors import ConfigError
from pioneer3.log.columns import Cell, TableColumn
from pioneer3.log.csv_file import ELAPSED, TIME

MOST_WAITING: Final = 200_000
"""Cells that wait to be written together."""


class ParquetFile:
    """A file with a table that is being written; ConfigError without pyarrow."""

    def __init__(self, path: Path, columns: Sequence[TableColumn]) -> None:
        try:
            import pyarrow
            from pyarrow.parquet import ParquetWriter
        except ImportError:
            raise ConfigError(f"Parquet needs pyarrow; run: {how_to_add('pyarrow')}") from None
        kinds = {
            float: pyarrow.float64(),
            int: pyarrow.int64(),
            bool: pyarrow.bool_(),
            str: pyarrow.string(),
        }
        self._arrow: Any = pyarrow
        self._schema = pyarrow.schema(
            [
                (TIME, pyarrow.timestamp("ns", "UTC")),
                (ELAPSED, pyarrow.float64()),
                *((column.name, kinds[column.kind]) for column in columns),
            ]
        )
        self._rows: list[tuple[Cell, ...]] = []
        self._most = max(1, MOST_WAITING // len(self._schema))
        self._writer = ParquetWriter(path, self._schema, compression="zstd")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._flush()
        self._writer.close()

    def add(self, time: int, elapsed: float, cells: Sequence[Cell]) -> None:
        """Add a row of a time [ns since 1970], so long after the log began [s]."""
        self._rows.append((time, elapsed, *cells))
        if len(self._rows) >= self._most:
            self._flush()

    def _flush(self) -> None:
        if self._rows:
            columns = [
                self._arrow.array(column, field.type)
                for column, field in zip(zip(*self._rows, strict=True), self._schema, strict=True)
            ]
            batch = self._arrow.record_batch(columns, schema=self._schema)
            self._rows.clear()
            self._writer.write_batch(batch)
