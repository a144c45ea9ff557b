"""What a robot observes, as numbers from -1 to 1; and what it can do."""

from math import pi

import numpy as np
from gymnasium.spaces import Box, Space
from numpy.typing import NDArray

from pioneer3.errors import ConfigError
from pioneer3.gym.task import Task
from pioneer3.models import RobotModel
from pioneer3.sim.kernels import laser_fan
from pioneer3.sim.kernels.drives import TOP, VELOCITY
from pioneer3.sim.sensors import SONAR_RANGE
from pioneer3.sim.world import World

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]

GOAL_RANGE = 10.0
"""Goals farther away than this seem to be this far [m]."""
OTHERS = 5
"""Numbers that are no ranges: goal distance, cosine and sine of its bearing, speed, turn rate."""


class Senses:
    """The sensors of all robots of a task, and the spaces that go with them.

    Attributes:
        sonars: Of each robot; 0 if they do not count.
        beams: The same of the laser.

    Raises:
        ConfigError: The model does not have a sensor that the task asks for.
    """

    def __init__(self, task: Task, model: RobotModel) -> None:
        if task.sensors != "laser" and not model.sonars:
            raise ConfigError(f"model {model.name}: has no sonars; take another one, or a laser")
        if task.sensors != "sonar" and model.laser is None:
            raise ConfigError(f"model {model.name}: has no laser; take another one, or sonars")
        self.sonars = len(model.sonars) if task.sensors != "laser" else 0
        self.beams, self._range = 0, task.laser_range
        if model.laser and task.sensors != "sonar":
            self.beams, mount = task.beams, model.laser
            self._fan = laser_fan(
                (mount.x, mount.y, mount.theta), -pi / 2, pi / (task.beams - 1), task.beams
            )

    def observation_space(self) -> Space[Float32]:
        """Return a new space for what one robot observes, shape (D,)."""
        low = [0.0] * (self.sonars + self.beams + 1) + [-1.0] * (OTHERS - 1)
        return Box(np.array(low, dtype=np.float32), np.float32(1.0), dtype=np.float32)

    def action_space(self) -> Space[Float32]:
        """Return a new space for what one robot can do: speed and turn rate, shape (2,)."""
        return Box(-1.0, 1.0, (2,), dtype=np.float32)

    def observe(self, world: World, ahead: Float) -> Float32:
        """Return what all robots observe, shape (N, D).

        Args:
            world: Where they are.
            ahead: The way from each to its goal, in the frame of the world [m], shape (N, 2).
        """
        ranges = []
        if self.sonars:
            ranges.append(world.sonars() / SONAR_RANGE)
        if self.beams:
            ranges.append(world.lasers(self._fan, self._range) / self._range)
        away, theta = np.hypot(*ahead.T), world.outlines.theta
        c, s = np.cos(theta), np.sin(theta)
        x, y = ahead.T / np.maximum(away, 1e-9)
        distance = np.minimum(away / GOAL_RANGE, 1.0)
        v, w = world.drives.axes[VELOCITY] / world.drives.axes[TOP]
        others = np.stack([distance, c * x + s * y, c * y - s * x, v, w], axis=1)
        return np.concatenate([*ranges, others], axis=1).astype(np.float32)
