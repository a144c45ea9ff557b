"""Drawings of worlds: their lines and markers, as SVG and as PNG."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from html import escape
from itertools import pairwise
from math import cos, sin
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.sim.maps.grid import shape_of, touched
from pioneer3.sim.maps.image import to_png
from pioneer3.sim.maps.line_map import Bounds, LineMap, MapObject
from pioneer3.sim.worldfile.person import Person
from pioneer3.sim.worldfile.spec import WorldFile

Float = NDArray[np.float64]

ARROW = 0.5
"""Length of the stroke that shows a heading [m]."""
MARGIN = 0.5
"""Around everything [m]."""
LONG_SIDE = 1600
"""Of a PNG picture [pixels]."""
DOT = 0.12
"""Radius of a mark [m]."""


class Ink(StrEnum):
    """What a line or a mark stands for; later ones are drawn over earlier ones."""

    WALL = "wall"
    FORBIDDEN = "forbidden"
    PERSON = "person"
    BOX = "box"
    DOCK = "dock"
    GOAL = "goal"
    HOME = "home"


COLOURS: Mapping[Ink, tuple[int, int, int]] = MappingProxyType(
    {
        Ink.WALL: (32, 32, 32),
        Ink.FORBIDDEN: (214, 39, 40),
        Ink.PERSON: (148, 103, 189),
        Ink.BOX: (188, 120, 0),
        Ink.DOCK: (140, 86, 75),
        Ink.GOAL: (31, 119, 180),
        Ink.HOME: (44, 160, 44),
    }
)


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


def to_svg(drawing: Drawing) -> str:
    """Return a drawing as SVG, 1 unit a metre, y upwards, its names as text."""
    x0, y0, x1, y1 = _framed(drawing.bounds)
    box = f"{x0:.3f} {-y1:.3f} {x1 - x0:.3f} {y1 - y0:.3f}"
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}">',
        f"<title>{_clean(drawing.name)}</title>",
        f'<rect x="{x0:.3f}" y="{-y1:.3f}" width="100%" height="100%" fill="white"/>',
        *_svg_lines(drawing),
        *(_svg_mark(mark, (y1 - y0) / 60) for mark in drawing.marks),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _svg_lines(drawing: Drawing) -> Iterator[str]:
    for ink in Ink:
        segments = drawing.lines.get(ink)
        if segments is not None and len(segments):
            path = "".join(
                f"M{a:.3f} {-b:.3f}L{c:.3f} {-d:.3f}" for a, b, c, d in segments.tolist()
            )
            style = f'stroke="{_hex(ink)}" stroke-width="0.05" stroke-linecap="round" fill="none"'
            yield f'<path class="{ink}" {style} d="{path}"/>'


def _svg_mark(mark: Mark, size: float) -> str:
    x, y, colour = mark.pose.x, -mark.pose.y, _hex(mark.ink)
    dot = f'<circle class="{mark.ink}" cx="{x:.3f}" cy="{y:.3f}" r="{DOT}" fill="{colour}"/>'
    if mark.heads:
        a, b, c, d = mark.stroke[0].tolist()
        ends = f'x1="{a:.3f}" y1="{-b:.3f}" x2="{c:.3f}" y2="{-d:.3f}"'
        dot += f'<line {ends} stroke="{colour}" stroke-width="0.05"/>'
    style = f'font-family="sans-serif" font-size="{size:.3f}" fill="{colour}"'
    text = f'<text x="{x + 2 * DOT:.3f}" y="{y:.3f}" {style}>{_clean(mark.name)}</text>'
    return dot + (text if mark.name else "")


def to_picture(drawing: Drawing) -> bytes:
    """Return a drawing as PNG without names, its longer side :data:`LONG_SIDE` pixels."""
    bounds = _framed(drawing.bounds)
    cell = max(bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min) / LONG_SIDE
    pixels = np.full((*shape_of(bounds, cell), 3), 255, dtype=np.uint8)
    for ink in Ink:
        segments = [drawing.lines.get(ink, np.empty((0, 4)))]
        marks = [mark for mark in drawing.marks if mark.ink is ink]
        segments += [mark.stroke for mark in marks if mark.heads]
        segments += [_cross(mark) for mark in marks]
        painted = _thick(touched(np.concatenate(segments), bounds, cell))
        pixels[painted] = COLOURS[ink]
    return to_png(pixels[::-1])


def _cross(mark: Mark) -> NDArray[np.float64]:
    x, y = mark.pose.x, mark.pose.y
    return np.array([[x - DOT, y, x + DOT, y], [x, y - DOT, x, y + DOT]])


def _thick(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Make lines two pixels wide."""
    thick = cells.copy()
    thick[1:] |= cells[:-1]
    thick[:, 1:] |= thick[:, :-1].copy()
    return thick


def _framed(bounds: Bounds) -> Bounds:
    x0, y0, x1, y1 = bounds
    return Bounds(x0 - MARGIN, y0 - MARGIN, x1 + MARGIN, y1 + MARGIN)


def _hex(ink: Ink) -> str:
    return "#{:02x}{:02x}{:02x}".format(*COLOURS[ink])


def _clean(text: str) -> str:
    return escape("".join(c if c.isprintable() else " " for c in text))
