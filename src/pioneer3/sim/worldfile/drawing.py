"""What there is to draw of a world, whatever it is drawn on."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.sim.maps.line_map import Bounds, LineMap, MapObject
from pioneer3.sim.worldfile.person import Person
from pioneer3.sim.worldfile.spec import WorldFile

Float = NDArray[np.float64]

ARROW = 0.5
"""Length of the stroke that shows a heading [m]."""


class Ink(StrEnum):
    """What a line or a mark stands for; later ones are drawn over earlier ones."""

    WALL = "wall"
    FORBIDDEN = "forbidden"
    PERSON = "person"
    BOX = "box"
    DOCK = "dock"
    GOAL = "goal"
    HOME = "home"


@dataclass(frozen=True, slots=True)
class Mark:
    """A named place.

    Attributes:
        ink: What it is.
        pose: Where [m, rad].
        name: Its label.
        heads: Whether the heading means anything.
    """

    ink: Ink
    pose: Pose2
    name: str
    heads: bool

    @property
    def stroke(self) -> Float:
        """A short line that shows the heading [m], shape (1, 4)."""
        x, y, theta = self.pose.x, self.pose.y, self.pose.theta
        return np.array([[x, y, x + ARROW * cos(theta), y + ARROW * sin(theta)]])


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """Lines and marks in the map frame.

    Attributes:
        name: Of the world.
        bounds: Of all lines and marks [m].
        lines: Segments [m] of each ink, shape (N, 4).
        marks: Named places.
    """

    name: str
    bounds: Bounds
    lines: dict[Ink, Float]
    marks: tuple[Mark, ...]


def draw(world: WorldFile, line_map: LineMap) -> Drawing:
    """Return what there is to draw of `world`, whose :meth:`WorldFile.line_map` is given."""
    lines = {Ink.WALL: line_map.walls}
    forbidden = [o for o in line_map.objects if o.kind.startswith("Forbidden")]
    lines[Ink.FORBIDDEN] = _sides(forbidden)
    movable = [box.as_object() for box in world.movable]
    lines[Ink.BOX] = _sides([o for o in line_map.objects if o.solid] + movable)
    lines[Ink.PERSON] = np.concatenate([np.empty((0, 4)), *map(_walk, world.people)])
    marks = tuple(_marks(world, line_map))
    return Drawing(name=world.name, bounds=_bounds(lines.values(), marks), lines=lines, marks=marks)


def _sides(objects: Iterable[MapObject]) -> Float:
    return np.array([side for item in objects for side in item.sides]).reshape(-1, 4)


def _walk(person: Person) -> Float:
    """Return the path of a person and their outline at the start [m]."""
    path = person.path + (person.path[:1] if person.loop else ())
    legs = [(*a, *b) for a, b in pairwise(path)]
    return np.concatenate([np.array(legs).reshape(-1, 4), person.outline_at(0.0)])


def _marks(world: WorldFile, line_map: LineMap) -> Iterator[Mark]:
    for item in line_map.objects:
        if item.kind.startswith("Dock"):
            yield Mark(Ink.DOCK, item.pose, item.name, heads=True)
        elif item.kind.startswith("Goal"):
            yield Mark(Ink.GOAL, item.pose, item.name, heads=item.kind == "GoalWithHeading")
        elif item.kind == "RobotHome":
            yield Mark(Ink.HOME, item.pose, item.name, heads=True)
    for robot in world.robots:
        if isinstance(robot.start, Pose2):
            yield Mark(Ink.HOME, robot.start, robot.name or robot.model, heads=True)


def _bounds(lines: Iterable[Float], marks: Iterable[Mark]) -> Bounds:
    points = [(mark.pose.x, mark.pose.y) for mark in marks]
    ends = [part.reshape(-1, 2) for part in lines]
    everything = np.concatenate([np.array(points).reshape(-1, 2), *ends])
    if not len(everything):
        return Bounds(-1.0, -1.0, 1.0, 1.0)
    (x_min, y_min), (x_max, y_max) = everything.min(axis=0), everything.max(axis=0)
    return Bounds(float(x_min), float(y_min), float(x_max), float(y_max))
