"""A robot in MuJoCo that drives as the firmware makes it: speeds change by its accelerations."""

from dataclasses import dataclass, field
from math import atan2, radians
from typing import Any

import numpy as np
import pytest

from pioneer3.models import RobotModel, physics_of, shape_of
from pioneer3.models.description.mjcf import SIDES
from pioneer3.models.description.tree import wheel_joint_names

mujoco: Any = pytest.importorskip("mujoco")

ACCELERATION, TURN_ACCELERATION = 0.3, radians(100)


@dataclass
class Drive:
    """A robot on a floor, which has come to rest."""

    model: RobotModel
    compiled: Any
    speed: float = 0.0
    rate: float = 0.0
    contacts: list[int] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Let it settle."""
        self.data = mujoco.MjData(self.compiled)
        mujoco.mj_step(self.compiled, self.data, 500)
        self._wheels = [self.compiled.joint(name) for name in wheel_joint_names(self.model)]

    def drive(self, speed: float, rate: float, seconds: float) -> None:
        """Drive at a speed [m/s] and a turn rate [rad/s]."""
        step = self.compiled.opt.timestep
        radius = physics_of(self.model).rolling_radius
        half = shape_of(self.model).effective_track / 2
        for _ in range(round(seconds / step)):
            self.speed += np.clip(speed - self.speed, -ACCELERATION * step, ACCELERATION * step)
            most = TURN_ACCELERATION * step
            self.rate += np.clip(rate - self.rate, -most, most)
            for side, sign in zip(SIDES, (-1, 1), strict=True):
                target = (self.speed + sign * self.rate * half) / radius
                self.data.actuator(side).ctrl[0] = target
            mujoco.mj_step(self.compiled, self.data)
            self.contacts.append(self.data.ncon)

    @property
    def place(self) -> tuple[float, float, float]:
        """Where it is [m], and its heading [rad]."""
        x, y, _, w, i, j, k = self.data.joint("base").qpos
        return x, y, atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k))

    @property
    def turned(self) -> tuple[float, float]:
        """Angles of the front wheels, left and right [rad]."""
        left, right = (float(self.data.qpos[wheel.qposadr[0]]) for wheel in self._wheels[:2])
        return left, right
