"""The `Cairn:` and `MapInfo:` lines of an ARIA map (facts.md 10.2, 10.3).

Their walls in the simulator, after MobileSim and AMRISim (their README, `MapLoader`):

* `Sim.BoxObstacle`, and areas of a type whose MapInfo says `Sim.Obstacle=yes`: four walls.
* `Reflector`, `Sim.Reflector`, types that end in `.Reflect`, and lines of a type whose MapInfo
  says `Sim.LaserReflect=` 2 or more: one wall. Walls have no reflectance here: a laser sees a
  reflector as a wall like any other.
* `Sim.Obstacle=no`, `Sim.LaserReflect=0` or `no` and `Sim.SonarReflect=no` ask for things that only
  some sensors see. A wall here stops robots, sonar and laser alike: `Sim.Obstacle=no` leaves
  the object out, the other two change nothing.
* All others, ForbiddenLine and ForbiddenArea among them, are objects without walls.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import cos, radians, sin
from types import MappingProxyType

from pioneer3.geometry import Pose2, wrap
from pioneer3.maps.line_map import MapObject
from pioneer3.text import TextLine, shown
from pioneer3.units import MM

STANDARD_LINES = frozenset({"ForbiddenLine", "Reflector", "Sim.Reflector"})
"""Types whose four numbers are the ends of a line, whether a MapInfo declares them or not."""
STANDARD_SOLIDS = frozenset({"Sim.BoxObstacle", "Reflector", "Sim.Reflector"})
"""Types that become walls, unless their MapInfo says `Sim.Obstacle=no`."""

_WORD = re.compile(r'"([^"]*)"|(\S+)')
_YES, _NO = ("yes", "true"), ("no", "false", "0")


@dataclass(frozen=True, slots=True)
class ObjectTypes:
    """The object types that the MapInfo lines of a map declare, with their class as `GoalType`.

    Four numbers of `lines` are their ends, of others the corners of areas; `solids` become walls;
    of those `turned_to` the MapInfo says `Heading=Required` or `Optional`.
    """

    lines: frozenset[str] = STANDARD_LINES
    solids: frozenset[str] = STANDARD_SOLIDS
    declared: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    turned_to: frozenset[str] = frozenset()


def words(text: str) -> list[str]:
    """Split at blanks; double quotes keep a word together and are dropped."""
    return [quoted or bare for quoted, bare in _WORD.findall(text)]


def object_types(infos: Iterable[str]) -> ObjectTypes:
    """Return the types that the values of MapInfo lines declare."""
    lines, solids = set(STANDARD_LINES), set(STANDARD_SOLIDS)
    declared: dict[str, str] = {}
    turned_to: set[str] = set()
    for info in infos:
        kind, *settings = words(info) or [""]
        given = dict(word.split("=", 1) for word in settings if "=" in word)
        name = given.get("Name", "")
        declared[name] = kind
        if given.get("Heading", "").lower() in ("required", "optional"):
            turned_to.add(name)
        is_line = kind == "BoundaryType"
        if is_line:
            lines.add(name)
        obstacle = given.get("Sim.Obstacle", "").lower()
        reflects = given.get("Sim.LaserReflect", "")
        if obstacle in _NO:
            solids.discard(name)
        elif (
            (obstacle in _YES and not is_line)
            or name.endswith(".Reflect")
            or (is_line and reflects.isdecimal() and reflects not in {"0", "1"})
        ):
            solids.add(name)
    return ObjectTypes(
        frozenset(lines), frozenset(solids), MappingProxyType(declared), frozenset(turned_to)
    )


def parse_object(line: TextLine, value: str, types: ObjectTypes) -> MapObject:
    """Return the object that a `Cairn:` line describes, of which `value` is the rest."""
    fields = words(value)
    if len(fields) not in (7, 11):
        raise line.wrong("Cairn", f"{len(fields)} fields instead of 7 or 11 in {shown(value)}")
    kind, name, corners_mm = fields[0], fields[6], fields[7:]
    x_mm, y_mm, theta_deg = line.numbers("Cairn", fields[1:4])
    theta = radians(theta_deg)
    outline: tuple[tuple[float, float], ...] = ()
    if corners_mm:
        x0, y0, x1, y1 = (MM * number for number in line.numbers("Cairn", corners_mm))
        is_line = kind in types.lines
        outline = ((x0, y0), (x1, y1)) if is_line else rectangle(x0, y0, x1, y1, theta)
    return MapObject(
        kind=kind,
        name=name,
        pose=Pose2(MM * x_mm, MM * y_mm, wrap(theta)),
        outline=outline,
        solid=bool(outline) and kind in types.solids,
        declared=types.declared.get(kind, ""),
        turned_to=not outline and kind in types.turned_to,
    )


def rectangle(
    x0: float, y0: float, x1: float, y1: float, theta: float
) -> tuple[tuple[float, float], ...]:
    """Return the corners of an area, in order [m].

    ARIA's code turns the two given corners by `theta` [rad] about the origin of the map, unlike its
    documents (facts.md 10.2).
    """
    c, s = cos(theta), sin(theta)
    corners = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    return tuple((c * x - s * y, s * x + c * y) for x, y in corners)
