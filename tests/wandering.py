"""A robot that drives by itself among walls, and what is to be said about how it does.

A contact counts as an impact with the speed of the robot's own point of contact: a robot that
stands when somebody walks up to it hits nobody.
"""

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field
from math import cos, hypot, inf, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pioneer3 import Robot, connect_async
from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import RatioInput
from pioneer3.behaviors.modes import goto
from pioneer3.behaviors.modes.by_hand import teleop
from pioneer3.geometry import Pose2, Twist2
from pioneer3.gym.maps import FreeSpace
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.kernels.drives import TOUCHED
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile import Box, Person
from tests.lasers import LaserUnit
from tests.support import SimulatedRobot

MODEL = "p3at-sh"
IN_BAND = "in-band"
"""The laser of the simulator in the robot's own stream; others are models of units."""
LOST_EVERY, LOST_FOR = 60.0, 10.0
"""A laser that is lost now and then is silent for so long, so often [s]."""
STICK_MOVES = 0.4
"""A stick moves in a second with this probability."""
NEAR_START = 0.8
"""People and movable boxes are at least so far from the start [m]."""
Cell = tuple[int, int]
Thing = Box | Person
Guide = Callable[[Robot], Stack | None]
"""Is asked every second; returns a mode to start, or `None` to go on."""


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
    """Writes the log of a simulated robot, step by step.

    Attributes:
        log: The log.
        total: The way driven so far [m].
    """

    def __init__(self, sim: SimulatedRobot) -> None:
        self.log = Log()
        self._sim = sim
        self._touched = False
        self._twist = Twist2()
        self._here = sim.body.robot_in_world
        self._way, self._minute, self.total = 0.0, 60.0, 0.0

    def begin(self) -> None:
        """Count way and minutes from now."""
        self._here = self._sim.body.robot_in_world
        self._way, self._minute = 0.0, self._sim.world.time + 60.0

    def __call__(self) -> None:
        """Note the step just taken."""
        sim, log = self._sim, self.log
        body, before = sim.body, self._twist
        pose = body.robot_in_world
        self._twist = Twist2(*body.speeds)
        touched = bool(body.drives.flags.item(TOUCHED, body.number))
        if touched and not self._touched:
            speed = _contact_speed(sim, pose, before)
            log.impacts.append(Impact(sim.world.time, speed, pose, before))
        self._touched = touched
        step = hypot(pose.x - self._here.x, pose.y - self._here.y)
        self._way += step
        self.total += step
        self._here = pose
        log.cells.add((int(pose.x // 1), int(pose.y // 1)))
        if sim.world.time >= self._minute:
            log.ways.append(self._way)
            self._way, self._minute = 0.0, self._minute + 60.0


async def drive_by_itself(
    mode: Stack | Guide,
    line_map: LineMap,
    home: Pose2,
    seconds: float,
    *,
    seed: int = 0,
    kernels: Kernels | None = None,
    realism: Realism | None = None,
    model: str = MODEL,
    things: Sequence[Thing] = (),
    laser: str | None = None,
    lossy: bool = False,
) -> Log:
    """Let a mode drive a simulated robot, through the whole driver, in the loop's time.

    Args:
        mode: The mode, or one after the other.
        line_map: What stands still.
        home: Where the robot starts.
        seconds: How long, at most [s].
        seed: Of all errors.
        kernels: Of the world.
        realism: Of wheels and sensors; the default if not given.
        model: Of the robot.
        things: People and movable boxes.
        laser: `IN_BAND`, the model of a unit, or `None` for none.
        lossy: Whether the unit is lost now and then, as `LOST_EVERY` and `LOST_FOR` say.
    """
    sim = SimulatedRobot(
        line_map, home=home, seed=seed, realism=realism or Realism(), kernels=kernels, model=model
    )
    for thing in things:
        sim.world.add_obstacle(thing)
    watch = sim.stepped = Watch(sim)
    async with sim, _connected(sim, laser, lossy=lossy) as robot:
        watch.begin()
        guide = _Once(mode) if isinstance(mode, Stack) else mode
        end = sim.world.time + seconds
        while sim.world.time < end:
            if (following := guide(robot)) is not None:
                robot.arbiter.start(following)
            await asyncio.sleep(1.0)
            if isinstance(mode, Stack) and robot.arbiter.mode is not mode:
                watch.log.ended = robot.arbiter.ended.why if robot.arbiter.ended else "?"
                break
    return watch.log


class _Once:
    """Starts one mode."""

    def __init__(self, mode: Stack) -> None:
        self._mode: Stack | None = mode

    def __call__(self, robot: Robot) -> Stack | None:
        mode, self._mode = self._mode, None
        return mode


class RandomGoals:
    """Goes to one place after the other; what is in the way ends a mode and calls for another.

    Args:
        line_map: With the places.
        home: Where the robot starts, the origin of its odometry.
        seed: Of the choice.
        model: Of the robot.
        speed: [m/s].
    """

    def __init__(
        self, line_map: LineMap, home: Pose2, seed: int, model: str = MODEL, speed: float = 0.4
    ) -> None:
        self._places, self._home, self._speed = places_of(line_map, model), home, speed
        self._rng = np.random.default_rng(seed)

    def __call__(self, robot: Robot) -> Stack | None:
        if robot.arbiter.mode is not None:
            return None
        goal = self._home.inverse() @ Pose2(*self._places.sample(self._rng))
        return goto(goal.x, goal.y, speed=self._speed)


class RandomStick:
    """Pushes a stick about, for the most part forwards, and turns.

    Args:
        seed: Of the choice.
    """

    def __init__(self, seed: int) -> None:
        self._rng, self._ratios = np.random.default_rng(seed), RatioInput()

    def __call__(self, robot: Robot) -> Stack | None:
        if self._rng.random() < STICK_MOVES:
            drive, turn = self._rng.uniform(-0.6, 1.0), self._rng.uniform(-1.0, 1.0)
            straight = self._rng.random() < 1 / 2
            self._ratios.push(float(drive), 0.0 if straight else float(turn))
        return None if robot.arbiter.mode is not None else teleop(self._ratios)


@asynccontextmanager
async def _connected(
    sim: SimulatedRobot, laser: str | None, *, lossy: bool
) -> AsyncIterator[Robot]:
    """Connect to the robot, and let its laser scan during the block."""
    async with AsyncExitStack() as stack:
        if laser is None or laser == IN_BAND:
            robot = await stack.enter_async_context(connect_async(sim.open))
        else:
            unit = await stack.enter_async_context(LaserUnit(sim, laser))
            spec = unit.spec(protocol=unit.laser.model.protocol)
            robot = await stack.enter_async_context(connect_async(sim.open, lasers=[spec]))
            if lossy:
                sim.stepped = _Losses(sim, unit)
        if laser is not None:
            stack.enter_context(robot.laser.wanted())
            await robot.laser.reading()
        yield robot


class _Losses:
    """Silences a unit now and then."""

    def __init__(self, sim: SimulatedRobot, unit: LaserUnit) -> None:
        self._stepped, self._sim, self._unit = sim.stepped, sim, unit
        self._next = LOST_EVERY / 2

    def __call__(self) -> None:
        if self._sim.world.time >= self._next:
            self._unit.laser.silence(LOST_FOR)
            self._next += LOST_EVERY
        self._stepped()


def start_in(
    line_map: LineMap, seed: int, model: str = MODEL, things: Sequence[Thing] = ()
) -> Pose2:
    """Return a random pose where the robot can turn, away from people and movable boxes."""
    rng = np.random.default_rng(seed)
    places = places_of(line_map, model)
    stand = [thing.pose if isinstance(thing, Box) else thing.pose_at(0.0) for thing in things]
    while True:
        x, y = places.sample(rng)
        if all(hypot(at.x - x, at.y - y) > NEAR_START for at in stand):
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
    model, walls = sim.body.model, np.concatenate([sim.world.map.walls, _sides_of_things(sim)])
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


def _sides_of_things(sim: SimulatedRobot) -> NDArray[np.float64]:
    """Return the sides of people and boxes [m], shape (S, 4)."""
    outlines = sim.world.outlines.shapes[len(sim.world.robots) :, 3:]
    corners = np.stack([outlines[:, ::2], outlines[:, 1::2]], axis=2)
    return np.concatenate([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 4)
