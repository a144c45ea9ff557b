"""Reads worlds of Gazebo: what is solid in them becomes boxes, columns and walls.

Only collision shapes count. An upright shape keeps its height; a tilted one, a ball and a mesh
become walls where a plane at the height of sensors cuts them, or around all of them below it.
"""

import logging
import re
from math import acos, atan2, ceil, pi
from pathlib import Path

import numpy as np

from pioneer3.arrays import Float, Float32
from pioneer3.errors import ConfigError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.maps.grid import MOST_WALLS
from pioneer3.names import clean_name, free_name, printable
from pioneer3.sim.equipment import NO_OPTIONS, EquipmentOptions
from pioneer3.sim.relief import Cylinder, Solid
from pioneer3.sim.relief.mesh_file import ENDINGS, read_mesh
from pioneer3.sim.relief.shapes import FARTHEST, outer
from pioneer3.sim.relief.solids import ROUND, SENSOR_HEIGHT
from pioneer3.sim.worldfile.collada import read_collada
from pioneer3.sim.worldfile.gazebo_frames import ANYWHERE, NONE, SdfFrames, flat, named, pose_of
from pioneer3.sim.worldfile.gazebo_text import SdfElement, SdfFiles, descendants
from pioneer3.sim.worldfile.spec import Box, RobotSpec, Wall, WorldFile
from pioneer3.sim.worldfile.stand_ins import homes_of, laser_of, pioneer_of

log = logging.getLogger(__name__)

