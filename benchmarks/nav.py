"""Navigation beside its bars: run as `python -m benchmarks nav [--quick] [--jobs 2]`.

Goals, maps, seeds and drives of the full size take hours; `--quick` takes minutes, and its rows say
little of bars that count seldom things.
"""

from collections.abc import Iterator
from itertools import product
from time import process_time

import numpy as np

from benchmarks import nav_localization, nav_long, nav_mapping, nav_pushes
from benchmarks.nav_goals import MODELS, Trial, maps
from benchmarks.nav_goto import SONAR_SHARE, outcomes_of, rows_of
from benchmarks.table import Row
from pioneer3.maps import LineMap
from pioneer3.models import load_model
from pioneer3.nav.costs import CostMap
from pioneer3.nav.planner import Way, plan
from pioneer3.nav.warm_up import warm_up

GOALS, SEEDS = 50, 3
QUICK_GOALS = 5
BOXES, PEOPLE = 6, 5
PEOPLE_SHARE = 48 / 50
WIDE, DEEP, ROOM = 60, 40, 5
"""Of the floor that a way is planned on, and of its rooms [m]."""
DOOR = 1.0
"""[m]."""
PLANS = 9


def rows(*, quick: bool = False, jobs: int | None = None) -> Iterator[Row]:
    """Yield all rows, each when it is measured.

    Args:
        quick: Few goals, one seed, short drives.
        jobs: Processes; as many as there are processors if not given.
    """
    yield from rows_of_plans()
    yield from rows_of_goto(quick=quick, jobs=jobs)
    yield from nav_localization.rows(quick=quick)
    sizes = (nav_mapping.QUICK_SECONDS, nav_mapping.QUICK_SEEDS) if quick else ()
    yield from nav_mapping.rows(*sizes)
    yield from nav_long.rows(*((nav_long.QUICK_METRES,) if quick else ()))
    yield from nav_pushes.rows(*((nav_pushes.QUICK_PUSHES,) if quick else ()))


def rows_of_plans() -> Iterator[Row]:
    """Yield the processor time of a plan over a large floor."""
    warm_up()
    costs = CostMap.of(_floor(), load_model("p3at-sh"))
    begin, end = (ROOM / 2, ROOM / 2), (WIDE - ROOM / 2, DEEP - ROOM / 2)
    seen = np.random.default_rng(0).uniform((0, 0), (WIDE, DEEP), (100, 2))
    took = []
    for _ in range(PLANS):
        began = process_time()
        way = plan(costs.with_obstacles(seen), begin, end)
        took.append(process_time() - began)
        assert isinstance(way, Way), way
    what = f"a plan, {WIDE} x {DEEP} m, with 100 things that are not on the map"
    yield Row(what, float(np.median(took)), "s", 0.2)


def rows_of_goto(*, quick: bool, jobs: int | None) -> Iterator[Row]:
    """Yield going to places: alone, among boxes, among people, and with everything against it."""
    goals, seeds = (QUICK_GOALS, 1) if quick else (GOALS, SEEDS)
    kinds = (
        ("goto", 0, 0, False, 1.0),
        (f"goto, {BOXES} boxes", BOXES, 0, False, 1.0),
        (f"goto, {PEOPLE} people", 0, PEOPLE, False, PEOPLE_SHARE),
        ("goto, hard", 0, PEOPLE, True, PEOPLE_SHARE),
    )
    for model in MODELS:
        alone = [
            Trial(where="office", model=model, seed=seed, goals=goals, sonar=True)
            for seed in range(seeds)
        ]
        together = [outcome for _, outcome in outcomes_of(alone, jobs)]
        yield from rows_of(f"goto by sonar, office {model}", together, SONAR_SHARE)
    for what, boxes, people, hard, share in kinds:
        trials = [
            Trial(
                where=where,
                model=model,
                seed=seed,
                goals=goals,
                boxes=boxes,
                people=people,
                hard=hard,
            )
            for where, model, seed in product(maps(), MODELS, range(seeds))
        ]
        together = []
        for number, (trial, outcome) in enumerate(outcomes_of(trials, jobs), 1):
            together.append(outcome)
            if number % seeds == 0:
                yield from rows_of(f"{what}, {trial.where} {trial.model}", together, share)
                together = []


def _floor() -> LineMap:
    """Return a floor of rooms with a door to each neighbour."""
    walls: list[list[float]] = [
        [0, 0, WIDE, 0],
        [0, DEEP, WIDE, DEEP],
        [0, 0, 0, DEEP],
        [WIDE, 0, WIDE, DEEP],
    ]
    half = (ROOM - DOOR) / 2
    for x, y in product(range(0, WIDE, ROOM), range(0, DEEP, ROOM)):
        if x:
            walls += [[x, y, x, y + half], [x, y + half + DOOR, x, y + ROOM]]
        if y:
            walls += [[x, y, x + half, y], [x + half + DOOR, y, x + ROOM, y]]
    return LineMap(name="floor", walls=np.array(walls, dtype=np.float64))
