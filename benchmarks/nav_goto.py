"""Going to places of a map: run as `python -m benchmarks.nav_goto`.

Each pair of places is driven by a whole robot in virtual time (`nav_goals.py`). Prints the drives
that failed, then the figures beside their bars.
"""

import argparse
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import product
from multiprocessing import Pool

import numpy as np

from benchmarks.nav_goals import MAPS, MODELS, Drive, Outcome, Trial, maps, run
from benchmarks.table import Row

TOP = 0.75
"""Of both robots, as they are delivered [m/s]."""
SONAR_SHARE, FAST = 0.9, 0.05
"""Of the goals that a robot without a laser reaches, and speed of the contacts that it must not
have [m/s]."""
TICK, WORST_TICK = 3.0, 12.0
"""Bars of the processor time of navigation in a tick [ms]."""


def rows_of(what: str, outcomes: Sequence[Outcome], share: float = 1.0) -> Iterator[Row]:
    """Yield the figures of some trials of the same kind.

    Args:
        what: The trials, in a few words.
        outcomes: Of them.
        share: Of the goals that is to be reached.
    """
    drives = [each for outcome in outcomes for each in outcome.drives]
    done = [each for each in drives if each.arrived]
    missed = len(drives) - len(done)
    allowed = round(len(drives) * (1 - share), 6)
    yield Row(f"{what}: goals not reached, of {len(drives)}", missed, "", allowed)
    contacts = [speed for each in drives for speed in each.contacts]
    yield Row(f"{what}: contacts while it moves", len(contacts), "", 0)
    if contacts:
        fast = sum(speed > FAST for speed in contacts)
        yield Row(f"{what}: of them above {FAST:g} m/s", fast, "", 0)
        yield Row(f"{what}: hardest", max(contacts), "m/s", None)
    ticks = 1000 * np.concatenate([outcome.ticks for outcome in outcomes])
    yield Row(f"{what}: a tick, median", float(np.median(ticks)), "ms", TICK)
    yield Row(f"{what}: a tick, 99.9 %", float(np.quantile(ticks, 0.999)), "ms", WORST_TICK)
    if done:
        yield from _rows_of_ways(what, done, alone=share == 1.0)


def _rows_of_ways(what: str, done: Sequence[Drive], *, alone: bool) -> Iterator[Row]:
    ratio = sum(each.way for each in done) / sum(each.shortest for each in done)
    yield Row(f"{what}: way by the shortest", ratio, "", 1.05 if alone else None)
    times = np.array([each.seconds / (each.shortest / TOP) for each in done])
    median, most = float(np.median(times)), float(np.quantile(times, 0.95))
    yield Row(f"{what}: time at top speed, median", median, "", 1.6 if alone else None)
    yield Row(f"{what}: the same, 95 %", most, "", 2.5 if alone else None)
    off, turned = max(each.off for each in done), max(each.turned for each in done)
    yield Row(f"{what}: off the goal, worst", 100 * off, "cm", 5)
    yield Row(f"{what}: off the heading, worst", np.degrees(turned), "deg", 3)


def outcomes_of(
    trials: Sequence[Trial], jobs: int | None, *, verbose: bool = False, times: int = 1
) -> Iterator[tuple[Trial, Outcome]]:
    """Yield the outcome of each trial, in order, from a pool of processes."""
    with Pool(jobs, maxtasksperchild=1) as pool:
        work = partial(run, verbose=verbose, times=times)
        yield from zip(trials, pool.imap(work, trials), strict=True)


def main() -> int:
    """Run all; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--map", action="append", choices=MAPS)
    parser.add_argument("--model", action="append", choices=MODELS)
    parser.add_argument("--goals", type=int, default=50)
    parser.add_argument("--seeds", type=int, default=1, help="how many; %(default)s")
    parser.add_argument("--seed", type=int, default=0, help="the first; %(default)s")
    parser.add_argument("--boxes", type=int, default=0)
    parser.add_argument("--people", type=int, default=0)
    parser.add_argument("--hard", action="store_true", help="laser and odometry err more")
    parser.add_argument("--sonar", action="store_true", help="a robot without a laser")
    parser.add_argument("--jobs", type=int, default=1, help="processes; %(default)s")
    parser.add_argument("--times", type=int, default=1, help="the least time of a tick counts")
    parser.add_argument("--verbose", action="store_true")
    given, missed = parser.parse_args(), 0
    trials = [
        Trial(
            where=where,
            model=model,
            seed=seed,
            goals=given.goals,
            boxes=given.boxes,
            people=given.people,
            hard=given.hard,
            sonar=given.sonar,
        )
        for where, model, seed in product(
            given.map or maps(), given.model or MODELS, range(given.seed, given.seed + given.seeds)
        )
    ]
    share = 48 / 50 if given.people or given.hard else 1.0
    share = SONAR_SHARE if given.sonar else share
    outcomes, options = [], {"verbose": given.verbose, "times": given.times}
    for trial, outcome in outcomes_of(trials, given.jobs, **options):
        outcomes.append(outcome)
        for row in rows_of(str(trial), [outcome], share):
            print(row, flush=True)
            missed += not row.met
    if len(outcomes) > 1:
        for row in rows_of("all", outcomes, share):
            print(row)
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
