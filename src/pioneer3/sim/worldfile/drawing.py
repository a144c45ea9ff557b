"""Drawings of worlds: what is on them besides their map, and pictures of drawings as PNG."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from pioneer3.arrays import Bool, Float
from pioneer3.geometry import Pose2
from pioneer3.maps.drawing import (
    DOT,
    Layer,
    MapDrawing,
    Marker,
    bounds_of,
    framed,
)
from pioneer3.maps.grid import shape_of, touched
from pioneer3.maps.image import to_png
from pioneer3.maps.line_map import LineMap, sides_of
from pioneer3.sim.relief import Ramp
from pioneer3.sim.worldfile.person import Person
from pioneer3.sim.worldfile.spec import WorldFile

LONG_SIDE = 1600
"""Long side of a PNG picture [pixels]."""
SOLID_LAYERS = (Layer.CARPET, Layer.HEIGHTFIELD, Layer.STEP, Layer.RAMP, Layer.TABLE)
"""The kinds of solids that are not walls, or not as a whole."""


def draw(world: WorldFile, line_map: LineMap) -> MapDrawing:
    """Return the drawing of `world`, whose :meth:`WorldFile.line_map` is given."""
    drawn = line_map.drawing
    lines = {Layer(kind): _solids(world, kind) for kind in SOLID_LAYERS} | drawn.lines
    movable = sides_of(box.as_object() for box in world.movable)
    lines[Layer.BOX] = np.concatenate([lines[Layer.BOX], movable])
    lines[Layer.PERSON] = np.concatenate([np.empty((0, 4)), *map(_walk, world.people)])
    homes = (
        Marker(Layer.HOME, robot.start, robot.name or robot.model, has_heading=True)
        for robot in world.robots
        if isinstance(robot.start, Pose2)
    )
    markers = (*drawn.markers, *homes)
    bounds = bounds_of(lines.values(), markers)
    return replace(drawn, name=world.name, bounds=bounds, lines=lines, markers=markers)


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


def _walk(person: Person) -> Float:
    """Return the path of a person and their outline at the start [m]."""
    path = person.path + (person.path[:1] if person.loop else ())
    legs = [(*a, *b) for a, b in pairwise(path)]
    return np.concatenate([np.array(legs).reshape(-1, 4), person.outline_at(0.0)])


def to_picture(drawing: MapDrawing) -> bytes:
    """Return a drawing as PNG without names, its longer side :data:`LONG_SIDE` pixels."""
    bounds = framed(drawing.bounds)
    cell = max(bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min) / LONG_SIDE
    pixels = np.full((*shape_of(bounds, cell), 3), 255, dtype=np.uint8)
    for layer in Layer:
        segments = [drawing.lines.get(layer, np.empty((0, 4)))]
        markers = [marker for marker in drawing.markers if marker.layer is layer]
        segments += [marker.stroke for marker in markers if marker.has_heading]
        segments += [_cross(marker) for marker in markers]
        painted = _thick(touched(np.concatenate(segments), bounds, cell))
        pixels[painted] = list(bytes.fromhex(layer.colour[1:]))
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
