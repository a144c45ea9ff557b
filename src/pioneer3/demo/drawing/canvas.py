"""A picture of the robot's surroundings in braille dots, the robot in the middle facing up."""

from collections.abc import Iterable
from enum import StrEnum
from itertools import groupby
from math import ceil, cos, hypot, inf, pi, sin
from operator import itemgetter
from typing import Final

from rich.text import Text

BLANK: Final = 0x2800
BITS: Final = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""The bit of each dot of a braille character, its rows from the top."""


class Ink(StrEnum):
    """What a dot stands for, as the style it is shown in. Later ones cover earlier ones."""

    GRID = "bright_black"
    TRAIL = "blue"
    FAR = "cyan"
    LASER = "magenta"
    CLOSE = "yellow"
    NEAR = "bold red"
    BODY = "green"


ORDER: Final = tuple(Ink)


class Canvas:
    """Dots on a plane around the robot: x [m] is up, y [m] is left.

    Args:
        columns: Width in characters, two dots each.
        rows: Height in characters, four dots each; dots are about square.
        reach: From the middle to the nearest edge [m].

    Raises:
        ValueError: there is no room, or nothing to reach.
    """

    def __init__(self, columns: int, rows: int, reach: float) -> None:
        if columns < 1 or rows < 1 or not 0 < reach < inf:
            raise ValueError(f"no picture of {reach} m has {columns} x {rows} characters")
        self.columns, self.rows = columns, rows
        self._across, self._down = 2 * columns, 4 * rows
        self.scale = 2 * reach / min(self._across, self._down)
        self._bits = [[0] * columns for _ in range(rows)]
        self._inks = [[-1] * columns for _ in range(rows)]
        self._letters: dict[tuple[int, int], str] = {}

    def dot(self, x: float, y: float, ink: Ink) -> None:
        """Set the dot at a point [m], if it is in the picture."""
        if cell := self._dot_of(x, y):
            across, down = cell
            row, column = down // 4, across // 2
            self._bits[row][column] |= BITS[down % 4][across % 2]
            self._stain(row, column, ink)

    def line(self, x1: float, y1: float, x2: float, y2: float, ink: Ink) -> None:
        """Draw from one point to another [m]."""
        steps = max(1, ceil(hypot(x2 - x1, y2 - y1) / self.scale * 1.5))
        for step in range(steps + 1):
            part = step / steps
            self.dot(x1 + part * (x2 - x1), y1 + part * (y2 - y1), ink)

    def box(self, x1: float, y1: float, x2: float, y2: float, ink: Ink) -> None:
        """Fill a rectangle [m], `x1` below `x2` and `y1` below `y2`; it is a dot at least."""
        rows = max(1, ceil((x2 - x1) / self.scale * 1.5))
        for row in range(rows + 1):
            x = x1 + row / rows * (x2 - x1)
            self.line(x, y1, x, y2, ink)

    def arc(
        self,
        x: float,
        y: float,
        radius: float,
        ink: Ink,
        *,
        start: float = 0.0,
        end: float = 2 * pi,
        gap: int = 1,
    ) -> None:
        """Draw an arc about a point [m] between two bearings [rad], a dot in every `gap`."""
        steps = max(1, ceil(radius * (end - start) / self.scale * (1.5 if gap == 1 else 1 / gap)))
        for step in range(steps + 1):
            bearing = start + step / steps * (end - start)
            self.dot(x + radius * cos(bearing), y + radius * sin(bearing), ink)

    def write(self, x: float, y: float, text: str, ink: Ink) -> None:
        """Write `text` from a point [m] to the right, as far as there is room."""
        if cell := self._dot_of(x, y):
            row, first = cell[1] // 4, cell[0] // 2
            for column, letter in enumerate(text[: self.columns - first], first):
                self._letters[row, column] = letter
                self._inks[row][column] = ORDER.index(ink)

    def lines(self) -> list[str]:
        """Return the picture as plain text, each line `columns` wide."""
        return ["".join(letter for letter, _ in row) for row in self._cells()]

    def text(self) -> Text:
        """Return the picture in colours."""
        text = Text(no_wrap=True, overflow="crop", end="")
        for number, row in enumerate(self._cells()):
            text.append("\n" if number else "")
            for ink, cells in groupby(row, key=itemgetter(1)):
                letters = "".join(letter for letter, _ in cells)
                text.append(letters, None if ink is None else ink.value)
        return text

    def _cells(self) -> Iterable[list[tuple[str, Ink | None]]]:
        for row in range(self.rows):
            yield [self._cell(row, column) for column in range(self.columns)]

    def _cell(self, row: int, column: int) -> tuple[str, Ink | None]:
        ink = self._inks[row][column]
        if ink < 0:
            return " ", None
        letter = self._letters.get((row, column)) or chr(BLANK + self._bits[row][column])
        return letter, ORDER[ink]

    def _dot_of(self, x: float, y: float) -> tuple[int, int] | None:
        """Return column and row of the dot that a point falls on, or `None` outside."""
        across = round(self._across / 2 - 0.5 - y / self.scale)
        down = round(self._down / 2 - 0.5 - x / self.scale)
        if 0 <= across < self._across and 0 <= down < self._down:
            return across, down
        return None

    def _stain(self, row: int, column: int, ink: Ink) -> None:
        """Let the ink that covers the others colour the whole character."""
        self._inks[row][column] = max(self._inks[row][column], ORDER.index(ink))
