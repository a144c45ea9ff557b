"""Rays among the geoms of a scene, and all that they need to know of robots and things."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from pioneer3.arrays import Bool, Float, Int
from pioneer3.maps.materials import GLASS, GLASS_ANGLE
from pioneer3.sim.physics.colors import COUNT, THINGS
from pioneer3.sim.physics.scene import Scene

LEVEL = float(np.cos(np.radians(0.5)))
"""Cosine of the tilt up to which a robot is level: at 8 m its beams are within 7 cm of level."""
THROUGH = 1e-4
"""A beam goes on so far behind the surface of glass that it has gone through [m]."""
MOST_SURFACES = 8
"""Most panes of glass that a beam goes through."""


class Hits(NamedTuple):
    """The first thing that each of R rays meets.

    Shapes are (R,): `ranges` [m], infinite where there is nothing; the numbers of `geoms`, -1 for
    nothing; `facing`, the cosine of the angle between the ray and the normal of the surface.
    """

    ranges: Float
    geoms: Int
    facing: Float


@dataclass(frozen=True, slots=True, eq=False)
class ScenePoses:
    """Where the N robots and T things of a scene are at one instant.

    `at` are the origins of the robots (N, 3) [m], `turned` their rotations (N, 3, 3), and `level`
    says which of them stand level (N,). Circles around all robots, things and people, the robots
    first, have `middles` (T, 2) and `radii` (T,) [m].
    """

    at: Float
    turned: Float
    level: Bool
    middles: Float
    radii: Float

    def near(self, number: int, reach: float) -> bool:
        """Whether anything but robot `number` itself is within `reach` [m] of it."""
        away = np.hypot(*(self.middles - self.at[number, :2]).T) - self.radii
        away[number] = np.inf
        return bool((away < reach).any())


def places_of(scene: Scene, outlines: Float, people: Float) -> ScenePoses:
    """Return the places in a scene whose kinematics are up to date.

    `outlines` are middle and radius of the circle around each robot [m], shape (N, 3); `people` the
    same of each person, shape (P, 3).
    """
    model, data = scene.model, scene.data
    at, turned = data.xpos[scene.bodies], data.xmat[scene.bodies].reshape(-1, 3, 3)
    solid = (scene.groups == THINGS) & (scene.robot < 0) & (model.geom_rbound > 0)
    things = np.column_stack([data.geom_xpos[solid, :2], model.geom_rbound[solid]])
    circles = np.concatenate([outlines, things, people])
    return ScenePoses(at, turned, turned[:, 2, 2] >= LEVEL, circles[:, :2], circles[:, 2])


def cast(
    scene: Scene, origin: Float, ways: Float, limit: float, *, groups: Sequence[int], but: int
) -> Hits:
    """Return the first hits of rays from one point.

    `origin` is that of all rays [m], shape (3,), and `ways` are unit vectors, shape (R, 3). They
    meet the geoms of `groups` within `limit` [m], but none of the body `but`. The kinematics of
    `scene` are up to date.
    """
    import mujoco

    count = len(ways)
    geoms, ranges = np.empty(count, dtype=np.int32), np.empty(count)
    normals, mask = np.zeros(3 * count), np.zeros(COUNT, dtype=np.uint8)
    mask[list(groups)] = 1
    mujoco.mj_multiRay(
        scene.model, scene.data, origin, ways.ravel(), mask, True, but, geoms, ranges, normals,
        count, limit,
    )  # fmt: skip
    met = (geoms >= 0) & (ranges <= limit)
    facing = abs((ways * normals.reshape(-1, 3)).sum(axis=1))
    return Hits(np.where(met, ranges, np.inf), np.where(met, geoms, -1), facing)


def cast_light(
    scene: Scene, origin: Float, ways: Float, limit: float, *, groups: Sequence[int], but: int
) -> Hits:
    """Return the first hits of light, which goes through glass that it does not meet in front.

    Arguments are those of :func:`cast`.
    """
    hits = cast(scene, origin, ways, limit, groups=groups, but=but)
    if not scene.has_glass:
        return hits
    for ray in range(len(ways)):
        for _ in range(MOST_SURFACES):
            geom, range_ = hits.geoms[ray], hits.ranges[ray] + THROUGH
            is_glass = geom >= 0 and scene.codes[geom] == GLASS
            if not is_glass or hits.facing[ray] >= np.cos(GLASS_ANGLE):
                break
            way = ways[ray : ray + 1]
            behind = cast(
                scene, origin + range_ * way[0], way, limit - range_, groups=groups, but=but
            )
            hits.ranges[ray] = behind.ranges[0] + range_
            hits.geoms[ray], hits.facing[ray] = behind.geoms[0], behind.facing[0]
    return hits


def refresh(scene: Scene) -> None:
    """Bring the places of geoms up to date with the state."""
    import mujoco

    mujoco.mj_kinematics(scene.model, scene.data)
