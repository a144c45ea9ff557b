"""Reads the YAML that map_server files are made of: a flat table of scalars and number lists.

PyYAML would be a dependency for six keys. What is nested belongs to keys that nobody here knows,
and is skipped.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pioneer3.sim.maps.text import Line, numbered, shown

_ENTRY = re.compile(r"""(?:"([^"]*)"|'([^']*)'|([A-Za-z_][\w.-]*))\s*:(?:\s+(.*))?""")
_ITEM = re.compile(r"\s*-\s+(.*)")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_TRUE, _FALSE = ("1", "true", "yes", "on"), ("0", "false", "no", "off")


@dataclass(frozen=True, slots=True)
class Field:
    """A key with its value, and where it stands."""

    line: Line
    key: str
    text: str

    def number(self, low: float, high: float) -> float:
        """Return a number from `low` to `high`.

        Raises:
            ConfigError: It is none, or out of range.
        """
        return self._number(self.text, low, high)

    def numbers(self, count: int, low: float, high: float) -> tuple[float, ...]:
        """Return `count` numbers from a list such as `[1, 2.5]`.

        Raises:
            ConfigError: It is no such list.
        """
        inside = re.fullmatch(r"\[(.*)\]", self.text)
        items = inside[1].rstrip(" ,").split(",") if inside else []
        if len(items) != count:
            raise self.line.wrong(
                self.key, f"expected a list of {count} numbers, not {shown(self.text)}"
            )
        return tuple(self._number(item.strip(), low, high) for item in items)

    def flag(self) -> bool:
        """Return true or false, also written 1 or 0.

        Raises:
            ConfigError: It is neither.
        """
        word = self.text.lower()
        if word not in _TRUE + _FALSE:
            raise self.line.wrong(self.key, f"expected 0 or 1, not {shown(self.text)}")
        return word in _TRUE

    def string(self) -> str:
        """Return the value without quotes.

        Raises:
            ConfigError: It is empty.
        """
        text = self.text
        if len(text) > 1 and text[0] == text[-1] == "'":
            text = text[1:-1].replace("''", "'")
        elif len(text) > 1 and text[0] == text[-1] == '"':
            text = re.sub(r"\\(.)", r"\1", text[1:-1])
        if not text:
            raise self.line.wrong(self.key, "has no value")
        return text

    def _number(self, word: str, low: float, high: float) -> float:
        if not _NUMBER.fullmatch(word):
            raise self.line.wrong(self.key, f"{shown(word)} is not a number")
        value = float(word)
        if not low <= value <= high:
            raise self.line.wrong(self.key, f"{shown(word)} is not in {low:g} to {high:g}")
        return value


def read_flat(path: Path, text: str) -> dict[str, Field]:
    """Read the text of a file.

    Raises:
        ConfigError: A line is no entry, or a key repeats.
    """
    found: dict[str, Field] = {}
    for field in _fields(path, text):
        if field.key in found:
            raise field.line.wrong(field.key, f"is on line {found[field.key].line.number} too")
        found[field.key] = field
    return found


def _fields(path: Path, text: str) -> Iterator[Field]:
    """Yield the entries, lists over several lines brought onto one."""
    current: Field | None = None
    items: list[str] = []
    for number, raw in numbered(text):
        content = _without_comment(raw)
        if not content.strip() or content.startswith(("---", "...", "%")):
            continue
        line = Line(path, number, content.strip())
        is_open = current is not None and current.text.startswith("[") and "]" not in current.text
        if current is not None and is_open:
            current = Field(current.line, current.key, f"{current.text} {line.text}")
        elif current is not None and not current.text and (item := _ITEM.fullmatch(content)):
            items.append(item[1])
        elif content[0] in " \t" and current is not None:
            continue
        elif entry := _ENTRY.fullmatch(line.text):
            if current is not None:
                yield _closed(current, items)
            key = entry[1] or entry[2] or entry[3] or ""
            current, items = Field(line, key, (entry[4] or "").strip()), []
        else:
            raise line.wrong("line", f"expected 'key: value', not {shown(line.text)}")
    if current is not None:
        yield _closed(current, items)


def _closed(field: Field, items: list[str]) -> Field:
    return Field(field.line, field.key, f"[{', '.join(items)}]") if items else field


def _without_comment(raw: str) -> str:
    """Return `raw` up to a `#` that follows a blank and stands in no quotes."""
    quote = ""
    for at, char in enumerate(raw):
        if quote:
            quote = "" if char == quote else quote
        elif char in "\"'" and raw[:at].rstrip().endswith((":", "-", "[", ",")):
            quote = char
        elif char == "#" and (at == 0 or raw[at - 1] in " \t"):
            return raw[:at].rstrip()
    return raw.rstrip()
