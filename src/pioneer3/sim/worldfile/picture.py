"""Drawings as SVG and PNG."""

from collections.abc import Iterator, Mapping
from html import escape
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from pioneer3.sim.maps.line_map import Bounds
from pioneer3.sim.maps.png import to_png
from pioneer3.sim.maps.raster import shape_of, touched
from pioneer3.sim.worldfile.drawing import Drawing, Ink, Mark

MARGIN = 0.5
"""Around everything [m]."""
LONG_SIDE = 1600
"""Of a PNG picture [pixels]."""
DOT = 0.12
"""Radius of a mark [m]."""
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
