"""Keys and values of an ARIA parameter file, converted to SI.

One `Key value ...` a line, `;` starts a comment, `Section Some name` opens a section, and words
may be quoted.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Never

from pioneer3.errors import ConfigError
from pioneer3.geometry import wrap
from pioneer3.models.model import BEARING, REACH, Bounds
from pioneer3.units import DEGREE, MM

_NEWLINE = re.compile(r"\r\n|\r|\n")
_WORD = re.compile(r'"(?P<quoted>[^"]*)"|(?P<comment>;.*)|(?P<bare>[^\s;]+)')
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_FLAGS = {"true": True, "1": True, "false": False, "0": False}
_SHOWN = 40
_UNIT_COUNT = Bounds(0, 256)
_UNIT_NUMBER = Bounds(0, 255)

Mount = tuple[float, float, float]
"""x, y [m], theta [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterLine:
    """One line of the file `source`, from 1, that holds a key; its errors name all three.

    Attributes:
        section: Name of the section it stands in, lower case; empty before the first.
        key: As the file spells it.
    """

    source: str
    number: int
    section: str
    key: str
    values: tuple[str, ...]

    @property
    def is_zero(self) -> bool:
        """Whether the value is a 0, which in many keys means not given."""
        return bool(_NUMBER.fullmatch(self.values[0])) and float(self.values[0]) == 0

    def scaled(self, index: int, bounds: Bounds, unit: float) -> float:
        """Return a number times `unit` [SI], checked against `bounds` [SI]."""
        word = self.values[index]
        if not _NUMBER.fullmatch(word):
            self.refuse(f"{word[:_SHOWN]!r} is not a number")
        value = float(word)
        if not bounds.holds(value * unit):
            self.refuse(bounds.complaint(value, unit))
        return value * unit

    def whole(self, index: int, bounds: Bounds) -> int:
        """Return a whole number."""
        value = self.scaled(index, bounds, 1.0)
        if value != int(value):
            self.refuse(f"{value:g} is not a whole number")
        return int(value)

    def flag(self) -> bool:
        """Return a `true` or `false`."""
        word = self.values[0].lower()
        if word not in _FLAGS:
            self.refuse(f"{word[:_SHOWN]!r} is neither true nor false")
        return _FLAGS[word]

    def word(self) -> str:
        """Return a word that is fit to print."""
        if not self.values[0].isprintable():
            self.refuse(f"{self.values[0][:_SHOWN]!r} is not printable")
        return self.values[0]

    def refuse(self, problem: str) -> Never:
        """Raise the error of this line."""
        raise ConfigError(f"{self.source}:{self.number}: {self.key}: {problem}")


def split(text: str, source: str) -> tuple[ParameterLine, ...]:
    """Return the lines of `text` that hold a key, section headings left out."""
    lines: list[ParameterLine] = []
    section = ""
    for number, raw in enumerate(_NEWLINE.split(text), start=1):
        key, *values = _words(raw) or [""]
        if key.lower() == "section":
            section = " ".join(values).lower()
        elif key:
            line = ParameterLine(
                source=source, number=number, section=section, key=key, values=tuple(values)
            )
            lines.append(line)
    return tuple(lines)


def _words(raw: str) -> list[str]:
    matches = (match for match in _WORD.finditer(raw) if match["comment"] is None)
    return [match["bare"] if match["quoted"] is None else match["quoted"] for match in matches]


class Parameters:
    """The keys of one file or section; a key without a value counts as not given."""

    def __init__(self, source: str, lines: Iterable[ParameterLine]) -> None:
        """Take the last line of a key that repeats."""
        self._source = source
        self._all = tuple(lines)
        self._lines: Mapping[str, ParameterLine] = {line.key.lower(): line for line in self._all}

    def length(self, key: str, bounds: Bounds, default: float | None = None) -> float:
        """Return a value given in mm, or mm per something, in metres, within `bounds` [m].

        The default counts where the file has no value, or 0; without one the key is essential.
        """
        return rounded(self._scaled(key, bounds, MM, default))

    def angle(self, key: str, bounds: Bounds, default: float | None = None) -> float:
        """Return a value given in degrees, or degrees per something, in radians."""
        return self._scaled(key, bounds, DEGREE, default)

    def number(self, key: str, bounds: Bounds, default: float | None = None) -> float:
        """Return a value as it stands in the file."""
        return self._scaled(key, bounds, 1.0, default)

    def count(self, key: str, bounds: Bounds, default: int) -> int:
        """Return a whole number."""
        line = self._find(key)
        return default if line is None else line.whole(0, bounds)

    def one_of(self, key: str, choices: tuple[int, ...], default: int) -> int:
        """Return a whole number out of `choices`."""
        value = self.count(key, Bounds(min(choices), max(choices)), default)
        if value not in choices:
            self._lines[key.lower()].refuse(f"{value} is not one of {', '.join(map(str, choices))}")
        return value

    def flag(self, key: str, *, default: bool) -> bool:
        """Return a `true` or `false`."""
        line = self._find(key)
        return default if line is None else line.flag()

    def word(self, key: str, default: str = "") -> str:
        """Return a printable word."""
        line = self._find(key)
        return default if line is None else line.word()

    def pose(self, prefix: str) -> Mount:
        """Return where `{prefix}X`, `{prefix}Y` and `{prefix}Th` put a sensor."""
        x, y = (self.length(f"{prefix}{axis}", REACH, 0.0) for axis in "XY")
        return x, y, wrap(self.angle(f"{prefix}Th", BEARING, 0.0))

    def units(self, kind: str, first: int, axes: str) -> list[Mount]:
        """Return the mounts of the `{kind}Unit` lines in the order of their numbers.

        `{kind}Num` of them exist: further lines are left out, and there may be fewer lines, since
        `powerbot` lists one less (facts.md 6.3). The word number `first` holds x; `axes` are `x y`,
        or `x y th` where the lines have a direction.
        """
        lines = [line for line in self._all if line.key.lower() == f"{kind}Unit".lower()]
        mounts = dict(_unit(line, first, axes) for line in lines)
        count = self.count(f"{kind}Num", _UNIT_COUNT, max(mounts, default=-1) + 1)
        listed = sorted(number for number in mounts if number < count)
        if listed != list(range(len(listed))):
            gap = next(n for n in range(count) if n not in mounts)
            raise ConfigError(f"{self._source}: {kind}Unit {gap}: missing, number the units from 0")
        return [mounts[number] for number in listed]

    def _find(self, key: str) -> ParameterLine | None:
        line = self._lines.get(key.lower())
        return line if line and line.values and line.values[0] else None

    def _scaled(self, key: str, bounds: Bounds, unit: float, default: float | None) -> float:
        line = self._find(key)
        if default is not None and (line is None or line.is_zero):
            return default
        if line is not None:
            return line.scaled(0, bounds, unit)
        problem = f"missing, expected {bounds.in_words(unit)}"
        if blank := self._lines.get(key.lower()):
            blank.refuse(problem)
        raise ConfigError(f"{self._source}: {key}: {problem}")


def rounded(metres: float) -> float:
    """Return the float nearest to the decimal meant, so that 246 mm and 0.246 m are equal."""
    return round(metres, 12)


def _unit(line: ParameterLine, first: int, axes: str) -> tuple[int, Mount]:
    """Return the number and the pose of a unit given as `number ... x y th` in mm and degrees."""
    if len(line.values) < first + len(axes.split()):
        line.refuse(f"too few values, expected {axes} from value {first + 1} on")
    x, y = (rounded(line.scaled(first + i, REACH, MM)) for i in range(2))
    theta = wrap(line.scaled(first + 2, BEARING, DEGREE)) if "th" in axes else 0.0
    return line.whole(0, _UNIT_NUMBER), (x, y, theta)
