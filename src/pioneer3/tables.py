"""TOML files whose tables msgspec checks: reading, writing, and errors that name their line.

An error is one line of text: the file, the line, the key, the problem and a hint. A type's `Meta`
may carry words for it in `extra`: `expected` for a value of another type, and `missing`.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from types import UnionType
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

from pioneer3.errors import ConfigError
from pioneer3.maps.text import one_line, shown, wrong
from pioneer3.models.toml import load_toml
from pioneer3.names import printable

Table = TypeVar("Table")

LONGEST_KEY = 40
_EXPECTED = {
    "int": "a whole number",
    "float": "a number",
    "bool": "true or false",
    "str": "a text",
    "object": "a table",
    "array": "a list",
}
_AT_LINE = re.compile(r" ?\(at line (\d+)(?:, (column \d+))?\)$")
_HEADING = re.compile(r"^\s*\[+\s*[\"']?[A-Za-z_]")


@dataclass(frozen=True, slots=True)
class Source:
    """The name of a file, and its text, in which the lines of keys are found again."""

    name: str
    text: str

    @classmethod
    def of(cls, path: Path, text: str) -> "Source":
        """Return the source of a file's text."""
        return cls(printable(str(path)), text)

    def wrong(self, place: str, problem: str) -> ConfigError:
        """Return the one-line error about the key at `place`, such as `box[1].size`."""
        line = self.line(place)
        where = f"{self.name}:{line}" if line else self.name
        return ConfigError(f"{where}: {place}: {problem}")

    def line(self, place: str) -> int | None:
        """Return the line of a key, or of its table; `None` where neither is found."""
        table, _, rest = place.partition(".")
        name, _, index = table.rstrip("]").partition("[")
        key = re.split(r"[.\[]", rest)[0]
        lines = self.text.split("\n")
        quoted = rf"[\"']?{re.escape(name)}[\"']?"
        heading = re.compile(rf"^\s*\[\[?\s*{quoted}\s*\]\]?\s*(#.*)?$")
        heads = [at for at, line in enumerate(lines) if heading.match(line)]
        if int(index or 0) >= len(heads):
            return _key_above_tables(lines, quoted)
        head = heads[int(index or 0)]
        entry = re.compile(rf"^\s*[\"']?{re.escape(key)}[\"']?\s*[=.]")
        for at in range(head + 1, len(lines)):
            if _HEADING.match(lines[at]):
                break
            if key and entry.match(lines[at]):
                return at + 1
        return head + 1


def load(path: Path, text: str) -> dict[str, object]:
    """Return the tables in the text of a file.

    Raises:
        ConfigError: It is not valid TOML; names file and line.
    """
    try:
        return load_toml(text)
    except ValueError as error:
        problem = str(error)
        place = _AT_LINE.search(problem)
        line = place[1] if place else text.rstrip("\n").count("\n") + 1
        column = f" ({place[2]})" if place and place[2] else ""
        told = one_line(_AT_LINE.sub("", problem)) + column
        raise wrong(path, f"{line}: not valid TOML: {told}") from None


def converted(source: Source, data: dict[str, object], kind: type[Table]) -> Table:
    """Return `data` as the table `kind`.

    Raises:
        ConfigError: A key is missing or unknown, or a value is wrong.
    """
    import msgspec

    if unknown := _unknown_key(source, "", data, kind):
        raise unknown  # here, as msgspec names no place in the topmost table
    try:
        table = msgspec.convert(data, kind)
    except msgspec.ValidationError as error:
        problem, _, path = str(error).rpartition(" - at `$")
        place = path.rstrip("`").lstrip(".") if problem else ""
        raise _complaint(source, data, kind, place, problem or str(error)) from None
    for place, text in _texts(msgspec.to_builtins(table)):
        if not text.isprintable():
            raise source.wrong(place, f"{shown(text)} cannot be printed on one line")
    return table


def written(file: object) -> str:
    """Return a table of tables as TOML; defaults are left out."""
    from msgspec import to_builtins

    blocks: list[str] = []
    for key, value in to_builtins(file).items():
        heading = f"[{key}]" if isinstance(value, dict) else f"[[{key}]]"
        for table in [value] if isinstance(value, dict) else value:
            entries = (f"{name} = {_written(entry)}\n" for name, entry in table.items())
            blocks.append(f"{heading}\n" + "".join(entries))
    return "\n".join(blocks)


def nearest(name: str, known: Iterator[str] | tuple[str, ...]) -> str:
    """Return the advice for a name that is not among those known."""
    names = tuple(known)
    close = get_close_matches(name[:LONGEST_KEY], names, n=1)
    return f"did you mean {close[0]}?" if close else f"known are {', '.join(names)}"


