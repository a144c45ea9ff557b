"""Reads worlds of Stage: their models become walls and boxes, their position models robots.

As in Stage the black pixels of a bitmap, or the blocks of a model, are scaled so that they fill the
size of the model: a white margin of a picture counts for nothing. Poses are those in the parent.
"""

import re
from collections import defaultdict
from math import radians
from pathlib import Path

import numpy as np

from pioneer3.arrays import Float
from pioneer3.errors import ConfigError
from pioneer3.geometry import ORIGIN, Pose2, wrap
from pioneer3.maps.grid import MOST_WALLS, raster_outline
from pioneer3.maps.image import read_image
from pioneer3.sim.relief import WALL_HEIGHT
from pioneer3.sim.relief.shapes import placed, rectangle
from pioneer3.sim.relief.solids import SENSOR_HEIGHT
from pioneer3.sim.worldfile.spec import Box, WorldFile
from pioneer3.sim.worldfile.stage_text import StageEntity, StageText
from pioneer3.sim.worldfile.stand_ins import (
    LASER_SAMPLES,
    TALLEST,
    THIN,
    FoundWorld,
    laser_of,
    pioneer_of,
    robot_of_size,
)
from pioneer3.text import shown, wrong

DARK = 127
"""Pixels whose red is no more are walls, as in Stage."""
SMALLEST = 0.1
"""Size of a model of which nothing is said [m]."""
_SCENERY = ("model", "floorplan")
_SILENT = ("window", "block", "polygon", "sensor", "ranger", "laser", "sonar")
"""Entities that have no counterpart and need none, or are read with their parents."""
_POINT = re.compile(r"(?:(?:block|polygon)s?\[(\d+)\]\.)?point\[(\d+)\]")
_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001}


def read_stage(path: Path) -> WorldFile:
    """Read a world of Stage, with its includes and pictures.

    A warning names once all that has no counterpart here.

    Raises:
        ConfigError: It cannot be read, or is wrong; names file and line.
    """
    return _StageReader(StageText(path)).world()


