"""Reads ARIA `.map` files (facts.md 10)."""

import re
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from pioneer3.arrays import Float, Int
from pioneer3.errors import ConfigError
from pioneer3.maps.aria_objects import object_types, parse_object
from pioneer3.maps.grid import grid_of, outline
from pioneer3.maps.line_map import LineMap, MapObject, OccupancyGrid, solid_walls
from pioneer3.text import LARGEST_MM, TextLine, lines_of, shown, wrong
from pioneer3.units import MM

Refuse = Callable[[ConfigError], None]

HEADER = re.compile(r"2D-Map(-Ex\d*)?")
"""First line: each edition of the format adds entries that do not concern us."""
DEFAULT_RESOLUTION_MM = 20.0
RESOLUTIONS_MM = (1.0, 10_000.0)
"""Smallest and largest side of a cell that is accepted [mm]."""

_SECTION = re.compile(r"(?:(\S+)_)?(LINES|DATA)")
_ENTRY = re.compile(r"([A-Za-z][\w.-]*)\s*:\s*(.*)")
_WORDED = re.compile(r"^[ \t]*[A-Za-z]", re.MULTILINE)
BLOCK = 1 << 18
"""Rows are read in pieces of about so many letters."""
_COMMENT = re.compile(r"^[ \t]*[#;].*", re.MULTILINE)
MOST_LINES = 2_000_000
MOST_ENTRIES = 50_000
MOST_SECTIONS = 100
"""Files with more are not read; ARIA's largest map has 64 thousand lines."""
_FIELDS = {"LINES": "x1 y1 x2 y2", "DATA": "x y"}


@dataclass(frozen=True, slots=True)
class AriaEntry:
    """A `Key: value` line."""

    line: TextLine
    key: str
    value: str


@dataclass(frozen=True, slots=True)
class Section:
    """The rows [mm] below one LINES or DATA heading; `source` is empty for the default sensor."""

    source: str
    kind: str
    _numbers: "array[float]" = field(default_factory=lambda: array("d"))
    _lines: "array[int]" = field(default_factory=lambda: array("q"))

    @property
    def width(self) -> int:
        """Numbers in a row."""
        return len(_FIELDS[self.kind].split())

    @property
    def rows(self) -> Float:
        """Their numbers [mm], shape (N, 4) for LINES and (N, 2) for DATA."""
        return np.array(self._numbers).reshape(-1, self.width)

    @property
    def at(self) -> Int:
        """The line of the file that each row stands on, shape (N,)."""
        return np.array(self._lines)

    def add(self, line: TextLine) -> None:
        """Read one more row."""
        words = line.text.split(None, self.width)
        if len(words) != self.width:
            expected = _FIELDS[self.kind]
            raise line.wrong(self.kind, f"expected numbers {expected}, not {shown(line.text)}")
        self._numbers.extend(line.numbers(self.kind, words))
        self._lines.append(line.number)

    def add_block(self, text: str, number: int) -> bool:
        """Read the lines of `text`, of which the first is line `number`, all at once.

        Return whether all are rows; else nothing is taken, and they are to be read one by one.
        """
        if len(text) > 2 * BLOCK:  # one endless line
            return False
        try:
            text = _COMMENT.sub("", text)
            words = text.split()
            values = np.fromiter(map(float, words), np.float64, len(words))
            told = np.frombuffer(f"\n{text}".encode("ascii"), dtype=np.uint8)
        except ValueError:
            return False
        blank = told <= ord(" ")
        begins = np.flatnonzero(blank[:-1] & ~blank[1:]) + 1
        ends = np.flatnonzero(told == ord("\n"))
        counts = np.diff(np.searchsorted(begins, np.append(ends, len(told))))
        if not np.isin(counts, (0, self.width)).all() or counts.sum() != len(words):
            return False
        if not (abs(values) <= LARGEST_MM).all():  # written so that NaN fails too
            return False
        self._numbers.frombytes(values.tobytes())
        self._lines.frombytes((np.flatnonzero(counts) + number).astype(np.int64).tobytes())
        return True


class AriaPlace(NamedTuple):
    """An object and the line it stands on."""

    line: TextLine
    item: MapObject


@dataclass(frozen=True, slots=True)
class AriaFile:
    """A map file with its line numbers."""

    path: Path
    entries: tuple[AriaEntry, ...]
    sections: tuple[Section, ...]
    places: tuple[AriaPlace, ...]

    def line_map(self) -> LineMap:
        """Return the map in SI, named after the file.

        Walls are the LINES of all sensors, the outline of their DATA points and the outlines of
        solid objects, in this order. Counts and boxes in the file are not trusted.
        """
        objects = tuple(place.item for place in self.places)
        parts, lines = list[Float](), list[Float]()
        grids: list[OccupancyGrid] = []
        for section in self.sections:
            rows, grid = section.rows * MM, None
            if not len(rows):
                continue
            if section.kind == "DATA":
                side = self._resolution(section.source)
                grid, rows = grid_of(rows, side), outline(rows, side)
            parts.append(rows)
            if grid is None:
                lines.append(rows)
            else:
                grids.append(grid)
        solid = solid_walls(objects)
        return LineMap(
            name=self.path.stem,
            walls=_joined([*parts, solid]),
            homes=tuple(item.pose for item in objects if item.kind == "RobotHome"),
            objects=objects,
            grids=tuple(grids),
            lines=_joined([*lines, solid]),
        )

    def _resolution(self, source: str) -> float:
        """Return the side of a cell [m] for a sensor: its own, else the map's, else ARIA's.

        0 and -1 stand for none, as in maps that were drawn.
        """
        for key in (f"{source}Resolution", "Resolution"):
            for entry in self.entries:
                if entry.key == key and (value_mm := resolution_mm(entry)):
                    return MM * value_mm
        return MM * DEFAULT_RESOLUTION_MM


