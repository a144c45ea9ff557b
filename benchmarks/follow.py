"""All rules of following, over courses that a person walks: `python -m benchmarks.follow`.

`--hard` adds courses with passers-by, pillars and chairs, by the legs. What is counted, and how:
`tests/e2e/follow_walk.py`; the courses: `follow_course.py` and `follow_obstructions.py` beside it.
"""

import argparse
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import chain
from math import inf, radians
from multiprocessing import Pool
from statistics import median
from time import perf_counter

from benchmarks.table import Row
from pioneer3.behaviors.leg_tracking import LegTracks
from pioneer3.behaviors.modes.follow import Rule
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.kernels import CACHE, Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.sensors import LASER_RANGE
from pioneer3.sim.world import World
from pioneer3.sim.worldfile import Person
from pioneer3.state import Scan
from tests.e2e.follow_course import Course, make_course
from tests.e2e.follow_obstructions import among_chairs, behind_pillars, passed_by
from tests.e2e.follow_walk import KEEP, SPEED, Outcome, Walk, within

MODELS = "p3at-sh", "p3dx-sh"
SEEDS = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """Walks that are counted together.

    Attributes:
        name: In the table.
        rule: That the robot follows.
        course: Makes the course of a seed.
        keep: Distance to keep [m].
        wide: Whether the laser has 1081 readings in 270 degrees, not 181 in 180.
        kept: Share of the time within 0.15 and 0.6 m that is promised [%].
        near: Share of the time within 0.5 m of the wanted distance that is promised [%].
        bound: Whether losing the person and the like miss a bar.
    """

    name: str
    rule: Rule
    course: Callable[[int], Course] = make_course
    keep: float = KEEP
    wide: bool = False
    kept: float = 0.0
    near: float = 0.0
    bound: bool = True


TRIALS = (
    Trial(name="legs", rule="legs", near=99.0),
    Trial(name="legs, 1081 readings", rule="legs", wide=True, near=99.0),
    Trial(name="tracking", rule="tracking", kept=95.0),
    Trial(name="lab", rule="lab", bound=False),
)
HARD = (
    Trial(name="legs among chairs", rule="legs", course=among_chairs, near=99.0),
    Trial(name="legs behind pillars", rule="legs", course=behind_pillars, keep=1.0, bound=False),
    Trial(name="legs, blocked by passers", rule="legs", course=passed_by, keep=1.0, bound=False),
    Trial(name="legs with passers-by", rule="legs", course=passed_by, keep=1.2, bound=False),
)


def cost() -> Row:
    """Return the time to find and track all legs in a scan of 1081 readings, amid chairs."""
    course = among_chairs(3)
    body = Body(load_model(MODELS[0]))
    world = World(
        course.room, [body], Kernels(compiled=CACHE.is_complete), seed=1, realism=Realism()
    )
    body.robot_in_world = Pose2(*course.path[0], course.heading) @ Pose2(-1.1)
    world.add_obstacle(Person(path=course.path, speed=SPEED, loop=False))
    start, step, count = radians(-135), radians(0.25), 1081
    angles, tracks, times = (
        tuple(start + k * step for k in range(count)),
        LegTracks(),
        list[float](),
    )
    for number in range(200):
        world.step(0.1)
        ranges = world.laser(body, ORIGIN, start, step, count).tolist()
        scan = Scan(
            stamp=number / 10,
            sequence=number,
            robot_in_odom=body.robot_in_world,
            sensor_in_robot=ORIGIN,
            angles=angles,
            ranges=tuple(metres if metres < LASER_RANGE else inf for metres in ranges),
        )
        began = perf_counter()
        tracks.look(scan)
        times.append(perf_counter() - began)
    return Row("legs in 1081 readings, found and tracked", 1000 * median(times), "ms", 3.0)


def rows(
    seeds: int = SEEDS, models: tuple[str, ...] = MODELS, trials: tuple[Trial, ...] = TRIALS
) -> Iterator[Row]:
    """Yield the figures of each trial with each model."""
    for model in models:
        for trial in trials:
            yield from _rows(model, trial, _outcomes(model, trial, seeds))


def _rows(model: str, trial: Trial, walks: list[Outcome]) -> Iterator[Row]:
    what, most = f"{model}, {trial.name}", 0.0 if trial.bound else inf
    near = sorted(100 * within(walk, trial.keep) for walk in walks)
    held = sorted(100 * walk.held / len(walk.gaps) for walk in walks)
    if trial.keep == KEEP:
        kept = sorted(100 * walk.share() for walk in walks)
        yield Row(f"{what}: 0.15 to 0.6 m", _mean(kept), "%", trial.kept, more_is_better=True)
        yield Row(f"{what}: the same, worst seed", kept[0], "%", 0.0, more_is_better=True)
    yield Row(
        f"{what}: as far as wanted +- 0.5 m", _mean(near), "%", trial.near, more_is_better=True
    )
    yield Row(f"{what}: the same, worst seed", near[0], "%", 0.0, more_is_better=True)
    yield Row(f"{what}: knows where they are", _mean(held), "%", 0.0, more_is_better=True)
    yield Row(f"{what}: the same, worst seed", held[0], "%", 0.0, more_is_better=True)
    yield Row(f"{what}: walks with the person lost", _count(walks, "lost"), "", most)
    yield Row(f"{what}: walks that chased walls", _count(walks, "walls"), "", most)
    yield Row(f"{what}: walks with contacts", _count(walks, "contacts"), "", most)
    yield Row(f"{what}: walks ended early", sum(w.ended is not None for w in walks), "", most)


def _mean(values: list[float]) -> float:
    return sum(values) / len(values)


def _count(walks: list[Outcome], what: str) -> int:
    return sum(getattr(walk, what) > 0 for walk in walks)


def _outcomes(model: str, trial: Trial, seeds: int) -> list[Outcome]:
    outcomes = []
    with Pool() as pool:
        for outcome in pool.imap(partial(_outcome, model, trial), range(seeds)):
            outcomes.append(outcome)
            done = f"\r{model}, {trial.name}: {len(outcomes)} of {seeds} walks"
            print(done, end="", file=sys.stderr, flush=True)
    print("\r\x1b[K", end="", file=sys.stderr, flush=True)
    return outcomes


def _outcome(model: str, trial: Trial, seed: int) -> Outcome:
    walk = Walk(
        course=trial.course(seed),
        seed=seed,
        rule=trial.rule,
        model=model,
        keep=trial.keep,
        wide=trial.wide,
    )
    return walk.run()


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--models", nargs="+", default=MODELS)
    parser.add_argument("--hard", action="store_true", help="walk the hard courses, too")
    given = parser.parse_args()
    missed = 0
    for row in chain((cost(),), rows(given.seeds, tuple(given.models), TRIALS + HARD * given.hard)):
        print(row, flush=True)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
