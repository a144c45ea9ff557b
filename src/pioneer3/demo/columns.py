"""ARIA's columns: a header and a line under it, each column right-aligned in its width."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import isnan

from pioneer3.units import DEGREE, MM

MISSING = "n/a"


@dataclass(frozen=True, slots=True)
class ColumnCell:
    """One column; what is longer than `width` is not cut."""

    name: str
    width: int
    text: str


@dataclass(frozen=True, slots=True)
class ColumnRow:
    """Columns at one instant, from left to right.

    `tail` follows the last one, without a header; `gap` is between two.
    """

    cells: tuple[ColumnCell, ...] = ()
    tail: str = ""
    gap: str = ""

    @property
    def header(self) -> str:
        """The names; empty without columns."""
        return self.gap.join(cell.name.rjust(cell.width) for cell in self.cells)

    @property
    def line(self) -> str:
        """The values."""
        return self.gap.join(cell.text.rjust(cell.width) for cell in self.cells) + self.tail

    def folded(self, width: int) -> list[str]:
        """Return header and line as often as it takes to keep within `width` characters."""
        lines: list[str] = []
        for cells in self._groups(width):
            part = ColumnRow(cells, gap=self.gap)
            lines += [part.header, part.line]
        if not self.cells:
            return [self.tail[at : at + width] for at in range(0, len(self.tail), width)]
        if len(lines[-1]) + len(self.tail) <= width:
            lines[-1] += self.tail
        else:
            lines.append(self.tail.strip())
        return lines

    def _groups(self, width: int) -> Iterator[tuple[ColumnCell, ...]]:
        group: list[ColumnCell] = []
        used = 0
        for cell in self.cells:
            wide = max(cell.width, len(cell.text), len(cell.name)) + len(self.gap)
            if group and used + wide > width:
                yield tuple(group)
                group, used = [], 0
            group.append(cell)
            used += wide
        if group:
            yield tuple(group)


def millimetres(metres: float) -> str:
    """Return a length [m] or speed [m/s] in whole millimetres."""
    return _rounded(metres / MM)


def whole_degrees(angle: float) -> str:
    """Return an angle [rad] or turn rate [rad/s] in whole degrees."""
    return _rounded(angle / DEGREE)


def tenths(value: float) -> str:
    """Return a number with one decimal."""
    return f"{value:.1f}" if abs(value) >= 0.05 else "0.0"


def hundredths(value: float) -> str:
    """Return a number with two decimals."""
    return f"{value:.2f}" if abs(value) >= 0.005 else "0.00"


def degrees_tenths(angle: float) -> str:
    """Return an angle [rad] in degrees with one decimal."""
    return tenths(angle / DEGREE)


def bits(value: int, count: int, *, group: int = 0) -> str:
    """Return `count` bits, bit 0 first, with a space after every `group` of them."""
    text = "".join(str(value >> bit & 1) for bit in range(count))
    if not group:
        return text
    return " ".join(text[at : at + group] for at in range(0, count, group))


def _rounded(value: float) -> str:
    return MISSING if isnan(value) else f"{round(value)}"
