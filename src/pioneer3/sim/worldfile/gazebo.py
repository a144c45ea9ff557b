"""Reads worlds of Gazebo: what is solid in them becomes boxes, columns and walls.

Only collision shapes count. An upright shape keeps its height; a tilted one, a ball and a mesh
become walls where a plane at the height of sensors cuts them, or around all of them below it.
"""

import re
from math import acos, atan2, ceil, pi
from pathlib import Path

import numpy as np

from pioneer3.arrays import Float, Float32
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps.grid import MOST_WALLS
from pioneer3.sim.relief import Cylinder
from pioneer3.sim.relief.mesh_file import ENDINGS, read_mesh
from pioneer3.sim.relief.shapes import FARTHEST, outer
from pioneer3.sim.relief.solids import ROUND, SENSOR_HEIGHT
from pioneer3.sim.worldfile.collada import read_collada
from pioneer3.sim.worldfile.gazebo_frames import ANYWHERE, NONE, SdfFrames, flat, named, pose_of
from pioneer3.sim.worldfile.gazebo_text import SdfElement, SdfFiles, descendants
from pioneer3.sim.worldfile.spec import Box, WorldFile
from pioneer3.sim.worldfile.stand_ins import (
    LASER_SAMPLES,
    TALLEST,
    THIN,
    FoundWorld,
    laser_of,
    pioneer_of,
)

LOW = 0.05
"""A solid no higher than this stops no robot here, and is left out [m]."""
FLOOR = 0.005
"""A solid no higher than this is floor [m]."""
UPRIGHT = 0.999
"""Least cosine between an axis of a solid that stands upright and the vertical."""
WIDE = 1.0
"""A round solid of a larger radius becomes a wall: a column has too few sides for it [m]."""
ROUNDING = 0.01
"""Farthest that such a wall is from the circle [m]."""
LARGEST = 1000.0
"""Longest side of a solid; larger ones are left out [m]."""
MOST_TRIANGLES = 3_000_000
"""Triangles of all meshes of a world."""
MOST_CUT = 30_000_000
"""Triangles of all meshes of a world, each use counted."""
SLOWER = 30
"""Triangles that are cut while one is outlined from above."""
MOST_CORNERS = 50_000
"""Corners of all walls that are made of round, tilted and angular solids."""
MOST_MODELS = 20_000
"""Models of a world, with those in other models."""
DEEPEST = 16
"""Deepest nesting of models and includes."""
_SQUARE = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
_LASERS = ("ray", "gpu_ray", "lidar", "gpu_lidar")
_DRIVE = re.compile(r"diff[-_]?drive|skid[-_]?steer|differential", re.IGNORECASE)
_USUAL = re.compile(
    r"(?:model://)?(?:sun|(?:\w+_)?ground_plane|asphalt_plane)/?$|.*/(?:sun|ground plane)$",
    re.IGNORECASE,
)
"""Includes that need no counterpart."""
_NAMED = ("actor", "road", "population")
"""Elements of a world that have no counterpart."""


def read_gazebo(path: Path) -> WorldFile:
    """Read a world or a model of Gazebo, with the files that it includes.

    A warning names once all that has no counterpart here, or is not on this computer.

    Raises:
        ConfigError: It cannot be read, or is wrong; names file and line.
    """
    return _GazeboReader(path).world()


