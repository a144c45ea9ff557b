"""Reads ARIA `.map` files (arcos.md 10): headers 2D-Map, 2D-Map-Ex and 2D-Map-Ex2."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.sim.maps.cairns import cairn, object_types
from pioneer3.sim.maps.cells import Cells, cells_of
from pioneer3.sim.maps.line_map import LineMap, MapObject, solid_walls
from pioneer3.sim.maps.outline import outline
from pioneer3.sim.maps.text import Line, lines_of, shown, wrong
from pioneer3.units import MM

Float = NDArray[np.float64]
Refuse = Callable[[ConfigError], None]

HEADERS = ("2D-Map", "2D-Map-Ex", "2D-Map-Ex2")
DEFAULT_RESOLUTION_MM = 20.0
RESOLUTIONS_MM = (1.0, 10_000.0)
"""Smallest and largest side of a cell that is believed."""

_SECTION = re.compile(r"(?:(\S+)_)?(LINES|DATA)")
_ENTRY = re.compile(r"([A-Za-z][\w.-]*)\s*:\s*(.*)")
_FIELDS = {"LINES": "x1 y1 x2 y2", "DATA": "x y"}


@dataclass(frozen=True, slots=True)
class Entry:
    """A `Key: value` line."""

    line: Line
    key: str
    value: str


@dataclass(frozen=True, slots=True)
class Section:
    """The rows [mm] below one LINES or DATA heading; `source` is empty for the default sensor.

    Attributes:
        source: The sensor.
        kind: LINES or DATA.
        rows: Their numbers [mm].
        at: The line of the file that each row stands on.
    """

    source: str
    kind: str
    rows: list[tuple[float, ...]] = field(default_factory=list)
    at: list[int] = field(default_factory=list)

    def add(self, line: Line) -> None:
        """Read one more row."""
        words = line.text.split()
        if len(words) != len(_FIELDS[self.kind].split()):
            expected = _FIELDS[self.kind]
            raise line.wrong(self.kind, f"expected numbers {expected}, not {shown(line.text)}")
        self.rows.append(line.numbers(self.kind, words))
        self.at.append(line.number)

    def metres(self) -> Float:
        """Return the rows [m], shape (N, 4) for LINES and (N, 2) for DATA."""
        width = len(_FIELDS[self.kind].split())
        return np.array(self.rows, dtype=np.float64).reshape(-1, width) * MM


class Place(NamedTuple):
    """An object and the line it stands on."""

    line: Line
    item: MapObject


@dataclass(frozen=True, slots=True)
class AriaFile:
    """A map file as it stands, with its line numbers."""

    path: Path
    entries: tuple[Entry, ...]
    sections: tuple[Section, ...]
    places: tuple[Place, ...]

    def line_map(self) -> LineMap:
        """Return the map in SI, named after the file.

        Walls are the LINES of all sensors, the outline of their DATA points and the outlines of
        solid objects, in this order. Counts and boxes in the file are not trusted.

        Raises:
            ConfigError: A resolution is wrong.
        """
        objects = tuple(place.item for place in self.places)
        parts: list[Float] = []
        lines: list[Float] = []
        cells: list[Cells] = []
        for section in self.sections:
            rows, grid = section.metres(), None
            if section.kind == "DATA":
                side = self._resolution(section.source)
                grid, rows = cells_of(rows, side), outline(rows, side)
            parts.append(rows)
            if grid is None:
                lines.append(rows)
            else:
                cells.append(grid)
        solid = solid_walls(objects)
        return LineMap(
            name=self.path.stem,
            walls=np.concatenate([*parts, solid]),
            homes=tuple(item.pose for item in objects if item.kind == "RobotHome"),
            objects=objects,
            cells=tuple(cells),
            lines=np.concatenate([*lines, solid]),
        )

    def _resolution(self, source: str) -> float:
        """Return the side of a cell [m] for a sensor: its own, else the map's, else ARIA's."""
        for key in (f"{source}Resolution", "Resolution"):
            for entry in self.entries:
                if entry.key == key:
                    return MM * _resolution_mm(entry)
        return MM * DEFAULT_RESOLUTION_MM


def _raise(error: ConfigError) -> None:
    raise error


def parse_aria(path: Path, text: str, refuse: Refuse = _raise) -> AriaFile:
    """Read the text of a map file.

    Args:
        path: The file, for messages and the map's name.
        text: All of it.
        refuse: Called with what is wrong with a line; if it returns, the line is left out.

    Raises:
        ConfigError: It is no such map; one line, `path:line: field: why`.
    """
    lines = lines_of(path, text)
    header = next(lines, None)
    if header is None:
        raise wrong(path, "1: header: the file is empty; a map starts with 2D-Map")
    if header.text not in HEADERS:
        names = ", ".join(HEADERS)
        raise header.wrong("header", f"expected one of {names}, not {shown(header.text)}")
    entries, sections = _parse(lines, refuse)
    types = object_types(entry.value for entry in entries if entry.key == "MapInfo")
    places: list[Place] = []
    for entry in entries:
        if entry.key == "Cairn":
            try:
                places.append(Place(entry.line, cairn(entry.line, entry.value, types)))
            except ConfigError as error:
                refuse(error)
    return AriaFile(path, tuple(entries), tuple(sections), tuple(places))


def _parse(lines: Iterable[Line], refuse: Refuse) -> tuple[list[Entry], list[Section]]:
    entries: list[Entry] = []
    sections: list[Section] = []
    for line in lines:
        try:
            if heading := _SECTION.fullmatch(line.text):
                sections.append(Section(heading[1] or "", heading[2]))
            elif entry := _ENTRY.fullmatch(line.text):
                entries.append(Entry(line, entry[1], entry[2]))
            elif sections:
                sections[-1].add(line)
            else:
                problem = f"expected 'Key: value' or LINES, not {shown(line.text)}"
                raise line.wrong("header", problem)
        except ConfigError as error:
            refuse(error)
    return entries, sections


def _resolution_mm(entry: Entry) -> float:
    words = entry.value.split()
    if len(words) != 1:
        raise entry.line.wrong(entry.key, f"expected one number, not {shown(entry.value)}")
    (value_mm,) = entry.line.numbers(entry.key, words)
    smallest, largest = RESOLUTIONS_MM
    if not smallest <= value_mm <= largest:
        problem = f"{value_mm:g} mm is not in {smallest:g} to {largest:g} mm"
        raise entry.line.wrong(entry.key, problem)
    return value_mm
