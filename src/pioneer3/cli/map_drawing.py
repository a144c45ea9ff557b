"""A map as characters: braille dots for lines, signs and names for places."""

from collections.abc import Mapping
from math import pi
from typing import Final

import numpy as np
from numpy.typing import NDArray
from rich.cells import cell_len
from rich.text import Text

from pioneer3.demo.drawing import Braille
from pioneer3.geometry import Extent
from pioneer3.maps.drawing import Layer, MapDrawing, Marker
from pioneer3.maps.grid import samples

ARROWS: Final = "→↗↑↖←↙↓↘"
SIGNS: Final[Mapping[Layer, str]] = {Layer.GOAL: "●", Layer.DOCK: "■", Layer.HOME: "▲"}
ROUND: Final = (1, 2, 5)


class CharacterCanvas(Braille):
    """Characters that a drawing of a map fits on, at most so many columns and rows."""

    def __init__(self, drawing: MapDrawing, columns: int, rows: int) -> None:
        bounds = drawing.bounds
        width, height = bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min
        # a character is two dots wide and four high, and dots are about square
        self.scale = max(width / (2 * columns - 1), height / (4 * rows - 1), 1e-6)
        super().__init__(
            min(columns, int(width / self.scale) // 2 + 1),
            min(rows, int(height / self.scale) // 4 + 1),
            [layer.style for layer in Layer],
        )
        self._bounds = bounds
        for layer in Layer:
            self._draw_lines(layer, drawing.lines.get(layer, np.empty((0, 4))))
        for marker in drawing.markers:
            self.write(*self._place(marker), _sign(marker), marker.layer.style)
        for marker in drawing.markers:
            self._name(marker)

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
        for dot in set(zip(across.tolist(), down.tolist(), strict=True)):
            self.dot(*dot, layer.style)

    def _place(self, marker: Marker) -> tuple[int, int]:
        """Return row and column of a sign."""
        column = int((marker.pose.x - self._bounds.x_min) / self.scale / 2 + 0.25)
        row = int((self._bounds.y_max - marker.pose.y) / self.scale / 4 + 0.125)
        return min(max(row, 0), self.rows - 1), min(max(column, 0), self.columns - 1)

    def _name(self, marker: Marker) -> None:
        """Write a name beside its sign, right or else left, if that hides no other sign."""
        name = "".join(c for c in marker.name[:20] if c.isprintable() and cell_len(c) == 1)
        row, column = self._place(marker)
        for first in (column + 1, column - len(name)):
            if self.is_free(row, first, len(name)):
                self.write(row, first, name, marker.layer.style)
                return


def _sign(marker: Marker) -> str:
    if marker.layer is Layer.HOME:
        return ARROWS[round(marker.pose.theta / (pi / 4)) % 8]
    return SIGNS[marker.layer]


def legend(bounds: Extent, drawing: MapDrawing) -> Text:
    """Return the meaning of colours and signs on the drawing, and its corners."""
    text = Text()
    used = {marker.layer for marker in drawing.markers}
    used |= {layer for layer, segments in drawing.lines.items() if len(segments)}
    for layer in Layer:
        if layer in used and layer is not Layer.WALL:
            sign = "→" if layer is Layer.HOME else SIGNS.get(layer, "⣿")
            text.append(f"{sign} {layer}  ", layer.style)
    across, up = (bounds.x_min, bounds.x_max), (bounds.y_min, bounds.y_max)
    x, y = (f"{low:z.1f} to {high:z.1f}" for low, high in (across, up))
    corners = f"x {x}, y {y} m"
    return text.append(corners, "dim")
