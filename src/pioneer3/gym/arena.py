"""Robots on their way to goals, as arrays: what all environments share."""

import logging
from copy import deepcopy
from math import ceil, pi
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from pioneer3.errors import CommandError, ConfigError, how_to_get
from pioneer3.gym.copies import Copies
from pioneer3.gym.observation import Senses
from pioneer3.gym.places import Places, Point, Ring
from pioneer3.gym.task import Task
from pioneer3.models import RobotModel, load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import WORTH_COMPILING, Kernels
from pioneer3.sim.kernels.drives import LONGEST, STALLED, TOP
from pioneer3.sim.maps import LineMap
from pioneer3.sim.placement.footprint import turning_circle
from pioneer3.sim.realism import Realism
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import load_map

Float = NDArray[np.float64]
Float32 = NDArray[np.float32]
Bool = NDArray[np.bool_]
Int = NDArray[np.int64]
Facts = dict[str, NDArray[Any]]

APART = 0.1
"""Between the turning circles of robots that start, or arrive, beside each other [m]."""


log = logging.getLogger(__name__)


class Outcome(NamedTuple):
    """What a step has come to, for each of N robots; shapes (N,)."""

    reward: Float
    arrived: Bool
    collided: Bool


class Arena:
    """Copies of a map, with robots in each that do not know of the other copies.

    Robots are numbered copy by copy: those of copy c are c * robots and the following ones.

    Args:
        task: What they are to do.
        copies: Of the map.
        robots: In each copy; these see each other, and are in each other's way.

    Attributes:
        task: What they are to do.
        world: Where they are. Its frame is not that of the map, see :class:`Copies`.
        senses: What they observe.
        goals: In the frame of the map [m], shape (N, 2).
        copies: The maps.

    Raises:
        ConfigError: The task cannot be done: no such map or model, no room, no such sensor.
    """

    def __init__(self, task: Task, copies: int = 1, robots: int = 1) -> None:
        if min(copies, robots) < 1:
            raise ConfigError(f"{copies} copies with {robots} robots each: both must be positive")
        self.task, self.robots, self.count = task, robots, copies * robots
        self._model = _model(task.model)
        line_map = task.map if isinstance(task.map, LineMap) else load_map(task.map)
        self.senses = Senses(task, self._model)
        self.copies = Copies(line_map, copies)
        self._radius = turning_circle(self._model)
        self._places = Places(line_map, self.copies.walls, self._radius)
        self._kernels = Kernels(task.threads)
        if self.count >= WORTH_COMPILING and not self._kernels.compiled:
            log.warning("without numba this simulation is slow: %s", how_to_get("fast"))
        self._shift = np.repeat(self.copies.shifts, robots, axis=0)
        self.goals = np.zeros((self.count, 2))
        self._far = np.zeros(self.count)
        self.renew(None)

    def renew(self, seed: int | None) -> None:
        """Make a new world, all of whose noise depends on `seed` alone; robots have no places."""
        bodies = [Body(self._model) for _ in range(self.count)]
        for body in bodies:
            body.firing = body.firing if self.senses.sonars else ()
        self.world = World(
            self.copies.together,
            bodies,
            self._kernels,
            seed=seed,
            realism=self.task.realism,
        )
        for body in self.world.robots:
            body.enable_motors(on=True)
        self._at_rest = deepcopy(self.world.drives)
        self._top = self._at_rest.axes[TOP]

    @property
    def noisy(self) -> bool:
        """Whether anything in the world is random."""
        return self.task.realism not in {None, Realism.ideal()}

    @property
    def poses(self) -> Float:
        """Where the robots are, in the frame of the map [m, rad], shape (N, 3)."""
        poses = self.world.outlines.poses.T.copy()
        poses[:, :2] -= self._shift
        return poses

    @property
    def present(self) -> Bool:
        """Which robots have not left, shape (N,)."""
        present: Bool = self.world.outlines.hidden == 0
        return present

    def begin(self, copy: int, rng: Generator) -> None:
        """Let the robots of one copy begin anew, at places that `rng` alone decides."""
        apart = 2 * self._radius + APART
        starts: list[Point] = []
        goals: list[Point] = []
        for _ in range(self.robots):
            start = self._places.draw(rng, Ring(starts, apart))
            ring = Ring([start], *self.task.goal_distance)
            goal = self._places.draw(rng, Ring(goals, apart), ring)
            starts.append(start)
            goals.append(goal)
        who = slice(copy * self.robots, (copy + 1) * self.robots)
        drives, outlines = self.world.drives, self.world.outlines
        rest = self._at_rest
        drives.axes[..., who], drives.flags[:, who] = rest.axes[..., who], rest.flags[:, who]
        drives.wheels[:, who] = rest.wheels[:, who]
        outlines.poses[:2, who] = (np.array(starts) + self._shift[who]).T
        outlines.theta[who] = rng.uniform(-pi, pi, self.robots)
        outlines.hidden[who] = 0.0
        outlines.stale = True
        self.goals[who] = goals
        self._far[who] = np.hypot(*self._ahead(who).T)

    def leave(self, who: Int) -> None:
        """Let robots leave the map: nobody sees or touches them any more."""
        self.world.drives.axes[..., who] = self._at_rest.axes[..., who]
        self.world.outlines.hidden[who] = 1.0
        self.world.outlines.stale = True

    def step(self, actions: Float | Float32, live: Bool) -> Outcome:
        """Let one step pass.

        Args:
            actions: Speed and turn rate, as shares of the highest, shape (N, 2); clipped to -1..1.
            live: Who acts, shape (N,); the others stand still and earn nothing.

        Raises:
            CommandError: An action is not finite or of the wrong shape.
        """
        wanted = np.asarray(actions, dtype=np.float64)
        if wanted.shape != (self.count, 2) or not np.isfinite(wanted).all():
            raise CommandError(f"actions: expected finite numbers, shape ({self.count}, 2)")
        speeds, rates = wanted.clip(-1.0, 1.0).T * self._top * live
        self.world.drives.go(speeds, rates)
        stalled = self._pass_time()
        before, self._far = self._far, np.hypot(*self._ahead().T)
        arrived = live & (self._far < self.task.goal_radius)
        collided = live & stalled & ~arrived
        worth = self.task.reward
        reward = worth.progress * (before - self._far) + worth.time
        reward += worth.arrival * arrived + worth.collision * collided
        return Outcome(np.where(live, reward, 0.0), arrived, collided)

    def _pass_time(self) -> Bool:
        """Let one step pass; return who was stopped at any time in it, shape (N,)."""
        pieces = ceil(self.task.dt / LONGEST - 1e-9)
        stalled = np.zeros(self.count, dtype=np.bool_)
        for _ in range(pieces):
            self.world.step(self.task.dt / pieces)
            stalled |= self.world.drives.flags[STALLED] != 0
        return stalled

    def observe(self) -> Float32:
        """Return what all robots observe now, shape (N, D)."""
        return self.senses.observe(self.world, self._ahead())

    def facts(self, outcome: Outcome | None = None) -> Facts:
        """Return what learners may be told beside rewards, by name, shapes (N, ...).

        That is `is_success`, `collision`, then `pose` and `goal` in the frame of the map; of a new
        episode without an outcome.
        """
        nobody = np.zeros((2, self.count), dtype=np.bool_)
        arrived, collided = outcome[1:] if outcome else nobody
        places = {"pose": self.poses, "goal": self.goals.copy()}
        return {"is_success": arrived, "collision": collided, **places}

    def _ahead(self, who: slice = slice(None)) -> Float:
        """Return the way from each robot, or some, to its goal [m], shape (N, 2)."""
        ahead: Float = self.goals[who] + self._shift[who] - self.world.outlines.poses[:2, who].T
        return ahead


def row(facts: Facts, n: int) -> dict[str, Any]:
    """Return what concerns one robot."""
    return {key: some[n] if some.ndim > 1 else some[n].item() for key, some in facts.items()}


def _model(model: str | Path | RobotModel) -> RobotModel:
    return model if isinstance(model, RobotModel) else load_model(model)
