"""The people, boxes and robots around a robot, as its camera sees them: blobs of colour.

A pinhole without lens errors or noise. Walls, whatever their height, and nearer things hide all
behind them.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, pi, tan
from typing import Literal

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.sim.body import Body
from pioneer3.sim.collision import outline
from pioneer3.sim.raycast import cast_reference
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Box

Kind = Literal["person", "box", "robot"]

HEIGHTS: dict[Kind, float] = {"person": 1.7, "box": 0.5, "robot": 0.3}
"""Heights of each kind of thing [m]."""
FARTHEST = 12.0
"""Nothing is seen beyond [m]."""
NEAREST = 0.05
LEAST_AREA = 10
"""Smaller blobs are not seen [pixels]."""
BEAMS = 481
"""Looked along, a tenth of a degree apart; a column is three times as wide."""
SLACK = 0.1
"""The world's own outlines of people and robots have other corners than these [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Eye:
    """The camera, so many metres above ground; its view is from the left edge to the right [rad].

    ACTS takes pictures of 160 by 120 pixels unless told otherwise.
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
    """The visible part of a thing, in [pixels] from the upper left corner; edges belong to it."""

    kind: Kind
    area: int
    x: int
    y: int
    left: int
    right: int
    top: int
    bottom: int


def look(world: World, body: Body, eye: Eye, pan: float = 0.0, tilt: float = 0.0) -> list[Patch]:
    """Return the visible part of each thing around `body`.

    The eye is above the front of the robot; `pan` is to the left of straight ahead, `tilt` up
    [rad].
    """
    mount = Pose2(body.model.length_front, 0.0, pan)
    at = body.robot_in_world @ mount
    things = [(kind, sides) for kind, sides in _things(world, body) if _within_reach(sides, at)]
    if not things:
        return []
    angles = np.linspace(-eye.view / 2, eye.view / 2, BEAMS)
    first = world.sight(body, mount, -eye.view / 2, eye.view / (BEAMS - 1), BEAMS)
    origin = np.array([at.x, at.y])
    ranges = np.array([cast_reference(origin, at.theta + angles, s, inf) for _, s in things])
    seen = (ranges == ranges.min(axis=0)) & (ranges <= first + SLACK)
    # columns are equally far apart in the picture, beams are in angle
    aside = np.arctan2(eye.width / 2 - 0.5 - np.arange(eye.width), eye.focal_length)
    beams = np.rint((aside + eye.view / 2) * (BEAMS - 1) / eye.view).astype(int)
    depths = np.where(seen, ranges, inf)[:, beams] * np.cos(aside)
    patches = (_patch(kind, own, eye, tilt) for (kind, _), own in zip(things, depths, strict=True))
    return [patch for patch in patches if patch is not None]


def _things(world: World, body: Body) -> Iterator[tuple[Kind, Float]]:
    """Yield the kind and the sides of everything but `body` and the walls."""
    for obstacle in world.obstacles:
        kind: Kind = "box" if isinstance(obstacle.kind, Box) else "person"
        yield kind, obstacle.outline_at(obstacle.pose)
    for other in world.robots:
        if other is not body:
            yield "robot", outline(other.model, other.robot_in_world)


def _within_reach(sides: Float, at: Pose2) -> bool:
    """Whether a thing with `sides` (S, 4) may be near enough to be seen from `at`."""
    ends = sides.reshape(-1, 2) - (at.x, at.y)
    return bool((np.hypot(ends[:, 0], ends[:, 1]) < FARTHEST).any())


def _patch(kind: Kind, depths: Float, eye: Eye, tilt: float) -> Patch | None:
    """Return the visible part of a thing with `depths` [m] in the columns, `inf` for none."""
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
