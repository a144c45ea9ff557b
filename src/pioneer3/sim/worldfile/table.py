"""Looks keys up in a TOML table; what is wrong is named with file, line and field."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from math import isfinite
from typing import TypeVar

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.maps.text import shown
from pioneer3.units import DEGREE

Word = TypeVar("Word", bound=str)

LONGEST_KEY = 40
FARTHEST = 1e5
"""Of a coordinate [m]."""


@dataclass(frozen=True, slots=True)
class Source:
    """A file: its name and its text, in which the lines of fields are found again."""

    name: str
    text: str

    def wrong(self, place: str, problem: str) -> ConfigError:
        """Return the one-line error about the field at `place`, such as `box[1].size`."""
        line = self._line(place)
        where = f"{self.name}:{line}" if line else self.name
        return ConfigError(f"{where}: {place}: {problem}")

    def _line(self, place: str) -> int | None:
        """Return the line of a field, or of its table; `None` where it is not plain to see."""
        table, _, key = place.partition(".")
        name, _, index = table.rstrip("]").partition("[")
        brackets = r"\[\[\s*{}\s*\]\]" if index else r"\[\s*{}\s*\]"
        heading = re.compile(rf"^\s*{brackets.format(re.escape(name))}\s*(#.*)?$")
        lines = self.text.splitlines()
        heads = [at for at, line in enumerate(lines) if heading.match(line)]
        if int(index or 0) >= len(heads):
            return None
        head = heads[int(index or 0)]
        first = re.split(r"[.\[]", key)[0]
        entry = re.compile(rf"^\s*[\"']?{re.escape(first)}[\"']?\s*=")
        for at in range(head + 1, len(lines)):
            if re.match(r"^\s*\[+\s*[A-Za-z_]", lines[at]):
                break
            if first and entry.match(lines[at]):
                return at + 1
        return head + 1


@dataclass(frozen=True, slots=True)
class Table:
    """A table of a file, and its place in it."""

    source: Source
    place: str
    data: Mapping[str, object]

    def only(self, known: Sequence[str]) -> None:
        """Refuse keys that are not among `known`.

        Raises:
            ConfigError: There is one; names the nearest.
        """
        for key in self.data:
            if key not in known:
                close = get_close_matches(key[:LONGEST_KEY], known, n=1)
                hint = f"did you mean {close[0]}?" if close else f"known are {', '.join(known)}"
                name = key if key.isprintable() and 0 < len(key) <= LONGEST_KEY else shown(key)
                raise self.source.wrong(self._at(name), f"unknown key, {hint}")

    def wrong(self, key: str, problem: str) -> ConfigError:
        """Return the error that says what is wrong with `key`."""
        return self.source.wrong(self._at(key), problem)

    def tables(self, key: str) -> "Iterator[Table]":
        """Yield the tables of `[[key]]`.

        Raises:
            ConfigError: They are no such tables.
        """
        items = self.data.get(key, [])
        if not isinstance(items, list):
            raise self.wrong(key, f"expected [[{key}]], with two brackets")
        for index, item in enumerate(items):
            yield self._table(f"{key}[{index}]", item)

    def table(self, key: str) -> "Table | None":
        """Return the table `[key]`, if there is one.

        Raises:
            ConfigError: It is no table.
        """
        return self._table(key, self.data[key]) if key in self.data else None

    def number(self, key: str, low: float, high: float, default: float | None = None) -> float:
        """Return a number from `low` to `high`; without a default it must be there."""
        return self._checked(key, self._given(key, default), low, high)

    def whole(self, key: str, low: int, high: int) -> int | None:
        """Return a whole number, or `None` if it is not given."""
        if key not in self.data:
            return None
        value = self.data[key]
        if isinstance(value, bool) or not isinstance(value, int):
            raise self.wrong(key, f"expected a whole number, got {_said(value)}")
        self._checked(key, value, low, high)
        return value

    def flag(self, key: str, *, default: bool) -> bool:
        """Return true or false."""
        value = self.data.get(key, default)
        if not isinstance(value, bool):
            raise self.wrong(key, f"expected true or false, got {_said(value)}")
        return value

    def string(self, key: str, default: str | None = None) -> str:
        """Return a text of one line."""
        value = self._given(key, default)
        if not isinstance(value, str):
            raise self.wrong(key, f"expected a text, got {_said(value)}")
        if not value.isprintable():
            raise self.wrong(key, f"{shown(value)} cannot be printed on one line")
        return value

    def choice(self, key: str, words: Sequence[Word]) -> Word | None:
        """Return one of `words`, or `None` if it is not given."""
        if key not in self.data:
            return None
        said = self.string(key)
        for word in words:
            if said == word:
                return word
        raise self.wrong(key, f"{shown(said)} is none of {', '.join(words)}")

    def pair(self, key: str, low: float, high: float) -> tuple[float, float]:
        """Return two numbers."""
        return self._pair(key, self._given(key, None), low, high)

    def points(self, key: str, least: int) -> tuple[tuple[float, float], ...]:
        """Return at least so many points [m]."""
        value = self._given(key, None)
        if not isinstance(value, list) or len(value) < least:
            expected = f"expected a list of {least} or more points [x, y]"
            raise self.wrong(key, f"{expected}, got {_said(value)}")
        return tuple(
            self._pair(f"{key}[{i}]", item, -FARTHEST, FARTHEST) for i, item in enumerate(value)
        )

    def pose(self) -> Pose2:
        """Return `x`, `y` [m] and `theta_deg`, which may be left out."""
        x, y = (self.number(axis, -FARTHEST, FARTHEST) for axis in "xy")
        return Pose2(x, y, self.angle("theta_deg"))

    def angle(self, key: str) -> float:
        """Return an angle given in degrees [rad], 0 if it is left out."""
        return wrap(self.number(key, -360, 360, 0.0) * DEGREE)

    def _pair(self, key: str, value: object, low: float, high: float) -> tuple[float, float]:
        if not isinstance(value, list) or len(value) != 2:
            raise self.wrong(key, f"expected two numbers, got {_said(value)}")
        return self._checked(key, value[0], low, high), self._checked(key, value[1], low, high)

    def _checked(self, key: str, value: object, low: float, high: float) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self.wrong(key, f"expected a number, got {_said(value)}")
        if not low <= value <= high:
            size = f"{value:g}" if abs(value) < 1e300 and isfinite(value) else "this number"
            raise self.wrong(key, f"{size} is out of range, expected {low:g} to {high:g}")
        return float(value)

    def _given(self, key: str, default: object) -> object:
        value = self.data.get(key, default)
        if value is None:
            raise self.wrong(key, "missing, add it")
        return value

    def _table(self, key: str, value: object) -> "Table":
        if not isinstance(value, dict):
            raise self.wrong(key, f"expected a table, got {_said(value)}")
        return Table(self.source, self._at(key), value)

    def _at(self, key: str) -> str:
        return f"{self.place}.{key}" if self.place else key


def _said(value: object) -> str:
    """Return `value` for a message; deep and long ones cut short."""
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if isinstance(value, int) and value.bit_length() > 128:
        return "a huge number"
    return shown(value) if isinstance(value, str) else str(value)
