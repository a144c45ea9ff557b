"""Reads the text of worlds of Stage: tokens, includes and macros become entities.

Such a text holds properties, `size [1 2]`, and entities, `model ( ... )`. After
`define floorplan model ( ... )` the word `floorplan` stands for a model with that content. As in
Stage the first definition of a macro counts, and the text of an include stands in its place.
"""

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from math import inf, isfinite, nan
from pathlib import Path, PureWindowsPath
from typing import NamedTuple

from pioneer3.errors import ConfigError
from pioneer3.sim.relief.shapes import FARTHEST
from pioneer3.text import TextLine, decoded, read_bytes, shown

LARGEST_STAGE = 1 << 20
"""Larger files are not read [bytes]."""
MOST_FILES = 64
"""Most files of one world."""
MOST_BYTES = 2 << 20
"""Most text of one world, with its includes [bytes]."""
MOST_TOKENS = 150_000
"""Most words, numbers and brackets of one world."""
MOST_USES = 50_000
"""Most entities of one world, those that macros bring counted each time."""
MOST_NESTED = 24
"""Deepest nesting of includes, of entities, and of macros of macros."""
ABOVE = 4
"""So many folders of a file and above it are looked into."""
SEARCH_PATH = "STAGEPATH"
"""Variable of the environment: folders in which Stage looks for includes."""
_TOKEN = re.compile(
    r"""[ \t\f\v\0]+ | \#[^\r\n]* | (?P<end>\r\n|\r|\n)
      | "(?P<string>[^"\r\n]*)" | (?P<word>[A-Za-z_][\w.-]*(?:\[\d+\][\w.]*)*)
      | (?P<number>[-+.\d][\w.+-]*) | (?P<mark>[()\[\]])""",
    re.VERBOSE,
)


class _Token(NamedTuple):
    """A token; `kind` is string, word, number or mark."""

    kind: str
    text: str
    line: TextLine


@dataclass(frozen=True, slots=True)
class StageProperty:
    """The values of a property as written, without quotes, and their line."""

    line: TextLine
    key: str
    values: tuple[str, ...]

    def numbers(self) -> tuple[float, ...]:
        """Return the values as numbers: lengths and angles."""
        return tuple(self._number(word, FARTHEST) for word in self.values)

    def number(self) -> float:
        """Return the first value as a number of any size."""
        return self._number(self.values[0] if self.values else "", inf)

    def wrong(self, problem: str) -> ConfigError:
        """Return the error about this property."""
        return self.line.wrong(self.key, problem)

    def _number(self, word: str, most: float) -> float:
        value = nan
        with suppress(ValueError):
            value = float(word)
        if not isfinite(value):
            raise self.wrong(f"{shown(word)} is not a number")
        if abs(value) > most:
            raise self.wrong(f"{shown(word)} is not within {most:g}")
        return value


@dataclass(frozen=True, slots=True, kw_only=True)
class StageEntity:
    """An entity, such as a model, a sensor or a block, with its properties by their names.

    `kinds` is the word before its brackets; that of a macro, then those that it stands for.
    """

    kinds: tuple[str, ...]
    line: TextLine
    properties: dict[str, StageProperty] = field(default_factory=dict)
    children: list["StageEntity"] = field(default_factory=list)

    def numbers(self, key: str) -> tuple[float, ...]:
        """Return the numbers of a property, none where it is missing."""
        return self.properties[key].numbers() if key in self.properties else ()

    def number(self, key: str, default: float) -> float:
        """Return the first number of a property."""
        return self.properties[key].number() if key in self.properties else default

    def text(self, key: str) -> str:
        """Return the first value of a property, empty where it is missing."""
        return next(iter(self.properties[key].values), "") if key in self.properties else ""