LOW = 0.05
"""A solid no higher than this stops no robot here, and is left out [m]."""
FLOOR = 0.005
"""A solid no higher than this is floor [m]."""
UPRIGHT = 0.999
"""Least cosine between an axis of a solid that stands upright and the vertical."""
THIN = 0.01
"""Shortest side of a box [m]."""
WIDE = 1.0
"""A round solid of a larger radius becomes a wall: a column has too few sides for it [m]."""
ROUNDING = 0.01
"""Farthest that such a wall is from the circle [m]."""
LARGEST = 1000.0
"""Longest side of a solid; larger ones are left out [m]."""
TALLEST = 100.0
"""Highest that anything is made [m]."""
MOST_TRIANGLES = 3_000_000
"""Triangles of all meshes of a world."""
MOST_CUT = 30_000_000
"""Triangles of all meshes of a world, each use counted."""
MOST_CORNERS = 50_000
"""Corners of all walls that are made of round, tilted and angular solids."""
MOST_MODELS = 20_000
"""Models of a world, with those in other models."""
DEEPEST = 16
"""Deepest nesting of models and includes."""
_LASER_SAMPLES = 30
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
        self._segments: list[Float] = []
        self._boxes: list[Box] = []
        self._walls: list[Wall] = []
        self._solids: list[Solid] = []
        self._robots: list[RobotSpec] = []
        self._names: set[str] = set()
        self._left: dict[str, None] = {}
        self._others: dict[str, str] = {}
        self._meshes: dict[Path, Float32] = {}
        self._models = self._triangles = self._cut = self._count = self._corners = 0

    def world(self) -> WorldFile:
        """Return the world, and warn of all that is not in it."""
        root = self._files.root(self._path)
        if root.tag not in ("sdf", "gazebo", "world"):
            raise root.wrong("expected <sdf> with a <world> or <model>")
        scope = root if root.tag == "world" else root.first("world") or root
        self._scope(scope, NONE, _saved(scope), 0)
        for tag in _NAMED:
            if scope.first(tag):
                self._left[tag] = None
        self._warn()
        name = printable(self._path.stem)
        base: LineMap | str = "empty"
        if self._segments:
            base = LineMap(name=name, walls=np.concatenate(self._segments))
        return WorldFile(
            name=name,
            map=base,
            robots=tuple(self._robots),
            boxes=tuple(self._boxes),
            walls=tuple(self._walls),
            solids=tuple(self._solids),
            places=homes_of(self._robots),
            source=str(self._path),
        )

    def _warn(self) -> None:
        told = [f"{uri} is not on this computer ({at})" for uri, at in self._files.missing.items()]
        told += [f"{model} stands for {name}, no Pioneer" for name, model in self._others.items()]
        if self._left:
            told.append(f"left out, without a counterpart: {', '.join(self._left)}")
        if told:
            log.warning("%s: %s", self._path, printable("; ".join(told)))

    def _scope(self, scope: SdfElement, place: Float, moved: dict[str, Float], depth: int) -> None:
        """Take all models and includes of a world or model whose frame is at `place`."""
        frames = SdfFrames(scope, moved)
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
        posed = include.first("pose") is not None or names[0] in frames.moved
        if pioneer_of(names):
            found = self._files.find(uri, include) and self._files.model(uri, include)
            self._files.missing.pop(uri, None)  # a robot of ours stands for it
            model = found.first("model") if found else None
            own = pose_of(model) if model and not posed else NONE
            self._robot(model, place @ frames.of(include) @ own, names)
            return
        root = self._files.model(uri, include)
        model = root.first("model") if root else None
        if model is None:
            return
        own = NONE if posed else pose_of(model)
        self._model(model, place @ frames.of(include) @ own, (*names, model.name), depth + 1)

    def _model(self, model: SdfElement, place: Float, names: tuple[str, ...], depth: int) -> None:
        """Take a model whose frame is at `place`: a robot, or what is solid of it."""
        drives = any(
            _DRIVE.search(each.attributes.get("filename", "") + each.name)
            for each in model.all("plugin")
        )
        if drives or (pioneer_of(names) and model.first("joint")):
            self._robot(model, place, names)
            return
        frames = SdfFrames(model, {})
        for link in model.all("link"):
            at = place @ frames.of(link)
            for collision in link.all("collision"):
                geometry = collision.first("geometry")
                for shape in geometry.children if geometry else ():
                    self._shape(shape, at @ pose_of(collision))
        self._scope(model, place, {}, depth + 1)

    def _robot(self, model: SdfElement | None, place: Float, names: tuple[str, ...]) -> None:
        kind = pioneer_of(names)
        if not kind:
            kind = "p3dx-sh"
            self._others[next(filter(None, names), "a robot")] = kind
        laser = ""
        for sensor in descendants(model, ("sensor",)) if model else ():
            horizontal = next(descendants(sensor, ("horizontal",)), None)
            span = next(descendants(sensor, ("range",)), None)
            if sensor.attributes.get("type") in _LASERS and horizontal:
                far = span.numbers("max", 1) if span else ()
                if horizontal.numbers("samples", 1) >= (_LASER_SAMPLES,):
                    laser = laser or laser_of((sensor.name,), far[0] if far else 0.0)
        name = clean_name(next(filter(None, names), ""))
        if name:
            name = free_name(name, self._names)
            self._names.add(name)
        equipment = EquipmentOptions(laser=laser) if laser else NO_OPTIONS
        spec = RobotSpec(model=kind, name=name, start=flat(place), equipment=equipment)
        self._robots.append(spec)

    def _shape(self, shape: SdfElement, place: Float) -> None:
        """Take one collision shape at a pose, a matrix (4, 4)."""
        if self._corners > MOST_CORNERS:
            raise shape.wrong(f"round and tilted solids of more than {MOST_CORNERS} corners")
        if abs(place[:3, 3]).max() > FARTHEST:
            self._left[f"solids farther than {FARTHEST / 1000:g} km"] = None
            return
        match shape.tag:
            case "box":
                size = _told(shape, "size", (1.0, 1.0, 1.0))
                corners = np.array(np.meshgrid(*[(-side / 2, side / 2) for side in size]))
                axis = _upright(place)
                if axis is None:
                    self._outlined(corners.reshape(3, -1).T, place)
                else:
                    self._box(size, place, axis)
            case "cylinder" | "capsule":
                radius, length = (_told(shape, key, (1.0,))[0] for key in ("radius", "length"))
                length += 2 * radius if shape.tag == "capsule" else 0.0
                if _upright(place) == 2:
                    self._column(place[:3, 3], radius, length)
                else:
                    self._outlined(_ring(radius, length), place)
            case "sphere":
                radius = _told(shape, "radius", (1.0,))[0]
                self._ball(place[:3, 3], radius)
            case "mesh":
                self._mesh(shape, place)
            case _:
                self._other(shape, place)

    def _other(self, shape: SdfElement, place: Float) -> None:
        """Take a collision shape of the rarer kinds."""
        match shape.tag:
            case "ellipsoid":
                radii = _told(shape, "radii", (1.0, 1.0, 1.0))
                self._outlined(np.array(_ring(1.0, 2.0)) * radii, place)
            case "polyline":
                points = [point.read("point", point.text, 2) for point in shape.all("point")]
                height = _told(shape, "height", (1.0,))[0]
                self._prism(np.array(points).reshape(-1, 2), height, place)
            case "plane":
                normal = np.array(shape.numbers("normal", 3) or (0.0, 0.0, 1.0))
                if abs((place[:3, :3] @ normal)[2]) < UPRIGHT * np.linalg.norm(normal):
                    self._left["planes that are not level"] = None
            case "empty":
                pass
            case other:
                self._left[other] = None

    def _box(self, size: tuple[float, ...], place: Float, axis: int) -> None:
        """Take a box whose axis of this number is upright."""
        along, across = (each for each in range(3) if each != axis)
        theta = atan2(place[1, along], place[0, along])
        center = place[:3, 3]
        span = self._span(center[2] - size[axis] / 2, center[2] + size[axis] / 2, max(size))
        if span:
            foot, height = span
            sides = (max(size[along], THIN), max(size[across], THIN))
            pose = Pose2(float(center[0]), float(center[1]), theta)
            self._boxes.append(Box(pose=pose, size=sides, height=height, z=foot))

    def _column(self, center: Float, radius: float, height: float) -> None:
        span = self._span(center[2] - height / 2, center[2] + height / 2, radius)
        if span:
            pose = Pose2(float(center[0]), float(center[1]))
            foot, height = span
            if radius > WIDE and foot < SENSOR_HEIGHT:
                sides = ceil(pi / acos(1 - ROUNDING / radius))
                angles = np.arange(sides) * (2 * pi / sides)
                rim = np.column_stack([np.cos(angles), np.sin(angles)]) * radius
                self._wall(rim + center[:2], span)
                return
            radius = min(max(radius, THIN), LARGEST / 2)
            self._solids.append(Cylinder(pose=pose, radius=radius, height=height, z=foot))

    def _ball(self, center: Float, radius: float) -> None:
        """Take a ball as a column, as wide as it is at the height of sensors if it is higher."""
        above = float(center[2]) - SENSOR_HEIGHT
        wide = max(radius**2 - max(above, 0.0) ** 2, 0.0) ** 0.5 if above < radius else radius
        self._column(center, wide, 2 * radius)

    def _prism(self, points: Float, height: float, place: Float) -> None:
        """Take a polygon (P, 2) that is as high as told."""
        if _upright(place) != 2:
            both = [np.column_stack([points, np.full(len(points), z)]) for z in (0.0, height)]
            self._outlined(np.concatenate(both), place)
            return
        corners = _moved(np.column_stack([points, np.zeros(len(points))]), place)
        foot = float(place[2, 3])
        span = self._span(foot, foot + height, 0.0)
        if span and len(corners) > 1:
            self._wall(corners[:, :2], span)

    def _outlined(self, points: Float, place: Float) -> None:
        """Take the convex hull of points (P, 3) as an upright wall, cut at the height of sensors.

        One that is not higher, or a little, is seen from above.
        """
        moved = _moved(np.asarray(points), place)
        low, high = moved[:, 2].min(), moved[:, 2].max()
        span = self._span(float(low), float(high), float(np.ptp(moved[:, :2], axis=0).max()))
        if span:
            if low <= SENSOR_HEIGHT < high - LOW:
                is_above = moved[:, 2] > SENSOR_HEIGHT
                # the cut of a hull is the hull of the cuts of all lines between its points
                start, end = moved[~is_above][:, None], moved[is_above][None]
                share = (SENSOR_HEIGHT - start[..., 2:]) / (end[..., 2:] - start[..., 2:])
                moved = (start + share * (end - start)).reshape(-1, 3)
            self._wall(outer(moved[:, :2]), span)

    def _wall(self, corners: Float, span: tuple[float, float]) -> None:
        foot, height = span
        if foot >= SENSOR_HEIGHT:
            self._left["tilted or angular solids above robots"] = None
            return
        spots = tuple((x, y) for x, y in corners.tolist())
        if len(spots) > 1:
            self._corners += len(spots)
            self._walls.append(Wall(points=spots, closed=len(spots) > 2, height=foot + height))

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
            self._outlined(triangles.reshape(-1, 3).astype(np.float64) * scale, place)
            return
        crossing = triangles[above.any(axis=1) & ~above.all(axis=1)] * scale
        walls = cut(_moved(crossing.reshape(-1, 3), place).reshape(-1, 3, 3), SENSOR_HEIGHT)
        self._count += len(walls)
        if self._count > MOST_WALLS or (len(walls) and abs(walls).max() > 100 * LARGEST):
            raise shape.wrong("has too many walls, or reaches too far")
        self._segments.append(walls)

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
    if not len(crossing):
        return np.empty((0, 4))
    after = np.roll(crossing, -1, axis=1)
    crosses = (crossing[:, :, 2] > height) != (after[:, :, 2] > height)
    start, end = crossing[crosses], after[crosses]
    share = (height - start[:, 2]) / (end[:, 2] - start[:, 2])
    points: Float = start[:, :2] + share[:, None] * (end[:, :2] - start[:, :2])
    return points.reshape(-1, 4)


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


def _ring(radius: float, length: float) -> Float:
    """Return points on both ends of a cylinder about the z axis, (2 * ROUND, 3)."""
    angles = np.arange(ROUND) * (2 * pi / ROUND)
    circle = np.column_stack([radius * np.cos(angles), radius * np.sin(angles)])
    ends = [np.column_stack([circle, np.full(ROUND, z)]) for z in (-length / 2, length / 2)]
    return np.concatenate(ends)


def _moved(points: Float, place: Float) -> Float:
    """Return points (P, 3) of the frame of a pose in that of the world."""
    moved: Float = points @ place[:3, :3].T + place[:3, 3]
    return moved
