"""Drives of whole robots to places of a map: driver, link, firmware, world, all in virtual time."""

import asyncio
from collections.abc import Callable, Iterator, Sequence
from contextlib import AsyncExitStack
from dataclasses import dataclass, field
from functools import cache, partial
from itertools import product
from math import hypot, inf, pi
from pathlib import Path
from time import thread_time
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from benchmarks.nav_course import BOXES, Ways, map_of
from benchmarks.nav_hard import Errors, HardRobot
from pioneer3.behaviors.action import Desire, Situation
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2, wrap
from pioneer3.maps import LineMap
from pioneer3.maps.grid import samples
from pioneer3.models import load_model
from pioneer3.nav.costs import CostMap
from pioneer3.nav.places import Destination
from pioneer3.nav.planner import CostToGo
from pioneer3.navigation.connect import connect_async
from pioneer3.navigation.follow_way import FollowWay
from pioneer3.navigation.navigator import Navigator
from pioneer3.robot.devices.laser import Laser
from pioneer3.robot.devices.presence import Presence
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile import Box, Person
from pioneer3.state import Snapshot
from pioneer3.tasks import running
from tests.conftest import VirtualTimeLoop
from tests.support import SimulatedRobot
from tests.wandering import Watch, places_of

SHARED = Path(__file__).resolve().parents[2] / "shared" / "maps"
MAPS = ("office", "AMROffice", "columbia", "flat")
DRAWN = ("office", "flat")
"""Maps that are there without files beside the project."""
MODELS = ("p3at-sh", "p3dx-sh")
PATIENCE = 240.0
"""Longest drive to one goal [s]."""
FAR = 3.0
"""Goals are farther away than this, and people walk farther [m]."""
MOVES = 0.02
"""A contact counts if the point of the robot that touches moves faster than this [m/s]: somebody
who walks up to a robot that stands is not hit by it."""
WALK = 0.8
"""Speed of people [m/s]."""
AWAY = 1.5
"""Nobody begins nearer to the robot than this [m]."""
NO_LASER = property(lambda _: Presence(False, "This robot has none."))
Float = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """Goals on one map, one after the other.

    Attributes:
        where: The map.
        model: Of the robot.
        seed: Of everything random.
        goals: How many.
        boxes: That are not on the map.
        people: That walk to and fro along shortest ways.
        hard: Whether laser and odometry err as :class:`Errors`.
        sonar: Whether the robot has no laser.
    """

    where: str
    model: str
    seed: int = 0
    goals: int = 50
    boxes: int = 0
    people: int = 0
    hard: bool = False
    sonar: bool = False

    def __str__(self) -> str:
        extras = [f"{self.boxes} boxes"] * (self.boxes > 0)
        extras += [f"{self.people} people"] * (self.people > 0) + ["hard"] * self.hard
        extras += ["by sonar"] * self.sonar
        return ", ".join([f"{self.where} {self.model} seed {self.seed}", *extras])


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One way, driven.

    Attributes:
        arrived: Whether it got there.
        why: The reason if not.
        shortest: Length of the shortest way [m].
        way: Driven [m].
        seconds: Taken.
        contacts: Speeds of the contacts that count [m/s].
        off: Distance from the goal in the end [m].
        turned: Angle off the heading in the end [rad].
    """

    arrived: bool
    why: str
    shortest: float
    way: float
    seconds: float
    contacts: tuple[float, ...]
    off: float
    turned: float


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What came of a trial.

    Attributes:
        drives: One for each goal.
        ticks: Processor time of localizer, sightings and follower in each tick [s].
    """

    drives: list[Drive]
    ticks: list[float]


@cache
def load(name: str) -> LineMap:
    """Return a map that ships, or one beside the project."""
    return map_of("shipped" if name == "office" else name)


def maps() -> tuple[str, ...]:
    """Return the maps that are there."""
    return tuple(n for n in MAPS if n in DRAWN or (SHARED / f"{n}.map").exists())


def open_costs(costs: CostMap) -> NDArray[np.float32]:
    """Return costs of 1 per metre wherever the robot fits."""
    fits = (costs.clearance >= costs.needed) & ~costs.closed
    return np.where(fits, costs.raster.cell, np.inf).astype(np.float32)


