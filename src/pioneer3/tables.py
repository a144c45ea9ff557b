"""TOML files read into frozen dataclasses and written from them; errors name their line.

A dataclass, or the `Struct` of a message, is a table, its fields are the keys, and msgspec checks
their types. A `Meta` in an `Annotated` type says the range, and in its `extra` words for errors:
`expected` for a wrong value, and `missing`. A :class:`FieldForm` there is for a field that files
have in another form.

An error is one line of text: the file, the line, the key, the problem and a hint.
"""

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from difflib import get_close_matches
from enum import Enum
from functools import cache
from math import degrees, radians
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Final, TypeVar, Union, get_args, get_origin, get_type_hints

import msgspec
from msgspec import structs

from pioneer3.errors import ConfigError
from pioneer3.names import printable
from pioneer3.text import one_line, shown

Table = TypeVar("Table")
Read = Callable[[Any], Any]

LONGEST_KEY: Final = 40
MOST_PARTS: Final = 16
"""Parts of a dotted key. tomllib needs memory by their square: 8 GB for 50 thousand."""
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+"""
_LONG_KEY = re.compile(rf"""(?<![\w"'-])(?:{_PART}){{{MOST_PARTS}}}""")
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
_PLACE = re.compile(r"([^.\[]*)(?:\[(\d+)\])?[^.]*\.?([^.\[]*)")


@dataclass(frozen=True, slots=True)
class FieldForm:
    """The form that files have a field in.

    Attributes:
        name: The key; empty for a field that is in no file.
        type: Its type in the file; `None` for that of the field.
        read: Makes the field from the value in the file; `write` does the reverse.
        spread: Whether `type` is a dataclass whose keys stand among those beside the field.
    """

    name: str = ""
    type: Any = None
    read: Read = lambda value: value
    write: Read = lambda value: value
    spread: bool = False


def in_degrees(name: str, low: float, high: float) -> FieldForm:
    """Return the key of an angle or a turn rate that is from `low` to `high` [rad, rad/s]."""
    limits = msgspec.Meta(ge=degrees_of(low), le=degrees_of(high))
    return FieldForm(name, Annotated[float, limits], radians, degrees_of)


def degrees_of(angle: float) -> float:
    """Return an angle as files have it."""
    return round(degrees(angle), 12)


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
        return ConfigError(": ".join(filter(None, (where, printable(place), problem))))

    def line(self, place: str) -> int | None:
        """Return the line of a key, or of its table; `None` where neither is found."""
        if not place:
            return None
        name, index, key = _PLACE.findall(place)[0]
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


def load(source: Source) -> dict[str, Any]:
    """Return the tables of a file.

    Raises:
        ConfigError: It is not valid TOML; names file and line.
    """
    if long := _LONG_KEY.search(source.text):
        line = source.text.count("\n", 0, long.start()) + 1
        problem = f"a key of more than {MOST_PARTS} parts (at line {line})"
    else:
        try:
            return tomllib.loads(source.text)
        except RecursionError:
            problem = "nested too deeply"
        except ValueError as error:
            problem = str(error)
    place = _AT_LINE.search(problem)
    at = place[1] if place else source.text.rstrip("\n").count("\n") + 1
    column = f" ({place[2]})" if place and place[2] else ""
    told = one_line(_AT_LINE.sub("", problem)) + column
    raise ConfigError(f"{source.name}:{at}: not valid TOML: {told}")


def converted(
    source: Source, table: Mapping[str, Any], kind: type[Table], place: str = ""
) -> Table:
    """Return the table at `place` as the dataclass `kind`.

    Raises:
        ConfigError: A key is missing or unknown, or a value is wrong.
    """
    known = keys(kind)
    for name in table:
        if name not in known:
            named = name if name.isprintable() and 0 < len(name) <= LONGEST_KEY else shown(name)
            advice = nearest(_keys_by_field(kind).get(name, name), known)
            raise source.wrong(_below(place, named), f"unknown key, {advice}")
    values = {}
    for field, usual, hint, key in _keyed(kind):
        at = _below(place, key.name)
        if key.spread:
            own = {name: table[name] for name in keys(key.type) if name in table}
            values[field] = key.read(converted(source, own, key.type, place))
        elif key.name in table:
            values[field] = key.read(_value(source, at, table[key.name], key.type or hint))
        elif usual is MISSING:
            raise source.wrong(at, _extra(hint, "missing") or "missing, add it")
    try:
        return kind(**values)
    except ConfigError as error:
        raise source.wrong(place, str(error)) from None


def keys(kind: type[Any]) -> tuple[str, ...]:
    """Return the keys of the table that a dataclass is."""
    return tuple(_keys_by_field(kind).values())


def _keys_by_field(kind: type[Any]) -> dict[str, str]:
    found: dict[str, str] = {}
    for name, _, _, key in _keyed(kind):
        found |= _keys_by_field(key.type) if key.spread else {name: key.name}
    return found


def table_of(value: object) -> dict[str, Any]:
    """Return the table that a dataclass is; defaults are left out."""
    table: dict[str, Any] = {}
    for field, usual, _, key in _keyed(type(value)):
        item = getattr(value, field)
        if key.spread:
            table |= table_of(key.write(item))
        elif item is not None and item != usual:
            table[key.name] = _plain(key.write(item))
    return table


def written(tables: Mapping[str, Any]) -> str:
    """Return tables, and lists of tables, as TOML."""
    blocks: list[str] = []
    for key, value in tables.items():
        heading = f"[{key}]" if isinstance(value, dict) else f"[[{key}]]"
        for table in [value] if isinstance(value, dict) else value:
            entries = (f"{name} = {_written(entry)}\n" for name, entry in table.items())
            blocks.append(f"{heading}\n" + "".join(entries))
    return "\n".join(blocks)


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the advice for a name that is not among those known."""
    names = tuple(known)
    close = get_close_matches(name[:LONGEST_KEY], names, n=1)
    return f"did you mean {close[0]}?" if close else f"known are {', '.join(names)}"


def _keyed(kind: Any) -> tuple[tuple[str, Any, Any, FieldForm], ...]:
    """Return the fields of a dataclass that files have, each with its default, type and key."""
    return _found(kind)


@cache
def _found(kind: Any) -> tuple[tuple[str, Any, Any, FieldForm], ...]:
    hints = get_type_hints(kind, include_extras=True)
    found = []
    for name, usual in _defaults(kind):
        notes = getattr(hints[name], "__metadata__", ())
        key = next((note for note in notes if isinstance(note, FieldForm)), FieldForm(name))
        if key.name or key.spread:
            found.append((name, usual, hints[name], key))
    return tuple(found)


def _defaults(kind: Any) -> Iterator[tuple[str, Any]]:
    """Yield the fields that a table can give, each with its default, if only `MISSING`."""
    if not is_dataclass(kind):  # a message of a robot
        for each in structs.fields(kind):
            yield each.name, MISSING if each.required else each.default
        return
    for field in fields(kind):
        if field.init:
            made = field.default_factory
            yield field.name, field.default if made is MISSING else made()


def _is_table(kind: object) -> bool:
    return is_dataclass(kind) or hasattr(kind, "__struct_fields__")


def _below(place: str, key: str) -> str:
    return f"{place}.{key}" if place else key


def _key_above_tables(lines: list[str], quoted: str) -> int | None:
    """Return the line of a table that is written as a value, such as `robot = [{}]`."""
    entry = re.compile(rf"^\s*{quoted}\s*[=.]")
    for at, line in enumerate(lines):
        if entry.match(line):
            return at + 1
        if _HEADING.match(line):
            break
    return None


def _value(source: Source, place: str, value: object, hint: Any) -> Any:
    """Return a value as the type `hint`: a table, a list of tables, or what msgspec knows."""
    choices = _alternatives(hint)
    table: Any = next(filter(_is_table, choices), None)
    if table and isinstance(value, dict):
        return converted(source, value, table, place)
    item = next((get_args(each)[0] for each in choices if get_origin(each) is tuple), None)
    if any(map(_is_table, _alternatives(item))):
        if isinstance(value, list):
            return tuple(
                _value(source, f"{place}[{index}]", each, item) for index, each in enumerate(value)
            )
        hint = tuple[dict[str, Any], ...]
    elif choices == (table,):
        hint = dict[str, Any]
    try:
        checked = msgspec.convert(value, hint)
    except msgspec.ValidationError as error:
        raise _complaint(source, place, value, hint, str(error)) from None
    for at, text in _texts(checked, place):
        if not text.isprintable():
            raise source.wrong(at, f"{shown(text)} cannot be printed on one line")
    return checked


def _complaint(source: Source, place: str, value: Any, hint: Any, told: str) -> ConfigError:
    """Return the error that msgspec told, in the words of a person."""
    problem, _, path = told.rpartition(" - at `$")
    for index in map(int, re.findall(r"\d+", path if problem else "")):
        value, hint, place = value[index], _element(hint, index), f"{place}[{index}]"
    return source.wrong(place, _misfit(place, value, hint, problem or told))


def _misfit(place: str, value: object, hint: object, problem: str) -> str:
    """Return the problem of a value, and the expected ones."""
    if expected := _extra(hint, "expected"):
        return f"expected {expected}, got {_said(value)}"
    if problem.startswith("Invalid enum value"):
        choices = [part for part in _parts(hint) if isinstance(part, str | int)]
        words = [choice for choice in choices if isinstance(choice, str)]
        close = get_close_matches(str(value)[:LONGEST_KEY], words, n=1)
        meant = f", did you mean {close[0]}?" if close else ""
        return f"{_said(value)} is not one of {', '.join(map(str, choices))}{meant}"
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
    items = next(get_args(part) for part in _parts(hint) if get_origin(part) is tuple)
    return items[0] if items[-1] is Ellipsis else items[index]


def _alternatives(hint: Any) -> tuple[Any, ...]:
    """Return the types of a union, or the one type, without annotations."""
    if get_origin(hint) is Annotated:
        return _alternatives(get_args(hint)[0])
    if get_origin(hint) in {Union, UnionType}:
        return tuple(each for part in get_args(hint) for each in _alternatives(part))
    return (hint,)


def _parts(hint: Any) -> Iterator[Any]:
    """Yield a type hint and all that it is made of."""
    yield hint
    inner = tuple(hint) if isinstance(hint, type) and issubclass(hint, Enum) else get_args(hint)
    for part in (*getattr(hint, "__metadata__", ()), *inner):
        yield from _parts(part)


def _texts(value: object, place: str = "") -> Iterator[tuple[str, str]]:
    """Yield every text in `value` with its place."""
    if isinstance(value, str):
        yield place, value
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _texts(item, _below(place, key))
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


def _plain(value: object) -> object:
    """Return a value as TOML's types have it."""
    if _is_table(value):
        return table_of(value)
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    return value.value if isinstance(value, Enum) else value


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