class _StageReader:
    """Collects the walls, boxes and robots of a world."""

    def __init__(self, text: StageText) -> None:
        self._text = text
        world = text.world
        self._meter = _UNITS.get(world.text("unit_length"), 1.0)
        self._is_radians = world.text("unit_angle") == "radians"
        self._found = FoundWorld()
        self._left = self._found.left
        self._heights: list[float] = []
        self._gone: ConfigError | None = None
        self._count = 0
        self._pictures: dict[Path, Float] = {}

    def world(self) -> WorldFile:
        """Return the world, and warn of all that is not in it."""
        for entity in self._text.world.children:
            self._read(entity, ORIGIN, 0.0)
        if self._gone and not self._found:
            raise self._gone
        highest = max(self._heights, default=WALL_HEIGHT)
        return self._found.file(self._text.path, self._text.missing, highest)

    def _read(self, entity: StageEntity, parent: Pose2, foot: float) -> None:
        """Add the walls, boxes or robots of an entity, and of the models in it."""
        whole = self._text.resolved(entity)
        kind = whole.kinds[-1]
        if kind == "position" or (kind not in _SCENERY and pioneer_of((kind,))):
            self._robot(whole, parent)
        elif kind in _SCENERY:
            pose, z = self._pose(whole)
            self._scenery(whole, parent @ pose, foot + z)
            size = self._size(whole)
            stacked = size[2] if len(size) > 2 and whole.number("stack_children", 1) else 0.0
            for child in whole.children:
                self._read(child, parent @ pose, foot + z + stacked)
        elif kind not in _SILENT:
            self._left[kind] = None

    def _scenery(self, model: StageEntity, pose: Pose2, foot: float) -> None:
        """Take the shape of a model that is no robot."""
        seen = model.number("ranger_return", 1) >= 0 and model.number("laser_return", 1) > 0
        if not seen and not model.number("obstacle_return", 1):
            self._left[f"{model.kinds[0]} that nothing meets"] = None
            return
        size, place = self._size(model), pose @ self._pose(model, "origin")[0]
        height = min(size[2], TALLEST) if len(size) > 2 and size[2] > 0 else None
        blocks = self._blocks(model)
        if model.text("bitmap"):
            if not self._bitmap(model, place, size, height):
                return
        elif blocks and not self._is_movable(model):
            self._polygons(blocks, place, size, height, foot)
        elif not model.number("noblocks", 0) or blocks:
            self._found.boxes.append(
                Box(
                    pose=place,
                    size=(max(size[0], THIN), max(size[1], THIN)),
                    movable=self._is_movable(model),
                    name=self._found.name(model.text("name")),
                    height=height,
                    z=min(max(foot, 0.0), TALLEST),
                )
            )
        if model.number("boundary", 0):
            self._found.segments.append(rectangle(place, (size[0], size[1])))

    def _bitmap(
        self, model: StageEntity, place: Pose2, size: tuple[float, ...], height: float | None
    ) -> bool:
        """Take the outlines of the dark pixels of a picture, scaled to the size of its model.

        Return whether the picture is there.
        """
        told = model.properties["bitmap"]
        picture = self._text.find(model.text("bitmap"), told.line)
        if picture is None:
            seen = "seen from the world's folder; put the picture there, or mend the path"
            self._gone = told.wrong(f"no such file: {shown(model.text('bitmap'))}, {seen}")
            self._left[f"the picture {model.text('bitmap')}, which is not there"] = None
            return False
        if Path(model.text("bitmap")).is_absolute() and Path(model.text("bitmap")) != picture:
            taken = f"{model.text('bitmap')} is not there, {picture} is taken"
            self._text.missing.append(f"{told.line.number}: {taken}")
        if picture not in self._pictures:
            self._pictures[picture] = _edges(picture)
        edges = self._pictures[picture]
        self._count += len(edges)
        if self._count > MOST_WALLS:
            raise told.wrong(
                f"with it the world has more than {MOST_WALLS / 1e6:.0f} million walls"
            )
        points = _fitted(edges.reshape(-1, 2), size)
        self._found.segments.append(placed(points, place).reshape(-1, 4))
        if height is not None:
            self._heights.append(height)
        return True

    def _polygons(
        self,
        blocks: list[tuple[Float, float]],
        place: Pose2,
        size: tuple[float, ...],
        height: float | None,
        foot: float,
    ) -> None:
        """Take the blocks of a model as closed walls, those that robots pass below left out."""
        points = placed(_fitted(np.concatenate([block for block, _ in blocks]), size), place)
        ends = np.cumsum([len(block) for block, _ in blocks])[:-1]
        for corners, (_, low) in zip(np.split(points, ends), blocks, strict=True):
            if foot + low >= SENSOR_HEIGHT:
                self._left["blocks above robots"] = None
                continue
            self._found.add_wall(corners, height)

    def _blocks(self, model: StageEntity) -> list[tuple[Float, float]]:
        """Return the corners (P, 2) of the blocks of a model, and the height of their feet."""
        found = []
        for entity in [model, *map(self._text.resolved, model.children)]:
            if entity is not model and entity.kinds[-1] not in ("block", "polygon"):
                continue
            corners: dict[int, dict[int, tuple[float, ...]]] = defaultdict(dict)
            for key, told in entity.properties.items():
                if match := _POINT.fullmatch(key):
                    if len(point := told.numbers()) != 2:
                        raise told.wrong("expected two numbers, as in [0.5 -0.5]")
                    corners[int(match[1] or 0)][int(match[2])] = point
            low = next(iter(entity.numbers("z")), 0.0) * self._meter
            for block in corners.values():
                if len(block) > 1:
                    ordered = np.array([block[number] for number in sorted(block)])
                    found.append((ordered * self._meter, low))
        return found

    def _robot(self, robot: StageEntity, parent: Pose2) -> None:
        """Take a position model, with the laser on it."""
        length, width, *_ = self._size(robot)
        self._found.add_robot(
            robot.kinds,
            robot.text("name"),
            parent @ self._pose(robot)[0],
            laser=self._laser(robot, 0),
            usual=robot_of_size(length, width),
        )

    def _laser(self, entity: StageEntity, depth: int) -> str:
        """Return the first laser on a robot, empty for none; name other devices on it."""
        found = ""
        for child in map(self._text.resolved, entity.children):
            kind = child.kinds[-1]
            sensors = [self._text.resolved(each) for each in child.children]
            if kind in ("ranger", "laser") or (kind not in _SILENT and "laser" in kind):
                ranges = [child, *sensors]
                samples = max(each.number("samples", 1) for each in ranges)
                far = [
                    each.numbers("range")[-1:] or (each.number("range_max", 0),) for each in ranges
                ]
                if kind != "ranger" or samples >= LASER_SAMPLES:
                    found = found or laser_of(child.kinds, max(far)[0] * self._meter)
            elif kind in ("model", "position") and depth < 3:
                found = found or self._laser(child, depth + 1)
            elif kind not in (*_SILENT, "model", "position"):
                self._left[kind] = None
        if "ctrl" in entity.properties:
            self._left["ctrl"] = None
        return found

    def _pose(self, entity: StageEntity, key: str = "pose") -> tuple[Pose2, float]:
        """Return a pose and its height [m]; three numbers are x, y and heading, as in Stage 2.

        As in Stage all after the fourth count for nothing.
        """
        numbers = entity.numbers(key)[:4]
        if len(numbers) == 1:
            raise entity.properties[key].wrong("expected 4 numbers: x y z heading")
        x, y, *rest = numbers or (0.0, 0.0)
        turn = rest[-1] if rest else 0.0
        z = rest[0] * self._meter if len(rest) == 2 else 0.0
        theta = wrap(turn if self._is_radians else radians(turn))
        return Pose2(x * self._meter, y * self._meter, theta), z

    def _size(self, entity: StageEntity) -> tuple[float, ...]:
        """Return length and width, and the height if it is told [m]."""
        numbers = entity.numbers("size")[:3]
        if len(numbers) == 1:
            raise entity.properties["size"].wrong("expected 3 numbers: x y z")
        return tuple(abs(side) * self._meter for side in numbers or (SMALLEST, SMALLEST))

    def _is_movable(self, model: StageEntity) -> bool:
        return bool(model.number("gripper_return", 0)) and not model.text("bitmap")


def _edges(picture: Path) -> Float:
    """Return the outlines of the dark pixels of a picture [pixels], shape (E, 4)."""
    try:
        edges = raster_outline(read_image(picture, reds=True).shades[::-1] <= DARK)
    except OverflowError as error:
        raise wrong(picture, f" pixels: {error}") from None
    if not len(edges):
        raise wrong(picture, " pixels: none is dark, so there is no wall")
    return edges


def _fitted(points: Float, size: tuple[float, ...]) -> Float:
    """Return points (P, 2) moved and scaled so that they fill a size around the origin."""
    low, high = points.min(axis=0), points.max(axis=0)
    extent = np.maximum(high - low, np.finfo(np.float64).eps)
    fitted: Float = (points - (low + high) / 2) * (np.array(size[:2]) / extent)
    return fitted
