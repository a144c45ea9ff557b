"""Splits the text of an ARIA parameter file into keys and values.

One `Key value ...` a line, `;` starts a comment, `Section Some name` opens a section, and words
may be quoted.
"""

import re
from dataclasses import dataclass
from typing import Never

from pioneer3.errors import ConfigError
from pioneer3.models.bounds import Bounds

_NEWLINE = re.compile(r"\r\n|\r|\n")
_WORD = re.compile(r'"(?P<quoted>[^"]*)"|(?P<comment>;.*)|(?P<bare>[^\s;]+)')
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_FLAGS = {"true": True, "1": True, "false": False, "0": False}
_SHOWN = 40


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One line that holds a key; whatever it refuses, it names file, line and key.

    Attributes:
        source: Name of the file.
        number: Counted from 1.
        section: Name of the section it stands in, lower case; empty before the first.
        key: As the file spells it.
        values: The words after the key.
    """

    source: str
    number: int
    section: str
    key: str
    values: tuple[str, ...]

    @property
    def is_blank(self) -> bool:
        """Whether the key has no value."""
        return not self.values or not self.values[0]

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


def split(text: str, source: str) -> tuple[Line, ...]:
    """Return the lines of `text` that hold a key, section headings left out."""
    lines: list[Line] = []
    section = ""
    for number, raw in enumerate(_NEWLINE.split(text), start=1):
        key, *values = _words(raw) or [""]
        if key.lower() == "section":
            section = " ".join(values).lower()
        elif key:
            line = Line(
                source=source, number=number, section=section, key=key, values=tuple(values)
            )
            lines.append(line)
    return tuple(lines)


def _words(raw: str) -> list[str]:
    matches = (match for match in _WORD.finditer(raw) if match["comment"] is None)
    return [match["bare"] if match["quoted"] is None else match["quoted"] for match in matches]
