"""The places of a map that people send robots to."""

from collections.abc import Iterator
from dataclasses import dataclass

from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.maps.line_map import MapObject

ROLES = ("goal", "dock", "home", "place")
"""Roles of the objects that a robot can be sent to."""
HOME = "home"
"""Name of the first home, whatever that is called."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Destination:
    """A place in the map's frame [m], to drive to, and the heading to turn to there [rad].

    Attributes:
        name: On the map, or empty.
        charges: Whether it is a dock.
    """

    x: float
    y: float
    heading: float | None = None
    name: str = ""
    charges: bool = False

    def __str__(self) -> str:
        return self.name or f"({self.x:.2f}, {self.y:.2f})"


def places(line_map: LineMap) -> Iterator[MapObject]:
    """Yield the places with a name, in the map's order."""
    return (item for item in line_map.objects if item.name and item.role in ROLES)


def find_place(line_map: LineMap, name: str) -> Destination:
    """Return the place of a name, in upper or lower case; `home` is the first home of the map.

    Raises:
        ConfigError: There is none, or more than one; names those that there are.
    """
    wanted = name.strip().casefold()
    found = [item for item in places(line_map) if item.name.casefold() == wanted]
    if len(found) == 1:
        return destination(found[0])
    begin = home(line_map)
    if not found and wanted == HOME and begin is not None:
        return Destination(x=begin.x, y=begin.y, heading=begin.theta, name=HOME)
    names = ", ".join(sorted({item.name for item in places(line_map)})) or "none"
    if found:
        raise ConfigError(f"place {name!r}: {len(found)} of the map have this name")
    raise ConfigError(f"place {name!r}: the map {line_map.name} has none of this name; has {names}")


def destination(item: MapObject) -> Destination:
    """Return the place of a map as a destination."""
    return Destination(
        x=item.pose.x,
        y=item.pose.y,
        heading=item.pose.theta if item.heads else None,
        name=item.name,
        charges=item.role == "dock",
    )


def home(line_map: LineMap) -> Pose2 | None:
    """Return the pose in which robots begin, or `None`."""
    return line_map.starts[0] if line_map.starts else None
