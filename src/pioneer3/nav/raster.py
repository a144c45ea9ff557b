"""The square cells that a map is divided into, and distances to walls in them."""

import mmap
import sys
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from math import ceil, floor, prod
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from pioneer3.arrays import Bool, Float, Float32, Int
from pioneer3.errors import ConfigError
from pioneer3.jit import fast
from pioneer3.maps import Extent
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.kernels.fields import Frame, nearest_wall

FINE_CELLS = 64_000_000
"""Cells above which they are made twice as large: 200 by 200 m at 2.5 cm."""
MOST_AREA = 160_000.0
"""Area of a map at most [m^2]: navigation takes 0.6 GB."""
STRIP_CELLS = 100_000
"""Cells of a strip: numbers that come of them between stay in a processor's caches."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Raster:
    """Rows and columns of square cells in the map's frame; row 0 is the lowest.

    The left edge is at `x`, the lower one at `y`; `cell` is the side of a cell [m].
    """

    x: float
    y: float
    cell: float
    height: int
    width: int

    @classmethod
    def around(
        cls, bounds: Extent, cell: float, margin: float = 0.0, fine: int = FINE_CELLS
    ) -> Self:
        """Return the cells that cover `bounds` and `margin` [m] around them.

        They are twice as large if there were more than `fine` ones. Edges lie on multiples of
        `cell`, so that rasters of the same cells fit together.

        Raises:
            ConfigError: The map is too large.
        """
        wide, deep = bounds.x_max - bounds.x_min, bounds.y_max - bounds.y_min
        if wide * deep > MOST_AREA:
            most = f"{MOST_AREA:.0f} square metres at most"
            size = f"{wide:.0f} x {deep:.0f} m"
            raise ConfigError(f"the map is {size}, too large to go by: {most}; take a part of it")
        cell *= 1 if wide * deep <= fine * cell**2 else 2
        left, low = (floor((edge - margin) / cell) for edge in bounds[:2])
        right, high = (ceil((edge + margin) / cell) for edge in bounds[2:])
        return cls(
            x=left * cell, y=low * cell, cell=cell, height=high - low + 1, width=right - left + 1
        )

    @property
    def edges(self) -> tuple[float, float, float]:
        """Left and lower edge, and the side of a cell [m]."""
        return self.x, self.y, self.cell

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.height, self.width

    @property
    def strips(self) -> Iterator[slice]:
        """Strips of whole rows, one after the other, to work on without large arrays between."""
        rows = max(1, STRIP_CELLS // self.width)
        return (slice(low, low + rows) for low in range(0, self.height, rows))

    def in_cells(self, points: Float) -> Float:
        """Return `points` (N, 2) [m] in cells from the lower left corner."""
        scaled: Float = (points - (self.x, self.y)) / self.cell
        return scaled

    def cells_of(self, points: Float) -> tuple[Int, Int, Bool]:
        """Return rows and columns of points (..., 2) [m], the nearest ones of those outside.

        The last array tells which are inside.
        """
        at = np.floor(self.in_cells(points)).astype(np.int64)
        columns, rows = at[..., 0], at[..., 1]
        inside = (columns >= 0) & (columns < self.width) & (rows >= 0) & (rows < self.height)
        return rows.clip(0, self.height - 1), columns.clip(0, self.width - 1), inside

    def cell_of(self, x: float, y: float) -> tuple[int, int] | None:
        """Return row and column of a point [m], or `None` outside."""
        row, column = floor((y - self.y) / self.cell), floor((x - self.x) / self.cell)
        inside = 0 <= row < self.height and 0 <= column < self.width
        return (row, column) if inside else None

    def window(self, x: float, y: float, within: float) -> tuple[slice, slice]:
        """Return the rows and columns of the cells within a distance of a place [m]."""
        u, v, reach = (x - self.x) / self.cell, (y - self.y) / self.cell, within / self.cell
        rows = slice(max(0, int(v - reach)), max(0, int(v + reach) + 1))
        return rows, slice(max(0, int(u - reach)), max(0, int(u + reach) + 1))

    def middles(self, rows: slice, columns: slice) -> tuple[Float, Float]:
        """Return the middles of rows and columns [m]: x, shape (C,), and y, shape (R, 1)."""
        x = self.x + np.arange(0.5, self.width, dtype=np.float64)[columns] * self.cell
        y = self.y + np.arange(0.5, self.height, dtype=np.float64)[rows, None] * self.cell
        return x, y

    def middle_of(self, row: int, column: int) -> tuple[float, float]:
        """Return the middle of a cell [m]."""
        return self.x + (column + 0.5) * self.cell, self.y + (row + 0.5) * self.cell

    def middles_of(self, rows: Int, columns: Int) -> Float:
        """Return the middles of cells [m], shape (N, 2)."""
        middles: Float = np.stack([columns + 0.5, rows + 0.5], axis=1) * self.cell
        middles += (self.x, self.y)
        return middles


def cells_where(marks: Bool) -> tuple[Int, Int]:
    """Return rows and columns of the cells that are marked, shape (H, W).

    `np.nonzero` takes 30 times as long where they are few of many.
    """
    rows, columns = np.divmod(np.flatnonzero(marks), marks.shape[1])
    return rows, columns


@dataclass(frozen=True, slots=True, eq=False)
class DistanceField:
    """The distance to the nearest wall from the middle of each cell [m], less `reach`, (H, W).

    Distances to segments have no bias. A field that counts from cells has one of half a cell, five
    times the error of a laser. Distances end at `reach` [m]: there the array is 0 and takes no
    memory.
    """

    raster: Raster
    distances: Float32
    reach: float

    @classmethod
    def of(cls, walls: Float, bounds: Extent, cell: float, reach: float) -> Self:
        """Return the field of `walls` (N, 4) [m] over `bounds` and `reach` [m] around them."""
        raster = Raster.around(bounds, cell, reach)
        field = cls(raster, sparse(raster.shape, np.float32), reach)
        fast(nearest_wall, CACHE)(walls, field.frame, reach, field.distances)
        return field

    @property
    def frame(self) -> Frame:
        """Left and lower edge of the cells, the side of one, and the reach [m]."""
        return *self.raster.edges, self.reach


def sparse(shape: tuple[int, ...], kind: type[np.generic]) -> NDArray[Any]:
    """Return zeros that take memory where they are written, to the nearest pages.

    With numpy's own a write takes 2 MB where the system has huge pages, with all that is beside it.
    """
    if sys.platform != "linux":
        return np.zeros(shape, dtype=kind)
    count = prod(shape)
    private = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS  # what is shared takes memory where it is read
    memory = mmap.mmap(-1, max(1, count * np.dtype(kind).itemsize), private)
    with suppress(OSError):  # a system without huge pages knows no such advice
        memory.madvise(mmap.MADV_NOHUGEPAGE)
    return np.frombuffer(memory, dtype=kind, count=count).reshape(shape)