class Course:
    """The map of a trial, its goals, and the things that are not on the map."""

    def __init__(self, trial: Trial) -> None:
        self.map, self.model, self.trial = load(trial.where), load_model(trial.model), trial
        self.costs = CostMap.of(self.map, self.model)
        self._rng = np.random.default_rng(trial.seed)
        self._places = places_of(self.map, trial.model)
        self._bounds = BOXES.get(trial.where, self.map.bounds)
        self.boxes: list[Box] = []
        self._add_boxes(trial.boxes)
        self.home = Pose2(*self._place(), float(self._rng.uniform(-pi, pi)))
        self.people = [*self._walkers(trial)]

    def _place(self) -> tuple[float, float]:
        box = self._bounds
        while True:
            if (
                self.trial.where == "flat"
            ):  # a circle around the robot fits through none of its doors
                x, y = self._rng.uniform((box.x_min, box.y_min), (box.x_max, box.y_max)).tolist()
            else:
                x, y = self._places.sample(self._rng)
            near = any(hypot(x - box.pose.x, y - box.pose.y) < 1.0 for box in self.boxes)
            inside = self._bounds.x_min < x < self._bounds.x_max
            inside &= self._bounds.y_min < y < self._bounds.y_max
            if inside and self.costs.can_turn(x, y) and not near:
                return x, y

    def _add_boxes(self, count: int) -> None:
        for _ in range(count):
            pose = Pose2(*self._place(), float(self._rng.uniform(-pi, pi)))
            self.boxes.append(Box(pose=pose, size=(0.4, 0.3), name=f"box {len(self.boxes)}"))

    def _walkers(self, trial: Trial) -> Iterator[Person]:
        """Yield people who walk to and fro between two places, by a shortest way."""
        if not trial.people:
            return
        rng = np.random.default_rng((trial.seed, 5))
        ways = Ways("shipped" if trial.where == "office" else trial.where, self.model)
        count = 0
        while count < trial.people:
            here, there = rng.choice(ways.centres_of_turns, 2).tolist()
            onwards, path = ways.to(there), []
            while here >= 0:
                path.append(tuple(ways.centres[here].tolist()))
                here = int(onwards[here])
            x, y = path[0]
            if hypot(x - self.home.x, y - self.home.y) > AWAY and _length(path) > FAR:
                count += 1
                yield Person(path=tuple(path[::5]), loop=False, speed=WALK)

    def goals(self, body: Body) -> Iterator[tuple[Pose2, float]]:
        """Yield goals that a robot can reach, with the length of the shortest way there."""
        open_ways = open_costs(self.with_boxes())
        count = self.trial.goals
        while count:
            x, y = self._place()
            there, here = Pose2(x, y, float(self._rng.uniform(-pi, pi))), body.robot_in_world
            to_go = CostToGo.of(open_ways, self.costs.raster, x, y)
            shortest = _from(to_go, here) if to_go else inf
            if FAR < shortest < inf:
                yield there, shortest
                count -= 1

    def with_boxes(self) -> CostMap:
        """Return the costs, boxes included."""
        sides = [box.outline for box in self.boxes]
        return (
            self.costs.with_obstacles(samples(np.concatenate(sides), 0.02)) if sides else self.costs
        )

    def robot(self) -> SimulatedRobot:
        """Return the robot in its world."""
        trial = self.trial
        if trial.hard:
            return HardRobot(
                self.map, home=self.home, model=trial.model, seed=trial.seed, errors=Errors()
            )
        return SimulatedRobot(
            self.map,
            home=self.home,
            seed=trial.seed,
            realism=Realism(),
            kernels=Kernels(),
            model=trial.model,
        )


def _length(path: Sequence[tuple[float, float]]) -> float:
    """Return the length of a path [m]."""
    return float(np.hypot(*np.diff(np.array(path), axis=0).T).sum())


def _from(to_go: CostToGo, here: Pose2) -> float:
    """Return the cost from a place, or from the nearest one that a robot fits at [m]."""
    near = [
        to_go.at(here.x + dx, here.y + dy) + hypot(dx, dy)
        for dx, dy in product((-0.1, -0.05, 0.0, 0.05, 0.1), repeat=2)
    ]
    cost = to_go.at(here.x, here.y)
    return cost if cost < inf else min(near)


