"""The `Cairn:` and `MapInfo:` lines of an ARIA map (arcos.md 10.2, 10.3)."""

import re
from collections.abc import Iterable
from math import cos, radians, sin

from pioneer3.geometry import Pose2, wrap
from pioneer3.sim.maps.line_map import MapObject
from pioneer3.sim.maps.text import Line, shown
from pioneer3.units import MM

STANDARD_LINES = frozenset({"ForbiddenLine", "Reflector"})
"""Types whose four numbers are the ends of a line, whether a MapInfo declares them or not."""

_WORD = re.compile(r'"([^"]*)"|(\S+)')
_NAME = re.compile(r"Name=(\S+)")


def words(text: str) -> list[str]:
    """Split at blanks; double quotes keep a word together and are dropped."""
    return [quoted or bare for quoted, bare in _WORD.findall(text)]


def line_types(infos: Iterable[str]) -> frozenset[str]:
    """Return the object types that are lines.

    Args:
        infos: The values of the MapInfo lines.
    """
    declared = set(STANDARD_LINES)
    for info in infos:
        kind, *settings = words(info) or [""]
        names = [match[1] for word in settings if (match := _NAME.fullmatch(word))]
        if kind == "BoundaryType":
            declared.update(names)
    return frozenset(declared)


def cairn(line: Line, value: str, lines: frozenset[str]) -> MapObject:
    """Return the object that a `Cairn:` line describes.

    Args:
        line: Where it stands, for errors.
        value: What follows `Cairn:`.
        lines: The types whose four numbers are the ends of a line; all others are areas.

    Raises:
        ConfigError: Fields are missing, left over or not numbers.
    """
    fields = words(value)
    if len(fields) not in (7, 11):
        raise line.wrong("Cairn", f"{len(fields)} fields instead of 7 or 11 in {shown(value)}")
    kind, name, corners_mm = fields[0], fields[6], fields[7:]
    x_mm, y_mm, theta_deg = line.numbers("Cairn", fields[1:4])
    theta = radians(theta_deg)
    outline: tuple[tuple[float, float], ...] = ()
    if corners_mm:
        x0, y0, x1, y1 = (MM * number for number in line.numbers("Cairn", corners_mm))
        outline = ((x0, y0), (x1, y1)) if kind in lines else rectangle(x0, y0, x1, y1, theta)
    pose = Pose2(MM * x_mm, MM * y_mm, wrap(theta))
    return MapObject(kind=kind, name=name, pose=pose, outline=outline)


def rectangle(
    x0: float, y0: float, x1: float, y1: float, theta: float
) -> tuple[tuple[float, float], ...]:
    """Return the corners of an area, in order [m].

    ARIA's code turns the two given corners by `theta` [rad] about the origin of the map, whatever
    its documents say (arcos.md 10.2).
    """
    c, s = cos(theta), sin(theta)
    corners = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    return tuple((c * x - s * y, s * x + c * y) for x, y in corners)