class StageText:
    """A world of Stage, with what it includes; `world` is all outside of macros, as one entity.

    `missing` are sentences on files that are not where a line names them.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.missing: list[str] = []
        self.macros: dict[str, StageEntity] = {}
        self._files = self._bytes = self._count = 0
        self._at = self._uses = 0
        self._tokens = list(self._tokens_of(path, (), None))
        self.world = StageEntity(kinds=("",), line=TextLine(path, 1, ""))
        self._fill(self.world, 0)

    def resolved(self, entity: StageEntity) -> StageEntity:
        """Return an entity with all that the macros in its name bring."""
        self._uses += 1
        if self._uses > MOST_USES:
            raise entity.line.wrong(entity.kinds[0], f"more than {MOST_USES} entities")
        layers = [entity]
        while macro := self.macros.get(layers[-1].kinds[-1]):
            layers.append(macro)
            if len(layers) > MOST_NESTED:
                raise macro.line.wrong(entity.kinds[0], "is defined by itself, or too deeply")
        properties: dict[str, StageProperty] = {}
        for layer in reversed(layers):
            properties |= layer.properties
        return StageEntity(
            kinds=tuple(layer.kinds[-1] for layer in layers),
            line=entity.line,
            properties=properties,
            children=[child for layer in reversed(layers) for child in layer.children],
        )

    def find(self, name: str, said: TextLine) -> Path | None:
        """Return the file that a line names, or `None`.

        As in Stage it is seen from the folder of the world, or lies in one of `STAGEPATH`; else it
        is seen from the file that names it, or where :func:`places_of` has it.
        """
        there = Path(name).expanduser() if name.startswith("~") else Path(name)
        base = PureWindowsPath(name).name
        stage = [Path(each) for each in os.environ.get(SEARCH_PATH, "").split(os.pathsep) if each]
        tried = [self.path.parent / there, *(each / base for each in stage)]
        tried += [said.path.parent / there, *places_of(name, self.path)]
        for path in tried:
            with suppress(OSError, ValueError):
                if path.is_file():
                    return path
        return None

    def _tokens_of(
        self, path: Path, within: tuple[Path, ...], said: TextLine | None
    ) -> Iterator[_Token]:
        """Yield the tokens of a file, those of an include in its place."""
        text = self._text(path, within, said)
        at, number, line = 0, 1, TextLine(path, 1, "")
        include = False
        while at < len(text):
            found = _TOKEN.match(text, at)
            if found is None:
                problem = "no end of a text in quotes" if text[at] == '"' else "not of Stage"
                raise line.wrong("syntax", f"{shown(text[at : at + 20])}: {problem}")
            at, kind = found.end(), found.lastgroup
            if kind == "end":
                number += 1
                line = TextLine(path, number, "")
            elif include and kind:
                if kind != "string":
                    raise line.wrong("include", 'expected a file in quotes, as in "map.inc"')
                include = False
                if inner := self.find(found[kind], line):
                    yield from self._tokens_of(inner, (*within, path), line)
                else:
                    self.missing.append(f"{line.number}: {found[kind]} is not there")
            elif kind == "word" and found[kind] == "include":
                include = True
            elif kind:
                self._count += 1
                if self._count > MOST_TOKENS:
                    raise line.wrong("syntax", f"more than {MOST_TOKENS} words and numbers")
                yield _Token(kind, found[kind], line)

    def _text(self, path: Path, within: tuple[Path, ...], said: TextLine | None) -> str:
        """Read a file, within the limits."""
        if said and path.resolve() in (each.resolve() for each in within):
            raise said.wrong("include", f"{shown(path.name)} includes itself")
        if said and len(within) > MOST_NESTED:
            raise said.wrong("include", f"more than {MOST_NESTED} files in each other")
        raw = read_bytes(path, LARGEST_STAGE, "world")
        self._files += 1
        self._bytes += len(raw)
        if said and (self._files > MOST_FILES or self._bytes > MOST_BYTES):
            most = f"{MOST_FILES} files or {MOST_BYTES >> 20} MB"
            raise said.wrong("include", f"a world of more than {most}")
        return decoded(raw)

    def _fill(self, entity: StageEntity, depth: int) -> None:
        """Read what is in an entity, and its closing bracket."""
        while self._at < len(self._tokens):
            token = self._next(entity.line)
            if token.text == ")" and token.kind == "mark" and depth:
                return
            if token.kind != "word":
                expected = "expected a name, as in size [1 1] or model ( )"
                raise token.line.wrong(shown(token.text), expected)
            if token.text == "define":
                name, parent = self._next(token.line), self._next(token.line)
                macro = self._entity(parent, depth)
                self.macros.setdefault(name.text, macro)
            elif self._tokens[self._at : self._at + 1] and self._tokens[self._at][:2] == (
                "mark",
                "(",
            ):
                entity.children.append(self._entity(token, depth))
            else:
                values = self._values(token)
                entity.properties[token.text] = StageProperty(token.line, token.text, values)
        if depth:
            raise entity.line.wrong(entity.kinds[0], "has no closing bracket )")

    def _entity(self, name: _Token, depth: int) -> StageEntity:
        if name.kind != "word" or self._next(name.line).text != "(":
            raise name.line.wrong(shown(name.text), "expected a name and ( here")
        if depth >= MOST_NESTED:
            raise name.line.wrong(name.text, f"more than {MOST_NESTED} entities in each other")
        entity = StageEntity(kinds=(name.text,), line=name.line)
        self._fill(entity, depth + 1)
        return entity

    def _values(self, name: _Token) -> tuple[str, ...]:
        """Read the value of a property, or all values between brackets."""
        first = self._next(name.line)
        if first.kind in ("number", "string"):
            return (first.text,)
        if first.text != "[":
            raise first.line.wrong(name.text, f"expected a value, not {shown(first.text)}")
        values = []
        while (token := self._next(name.line)).text != "]" or token.kind == "string":
            if token.kind not in ("number", "string"):
                raise token.line.wrong(
                    name.text, f"expected a number or ], not {shown(token.text)}"
                )
            values.append(token.text)
        return tuple(values)

    def _next(self, line: TextLine) -> _Token:
        if self._at >= len(self._tokens):
            raise line.wrong("syntax", "the file ends in the middle; is it whole?")
        self._at += 1
        return self._tokens[self._at - 1]


def places_of(name: str, file: Path) -> Iterator[Path]:
    """Yield where a file named by the path of another computer may be: in folders above `file`.

    In each of them the whole path is tried first, and its last part alone last.
    """
    parts = PureWindowsPath(name).parts
    for folder in file.resolve().parents[:ABOVE]:
        for first in range(len(parts)):
            yield folder.joinpath(*parts[first:])
