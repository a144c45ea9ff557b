"""Reads the triangles of COLLADA files (.dae), the usual meshes of Gazebo.

As there the unit of the file counts, and its upward axis does not.
"""

from collections.abc import Iterator
from math import cos, radians, sin
from pathlib import Path

import numpy as np

from pioneer3.arrays import Float, Int
from pioneer3.sim.worldfile.gazebo_text import SdfElement, SdfFiles, descendants
from pioneer3.text import wrong

MOST_TRIANGLES = 500_000
"""Triangles of a scene, each use of a geometry counted."""
MOST_NODES = 20_000
"""Most nodes of a scene, each use counted."""
DEEPEST = 50
"""Deepest nesting of nodes."""


def read_collada(path: Path) -> Float:
    """Return the triangles of the scene of a file [m], shape (T, 3, 3)."""
    root = SdfFiles().root(path)
    try:
        with np.errstate(all="ignore"):  # numbers too large, which are told below
            found = list(_Scene(root).triangles())
        triangles = np.concatenate(found) if found else np.empty((0, 3, 3))
    except _TooManyError:
        most = f"{MOST_TRIANGLES} triangles, or {MOST_NODES} nodes"
        raise wrong(path, f" holds more than {most}: reduce it") from None
    except (ValueError, IndexError, KeyError, OverflowError):
        raise wrong(path, " is damaged: no COLLADA file") from None
    if not len(triangles):
        raise wrong(path, " holds no triangles")
    if not np.isfinite(triangles).all():
        raise wrong(path, " is damaged: a corner is no number")
    return triangles


class _TooManyError(Exception):
    """A file has more triangles or nodes than are read."""


class _Scene:
    """The nodes of a file, and the geometries that they place."""

    def __init__(self, root: SdfElement) -> None:
        self._root = root
        self._by_id = {
            each.attributes["id"]: each
            for each in descendants(root, ("node", "geometry", "source", "vertices"))
            if "id" in each.attributes
        }
        self._shapes: dict[str, Float] = {}
        self._nodes = self._count = 0

    def triangles(self) -> Iterator[Float]:
        """Yield the triangles of each placed geometry [m], shape (T, 3, 3)."""
        unit = next(descendants(self._root, ("unit",)), None)
        scale = np.diag([float(unit.attributes.get("meter", 1)) if unit else 1.0] * 3 + [1.0])
        for scene in descendants(self._root, ("visual_scene",)):
            for node in scene.all("node"):
                yield from self._placed(node, scale, 0)

    def _placed(self, node: SdfElement, place: Float, depth: int) -> Iterator[Float]:
        self._nodes += 1
        if depth > DEEPEST or self._nodes > MOST_NODES:
            raise _TooManyError
        for child in node.children:
            place = place @ _transform(child)
        for child in node.children:
            target = child.attributes.get("url", "")[1:]
            match child.tag:
                case "node":
                    yield from self._placed(child, place, depth + 1)
                case "instance_node":
                    yield from self._placed(self._by_id[target], place, depth + 1)
                case "instance_geometry":
                    shape = self._shape(target)
                    self._count += len(shape)
                    if self._count > MOST_TRIANGLES:
                        raise _TooManyError
                    yield shape @ place[:3, :3].T + place[:3, 3]

    def _shape(self, name: str) -> Float:
        if name not in self._shapes:
            mesh = self._by_id[name].first("mesh")
            kinds = ("triangles", "polylist", "polygons")
            parts = [self._part(each) for each in (mesh.all(*kinds) if mesh else ())]
            self._shapes[name] = np.concatenate([np.empty((0, 3, 3)), *parts])
        return self._shapes[name]

    def _part(self, part: SdfElement) -> Float:
        """Return the triangles of a list of faces; faces of more corners become fans."""
        inputs = {each.attributes["semantic"]: each.attributes for each in part.all("input")}
        stride = max(int(each.attributes.get("offset", 0)) for each in part.all("input")) + 1
        vertices = self._by_id[inputs["VERTEX"]["source"][1:]]
        points = self._points(vertices)
        first = int(inputs["VERTEX"].get("offset", 0))
        faces = [_whole(each.text) for each in part.all("p")]
        corners = np.concatenate([np.empty(0, np.int64), *faces]).reshape(-1, stride)[:, first]
        if (corners < 0).any():
            raise ValueError
        if part.tag == "triangles":
            found: Float = points[corners.reshape(-1, 3)]
            return found
        if part.tag == "polylist":
            counts = _whole(part.told("vcount"))
        else:
            counts = np.array([len(face) // stride for face in faces], dtype=np.int64)
        if (counts < 0).any() or counts.sum() != len(corners):
            raise ValueError
        starts = np.cumsum(counts) - counts
        fans = (counts - 2).clip(min=0)
        owner = np.repeat(np.arange(len(counts)), fans)
        step = np.arange(len(owner)) - np.repeat(np.cumsum(fans) - fans, fans)
        begin = starts[owner]
        fan: Float = points[corners[np.stack([begin, begin + step + 1, begin + step + 2], axis=1)]]
        return fan

    def _points(self, vertices: SdfElement) -> Float:
        inputs = {each.attributes["semantic"]: each.attributes for each in vertices.all("input")}
        source = inputs["POSITION"]["source"][1:]
        return _numbers(self._by_id[source].told("float_array")).reshape(-1, 3)


def _whole(text: str) -> Int:
    words = text.split()
    return np.fromiter(map(int, words), np.int64, len(words))


def _numbers(text: str) -> Float:
    words = text.split()
    return np.fromiter(map(float, words), np.float64, len(words))


def _transform(element: SdfElement) -> Float:
    """Return the move that a child of a node is, as a matrix (4, 4)."""
    matrix = np.eye(4)
    if element.tag not in ("matrix", "translate", "rotate", "scale"):
        return matrix
    numbers = _numbers(element.text)
    match element.tag:
        case "matrix":
            return numbers.reshape(4, 4)
        case "translate":
            matrix[:3, 3] = numbers
        case "scale":
            matrix[:3, :3] = np.diag(numbers)
        case _:
            x, y, z = numbers[:3] / max(float(np.linalg.norm(numbers[:3])), 1e-12)
            c, s = cos(radians(numbers[3])), sin(radians(numbers[3]))
            cross = np.array([(0, -z, y), (z, 0, -x), (-y, x, 0)])
            matrix[:3, :3] = np.eye(3) + s * cross + (1 - c) * cross @ cross
    return matrix
