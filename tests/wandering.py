"""A robot that drives by itself among walls, and what is to be said about how it does."""

import asyncio
from dataclasses import dataclass, field
from math import cos, hypot, inf, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pioneer3 import connect_async
from pioneer3.behaviors.action import Stack
from pioneer3.geometry import Pose2, Twist2
from pioneer3.gym.maps import FreeSpace
from pioneer3.models import load_model
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.kernels.drives import TOUCHED
from pioneer3.sim.maps import LineMap
from pioneer3.sim.realism import Realism
from tests.support import SimulatedRobot

MODEL = "p3at-sh"
Cell = tuple[int, int]


class Impact(NamedTuple):
    """The robot met a wall: when [s], how fast the point of contact moved [m/s], and where."""

    when: float
    speed: float
    pose: Pose2
    twist: Twist2


@dataclass
class Log:
    """What happened.

    Attributes:
        impacts: In order; a contact that lasts counts once.
        ways: What it drove in each whole minute [m].
        cells: Squares of 1 m where its centre has been.
        ended: Why the mode ended before its time, or `None`.
    """

    impacts: list[Impact] = field(default_factory=list)
    ways: list[float] = field(default_factory=list)
    cells: set[Cell] = field(default_factory=set)
    ended: str | None = None

    @property
    def hardest(self) -> float:
        """Speed of the hardest impact [m/s]; 0 without any."""
        return max((impact.speed for impact in self.impacts), default=0.0)


class Watch:
    """Writes the log of a simulated robot, step by step."""

    def __init__(self, sim: SimulatedRobot) -> None:
        self.log = Log()
        self._sim = sim
        self._touched = False
        self._twist = Twist2()
        self._here = sim.body.robot_in_world
        self._way, self._minute = 0.0, 60.0

    def __call__(self) -> None:
        """Note the step just taken."""
        sim, log = self._sim, self.log
        body, before = sim.body, self._twist
        pose, drive = body.robot_in_world, body.drive
        self._twist = Twist2(drive.linear.velocity, drive.angular.velocity)
        touched = bool(body.drives.flags.item(TOUCHED, body.number))
        if touched and not self._touched:
            speed = _contact_speed(sim, pose, before)
            log.impacts.append(Impact(sim.world.time, speed, pose, before))
        self._touched = touched
        self._way += hypot(pose.x - self._here.x, pose.y - self._here.y)
        self._here = pose
        log.cells.add((int(pose.x // 1), int(pose.y // 1)))
        if sim.world.time >= self._minute:
            log.ways.append(self._way)
            self._way, self._minute = 0.0, self._minute + 60.0


async def drive_by_itself(
    stack: Stack,
    line_map: LineMap,
    home: Pose2,
    seconds: float,
    *,
    seed: int = 0,
    kernels: Kernels | None = None,
    realism: Realism | None = None,
    model: str = MODEL,
) -> Log:
    """Let a stack drive a simulated robot, through the whole driver, in the loop's time."""
    sim = SimulatedRobot(
        line_map, home=home, seed=seed, realism=realism or Realism(), kernels=kernels, model=model
    )
    watch = sim.stepped = Watch(sim)
    async with sim, connect_async(sim.open) as robot:
        robot.arbiter.start(stack)
        end = asyncio.get_running_loop().time() + seconds
        while sim.world.time < seconds and asyncio.get_running_loop().time() < end:
            await asyncio.sleep(1.0)
            if robot.arbiter.mode is not stack:
                watch.log.ended = robot.arbiter.ended.why if robot.arbiter.ended else "?"
                break
    return watch.log


def start_in(line_map: LineMap, seed: int, model: str = MODEL) -> Pose2:
    """Return a random pose where the robot can turn."""
    rng = np.random.default_rng(seed)
    x, y = places_of(line_map, model).sample(rng)
    return Pose2(x, y, float(rng.uniform(-np.pi, np.pi)))


def places_of(line_map: LineMap, model: str = MODEL) -> FreeSpace:
    """Return where the robot can turn, and get to."""
    return FreeSpace(line_map, line_map.walls, load_model(model).radius)


def cells_of(line_map: LineMap, model: str = MODEL) -> set[Cell]:
    """Return the squares of 1 m with a place where the robot can turn, and get to."""
    points = places_of(line_map, model).points
    return {(int(x // 1), int(y // 1)) for x, y in points.tolist()}


def _contact_speed(sim: SimulatedRobot, pose: Pose2, twist: Twist2) -> float:
    """Return how fast the point of the robot that is nearest to a wall moves [m/s]."""
    x, y = _contact(sim, pose)
    return hypot(twist.v - twist.w * y, twist.w * x)


def _contact(sim: SimulatedRobot, pose: Pose2) -> tuple[float, float]:
    """Return the point of the robot nearest to a wall, in its own frame [m]."""
    model, walls = sim.body.model, sim.world.map.walls
    c, s = cos(pose.theta), sin(pose.theta)
    ends = walls.reshape(-1, 2) - (pose.x, pose.y)
    ends = np.stack([c * ends[:, 0] + s * ends[:, 1], c * ends[:, 1] - s * ends[:, 0]], axis=1)
    start, end = ends[::2], ends[1::2]
    half = model.width / 2
    low, high = np.array([-model.length_rear, -half]), np.array([model.length_front, half])
    shares = np.linspace(0, 1, 201)[:, None, None]
    near = np.hypot(*((start + end) / 2).T) - np.hypot(*(end - start).T) / 2 < 1.0
    if not near.any():
        return 0.0, 0.0
    points = (start[near] + shares * (end - start)[near]).reshape(-1, 2)
    best, found = inf, (0.0, 0.0)
    nearest: NDArray[np.float64] = np.clip(points, low, high)
    away = np.hypot(*(points - nearest).T)
    i = int(away.argmin())
    best, found = float(away[i]), (float(nearest[i, 0]), float(nearest[i, 1]))
    for corner in ((low[0], low[1]), (low[0], high[1]), (high[0], low[1]), (high[0], high[1])):
        ab, ap = (end - start)[near], np.array(corner) - start[near]
        share = np.clip((ap * ab).sum(axis=1) / np.maximum((ab**2).sum(axis=1), 1e-12), 0, 1)
        gap = float(np.hypot(*(ap - share[:, None] * ab).T).min())
        if gap < best:
            best, found = gap, (float(corner[0]), float(corner[1]))
    return found
