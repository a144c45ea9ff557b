"""Heights of the ground, by rays from above, and how things stand on it."""

from math import cos, radians, sin, tan
from typing import Any

import numpy as np

from pioneer3.arrays import Float
from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel, shape_of
from pioneer3.sim.physics.colors import COUNT, THINGS, TOUCHING
from pioneer3.sim.physics.elements import FLOOR, turned
from pioneer3.sim.relief import Relief
from pioneer3.sim.worldfile import Box

ABOVE = 1000.0
"""Rays begin so high [m]; nothing in a world file is as high."""
STEEPEST = radians(30)
"""Steepest stand of a body; a steeper one, as at an edge, is put level above the ground."""


def has_ground(relief: Relief) -> bool:
    """Whether the floor has other heights than 0 somewhere."""
    return any(solid.is_ground for solid in relief.solids.values())


class Ground:
    """The ground of a compiled world.

    The places of what stands still are computed in `data`.
    """

    def __init__(self, model: Any, data: Any) -> None:
        import mujoco

        self._mujoco: Any = mujoco
        self._model, self._data = model, data
        self._groups = np.zeros(COUNT, dtype=np.uint8)
        self._groups[THINGS] = 1
        self._is_ground = (model.geom_contype == FLOOR) & (model.geom_conaffinity == 0)
        mujoco.mj_kinematics(model, data)

    def height(self, x: float, y: float) -> float:
        """Return the height of the ground at a place of the map [m]."""
        origin, down = np.array([x, y, ABOVE]), np.array([0.0, 0.0, -1.0])
        geom, groups = np.empty(1, dtype=np.int32), self._model.geom_group.copy()
        self._model.geom_group[:] = np.where(self._is_ground, THINGS, TOUCHING)
        away = self._mujoco.mj_ray(
            self._model, self._data, origin, down, self._groups, True, -1, geom
        )
        self._model.geom_group[:] = groups
        return ABOVE - float(away) if away >= 0 else 0.0

    def standing(self, pose: Pose2, feet: Float) -> tuple[float, list[float]]:
        """Return height of the origin [m] and quaternion w, x, y, z of a thing on the ground.

        `pose` is that on the plane [m, rad]; its `feet` (F, 2), in its own frame [m], are not all
        on one line.
        """
        c, s = cos(pose.theta), sin(pose.theta)
        x, y = feet[:, 0], feet[:, 1]
        places = zip(pose.x + c * x - s * y, pose.y + s * x + c * y, strict=True)
        heights = np.array([self.height(*place) for place in places])
        level = turned(pose.theta)
        highest = float(heights.max())
        if highest == heights.min():
            return highest, level
        columns = np.column_stack([x, y, np.ones(len(feet))])
        (along, across, middle), *_ = np.linalg.lstsq(columns, heights, rcond=None)
        if np.hypot(along, across) > tan(STEEPEST):
            return highest, level
        lift = float((heights - columns @ (along, across, middle)).max())
        return float(middle) + max(lift, 0.0), self._tilted(pose.theta, along, across)

    def _tilted(self, theta: float, along: float, across: float) -> list[float]:
        """Return the orientation on a slope whose x axis points to `theta` from above."""
        c, s = cos(theta), sin(theta)
        ahead = np.array([c, s, along])
        up = np.cross(ahead, [-s, c, across])
        ahead, up = ahead / np.linalg.norm(ahead), up / np.linalg.norm(up)
        tilted = np.empty(4)
        axes = np.column_stack([ahead, np.cross(up, ahead), up])
        self._mujoco.mju_mat2Quat(tilted, axes.ravel())
        return tilted.tolist()


def feet_of(model: RobotModel) -> Float:
    """Return where a robot touches the floor, in its frame [m], shape (F, 2)."""
    shape = shape_of(model)
    feet = [(x, side * shape.track / 2) for x in shape.axles for side in (1, -1)]
    if shape.caster is not None:
        feet.append((shape.caster - shape.caster_trail, 0.0))
    return np.array(feet)


def feet_of_box(box: Box) -> Float:
    """Return the corners of a box, in its frame [m], shape (4, 2)."""
    x, y = box.size[0] / 2, box.size[1] / 2
    return np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
