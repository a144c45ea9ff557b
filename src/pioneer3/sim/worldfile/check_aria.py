"""Checks the text of an ARIA map: every bad line, counts, boxes, lines without length, doubles."""

from collections.abc import Iterator
from pathlib import Path

from pioneer3.errors import ConfigError
from pioneer3.sim.maps.aria import AriaFile, Section, parse_aria
from pioneer3.sim.worldfile.remark import Level, Remark, some, warning

_COUNTS = {"LINES": "NumLines", "DATA": "NumPoints"}
_BOXES = {"LINES": ("LineMinPos", "LineMaxPos"), "DATA": ("MinPos", "MaxPos")}
ROUNDING_MM = 1.0
MOST_ERRORS = 1000


def check_aria(path: Path, text: str) -> Iterator[Remark]:
    """Yield what is wrong with the text of a map file, line by line."""
    errors: list[ConfigError] = []

    def note(error: ConfigError) -> None:
        if len(errors) < MOST_ERRORS:
            errors.append(error)

    try:
        file = parse_aria(path, text, note)
    except ConfigError as error:
        yield as_remark(path, error)
        return
    yield from some((as_remark(path, error) for error in errors), "errors")
    yield from _header(file)
    for section in file.sections:
        if section.kind == "LINES":
            yield from some(_without_length(section), "lines without length")
            yield from some(_doubles(section), "doubled lines")


def as_remark(path: Path, error: ConfigError) -> Remark:
    """Return an error about the file at `path` as a remark, its line taken out of the text."""
    text = str(error).removeprefix(f"{path}:").strip()
    number, _, rest = text.partition(":")
    line = int(number) if number.isdecimal() else None
    return Remark(level=Level.ERROR, text=rest.strip() if line else text, line=line)


def _header(file: AriaFile) -> Iterator[Remark]:
    """Yield where counts and boxes in the header disagree with what follows."""
    for entry in file.entries:
        for section in file.sections:
            if entry.key == section.source + _COUNTS[section.kind]:
                there = len(section.rows)
                if entry.value.strip() != str(there):
                    said = f"{entry.key} says {entry.value[:20]!a}, there are {there}"
                    yield warning(said, entry.line.number)
            elif entry.key in [section.source + key for key in _BOXES[section.kind]]:
                corner = _corner(section, is_low="Min" in entry.key)
                if corner and not _agrees(entry.value, corner):
                    x, y = corner
                    said = f"{entry.key} says {entry.value[:30]!a}, it is {x:g} {y:g}"
                    yield warning(said, entry.line.number)


def _corner(section: Section, *, is_low: bool) -> tuple[float, float] | None:
    """Return the lowest or highest x and y of a section [mm]."""
    points = section.rows.reshape(-1, 2)
    if not len(points):
        return None
    x, y = (points.min(axis=0) if is_low else points.max(axis=0)).tolist()
    return x, y


def _agrees(value: str, corner: tuple[float, float]) -> bool:
    try:
        numbers = [float(word) for word in value.split()]
    except ValueError:
        return False
    return len(numbers) == 2 and all(
        abs(said - true) <= ROUNDING_MM for said, true in zip(numbers, corner, strict=True)
    )


def _rows(section: Section) -> Iterator[tuple[tuple[float, ...], int]]:
    """Yield each row with its line."""
    yield from zip(map(tuple, section.rows.tolist()), section.at.tolist(), strict=True)


def _without_length(section: Section) -> Iterator[Remark]:
    for row, line in _rows(section):
        if row[:2] == row[2:]:
            yield warning(f"a line without length at {row[0]:g} {row[1]:g}", line)


def _doubles(section: Section) -> Iterator[Remark]:
    seen: dict[tuple[float, ...], int] = {}
    for row, line in _rows(section):
        key = min(row, row[2:] + row[:2])
        if key in seen:
            yield warning(f"the same line as on line {seen[key]}", line)
        seen.setdefault(key, line)
