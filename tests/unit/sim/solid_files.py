"""Files of solids for tests: meshes as binary STL, pictures of heights."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pioneer3.maps.image import to_png

Float = NDArray[np.float64]
Corner = tuple[float, float, float]

FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
"""Of the corners of a cuboid, each counter-clockwise from outside."""


def cuboid(low: Corner, high: Corner) -> Float:
    """Return the twelve triangles of a cuboid, shape (12, 3, 3)."""
    corners = np.array(
        [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    )
    return np.array([corners[[a, *pair]] for a, b, c, d in FACES for pair in ((b, c), (c, d))])


def write_stl(path: Path, parts: Iterable[Float]) -> None:
    """Write triangles as binary STL."""
    triangles = np.concatenate([*parts])
    rows = np.zeros(len(triangles), np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("r", "<u2")]))
    rows["c"] = triangles
    path.write_bytes(bytes(80) + len(rows).to_bytes(4, "little") + rows.tobytes())


def write_block(path: Path, size: Corner) -> None:
    """Write a cuboid on the floor, its origin in the middle of its foot."""
    x, y, z = size
    write_stl(path, [cuboid((-x / 2, -y / 2, 0.0), (x / 2, y / 2, z))])


def write_u(path: Path) -> None:
    """Write three walls around a room of 0.8 m, open to one side."""
    walls = [((0, 0, 0), (1, 0.1, 0.6)), ((0, 0.9, 0), (1, 1, 0.6)), ((0, 0.1, 0), (0.1, 0.9, 0.6))]
    write_stl(path, [cuboid(*wall) for wall in walls])


def write_hill(path: Path, *, rows: int = 21, columns: int = 31) -> None:
    """Write a picture whose shade grows from 55 at the left to 205 at the right."""
    shades = np.tile(np.linspace(55, 205, columns).astype(np.uint8), (rows, 1))
    path.write_bytes(to_png(np.repeat(shades[:, :, None], 3, axis=2)))
