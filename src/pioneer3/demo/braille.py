"""Dots as text: each braille character has two by four of them."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from operator import itemgetter
from typing import Final

from rich.text import Text

BLANK: Final = 0x2800
BITS: Final = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""The bit of each dot of a character, its rows from the top."""
NONE: Final = -1


class Braille:
    """A picture of dots and letters.

    Args:
        columns: Width [characters].
        rows: Height [characters].
        styles: Of all dots and letters. Where some meet in a character, the last of them in this
            order colours it.
    """

    def __init__(self, columns: int, rows: int, styles: Sequence[str]) -> None:
        self.columns, self.rows = columns, rows
        self._styles = tuple(styles)
        self._bits = [[0] * columns for _ in range(rows)]
        self._ranks = [[NONE] * columns for _ in range(rows)]
        self._letters: dict[tuple[int, int], str] = {}

    def dot(self, across: int, down: int, style: str) -> None:
        """Set a dot, counted from the upper left corner."""
        row, column = down // 4, across // 2
        self._bits[row][column] |= BITS[down % 4][across % 2]
        self._ranks[row][column] = max(self._ranks[row][column], self._styles.index(style))

    def write(self, row: int, column: int, text: str, style: str) -> None:
        """Write `text` over the dots, as far as there is room."""
        for at, letter in enumerate(text[: self.columns - column], column):
            self._letters[row, at] = letter
            self._ranks[row][at] = self._styles.index(style)

    def is_free(self, row: int, column: int, count: int) -> bool:
        """Return whether `count` characters have room there and hide no letter."""
        cells = [(row, at) for at in range(column, column + count)]
        inside = column >= 0 and column + count <= self.columns
        return inside and not any(cell in self._letters for cell in cells)

    def lines(self) -> list[str]:
        """Return the picture as plain text, each line `columns` wide."""
        return ["".join(letter for letter, _ in row) for row in self._cells()]

    def text(self) -> Text:
        """Return the picture in colours."""
        text = Text(no_wrap=True, overflow="crop", end="")
        for number, row in enumerate(self._cells()):
            text.append("\n" if number else "")
            for style, cells in groupby(row, key=itemgetter(1)):
                text.append("".join(letter for letter, _ in cells), style or None)
        return text

    def _cells(self) -> Iterator[list[tuple[str, str]]]:
        for row in range(self.rows):
            yield [self._cell(row, column) for column in range(self.columns)]

    def _cell(self, row: int, column: int) -> tuple[str, str]:
        rank = self._ranks[row][column]
        if rank == NONE:
            return " ", ""
        letter = self._letters.get((row, column)) or chr(BLANK + self._bits[row][column])
        return letter, self._styles[rank]
