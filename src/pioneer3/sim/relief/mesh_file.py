"""Reads meshes: STL, binary or text, and the points and faces of OBJ."""

import re
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice, pairwise
from pathlib import Path

import numpy as np

from pioneer3.arrays import Float, Int
from pioneer3.text import decoded, numbered, read_bytes, wrong

ENDINGS = (".stl", ".obj")
LARGEST_MESH = 16 << 20
"""Larger files are not read [bytes]."""
MOST_TRIANGLES = 50_000
"""A page draws them all, and rays are tested against each."""
MOST_POINTS = 3 * MOST_TRIANGLES
"""So many corners have triangles that share none."""
_HEADER = 84
"""Size of a binary STL's header with the number of triangles [bytes]."""
_RECORD = 50
"""Size of one triangle of it [bytes]."""
_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
_VERTEX = re.compile(r"^[ \t]*vertex[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE)


class _TooManyError(Exception):
    """A file has more triangles or points than are read."""


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """A surface of points (P, 3) in the frame of the mesh; compares by identity.

    `corners` are three numbers of points for each triangle, counter-clockwise from outside, (T, 3).
    """

    points: Float
    corners: Int

    @property
    def volume(self) -> float:
        """The volume inside of a closed surface, in cubes of the unit of its points."""
        a, b, c = (self.points[self.corners[:, number]] for number in range(3))
        return float((a * np.cross(b, c)).sum() / 6)

    @property
    def reach(self) -> float:
        """The largest coordinate, without its sign."""
        return float(abs(self.points).max())

    @property
    def thickness(self) -> float:
        """The smallest extent, along the axes of its frame or its principal axes."""
        about = self.points - self.points.mean(axis=0)
        _, axes = np.linalg.eigh(about.T @ about)
        return float(np.ptp(np.hstack([self.points, about @ axes]), axis=0).min())


def read_mesh(path: Path) -> Triangles:
    """Read an STL or OBJ file, in its units; ConfigError if it is damaged, too large or empty."""
    try:
        there = path.stat()
        key = there.st_mtime_ns, there.st_size
    except (OSError, ValueError):
        key = 0, 0  # reading says why
    return _read(path, key)


@lru_cache(maxsize=64)
def scaled(mesh: Triangles, scale: float) -> Triangles:
    """Return a mesh `scale` times as large; the same one for the same scale."""
    return Triangles(mesh.points * scale, mesh.corners)


@lru_cache(maxsize=64)
def _read(path: Path, version: tuple[int, int]) -> Triangles:
    if path.suffix.lower() not in ENDINGS:
        raise wrong(path, f" is no mesh that can be read: expected {' or '.join(ENDINGS)}")
    raw = read_bytes(path, LARGEST_MESH, "mesh")
    try:
        mesh = _obj(decoded(raw)) if path.suffix.lower() == ".obj" else _stl(raw)
    except (ValueError, IndexError, OverflowError):
        raise wrong(path, f" is damaged: no {path.suffix[1:].upper()} file") from None
    except _TooManyError:
        problem = f"more than {MOST_TRIANGLES} triangles, or {MOST_POINTS} points: reduce it"
        raise wrong(path, f" holds {problem}") from None
    if not len(mesh.corners):
        raise wrong(path, " holds no triangles")
    inside = (mesh.corners >= 0) & (mesh.corners < len(mesh.points))
    if not inside.all() or not np.isfinite(mesh.points).all():
        raise wrong(path, " is damaged: a corner is missing or no number")
    return mesh


def _stl(raw: bytes) -> Triangles:
    count = int.from_bytes(raw[80:_HEADER], "little")
    if len(raw) >= _HEADER and len(raw) == _HEADER + _RECORD * count:
        if count > MOST_TRIANGLES:
            raise _TooManyError
        corners = np.frombuffer(raw, _ROW, count, _HEADER)["corners"].astype(np.float64)
    elif raw.lstrip()[:5] == b"solid":
        vertices = _VERTEX.finditer(decoded(raw))
        found = [tuple(map(float, each.groups())) for each in islice(vertices, MOST_POINTS + 1)]
        if len(found) > MOST_POINTS:
            raise _TooManyError
        corners = np.array(found, dtype=np.float64).reshape(-1, 3, 3)
    else:
        raise ValueError
    points, numbers = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return Triangles(points, numbers.reshape(-1, 3).astype(np.int64))


def _obj(text: str) -> Triangles:
    """Read the lines `v x y z` and `f a b c ...`; faces of more corners become fans."""
    points: list[tuple[float, ...]] = []
    corners: list[tuple[int, int, int]] = []
    for _, line in numbered(text):
        # a face of more corners than are read keeps one of them too many, and costs no more
        key, *words = line.split(None, MOST_TRIANGLES + 3) or [""]
        if key == "v":
            points.append(tuple(map(float, words[:3])))
        elif key == "f":
            if len(corners) + len(words) - 2 > MOST_TRIANGLES:
                raise _TooManyError
            numbers = [int(word.partition("/")[0]) for word in words]
            # from 1; negative ones count back from the last point so far
            first, *others = (n - 1 if n > 0 else len(points) + n for n in numbers)
            corners += [(first, a, b) for a, b in pairwise(others)]
        if len(points) > MOST_POINTS:
            raise _TooManyError
    shaped = np.array(points, dtype=np.float64).reshape(-1, 3)
    return Triangles(shaped, np.array(corners, dtype=np.int64).reshape(-1, 3))
