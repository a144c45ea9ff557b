"""Drawings of maps: lines of several kinds, and markers of places; as SVG."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from html import escape
from math import cos, sin

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Extent, Pose2
from pioneer3.names import printable

ARROW = 0.5
"""Length of the stroke that shows a heading [m]."""
MARGIN = 0.5
"""Around everything [m]."""
DOT = 0.12
"""Radius of a marker [m]."""
SHOWN = ' style="width:100%;max-width:48em;max-height:36em"'
"""Size of a drawing in a notebook."""


class Layer(StrEnum):
    """A layer of a drawing, its colour, and its style in a terminal; later ones come on top."""

    colour: str
    style: str

    def __new__(cls, word: str, colour: str = "", style: str = "") -> "Layer":
        """Return a layer whose value is its word."""
        layer = str.__new__(cls, word)
        layer._value_, layer.colour, layer.style = word, colour, style
        return layer

    CARPET = "carpet", "#c4a0be", "dim magenta"
    HEIGHTFIELD = "heightfield", "#96aa6e", "dim green"
    STEP = "step", "#808ca0", "blue"
    RAMP = "ramp", "#46828c", "cyan"
    TABLE = "table", "#c8aa78", "dim yellow"
    WALL = "wall", "#202020", ""
    FORBIDDEN = "forbidden", "#d62728", "red"
    PERSON = "person", "#9467bd", "magenta"
    BOX = "box", "#bc7800", "yellow"
    BLACK = "black", "#000000", "dim"
    GLASS = "glass", "#6ebeeb", "bright_cyan"
    REFLECTOR = "reflector", "#eb5ac8", "bright_magenta"
    DOCK = "dock", "#8c564b", "bold yellow"
    GOAL = "goal", "#1f77b4", "bold cyan"
    HOME = "home", "#2ca02c", "bold green"


DARK = (Layer.WALL, Layer.BLACK)
"""Layers in the colour of text, where that is not known to be dark."""


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
class MapDrawing:
    """Lines of each layer, (N, 4) [m], and markers in the map frame, and the bounds of all [m]."""

    name: str
    bounds: Extent
    lines: dict[Layer, Float]
    markers: tuple[Marker, ...]


def bounds_of(lines: Iterable[Float], markers: Iterable[Marker]) -> Extent:
    """Return the smallest box around lines and markers [m]; a small one where there are none."""
    points = [(marker.pose.x, marker.pose.y) for marker in markers]
    ends = [part.reshape(-1, 2) for part in lines]
    everything = np.concatenate([np.array(points).reshape(-1, 2), *ends])
    if not len(everything):
        return Extent(-1.0, -1.0, 1.0, 1.0)
    (x_min, y_min), (x_max, y_max) = everything.min(axis=0), everything.max(axis=0)
    return Extent(float(x_min), float(y_min), float(x_max), float(y_max))


def to_svg(drawing: MapDrawing, *, over: Iterable[str] = (), on_page: bool = True) -> str:
    """Return a drawing as SVG, 1 unit a metre, y upwards, its names as text.

    Elements `over` it come last. It is on a white page, or in the colours of whatever shows it,
    such as a notebook: light or dark.
    """
    x0, y0, x1, y1 = framed(drawing.bounds)
    box = f"{x0:.3f} {-y1:.3f} {x1 - x0:.3f} {y1 - y0:.3f}"
    page = f'<rect x="{x0:.3f}" y="{-y1:.3f}" width="100%" height="100%" fill="white"/>'
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}"{"" if on_page else SHOWN}>',
        f"<title>{_clean(drawing.name)}</title>",
        *([page] if on_page else []),
        *_svg_lines(drawing, on_page=on_page),
        *(_svg_marker(marker, (y1 - y0) / 60) for marker in drawing.markers),
        *over,
        "</svg>",
    ]
    return "\n".join(parts) + "\n"


def _svg_lines(drawing: MapDrawing, *, on_page: bool) -> Iterator[str]:
    for layer in Layer:
        segments = drawing.lines.get(layer)
        if segments is not None and len(segments):
            path = "".join(
                f"M{a:.3f} {-b:.3f}L{c:.3f} {-d:.3f}" for a, b, c, d in segments.tolist()
            )
            colour = layer.colour if on_page or layer not in DARK else "currentColor"
            style = f'stroke="{colour}" stroke-width="0.05" stroke-linecap="round" fill="none"'
            yield f'<path class="{layer}" {style} d="{path}"/>'


def _svg_marker(marker: Marker, size: float) -> str:
    x, y, colour = marker.pose.x, -marker.pose.y, marker.layer.colour
    dot = f'<circle class="{marker.layer}" cx="{x:.3f}" cy="{y:.3f}" r="{DOT}" fill="{colour}"/>'
    if marker.has_heading:
        a, b, c, d = marker.stroke[0].tolist()
        ends = f'x1="{a:.3f}" y1="{-b:.3f}" x2="{c:.3f}" y2="{-d:.3f}"'
        dot += f'<line {ends} stroke="{colour}" stroke-width="0.05"/>'
    style = f'font-family="sans-serif" font-size="{size:.3f}" fill="{colour}"'
    text = f'<text x="{x + 2 * DOT:.3f}" y="{y:.3f}" {style}>{_clean(marker.name)}</text>'
    return dot + (text if marker.name else "")


def framed(bounds: Extent) -> Extent:
    """Return a box with a margin around it."""
    x0, y0, x1, y1 = bounds
    return Extent(x0 - MARGIN, y0 - MARGIN, x1 + MARGIN, y1 + MARGIN)


def _clean(text: str) -> str:
    return escape(printable(text))
