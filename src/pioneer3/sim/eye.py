"""What a camera on a robot sees of the people, boxes and robots around it, as blobs of colour.

A pinhole without lens errors or noise. Walls hide what is behind them, whatever their height, and
so does whatever is nearer.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf, pi, tan
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pioneer3.geometry import Pose2
from pioneer3.sim.body import Body
from pioneer3.sim.obstacles import Obstacle
from pioneer3.sim.population.footprint import outline
from pioneer3.sim.raycast import cast_reference
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box

Float = NDArray[np.float64]
Kind = Literal["person", "box", "robot"]

HEIGHTS: dict[Kind, float] = {"person": 1.7, "box": 0.5, "robot": 0.3}
"""Of what is seen [m]."""
FARTHEST = 12.0
"""Nothing is seen beyond [m]."""
NEAREST = 0.05
LEAST_AREA = 10
"""Smaller blobs are not seen [pixels]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Eye:
    """The camera.

    Attributes:
        width: Of the picture [pixels]; ACTS takes pictures of 160 by 120 unless told otherwise.
        height: [pixels].
        view: Angle from the left edge to the right [rad].
        above_ground: [m].
    """

    width: int = 160
    height: int = 120
    view: float = 48 * pi / 180
    above_ground: float = 0.4

    @property
    def focal_length(self) -> float:
        """Between pinhole and picture [pixels]."""
        return self.width / 2 / tan(self.view / 2)


@dataclass(frozen=True, slots=True, kw_only=True)
class Patch:
    """What is seen of one thing, in [pixels] from the upper left corner; edges belong to it."""

    kind: Kind
    area: int
    x: int
    y: int
    left: int
    right: int
    top: int
    bottom: int


def look(world: World, body: Body, eye: Eye, pan: float = 0.0, tilt: float = 0.0) -> list[Patch]:
    """Return what `body` sees of each thing.

    Args:
        world: Where it is.
        body: Who looks; the eye is above its front.
        eye: The camera.
        pan: Where the camera looks, to the left of straight ahead [rad].
        tilt: And up [rad].
    """
    at = body.robot_in_world @ Pose2(body.model.length_front, 0.0, pan)
    columns = np.arange(eye.width)
    aside = np.arctan2(eye.width / 2 - 0.5 - columns, eye.focal_length)
    origin = np.array([at.x, at.y])
    near = _near(world.map.walls, origin)
    things = [(kind, sides) for kind, sides in _things(world, body) if len(_near(sides, origin))]
    ranges = [cast_reference(origin, at.theta + aside, s, inf) for _, s in things]
    walls = cast_reference(origin, at.theta + aside, near, FARTHEST)
    nearest = np.min([walls, *ranges], axis=0) if ranges else walls
    patches = (
        _patch(kind, np.where(own <= nearest, own, inf) * np.cos(aside), eye, tilt)
        for (kind, _), own in zip(things, ranges, strict=True)
    )
    return [patch for patch in patches if patch is not None]


def _things(world: World, body: Body) -> Iterator[tuple[Kind, Float]]:
    """Yield the kind and the sides of everything but `body` and the walls."""
    for obstacle in world.obstacles:
        yield ("box" if isinstance(obstacle.kind, Box) else "person"), _sides(obstacle)
    for other in world.robots:
        if other is not body:
            yield "robot", outline(other.model, other.robot_in_world)


def _sides(obstacle: Obstacle) -> Float:
    kind, pose = obstacle.kind, obstacle.pose
    if isinstance(kind, Box):
        return replace(kind, pose=pose).outline
    return replace(kind, path=((pose.x, pose.y),)).outline_at(0.0)


def _near(segments: Float, origin: Float) -> Float:
    """Return those of `segments` (S, 4) that may come within sight of `origin`."""
    ends = segments.reshape(-1, 2, 2) - origin
    lows, highs = ends.min(axis=1), ends.max(axis=1)
    near: Float = segments[((lows <= FARTHEST) & (highs >= -FARTHEST)).all(axis=1)]
    return near


def _patch(kind: Kind, depths: Float, eye: Eye, tilt: float) -> Patch | None:
    """Return what is seen of a thing whose depth in each column is `depths` [m], `inf` for none."""
    columns = np.flatnonzero(depths < FARTHEST)
    if not len(columns):
        return None
    depth = np.maximum(depths[columns], NEAREST)
    horizon = eye.height / 2 + eye.focal_length * tan(tilt)
    scale = eye.focal_length / depth
    tops = np.floor(horizon - scale * (HEIGHTS[kind] - eye.above_ground)).clip(0, eye.height)
    bottoms = np.ceil(horizon + scale * eye.above_ground).clip(0, eye.height)
    rows = bottoms - tops
    area = rows.sum()
    if area < LEAST_AREA:
        return None
    seen = columns[rows > 0]
    return Patch(
        kind=kind,
        area=int(area),
        x=round(float((columns * rows).sum() / area)),
        y=round(float(((tops + bottoms - 1) / 2 * rows).sum() / area)),
        left=int(seen[0]),
        right=int(seen[-1]),
        top=int(tops[rows > 0].min()),
        bottom=int(bottoms[rows > 0].max()) - 1,
    )
