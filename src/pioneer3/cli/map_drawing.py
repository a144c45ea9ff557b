"""A map as characters: braille dots for lines, signs and names for places."""

from collections.abc import Mapping
from math import pi
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from rich.cells import cell_len
from rich.text import Text

from pioneer3.sim.maps.grid import samples
from pioneer3.sim.maps.line_map import Bounds
from pioneer3.sim.worldfile.drawing import Drawing, Layer, Marker

BLANK: Final = 0x2800
DOTS: Final = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""The bit of each dot of a braille character, its rows from the top."""
ARROWS: Final = "→↗↑↖←↙↓↘"
SIGNS: Mapping[Layer, str] = MappingProxyType({Layer.GOAL: "●", Layer.DOCK: "■", Layer.HOME: "▲"})
STYLES: Mapping[Layer, str] = MappingProxyType(
    {
        Layer.WALL: "",
        Layer.FORBIDDEN: "red",
        Layer.PERSON: "magenta",
        Layer.BOX: "yellow",
        Layer.DOCK: "bold yellow",
        Layer.GOAL: "bold cyan",
        Layer.HOME: "bold green",
    }
)
ROUND: Final = (1, 2, 5)


class Canvas:
    """Characters that a drawing fits on.

    Args:
        drawing: What to draw.
        columns: Characters at most.
        rows: The same.
    """

    def __init__(self, drawing: Drawing, columns: int, rows: int) -> None:
        bounds = drawing.bounds
        width, height = bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min
        # a character is two dots wide and four high, and dots are about square
        self.scale = max(width / (2 * columns - 1), height / (4 * rows - 1), 1e-6)
        self.columns = min(columns, int(width / self.scale) // 2 + 1)
        self.rows = min(rows, int(height / self.scale) // 4 + 1)
        self._bounds = bounds
        self._bits = np.zeros((self.rows, self.columns), dtype=np.int64)
        self._styles = [[""] * self.columns for _ in range(self.rows)]
        self._letters: dict[tuple[int, int], tuple[str, str]] = {}
        for layer in Layer:
            self._draw_lines(layer, drawing.lines.get(layer, np.empty((0, 4))))
        for marker in drawing.markers:
            self._put(*self._cell(marker), _sign(marker), STYLES[marker.layer])
        for marker in drawing.markers:
            self._name(marker)

    def text(self) -> Text:
        """Return all of it, one line of text a row."""
        text = Text(no_wrap=True, overflow="crop")
        for row in range(self.rows):
            for column in range(self.columns):
                dots = chr(BLANK + int(self._bits[row, column])), self._styles[row][column]
                letter, style = self._letters.get((row, column), dots)
                text.append(letter, style or None)
            text.append("\n")
        return text

    def ruler(self) -> Text:
        """Return a line that is a round number of metres long, and says so."""
        longest = self.columns * 2 * self.scale / 3
        power = 10.0 ** np.floor(np.log10(longest))
        metres = max(step * power for step in ROUND if step * power <= longest)
        width = max(2, round(metres / self.scale / 2))
        return Text(f"├{'─' * (width - 2)}┤ {metres:g} m", "dim")

    def _draw_lines(self, layer: Layer, segments: NDArray[np.float64]) -> None:
        if not len(segments):
            return
        points = samples(segments, self.scale / 2)
        x = (points[:, 0] - self._bounds.x_min) / self.scale
        y = (self._bounds.y_max - points[:, 1]) / self.scale
        across = np.rint(x).astype(np.int64).clip(0, 2 * self.columns - 1)
        down = np.rint(y).astype(np.int64).clip(0, 4 * self.rows - 1)
        np.bitwise_or.at(self._bits, (down // 4, across // 2), DOTS[down % 4, across % 2])
        for row, column in set(zip((down // 4).tolist(), (across // 2).tolist(), strict=True)):
            self._styles[row][column] = STYLES[layer]

    def _cell(self, marker: Marker) -> tuple[int, int]:
        column = int((marker.pose.x - self._bounds.x_min) / self.scale / 2 + 0.25)
        row = int((self._bounds.y_max - marker.pose.y) / self.scale / 4 + 0.125)
        return min(max(row, 0), self.rows - 1), min(max(column, 0), self.columns - 1)

    def _put(self, row: int, column: int, letter: str, style: str) -> None:
        self._letters[row, column] = letter, style

    def _name(self, marker: Marker) -> None:
        """Write a name beside its sign, right or else left, if that hides no other sign."""
        name = "".join(c for c in marker.name[:20] if c.isprintable() and cell_len(c) == 1)
        row, column = self._cell(marker)
        for first in (column + 1, column - len(name)):
            cells = [(row, at) for at in range(first, first + len(name))]
            inside = first >= 0 and first + len(name) <= self.columns
            if inside and not any(cell in self._letters for cell in cells):
                for cell, letter in zip(cells, name, strict=True):
                    self._put(*cell, letter, STYLES[marker.layer])
                return


def _sign(marker: Marker) -> str:
    if marker.layer is Layer.HOME:
        return ARROWS[round(marker.pose.theta / (pi / 4)) % 8]
    return SIGNS[marker.layer]


def legend(bounds: Bounds, drawing: Drawing) -> Text:
    """Return the meaning of colours and signs on the drawing, and its corners."""
    text = Text()
    used = {marker.layer for marker in drawing.markers}
    used |= {layer for layer, segments in drawing.lines.items() if len(segments)}
    for layer in Layer:
        if layer in used and layer is not Layer.WALL:
            sign = "→" if layer is Layer.HOME else SIGNS.get(layer, "⣿")
            text.append(f"{sign} {layer}  ", STYLES[layer])
    across, up = (bounds.x_min, bounds.x_max), (bounds.y_min, bounds.y_max)
    x, y = (f"{low:z.1f} to {high:z.1f}" for low, high in (across, up))
    corners = f"x {x}, y {y} m"
    return text.append(corners, "dim")