def _joined(parts: list[Float]) -> Float:
    """Return all segments in one read-only array, shape (W, 4)."""
    there = [part for part in parts if len(part)]
    joined = there[0] if len(there) == 1 else np.concatenate(parts)
    joined.setflags(write=False)
    return joined


def _raise(error: ConfigError) -> None:
    raise error


def parse_aria(path: Path, text: str, refuse: Refuse = _raise) -> AriaFile:
    """Read the text of the map file at `path`.

    `refuse` is called with the error of a bad line; if it returns, the line is left out.

    Raises:
        ConfigError: It is no such map; one line, `path:line: field: why`.
    """
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    header = next(lines_of(path, text), None)
    if header is None:
        raise wrong(path, "1: header: the file is empty; a map starts with 2D-Map")
    if not HEADER.fullmatch(header.text):
        raise header.wrong("header", f"expected 2D-Map or 2D-Map-Ex, not {shown(header.text)}")
    entries, sections = _parse(path, text, header.number, refuse)
    types = object_types(entry.value for entry in entries if entry.key == "MapInfo")
    places: list[AriaPlace] = []
    for entry in entries:
        if entry.key == "Cairn":
            try:
                places.append(AriaPlace(entry.line, parse_object(entry.line, entry.value, types)))
            except ConfigError as error:
                refuse(error)
    return AriaFile(path, tuple(entries), tuple(sections), tuple(places))


def _parse(
    path: Path, text: str, header: int, refuse: Refuse
) -> tuple[list[AriaEntry], list[Section]]:
    """Return all that stands below the line `header`."""
    entries: list[AriaEntry] = []
    sections: list[Section] = []
    number = 1
    for block in _blocks(text):
        plain = sections and sections[-1].add_block(block, number)
        for line in () if plain else lines_of(path, block, number):
            if line.number > header:
                _read(line, entries, sections, refuse)
        number += block.count("\n")
        if number > MOST_LINES:
            raise wrong(path, f" has more than {MOST_LINES / 1e6:g} million lines")
        if len(entries) > MOST_ENTRIES or len(sections) > MOST_SECTIONS:
            most = f"{MOST_ENTRIES} entries, or {MOST_SECTIONS} headings LINES and DATA"
            raise wrong(path, f" has more than {most}")
    return entries, sections


def _blocks(text: str) -> Iterator[str]:
    """Yield `text` in pieces of whole lines: single ones that begin with a letter, and rows.

    There may be a million rows between; they come in blocks that are quick to read.
    """
    at = 0
    while at < len(text):
        worded = _WORDED.search(text, at)
        until = worded.start() if worded else len(text)
        while at < until:
            cut = text.rfind("\n", at, at + BLOCK) + 1 if at + BLOCK < until else until
            cut = cut or text.find("\n", at) + 1 or until
            yield text[at:cut]
            at = cut
        if worded:
            at = text.find("\n", until) + 1 or len(text)
            yield text[until:at]


def _read(
    line: TextLine, entries: list[AriaEntry], sections: list[Section], refuse: Refuse
) -> None:
    """Take one line."""
    try:
        if heading := _SECTION.fullmatch(line.text):
            sections.append(Section(heading[1] or "", heading[2]))
        elif entry := _ENTRY.fullmatch(line.text):
            entries.append(AriaEntry(line, entry[1], entry[2]))
        elif sections:
            sections[-1].add(line)
        else:
            problem = f"expected 'Key: value' or LINES, not {shown(line.text)}"
            raise line.wrong("header", problem)
    except ConfigError as error:
        refuse(error)


def resolution_mm(entry: AriaEntry) -> float | None:
    """Return the side of a cell that an entry tells [mm]; `None` for 0 or less."""
    words = entry.value.split()
    if len(words) != 1:
        raise entry.line.wrong(entry.key, f"expected one number, not {shown(entry.value)}")
    (value_mm,) = entry.line.numbers(entry.key, words)
    smallest, largest = RESOLUTIONS_MM
    if value_mm <= 0:
        return None
    if not smallest <= value_mm <= largest:
        problem = f"{value_mm:g} mm is not in {smallest:g} to {largest:g} mm"
        raise entry.line.wrong(entry.key, problem)
    return value_mm