def _key_above_tables(lines: list[str], quoted: str) -> int | None:
    """Return the line of a table that is written as a value, such as `robot = [{}]`."""
    entry = re.compile(rf"^\s*{quoted}\s*[=.]")
    for at, line in enumerate(lines):
        if entry.match(line):
            return at + 1
        if _HEADING.match(line):
            break
    return None


def _complaint(
    source: Source, data: dict[str, object], kind: type, place: str, problem: str
) -> ConfigError:
    """Return msgspec's `problem` with the key at `place` in the words of a person."""
    value: Any = data
    hint: Any = kind
    for part in re.findall(r"\w+", place):
        value = value[int(part) if part.isdecimal() else part]
        hint = _element(hint, int(part)) if part.isdecimal() else _keys(hint)[part]
    if problem.startswith("Object") and (unknown := _unknown_key(source, place, value, hint)):
        return unknown
    if missing := re.match(r"Object missing required field `(\w+)`", problem):
        key = f"{place}.{missing[1]}".lstrip(".")
        return source.wrong(key, _extra(_keys(hint)[missing[1]], "missing") or "missing, add it")
    return source.wrong(place, _misfit(place, value, hint, problem))


def _unknown_key(
    source: Source, place: str, table: dict[str, object], hint: object
) -> ConfigError | None:
    """Return the error about the first unknown key of a table, if there is one."""
    known = _keys(hint)
    key = next((key for key in table if key not in known), None)
    if key is None:
        return None
    named = key if key.isprintable() and 0 < len(key) <= LONGEST_KEY else shown(key)
    advice = nearest(key, tuple(known))
    return source.wrong(f"{place}.{named}" if place else named, f"unknown key, {advice}")


def _misfit(place: str, value: object, hint: object, problem: str) -> str:
    """Return the problem of a value, and the expected ones."""
    if expected := _extra(hint, "expected"):
        return f"expected {expected}, got {_said(value)}"
    if problem.startswith("Invalid enum value"):
        choices = [part for part in _parts(hint) if isinstance(part, str)]
        close = get_close_matches(str(value)[:LONGEST_KEY], choices, n=1)
        meant = f", did you mean {close[0]}?" if close else ""
        return f"{shown(str(value))} is not one of {', '.join(choices)}{meant}"
    if re.match(r"Expected `\w+` [<>]=|Number out of range", problem):
        low, high = next((p.ge, p.le) for p in _parts(hint) if getattr(p, "ge", None) is not None)
        return f"{_said(value)} is out of range, expected {low:g} to {high:g}"
    if problem.startswith("Expected `array") and place.isidentifier():
        return f"expected [[{place}]], with two brackets"
    return f"expected {_EXPECTED[re.split(r'[` ]+', problem)[1]]}, got {_said(value)}"


def _extra(hint: Any, word: str) -> str:
    """Return what the type hint or one of its alternatives, not their elements, says to people."""
    alternatives = get_args(hint) if get_origin(hint) in {Union, UnionType} else (hint,)
    notes = (note for each in alternatives for note in getattr(each, "__metadata__", ()))
    said = (note.extra[word] for note in notes if word in (getattr(note, "extra", None) or {}))
    return str(next(said, ""))


def _element(hint: Any, index: int) -> Any:
    """Return the hint of a list's element."""
    items = next(get_args(part) for part in _parts(hint) if getattr(part, "__origin__", 0) is tuple)
    return items[0] if items[-1] is Ellipsis else items[index]


def _parts(hint: Any) -> Iterator[Any]:
    """Yield a type hint and all that it is made of."""
    yield hint
    for part in (*getattr(hint, "__metadata__", ()), *get_args(hint)):
        yield from _parts(part)


def _keys(hint: Any) -> dict[str, Any]:
    """Return the keys of the table that a type hint names, and the hint of each."""
    table = next(part for part in _parts(hint) if hasattr(part, "__struct_fields__"))
    hints = get_type_hints(table, include_extras=True)
    names = zip(table.__struct_encode_fields__, table.__struct_fields__, strict=True)
    return {key: hints[name] for key, name in names}


def _texts(value: object, place: str = "") -> Iterator[tuple[str, str]]:
    """Yield every text in `value` with its place."""
    if isinstance(value, str):
        yield place, value
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _texts(item, f"{place}.{key}" if place else key)
    elif isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield from _texts(item, f"{place}[{index}]")


def _said(value: object) -> str:
    """Return `value` for a message; deep and long ones cut short."""
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if isinstance(value, int) and value.bit_length() > 128:
        return "a huge number"
    if isinstance(value, str):
        return shown(value)
    return str(value) if isinstance(value, bool) or not isinstance(value, float) else f"{value:g}"


def _written(value: object) -> str:
    """Return a value as TOML has it."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_written(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_written, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    if not isinstance(value, str):
        return repr(value)
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return '"' + "".join(c if c.isprintable() else f"\\u{ord(c):04X}" for c in escaped) + '"'
