"""Columns of a table of messages: their names with units, and the cells of a message in them.

Each number, text or flag has a column, by its path in the message: `odometry.twist.v [m/s]`. So has
each number of a list, `sonar.ranges.3 [m]`; all other lists are JSON in one cell.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, NamedTuple

import msgspec

from pioneer3.log.topics import NO_NUMBERS, with_texts

MOST_COLUMNS: Final = 16_000
"""Columns of a table at most: spreadsheets take 16,384."""
UNITS: Final[Mapping[str, str]] = {
    "stamp": "s",
    "x": "m",
    "y": "m",
    "theta": "rad",
    "heading": "rad",
    "v": "m/s",
    "w": "rad/s",
    "left_speed": "m/s",
    "right_speed": "m/s",
    "voltage": "V",
    "analog": "V",
    "compass": "rad",
    "temperature": "deg C",
    "rate": "1/s",
    "angles": "rad",
    "ranges": "m",
    "near": "m",
    "far": "m",
    "beam_time": "s",
    "period": "s",
    "seconds": "s",
    "until": "s",
    "spread": "m",
    "turn_spread": "rad",
    "speed": "m/s",
}
"""Units of numbers by the names of their fields; all others have none."""
LISTS: Final = (list, tuple)
"""Types of lists: read from JSON, or of our own classes."""
MEASURES: Final = {float, bool}
"""Types of the numbers whose lists have columns; whole numbers in a list count or name others."""
Cell = float | int | bool | str | None
"""Content of a cell; `None` where nothing is known."""


class TableColumn(NamedTuple):
    """A column: its name with the unit, and the type of its cells."""

    name: str
    kind: type


@dataclass(slots=True)
class ValueShape:
    """The shape of all values seen at one place of messages.

    Attributes:
        parts: Of an object, by their names.
        length: Of the longest list of numbers; `None` where there was none.
        kinds: Types of the numbers in lists, or of single values.
        single: Whether there was a value that is neither an object nor a list of numbers.
        places: Below this one.
    """

    parts: "dict[str, ValueShape]" = field(default_factory=dict)
    length: int | None = None
    kinds: set[type] = field(default_factory=set)
    single: bool = False
    places: int = 0

    def see(self, value: Any) -> int:
        """Take a value into account; return how many places are new.

        Raises:
            ValueError: There are more than a table can have columns.
        """
        new = 0
        if isinstance(value, dict):
            for name, part in value.items():
                if name not in self.parts:
                    self.parts[name] = ValueShape()
                    new += 1
                new += self.parts[name].see(part)
        elif isinstance(value, LISTS) and value and (kinds := _kinds(value)) <= MEASURES:
            new = max(0, len(value) - (self.length or 0))
            self.length = max(self.length or 0, len(value))
            self.kinds |= kinds
        elif value is not None and not (isinstance(value, LISTS) and not value):
            self.single = True
            self.kinds.add(_kind(value))
        self.places += new
        if self.places > MOST_COLUMNS:
            raise ValueError(f"more than {MOST_COLUMNS} columns")
        return new

    def columns(self, path: str = "") -> Iterator[TableColumn]:
        """Yield the columns of the place."""
        if self._is_object:
            before = f"{path}." if path else ""
            for name, part in self.parts.items():
                yield from part.columns(f"{before}{name}")
            return
        unit = UNITS.get(path.rpartition(".")[2])
        after = f" [{unit}]" if unit else ""
        if self._is_list:
            for number in range(self.length or 0):
                yield TableColumn(f"{path}.{number}{after}", self._type)
        else:
            yield TableColumn(f"{path}{after}", self._type)

    def cells(self, value: Any) -> list[Cell]:
        """Return the cells of a value, one for each column."""
        row: list[Cell] = []
        self._fill(row, value)
        return row

    def _fill(self, row: list[Cell], value: Any) -> None:
        if self._is_object:
            for name, part in self.parts.items():
                part._fill(row, value.get(name) if value else None)
        elif self._is_list:
            numbers, kind = value or (), self._type
            same = {*map(type, numbers)} == {kind}
            row += numbers if same else [_cell(each, kind) for each in numbers]
            row += [None] * ((self.length or 0) - len(numbers))
        else:
            row.append(None if value is None else _cell(value, self._type))

    @property
    def _is_object(self) -> bool:
        return bool(self.parts) and not self.single and self.length is None

    @property
    def _is_list(self) -> bool:
        return self.length is not None and not self.single and not self.parts

    @property
    def _type(self) -> type:
        """Type of the cells."""
        if (self.single and (self.parts or self.length is not None)) or (self.parts and self.kinds):
            return str
        if len(self.kinds) == 1:
            return next(iter(self.kinds))
        return float if self.kinds == {int, float} else str


def _kinds(values: Sequence[Any]) -> set[type]:
    """Return the types of values."""
    kinds = {*map(type, values)}
    return kinds if kinds <= MEASURES else {*map(_kind, values)}


def _kind(value: Any) -> type:
    """Return the type of a single value; lists are texts."""
    if isinstance(value, str) and value in NO_NUMBERS:
        return float
    return type(value) if isinstance(value, float | int) else str


def _cell(value: Any, kind: type) -> Cell:
    if kind is not str:
        return kind(value)  # type: ignore[no-any-return]
    if isinstance(value, str):
        return value
    return msgspec.json.encode(with_texts(value)).decode()
