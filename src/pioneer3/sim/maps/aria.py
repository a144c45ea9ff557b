"""Reads ARIA `.map` files (arcos.md 10)."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.maps.cairns import cairn, line_types
from pioneer3.sim.maps.line_map import LineMap, MapObject
from pioneer3.sim.maps.outline import outline
from pioneer3.sim.maps.text import Line, read_lines, shown, wrong
from pioneer3.units import MM

Float = NDArray[np.float64]

HEADERS = ("2D-Map", "2D-Map-Ex", "2D-Map-Ex2")
DEFAULT_RESOLUTION_MM = 20.0
RESOLUTIONS_MM = (1.0, 10_000.0)
"""Smallest and largest side of a cell that is believed."""

_SECTION = re.compile(r"(?:(\S+)_)?(LINES|DATA)")
_ENTRY = re.compile(r"([A-Za-z][\w.-]*)\s*:\s*(.*)")
_FIELDS = {"LINES": "x1 y1 x2 y2", "DATA": "x y"}


@dataclass(frozen=True, slots=True)
class _Entry:
    """A `Key: value` line."""

    line: Line
    key: str
    value: str


@dataclass(frozen=True, slots=True)
class _Section:
    """The rows [mm] below one LINES or DATA heading; `source` is empty for the default sensor."""

    source: str
    kind: str
    rows: list[tuple[float, ...]] = field(default_factory=list)

    def add(self, line: Line) -> None:
        words = line.text.split()
        if len(words) != len(_FIELDS[self.kind].split()):
            expected = _FIELDS[self.kind]
            raise line.wrong(self.kind, f"expected numbers {expected}, not {shown(line.text)}")
        self.rows.append(line.numbers(self.kind, words))

    def metres(self) -> Float:
        """Return the rows [m], shape (N, 4) for LINES and (N, 2) for DATA."""
        width = len(_FIELDS[self.kind].split())
        return np.array(self.rows, dtype=np.float64).reshape(-1, width) * MM


def read_map(path: Path) -> LineMap:
    """Read an ARIA map: headers 2D-Map, 2D-Map-Ex and 2D-Map-Ex2.

    Walls are the LINES of all sensors, the outline of their DATA points and the four sides of each
    `Sim.BoxObstacle`. Counts and boxes in the file are not trusted. The map is named
    after the file.

    Raises:
        ConfigError: The file cannot be read or is no such map; one line, `path:line: field: why`.
    """
    lines = read_lines(path)
    header = next(lines, None)
    if header is None:
        raise wrong(path, "1: header: the file is empty; a map starts with 2D-Map")
    if header.text not in HEADERS:
        names = ", ".join(HEADERS)
        raise header.wrong("header", f"expected one of {names}, not {shown(header.text)}")
    entries, sections = _parse(lines)
    kinds = line_types(entry.value for entry in entries if entry.key == "MapInfo")
    cairns = (entry for entry in entries if entry.key == "Cairn")
    objects = tuple(cairn(entry.line, entry.value, kinds) for entry in cairns)
    return LineMap(
        name=path.stem,
        walls=_walls(entries, sections, objects),
        homes=tuple(item.pose for item in objects if item.kind == "RobotHome"),
        objects=objects,
    )


def _parse(lines: Iterable[Line]) -> tuple[list[_Entry], list[_Section]]:
    entries: list[_Entry] = []
    sections: list[_Section] = []
    for line in lines:
        if heading := _SECTION.fullmatch(line.text):
            sections.append(_Section(heading[1] or "", heading[2]))
        elif entry := _ENTRY.fullmatch(line.text):
            entries.append(_Entry(line, entry[1], entry[2]))
        elif sections:
            sections[-1].add(line)
        else:
            raise line.wrong("header", f"expected 'Key: value' or LINES, not {shown(line.text)}")
    return entries, sections


def _walls(
    entries: list[_Entry], sections: list[_Section], objects: tuple[MapObject, ...]
) -> Float:
    """Return all walls [m], shape (W, 4): lines and outlines in file order, then boxes."""
    parts = [
        section.metres()
        if section.kind == "LINES"
        else outline(section.metres(), _resolution(entries, section.source))
        for section in sections
    ]
    boxes = (item.outline for item in objects if item.kind == "Sim.BoxObstacle")
    sides = [
        (*start, *end)
        for corners in boxes
        for start, end in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    return np.concatenate([*parts, np.array(sides, dtype=np.float64).reshape(-1, 4)])


def _resolution(entries: list[_Entry], source: str) -> float:
    """Return the side of a cell [m] for a sensor: its own, else the map's, else ARIA's."""
    for key in (f"{source}Resolution", "Resolution"):
        for entry in entries:
            if entry.key == key:
                return MM * _resolution_mm(entry)
    return MM * DEFAULT_RESOLUTION_MM


def _resolution_mm(entry: _Entry) -> float:
    words = entry.value.split()
    if len(words) != 1:
        raise entry.line.wrong(entry.key, f"expected one number, not {shown(entry.value)}")
    (value_mm,) = entry.line.numbers(entry.key, words)
    smallest, largest = RESOLUTIONS_MM
    if not smallest <= value_mm <= largest:
        problem = f"{value_mm:g} mm is not in {smallest:g} to {largest:g} mm"
        raise entry.line.wrong(entry.key, problem)
    return value_mm
