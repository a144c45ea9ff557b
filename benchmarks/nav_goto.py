"""Going to places of a map: run as `python -m benchmarks.nav_goto`.

Each pair of places is driven by a whole robot in virtual time: driver, link, firmware, world with
all errors. Prints a line per goal, then the figures beside their bars.
"""

import argparse
import asyncio
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import hypot, inf, pi
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.table import Row
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2, wrap
from pioneer3.maps import LineMap, read_map, shipped_map
from pioneer3.maps.grid import samples
from pioneer3.models import load_model
from pioneer3.nav.costs import CostMap
from pioneer3.nav.places import Destination
from pioneer3.nav.planner import CostToGo
from pioneer3.runtime.connect import connect_async
from pioneer3.runtime.navigator import Navigator
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile import Box
from pioneer3.tasks import running
from tests.conftest import VirtualTimeLoop
from tests.support import SimulatedRobot
from tests.wandering import Watch, places_of

SHARED = Path(__file__).resolve().parents[2] / "shared" / "maps"
TOP = 0.75
"""Of both robots, as they are delivered [m/s]."""
PATIENCE = 240.0
"""Longest drive to one goal [s]."""
FAR = 3.0
"""Goals are farther away than this [m]."""
Float = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One way, driven.

    Attributes:
        arrived: Whether it got there.
        why: The reason if not.
        shortest: Length of the shortest way [m].
        way: Driven [m].
        seconds: Taken.
        hardest: Speed of the hardest contact [m/s]; 0 without any.
        contacts: Number of them.
        off: Distance from the goal in the end [m].
        turned: Angle off the heading in the end [rad].
    """

    arrived: bool
    why: str
    shortest: float
    way: float
    seconds: float
    hardest: float
    contacts: int
    off: float
    turned: float


def load(name: str) -> LineMap:
    """Return a map that ships, or one beside the project."""
    return shipped_map(name) if name == "office" else read_map(SHARED / f"{name}.map")


def open_costs(costs: CostMap) -> NDArray[np.float32]:
    """Return costs of 1 per metre wherever the robot fits."""
    fits = (costs.clearance >= costs.needed) & ~costs.closed
    return np.where(fits, costs.raster.cell, np.inf).astype(np.float32)


class Course:
    """Goals on one map, one after the other."""

    def __init__(self, name: str, model: str, seed: int, boxes: int) -> None:
        self.map, self.model, self.seed = load(name), load_model(model), seed
        self.costs = CostMap.of(self.map, self.model)
        self._rng = np.random.default_rng(seed)
        self._places = places_of(self.map, model)
        self.boxes: list[Box] = []
        self._add_boxes(boxes)
        self.home = Pose2(*self._place(), float(self._rng.uniform(-pi, pi)))

    def _place(self) -> tuple[float, float]:
        while True:
            x, y = self._places.sample(self._rng)
            near = any(hypot(x - box.pose.x, y - box.pose.y) < 1.0 for box in self.boxes)
            if self.costs.can_turn(x, y) and not near:
                return x, y

    def _add_boxes(self, count: int) -> None:
        for _ in range(count):
            pose = Pose2(*self._place(), float(self._rng.uniform(-pi, pi)))
            self.boxes.append(Box(pose=pose, size=(0.4, 0.3), name=f"box {len(self.boxes)}"))

    def goals(self, start: Pose2, count: int) -> Iterator[tuple[Pose2, float]]:
        """Yield goals that can be reached, with the length of the shortest way."""
        open_ways = open_costs(self.with_boxes())
        here = start
        while count:
            x, y = self._place()
            there = Pose2(x, y, float(self._rng.uniform(-pi, pi)))
            to_go = CostToGo.of(open_ways, self.costs.raster, x, y)
            shortest = to_go.at(here.x, here.y) if to_go else inf
            if FAR < shortest < inf:
                yield there, shortest
                here, count = there, count - 1

    def with_boxes(self) -> CostMap:
        """Return the costs, boxes included."""
        sides = [box.outline for box in self.boxes]
        return (
            self.costs.with_obstacles(samples(np.concatenate(sides), 0.02)) if sides else self.costs
        )


async def at_once(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call `function` here: in virtual time nothing takes long."""
    return function(*arguments)


async def drive_all(course: Course, count: int, verbose: bool) -> list[Drive]:
    """Drive to `count` goals."""
    sim = SimulatedRobot(
        course.map,
        home=course.home,
        seed=course.seed,
        realism=Realism(),
        kernels=Kernels(),
        model=course.model.name,
    )
    for box in course.boxes:
        sim.world.add_obstacle(box)
    watch = sim.stepped = Watch(sim)
    drives: list[Drive] = []
    async with sim, connect_async(sim.open) as robot:
        rng = np.random.default_rng(course.seed)
        navigator = await Navigator.on(
            robot, course.map, start=course.home, rng=rng, in_thread=at_once
        )
        async with running(navigator.run()):
            await until_sure(navigator)
            watch.begin()
            for goal, shortest in course.goals(course.home, count):
                done = await drive(sim, navigator, watch, goal, shortest)
                drives.append(done)
                if verbose or not done.arrived or done.contacts:
                    print(f"  {len(drives):>3} {done}", flush=True)
    return drives


async def until_sure(navigator: Navigator) -> None:
    """Wait until the navigator knows where the robot is."""
    async for state in navigator.state.values():
        if state.estimate.sure:
            return


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
        hardest=max((impact.speed for impact in impacts), default=0.0),
        contacts=len(impacts),
        off=hypot(at.x - goal.x, at.y - goal.y),
        turned=abs(wrap(at.theta - goal.theta)),
    )


def rows(drives: Sequence[Drive], top: float) -> Iterator[Row]:
    """Say what counts."""
    done = [each for each in drives if each.arrived]
    yield Row(f"goals not reached, of {len(drives)}", len(drives) - len(done), "", 0)
    yield Row("contacts", sum(each.contacts for each in drives), "", 0)
    yield Row("hardest contact", max(each.hardest for each in drives), "m/s", 0)
    if not done:
        return
    ratio = sum(each.way for each in done) / sum(each.shortest for each in done)
    yield Row("way by the shortest", ratio, "", 1.05)
    times = np.array([each.seconds / (each.shortest / top) for each in done])
    yield Row("time by the shortest at top speed, median", float(np.median(times)), "", 1.6)
    yield Row("the same, 95 %", float(np.quantile(times, 0.95)), "", 2.5)
    yield Row("off the goal, worst", 100 * max(each.off for each in done), "cm", 5)
    yield Row("off the heading, worst", np.degrees(max(each.turned for each in done)), "deg", 3)


def main() -> int:
    """Run all; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--map", action="append", choices=("office", "AMROffice", "columbia"))
    parser.add_argument("--model", action="append", choices=("p3at-sh", "p3dx-sh"))
    parser.add_argument("--goals", type=int, default=50)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--boxes", type=int, default=0)
    parser.add_argument("--verbose", action="store_true")
    given = parser.parse_args()
    missed = 0
    for name in given.map or ("office", "AMROffice", "columbia"):
        for model in given.model or ("p3at-sh", "p3dx-sh"):
            for seed in range(given.seeds):
                course = Course(name, model, seed, given.boxes)
                began = time.perf_counter()
                with asyncio.Runner(loop_factory=partial(VirtualTimeLoop, inf)) as runner:
                    drives = runner.run(drive_all(course, given.goals, given.verbose))
                took = time.perf_counter() - began
                print(f"{name} {model} seed {seed}, {given.boxes} boxes: {took:.0f} s")
                for row in rows(drives, TOP):
                    print("  ", row)
                    missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