class _GazeboReader:
    """Collects the solids and robots of a world."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._files = SdfFiles()
        self._found = FoundWorld()
        self._left = self._found.left
        self._meshes: dict[Path, Float32] = {}
        self._models = self._triangles = self._cut = self._count = self._corners = 0
        self._takers = {
            "box": self._box,
            "capsule": self._cylinder,
            "cylinder": self._cylinder,
            "ellipsoid": self._ellipsoid,
            "empty": lambda *_: None,
            "mesh": self._mesh,
            "plane": self._plane,
            "polyline": self._polyline,
            "sphere": self._ball,
        }

    def world(self) -> WorldFile:
        """Return the world, and warn of all that is not in it."""
        root = self._files.root(self._path)
        if root.tag not in ("sdf", "gazebo", "world"):
            raise root.wrong("expected <sdf> with a <world> or <model>")
        scope = root if root.tag == "world" else root.first("world") or root
        self._scope(scope, NONE, SdfFrames(scope, _saved(scope)), 0)
        self._left.update((tag, None) for tag in _NAMED if scope.first(tag))
        missing = self._files.missing.items()
        return self._found.file(
            self._path, [f"{uri} is not on this computer ({at})" for uri, at in missing]
        )

    def _scope(self, scope: SdfElement, place: Float, frames: SdfFrames, depth: int) -> None:
        """Take all models and includes of a world or model whose frame is at `place`."""
        for child in scope.all("model", "include"):
            self._models += 1
            if self._models > MOST_MODELS or depth > DEEPEST:
                most = f"{MOST_MODELS} models, or {DEEPEST} in each other"
                raise child.wrong(f"a world of more than {most}")
            if child.tag == "model":
                self._model(child, place @ frames.of(child), (child.name,), depth)
            else:
                self._include(child, place, frames, depth)

    def _include(self, include: SdfElement, place: Float, frames: SdfFrames, depth: int) -> None:
        uri = include.told("uri") or include.attributes.get("filename", "")
        if _USUAL.match(uri):
            return
        names = (named(include), uri.rstrip("/").rpartition("/")[2])
        is_robot = bool(pioneer_of(names))
        there = not is_robot or self._files.find(uri, include)
        root = self._files.model(uri, include) if there else None
        model = root.first("model") if root else None
        if not (is_robot or model):
            return
        posed = include.first("pose") is not None or names[0] in frames.moved
        at = place @ frames.of(include) @ (NONE if posed or model is None else pose_of(model))
        if is_robot:
            self._files.missing.pop(uri, None)  # a robot of ours stands for it
            self._robot(model, at, names)
        elif model:
            self._model(model, at, (*names, model.name), depth + 1)

    def _model(self, model: SdfElement, place: Float, names: tuple[str, ...], depth: int) -> None:
        """Take a model whose frame is at `place`: a robot, or what is solid of it."""
        drives = any(
            _DRIVE.search(each.attributes.get("filename", "") + each.name)
            for each in model.all("plugin")
        )
        if drives or (model.first("joint") and pioneer_of(names)):
            self._robot(model, place, names)
            return
        frames = SdfFrames(model, {})
        for link in model.all("link"):
            at = place @ frames.of(link)
            for collision in link.all("collision"):
                geometry = collision.first("geometry")
                for shape in geometry.children if geometry else ():
                    self._shape(shape, at @ pose_of(collision))
        self._scope(model, place, frames, depth + 1)

    def _robot(self, model: SdfElement | None, place: Float, names: tuple[str, ...]) -> None:
        laser = ""
        for sensor in descendants(model, ("sensor",)) if model else ():
            horizontal = next(descendants(sensor, ("horizontal",)), None)
            span = next(descendants(sensor, ("range",)), None)
            if sensor.attributes.get("type") in _LASERS and horizontal:
                far = span.numbers("max", 1) if span else ()
                if horizontal.numbers("samples", 1) >= (LASER_SAMPLES,):
                    laser = laser or laser_of((sensor.name,), far[0] if far else 0.0)
        name = next(filter(None, names), "")
        self._found.add_robot(names, name, flat(place), laser=laser, usual="p3dx-sh")

    def _shape(self, shape: SdfElement, place: Float) -> None:
        """Take one collision shape at a pose, a matrix (4, 4)."""
        if self._corners > MOST_CORNERS:
            raise shape.wrong(f"round and tilted solids of more than {MOST_CORNERS} corners")
        if abs(place[:3, 3]).max() > FARTHEST:
            self._left[f"solids farther than {FARTHEST / 1000:g} km"] = None
        elif shape.tag in self._takers:
            self._takers[shape.tag](shape, place)
        else:
            self._left[shape.tag] = None

    def _box(self, shape: SdfElement, place: Float) -> None:
        size = _told(shape, "size", (1.0, 1.0, 1.0))
        axis = _upright(place)
        if axis is None:
            self._outlined(_prism(_SQUARE * size[:2], -size[2] / 2, size[2] / 2), place)
            return
        along, across = (each for each in range(3) if each != axis)
        x, y, z = place[:3, 3].tolist()
        span = self._span(z - size[axis] / 2, z + size[axis] / 2, max(size))
        if span:
            foot, height = span
            sides = (max(size[along], THIN), max(size[across], THIN))
            pose = Pose2(x, y, atan2(place[1, along], place[0, along]))
            self._found.boxes.append(Box(pose=pose, size=sides, height=height, z=foot))

    def _cylinder(self, shape: SdfElement, place: Float) -> None:
        """Take a cylinder or a capsule."""
        radius, length = (_told(shape, key, (1.0,))[0] for key in ("radius", "length"))
        length += 2 * radius if shape.tag == "capsule" else 0.0
        if _upright(place) == 2:
            self._column(place[:3, 3], radius, length)
        else:
            self._outlined(_prism(_circle(ROUND) * radius, -length / 2, length / 2), place)

    def _ellipsoid(self, shape: SdfElement, place: Float) -> None:
        radii = _told(shape, "radii", (1.0, 1.0, 1.0))
        self._outlined(_prism(_circle(ROUND), -1.0, 1.0) * radii, place)

    def _column(self, center: Float, radius: float, height: float) -> None:
        span = self._span(center[2] - height / 2, center[2] + height / 2, radius)
        if span:
            foot, height = span
            if radius > WIDE and foot < SENSOR_HEIGHT:
                sides = ceil(pi / acos(1 - ROUNDING / radius))
                self._wall(_circle(sides) * radius + center[:2], span)
                return
            pose = Pose2(float(center[0]), float(center[1]))
            radius = min(max(radius, THIN), LARGEST / 2)
            self._found.solids.append(Cylinder(pose=pose, radius=radius, height=height, z=foot))

    def _ball(self, shape: SdfElement, place: Float) -> None:
        """Take a ball as a column, as wide as it is at the height of sensors if it is higher."""
        radius = _told(shape, "radius", (1.0,))[0]
        above = float(place[2, 3]) - SENSOR_HEIGHT
        wide = max(radius**2 - max(above, 0.0) ** 2, 0.0) ** 0.5 if above < radius else radius
        self._column(place[:3, 3], wide, 2 * radius)

    def _polyline(self, shape: SdfElement, place: Float) -> None:
        """Take a polygon that is as high as told."""
        told = [point.read("point", point.text, 2) for point in shape.all("point")]
        points = np.array(told).reshape(-1, 2)
        height = _told(shape, "height", (1.0,))[0]
        foot = float(place[2, 3])
        if _upright(place) == 2:
            if span := self._span(foot, foot + height, 0.0):
                self._wall(_moved(_prism(points, 0.0, 0.0)[0], place)[:, :2], span)
        elif len(hull := outer(points)):
            self._outlined(_prism(hull, 0.0, height), place)

    def _plane(self, shape: SdfElement, place: Float) -> None:
        normal = np.array(shape.numbers("normal", 3) or (0.0, 0.0, 1.0))
        if abs((place[:3, :3] @ normal)[2]) < UPRIGHT * np.linalg.norm(normal):
            self._left["planes that are not level"] = None

    def _outlined(self, rings: Float, place: Float) -> None:
        """Take a convex solid as an upright wall, cut at the height of sensors.

        Its corners are those of its foot and its top, (2, P, 3). One that is not higher, or a
        little, is seen from above.
        """
        moved = _moved(rings, place)
        low, high = float(moved[..., 2].min()), float(moved[..., 2].max())
        span = self._span(low, high, float(np.ptp(moved[..., :2], axis=(0, 1)).max()))
        if span:
            points = moved[..., :2].reshape(-1, 2)
            if low <= SENSOR_HEIGHT < high - LOW:
                after = np.roll(moved, -1, axis=1)
                start = np.concatenate([*moved, moved[0]])
                end = np.concatenate([*after, moved[-1]])
                points = _crossings(start, end, SENSOR_HEIGHT)
            self._wall(outer(points), span)

    def _wall(self, corners: Float, span: tuple[float, float]) -> None:
        foot, height = span
        if foot >= SENSOR_HEIGHT:
            self._left["tilted or angular solids above robots"] = None
        elif len(corners) > 1:
            self._corners += len(corners)
            self._found.add_wall(corners, foot + height)

    def _mesh(self, shape: SdfElement, place: Float) -> None:
        """Take the cut of a mesh at the height of sensors."""
        uri = shape.told("uri") or shape.attributes.get("filename", "")
        path = self._files.find(uri, shape)
        if path is None:
            return
        ending = path.suffix.lower()
        if ending not in (*ENDINGS, ".dae"):
            self._left[f"meshes in {ending or 'files without an ending'}"] = None
            return
        triangles = self._triangles_of(path, shape)
        self._cut += len(triangles)
        if self._cut > MOST_CUT:
            raise shape.wrong(f"the meshes have more than {MOST_CUT / 1e6:g} million triangles")
        scale = shape.numbers("scale", 3) or (1.0, 1.0, 1.0)
        heights = triangles @ (place[2, :3] * scale) + place[2, 3]
        if not self._span(float(heights.min()), float(heights.max()), 0.0):
            return
        above = heights > SENSOR_HEIGHT
        if not above.any():
            self._cut += SLOWER * len(triangles)
            points = triangles.reshape(1, -1, 3).astype(np.float64) * scale
            self._outlined(points, place)
            return
        crossing = triangles[above.any(axis=1) & ~above.all(axis=1)] * scale
        walls = cut(_moved(crossing, place), SENSOR_HEIGHT)
        self._count += len(walls)
        if self._count > MOST_WALLS or (len(walls) and abs(walls).max() > 100 * LARGEST):
            raise shape.wrong("has too many walls, or reaches too far")
        self._found.segments.append(walls)

    def _triangles_of(self, path: Path, shape: SdfElement) -> Float32:
        """Return the triangles of a mesh, which is read once, shape (T, 3, 3)."""
        if path not in self._meshes:
            try:
                if path.suffix.lower() == ".dae":
                    triangles = read_collada(path)
                else:
                    mesh = read_mesh(path)
                    triangles = mesh.points[mesh.corners]
            except ConfigError as error:
                raise shape.wrong(str(error)) from None
            if abs(triangles).max() > ANYWHERE:
                raise shape.wrong("has too many walls, or reaches too far")
            self._triangles += len(triangles)
            if self._triangles > MOST_TRIANGLES:
                most = f"{MOST_TRIANGLES / 1e6:g} million"
                raise shape.wrong(f"the meshes have more than {most} triangles")
            self._meshes[path] = triangles.astype(np.float32)  # there may be millions
        return self._meshes[path]

    def _span(self, low: float, high: float, side: float) -> tuple[float, float] | None:
        """Return foot and height of a solid [m]; `None` for floor and for what is left out."""
        if high <= FLOOR:
            return None
        if high <= LOW:
            self._left[f"solids no higher than {LOW * 100:g} cm"] = None
            return None
        if side > LARGEST or low > TALLEST:
            self._left["solids of more than 1 km, or above 100 m"] = None
            return None
        foot = float(max(low, 0.0))
        return foot, float(min(max(high - foot, 0.001), TALLEST))


def cut(triangles: Float, height: float) -> Float:
    """Return the segments where a level plane cuts triangles (T, 3, 3), shape (S, 4)."""
    above = triangles[:, :, 2] > height
    crossing = triangles[above.any(axis=1) & ~above.all(axis=1)]
    after = np.roll(crossing, -1, axis=1)
    return _crossings(crossing.reshape(-1, 3), after.reshape(-1, 3), height).reshape(-1, 4)


def _crossings(start: Float, end: Float, height: float) -> Float:
    """Return the points (P, 2) where lines between points (L, 3) cross a height."""
    crosses = (start[:, 2] > height) != (end[:, 2] > height)
    start, end = start[crosses], end[crosses]
    share = (height - start[:, 2]) / (end[:, 2] - start[:, 2])
    points: Float = start[:, :2] + share[:, None] * (end[:, :2] - start[:, :2])
    return points


def _saved(world: SdfElement) -> dict[str, Float]:
    """Return the poses of models in the state with which a world was saved."""
    state = world.first("state")
    models = state.all("model") if state else ()
    return {model.name: pose_of(model) for model in models if model.first("pose")}


def _told(shape: SdfElement, key: str, usual: tuple[float, ...]) -> tuple[float, ...]:
    """Return numbers of a shape without their signs; where there are none, those of SDF."""
    return tuple(map(abs, shape.numbers(key, len(usual)) or usual))


def _upright(place: Float) -> int | None:
    """Return the number of the axis of a pose that is upright, if one is."""
    axis = int(abs(place[2, :3]).argmax())
    return axis if abs(place[2, axis]) >= UPRIGHT else None


def _circle(corners: int) -> Float:
    """Return points of a circle of radius 1, shape (corners, 2)."""
    angles = np.arange(corners) * (2 * pi / corners)
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _prism(ring: Float, low: float, high: float) -> Float:
    """Return the corners of foot and top of a solid above a polygon (P, 2), shape (2, P, 3)."""
    return np.array([np.column_stack([ring, np.full(len(ring), z)]) for z in (low, high)])


def _moved(points: Float, place: Float) -> Float:
    """Return points (..., 3) of the frame of a pose in that of the world."""
    moved: Float = points @ place[:3, :3].T + place[:3, 3]
    return moved
