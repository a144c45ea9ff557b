"""The simulation that all environments share: robots on their way to goals, as arrays."""

import logging
from copy import deepcopy
from math import ceil, pi
from typing import Any, NamedTuple

import numpy as np
from gymnasium.spaces import Box, Space
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.arrays import Bool, Float, Float32, Int
from pioneer3.distribution import how_to_get
from pioneer3.errors import CommandError, ConfigError
from pioneer3.gym.maps import Distance, FreeSpace, Point, TiledMap
from pioneer3.gym.task import Task
from pioneer3.maps import LineMap
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.body import Body
from pioneer3.sim.collision import turning_circle
from pioneer3.sim.dynamics import dynamics_of
from pioneer3.sim.kernels import (
    CACHE,
    WORTH_COMPILING,
    Kernels,
    compiled_kernels,
    laser_fan,
)
from pioneer3.sim.kernels.drives import LONGEST, STALLED, TOP, VELOCITY
from pioneer3.sim.realism import Realism
from pioneer3.sim.sensors import SONAR_RANGE
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import load_map

Infos = dict[str, NDArray[Any]]

APART = 0.1
"""Between the turning circles of robots that start, or arrive, beside each other [m]."""

GOAL_RANGE = 10.0
"""Goals farther away than this seem to be this far [m]."""
OTHERS = 5
"""Numbers that are no ranges: goal distance, cosine and sine of its bearing, speed, turn rate."""
COMPILING = "compiling the simulator, once on this machine: it takes some 20 seconds"

log = logging.getLogger(__name__)


class StepResult(NamedTuple):
    """Rewards and ends of a step, for each of N robots; shapes (N,)."""

    reward: Float
    arrived: Bool
    collided: Bool


class Observations:
    """Observations of all robots of a task, and the spaces of these and of actions.

    The numbers of each robot's `sonars` and `beams` of its laser are 0 if these are not observed.

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
        """Return a new space for the observation of one robot, shape (D,)."""
        low = [0.0] * (self.sonars + self.beams + 1) + [-1.0] * (OTHERS - 1)
        return Box(np.array(low, dtype=np.float32), np.float32(1.0), dtype=np.float32)

    def action_space(self) -> Space[Float32]:
        """Return a new space for the action of one robot: speed and turn rate, shape (2,)."""
        return Box(-1.0, 1.0, (2,), dtype=np.float32)

    def observe(self, world: World, ahead: Float) -> Float32:
        """Return the observations of all robots of `world`, shape (N, D).

        `ahead` is the vector from each to its goal, in the frame of the world [m], shape (N, 2).
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


