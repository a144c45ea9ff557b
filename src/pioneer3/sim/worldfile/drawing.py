"""Drawings of worlds: their lines and markers, as SVG and as PNG."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from html import escape
from itertools import pairwise
from math import cos, sin
from types import MappingProxyType

import numpy as np

from pioneer3.arrays import Bool, Float
from pioneer3.geometry import Pose2
from pioneer3.maps.grid import shape_of, touched
from pioneer3.maps.image import to_png
from pioneer3.maps.line_map import Extent, LineMap, MapObject
from pioneer3.maps.materials import BLACK, GLASS, REFLECTOR
from pioneer3.names import printable
from pioneer3.sim.relief import Ramp
from pioneer3.sim.worldfile.person import Person
from pioneer3.sim.worldfile.spec import WorldFile

ARROW = 0.5
"""Length of the stroke that shows a heading [m]."""
MARGIN = 0.5
"""Around everything [m]."""
LONG_SIDE = 1600
"""Long side of a PNG picture [pixels]."""
DOT = 0.12
"""Radius of a marker [m]."""


class Layer(StrEnum):
    """A layer of a drawing; later ones are drawn over earlier ones."""

    CARPET = "carpet"
    HEIGHTFIELD = "heightfield"
    STEP = "step"
    RAMP = "ramp"
    TABLE = "table"
    WALL = "wall"
    FORBIDDEN = "forbidden"
    PERSON = "person"
    BOX = "box"
    BLACK = "black"
    GLASS = "glass"
    REFLECTOR = "reflector"
    DOCK = "dock"
    GOAL = "goal"
    HOME = "home"


COLOURS: Mapping[Layer, tuple[int, int, int]] = MappingProxyType(
    {
        Layer.CARPET: (196, 160, 190),
        Layer.HEIGHTFIELD: (150, 170, 110),
        Layer.STEP: (128, 140, 160),
        Layer.RAMP: (70, 130, 140),
        Layer.TABLE: (200, 170, 120),
        Layer.WALL: (32, 32, 32),
        Layer.FORBIDDEN: (214, 39, 40),
        Layer.PERSON: (148, 103, 189),
        Layer.BOX: (188, 120, 0),
        Layer.BLACK: (0, 0, 0),
        Layer.GLASS: (110, 190, 235),
        Layer.REFLECTOR: (235, 90, 200),
        Layer.DOCK: (140, 86, 75),
        Layer.GOAL: (31, 119, 180),
        Layer.HOME: (44, 160, 44),
    }
)

SOLID_LAYERS = (Layer.CARPET, Layer.HEIGHTFIELD, Layer.STEP, Layer.RAMP, Layer.TABLE)
"""The kinds of solids that are not walls, or not as a whole."""


@dataclass(frozen=True, slots=True)
class Marker:
    """A named place; its heading is drawn if it has one."""

    layer: Layer
    pose: Pose2
    name: str
    has_heading: bool

    @property
    def stroke(self) -> Float:
        """A short line that shows the heading [m], shape (1, 4)."""
        x, y, theta = self.pose.x, self.pose.y, self.pose.theta
        return np.array([[x, y, x + ARROW * cos(theta), y + ARROW * sin(theta)]])


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldDrawing:
    """Lines of each layer, (N, 4) [m], and markers in the map frame, and the bounds of all [m]."""

    name: str
    bounds: Extent
    lines: dict[Layer, Float]
    markers: tuple[Marker, ...]


def draw(world: WorldFile, line_map: LineMap) -> WorldDrawing:
    """Return the drawing of `world`, whose :meth:`WorldFile.line_map` is given."""
    lines = {Layer(kind): _solids(world, kind) for kind in SOLID_LAYERS}
    lines[Layer.WALL] = line_map.walls
    forbidden = [o for o in line_map.objects if o.kind.startswith("Forbidden")]
    lines[Layer.FORBIDDEN] = _sides(forbidden)
    movable = [box.as_object() for box in world.movable]
    lines[Layer.BOX] = _sides([o for o in line_map.objects if o.solid] + movable)
    for layer, code in ((Layer.BLACK, BLACK), (Layer.GLASS, GLASS), (Layer.REFLECTOR, REFLECTOR)):
        lines[layer] = line_map.walls[line_map.materials == code]
    lines[Layer.PERSON] = np.concatenate([np.empty((0, 4)), *map(_walk, world.people)])
    markers = tuple(_markers(world, line_map))
    return WorldDrawing(
        name=world.name, bounds=_bounds(lines.values(), markers), lines=lines, markers=markers
    )


def _solids(world: WorldFile, table: str) -> Float:
    """Return the outlines of all solids of one table; of ramps an arrow to the upper end, too."""
    found = [np.empty((0, 4))]
    for solid in world.solids:
        if solid.table == table:
            found.append(solid.outline)
            if isinstance(solid, Ramp):
                found.append(_arrow(solid))
    return np.concatenate(found)


def _arrow(ramp: Ramp) -> Float:
    length, width = ramp.size
    tip, head = 0.4 * length, 0.3 * min(length, width)
    strokes = [((-tip, 0.0), (tip, 0.0))]
    strokes += [((tip - head, side * head / 2), (tip, 0.0)) for side in (-1, 1)]
    ends = [[ramp.pose @ Pose2(x, y) for x, y in stroke] for stroke in strokes]
    return np.array([(a.x, a.y, b.x, b.y) for a, b in ends])


def _sides(objects: Iterable[MapObject]) -> Float:
    return np.array([side for item in objects for side in item.sides]).reshape(-1, 4)


def _walk(person: Person) -> Float:
    """Return the path of a person and their outline at the start [m]."""
    path = person.path + (person.path[:1] if person.loop else ())
    legs = [(*a, *b) for a, b in pairwise(path)]
    return np.concatenate([np.array(legs).reshape(-1, 4), person.outline_at(0.0)])


def _markers(world: WorldFile, line_map: LineMap) -> Iterator[Marker]:
    for item in line_map.objects:
        if item.kind.startswith("Dock"):
            yield Marker(Layer.DOCK, item.pose, item.name, has_heading=True)
        elif item.kind.startswith("Goal"):
            yield Marker(
                Layer.GOAL, item.pose, item.name, has_heading=item.kind == "GoalWithHeading"
            )
        elif item.kind == "RobotHome":
            yield Marker(Layer.HOME, item.pose, item.name, has_heading=True)
    for robot in world.robots:
        if isinstance(robot.start, Pose2):
            yield Marker(Layer.HOME, robot.start, robot.name or robot.model, has_heading=True)


def _bounds(lines: Iterable[Float], markers: Iterable[Marker]) -> Extent:
    points = [(marker.pose.x, marker.pose.y) for marker in markers]
    ends = [part.reshape(-1, 2) for part in lines]
    everything = np.concatenate([np.array(points).reshape(-1, 2), *ends])
    if not len(everything):
        return Extent(-1.0, -1.0, 1.0, 1.0)
    (x_min, y_min), (x_max, y_max) = everything.min(axis=0), everything.max(axis=0)
    return Extent(float(x_min), float(y_min), float(x_max), float(y_max))


def to_svg(drawing: WorldDrawing) -> str:
    """Return a drawing as SVG, 1 unit a metre, y upwards, its names as text."""
    x0, y0, x1, y1 = _framed(drawing.bounds)
    box = f"{x0:.3f} {-y1:.3f} {x1 - x0:.3f} {y1 - y0:.3f}"
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}">',
        f"<title>{_clean(drawing.name)}</title>",
        f'<rect x="{x0:.3f}" y="{-y1:.3f}" width="100%" height="100%" fill="white"/>',
        *_svg_lines(drawing),
        *(_svg_marker(marker, (y1 - y0) / 60) for marker in drawing.markers),
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _svg_lines(drawing: WorldDrawing) -> Iterator[str]:
    for layer in Layer:
        segments = drawing.lines.get(layer)
        if segments is not None and len(segments):
            path = "".join(
                f"M{a:.3f} {-b:.3f}L{c:.3f} {-d:.3f}" for a, b, c, d in segments.tolist()
            )
            style = f'stroke="{_hex(layer)}" stroke-width="0.05" stroke-linecap="round" fill="none"'
            yield f'<path class="{layer}" {style} d="{path}"/>'


def _svg_marker(marker: Marker, size: float) -> str:
    x, y, colour = marker.pose.x, -marker.pose.y, _hex(marker.layer)
    dot = f'<circle class="{marker.layer}" cx="{x:.3f}" cy="{y:.3f}" r="{DOT}" fill="{colour}"/>'
    if marker.has_heading:
        a, b, c, d = marker.stroke[0].tolist()
        ends = f'x1="{a:.3f}" y1="{-b:.3f}" x2="{c:.3f}" y2="{-d:.3f}"'
        dot += f'<line {ends} stroke="{colour}" stroke-width="0.05"/>'
    style = f'font-family="sans-serif" font-size="{size:.3f}" fill="{colour}"'
    text = f'<text x="{x + 2 * DOT:.3f}" y="{y:.3f}" {style}>{_clean(marker.name)}</text>'
    return dot + (text if marker.name else "")


def to_picture(drawing: WorldDrawing) -> bytes:
    """Return a drawing as PNG without names, its longer side :data:`LONG_SIDE` pixels."""
    bounds = _framed(drawing.bounds)
    cell = max(bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min) / LONG_SIDE
    pixels = np.full((*shape_of(bounds, cell), 3), 255, dtype=np.uint8)
    for layer in Layer:
        segments = [drawing.lines.get(layer, np.empty((0, 4)))]
        markers = [marker for marker in drawing.markers if marker.layer is layer]
        segments += [marker.stroke for marker in markers if marker.has_heading]
        segments += [_cross(marker) for marker in markers]
        painted = _thick(touched(np.concatenate(segments), bounds, cell))
        pixels[painted] = COLOURS[layer]
    return to_png(pixels[::-1])


def _cross(marker: Marker) -> Float:
    x, y = marker.pose.x, marker.pose.y
    return np.array([[x - DOT, y, x + DOT, y], [x, y - DOT, x, y + DOT]])


def _thick(cells: Bool) -> Bool:
    """Make lines two pixels wide."""
    thick = cells.copy()
    thick[1:] |= cells[:-1]
    thick[:, 1:] |= thick[:, :-1].copy()
    return thick


def _framed(bounds: Extent) -> Extent:
    x0, y0, x1, y1 = bounds
    return Extent(x0 - MARGIN, y0 - MARGIN, x1 + MARGIN, y1 + MARGIN)


def _hex(layer: Layer) -> str:
    return "#{:02x}{:02x}{:02x}".format(*COLOURS[layer])


def _clean(text: str) -> str:
    return escape(printable(text))