async def at_once(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call `function` here: in virtual time nothing takes long."""
    return function(*arguments)


@dataclass(slots=True)
class Stopwatch:
    """Adds up the processor time of navigation in each tick.

    Attributes:
        ticks: [s].
    """

    ticks: list[float] = field(default_factory=list)
    _taken: float = 0.0

    def running(self) -> Any:
        """Return a context in which the action that follows ways is timed."""
        decide = FollowWay.decide

        def timed(action: FollowWay, situation: Situation) -> Desire | None:
            began = thread_time()
            try:
                return decide(action, situation)
            finally:
                self.ticks.append(thread_time() - began + self._taken)
                self._taken = 0.0

        return patch.object(FollowWay, "decide", timed)

    def take(self, navigator: Navigator, snapshot: Snapshot) -> None:
        """Let a navigator take a snapshot."""
        began = thread_time()
        Navigator._take(navigator, snapshot)
        self._taken += thread_time() - began


async def drive_all(course: Course, tell: Callable[[int, Drive], None]) -> Outcome:
    """Drive to all goals; tell of each."""
    sim = course.robot()
    things: list[Box | Person] = [*course.boxes, *course.people]
    for thing in things:
        sim.world.add_obstacle(thing)
    watch, stopwatch = Watch(sim), Stopwatch()
    sim.stepped = watch
    drives: list[Drive] = []
    async with AsyncExitStack() as stack:
        if course.trial.sonar:
            stack.enter_context(patch.object(Laser, "presence", NO_LASER))
        await stack.enter_async_context(sim)
        robot = await stack.enter_async_context(connect_async(sim.open, record=False))
        rng = np.random.default_rng(course.trial.seed)
        navigator = await Navigator.on(
            robot, course.map, start=course.home, rng=rng, in_thread=at_once
        )
        navigator._take = partial(stopwatch.take, navigator)  # type: ignore[method-assign]
        with stopwatch.running():
            async with running(navigator.run()):
                if course.trial.sonar or not await navigator.find():
                    await navigator.look_around()
                watch.begin()
                for goal, shortest in course.goals(sim.body):
                    drives.append(await drive(sim, navigator, watch, goal, shortest))
                    tell(len(drives), drives[-1])
    return Outcome(drives, stopwatch.ticks)


async def drive(
    sim: SimulatedRobot, navigator: Navigator, watch: Watch, goal: Pose2, shortest: float
) -> Drive:
    """Drive to one goal."""
    began, contacts, way = sim.world.time, len(watch.log.impacts), watch.total
    why, place = "", Destination(x=goal.x, y=goal.y, heading=goal.theta)
    try:
        async with asyncio.timeout(PATIENCE):
            await navigator.goto(place)
    except (MotionError, TimeoutError) as error:
        why = str(error) or "took too long"
    impacts = watch.log.impacts[contacts:]
    at = sim.body.robot_in_world
    return Drive(
        arrived=not why,
        why=why,
        shortest=shortest,
        way=watch.total - way,
        seconds=sim.world.time - began,
        contacts=tuple(impact.speed for impact in impacts if impact.speed > MOVES),
        off=hypot(at.x - goal.x, at.y - goal.y),
        turned=abs(wrap(at.theta - goal.theta)),
    )


def run(trial: Trial, verbose: bool = False, times: int = 1) -> Outcome:
    """Run a trial; print the drives that failed, or all.

    Repeated so many `times`, it is the same to the last bit; of each tick the least time counts.
    What else runs on the computer makes a tick in a hundred three times as long.
    """

    def tell(number: int, done: Drive) -> None:
        if verbose or not done.arrived or done.contacts:
            print(f"  {trial} {number:>3} {done}", flush=True)

    with asyncio.Runner(loop_factory=partial(VirtualTimeLoop, inf)) as runner:
        outcome = runner.run(drive_all(Course(trial), tell))
    if times == 1:
        return outcome
    again = run(trial, times=times - 1).ticks
    return Outcome(outcome.drives, np.minimum(outcome.ticks, again).tolist())