class GoalSimulation:
    """Robots with goals in copies of a map; robots of one copy do not see the other copies.

    Robots are numbered copy by copy: those of copy c are c * robots and the following ones.

    Attributes:
        task: The task of every robot.
        robots: Robots in each copy; these see each other, and are in each other's way.
        count: Robots in all.
        world: The robots among walls. Its frame is not that of the map, see :class:`TiledMap`.
        observations: Computes observations, and has the spaces.
        goals: In the frame of the map [m], shape (N, 2).

    Raises:
        ConfigError: The task cannot be done: no such map or model, no room, no such sensor.
    """

    def __init__(self, task: Task, copies: int = 1, robots: int = 1) -> None:
        if min(copies, robots) < 1:
            raise ConfigError(f"{copies} copies with {robots} robots each: both must be positive")
        self.task, self.robots, self.count = task, robots, copies * robots
        self._model = task.model if isinstance(task.model, RobotModel) else load_model(task.model)
        line_map = task.map if isinstance(task.map, LineMap) else load_map(task.map)
        self.observations = Observations(task, self._model)
        self.maps = TiledMap(line_map, copies)
        self._radius = turning_circle(self._model)
        self._free = FreeSpace(line_map, self.maps.walls, self._radius)
        _compile_once()
        self._kernels = Kernels(task.threads)
        if self.count >= WORTH_COMPILING and not self._kernels.compiled:
            log.warning("without numba this simulation is slow: %s", how_to_get("fast"))
        self._offsets = np.repeat(self.maps.offsets, robots, axis=0)
        self.goals = np.zeros((self.count, 2))
        self._goal_distances = np.zeros(self.count)
        self.rebuild(None)

    def rebuild(self, seed: int | None) -> None:
        """Make a new world, whose noise depends on `seed` alone; :meth:`reset` comes next."""
        bodies = [Body(self._model) for _ in range(self.count)]
        for body in bodies:
            body.firing = body.firing if self.observations.sonars else ()
        self.world = World(
            self.maps.line_map,
            bodies,
            self._kernels,
            seed=seed,
            realism=self.task.realism,
            dynamics=dynamics_of(self.task.physics),
        )
        for body in self.world.robots:
            body.enable_motors(on=True)
        self._at_rest = deepcopy(self.world.drives)
        self._top = self._at_rest.axes[TOP]

    def __setstate__(self, attributes: dict[str, Any]) -> None:
        """Take the attributes of another one; Ray lends arrays that nobody may write to."""
        self.__dict__.update(deepcopy(attributes))
        _compile_once()

    @property
    def noisy(self) -> bool:
        """Whether anything in the world is random."""
        return self.task.realism not in {None, Realism.ideal()}

    @property
    def poses(self) -> Float:
        """Poses of the robots in the frame of the map [m, rad], shape (N, 3)."""
        poses = self.world.outlines.poses.T.copy()
        poses[:, :2] -= self._offsets
        return poses

    @property
    def active(self) -> Bool:
        """Whether each robot is still there, shape (N,)."""
        active: Bool = self.world.outlines.hidden == 0
        return active

    def reset(self, copy: int, rng: Generator) -> None:
        """Begin an episode with the robots of one copy, at positions that `rng` alone decides."""
        apart = 2 * self._radius + APART
        starts: list[Point] = []
        goals: list[Point] = []
        for _ in range(self.robots):
            start = self._free.sample(rng, Distance(starts, apart))
            from_start = Distance([start], *self.task.goal_distance)
            goal = self._free.sample(rng, Distance(goals, apart), from_start)
            starts.append(start)
            goals.append(goal)
        who = slice(copy * self.robots, (copy + 1) * self.robots)
        drives, outlines, rest = self.world.drives, self.world.outlines, self._at_rest
        drives.axes[..., who], drives.flags[:, who] = rest.axes[..., who], rest.flags[:, who]
        drives.wheels[:, who] = rest.wheels[:, who]
        outlines.poses[:2, who] = (np.array(starts) + self._offsets[who]).T
        outlines.theta[who] = rng.uniform(-pi, pi, self.robots)
        outlines.hidden[who] = 0.0
        outlines.stale = True
        self.goals[who] = goals
        self._goal_distances[who] = np.hypot(*self._goal_vectors(who).T)

    def remove(self, who: Int) -> None:
        """Remove robots from the map: from now on nothing sees or touches them."""
        self.world.drives.axes[..., who] = self._at_rest.axes[..., who]
        self.world.outlines.hidden[who] = 1.0
        self.world.outlines.stale = True

    def step(self, actions: Float | Float32, active: Bool) -> StepResult:
        """Let one step pass.

        `actions` are speed and turn rate, as shares of the highest, shape (N, 2), clipped to -1..1.
        Robots that are not `active` (N,) stand still and have no reward.

        Raises:
            CommandError: An action is not finite or of the wrong shape.
        """
        wanted = np.asarray(actions, dtype=np.float64)
        if wanted.shape != (self.count, 2) or not np.isfinite(wanted).all():
            raise CommandError(f"actions: expected finite numbers, shape ({self.count}, 2)")
        speeds, rates = wanted.clip(-1.0, 1.0).T * self._top * active
        self.world.drives.go(speeds, rates)
        stalled = self._pass_time()
        before, self._goal_distances = self._goal_distances, np.hypot(*self._goal_vectors().T)
        arrived = active & (self._goal_distances < self.task.goal_radius)
        collided = active & stalled & ~arrived
        worth = self.task.reward
        reward = worth.progress * (before - self._goal_distances) + worth.time
        reward += worth.arrival * arrived + worth.collision * collided
        return StepResult(np.where(active, reward, 0.0), arrived, collided)

    def _pass_time(self) -> Bool:
        """Let one step pass; return which robots stalled at any time in it, shape (N,)."""
        pieces = ceil(self.task.dt / LONGEST - 1e-9)
        stalled = np.zeros(self.count, dtype=np.bool_)
        for _ in range(pieces):
            self.world.step(self.task.dt / pieces)
            stalled |= self.world.drives.flags[STALLED] != 0
        return stalled

    def observe(self) -> Float32:
        """Return the observations of all robots now, shape (N, D)."""
        return self.observations.observe(self.world, self._goal_vectors())

    def infos(self, result: StepResult | None = None) -> Infos:
        """Return the information of all robots, by key, shapes (N, ...).

        The keys are `is_success`, `collision`, then `pose` and `goal` in the frame of the map. A
        new episode has no result.
        """
        none = np.zeros((2, self.count), dtype=np.bool_)
        arrived, collided = result[1:] if result else none
        places = {"pose": self.poses, "goal": self.goals.copy()}
        return {"is_success": arrived, "collision": collided, **places}

    def _goal_vectors(self, who: slice = slice(None)) -> Float:
        """Return the vector from each robot, or some, to its goal [m], shape (N, 2)."""
        vectors: Float = self.goals[who] + self._offsets[who] - self.world.outlines.poses[:2, who].T
        return vectors


def _compile_once() -> None:
    """Compile the kernels, and say so, if nobody has on this machine."""
    if CACHE.is_missing:
        compiled_kernels(begin=lambda: log.warning(COMPILING))


def info_of(infos: Infos, n: int) -> dict[str, Any]:
    """Return the information of one robot."""
    return {key: some[n] if some.ndim > 1 else some[n].item() for key, some in infos.items()}
