"""Both rules of following, over courses that a person walks: `python -m benchmarks.follow`.

What is counted, and how: `tests/e2e/follow_walk.py`; the courses: `tests/e2e/follow_course.py`.
"""

import argparse
import sys
from collections.abc import Iterator
from multiprocessing import Pool

from benchmarks.table import Row
from pioneer3.behaviors.modes.follow import RULES
from tests.e2e.follow_course import make_course
from tests.e2e.follow_walk import Outcome, Walk

MODELS = "p3at-sh", "p3dx-sh"
SEEDS = 50
KEPT = 95.0
"""Share of the time that the tracking rule must keep the person [%]."""


def rows(seeds: int = SEEDS, models: tuple[str, ...] = MODELS) -> Iterator[Row]:
    """Yield the figures of both rules; only `tracking` has bars to meet."""
    for model in models:
        for rule in RULES.names:
            yield from _rows(f"{model}, {rule}", _outcomes(model, rule, seeds), bound=rule != "lab")


def _rows(what: str, walks: list[Outcome], *, bound: bool) -> Iterator[Row]:
    kept = sorted(walk.share() * 100 for walk in walks)
    lowest, most = (KEPT if bound else 0.0), (0.0 if bound else float("inf"))
    mean = sum(kept) / len(kept)
    yield Row(f"{what}: 0.15 to 0.6 m", mean, "%", lowest, more_is_better=True)
    yield Row(f"{what}: the same, worst seed", kept[0], "%", 0.0, more_is_better=True)
    yield Row(f"{what}: walks with the person lost", _count(walks, "lost"), "", most)
    yield Row(f"{what}: walks that chased walls", _count(walks, "walls"), "", most)
    yield Row(f"{what}: walks with contacts", _count(walks, "contacts"), "", most)
    yield Row(f"{what}: walks ended early", sum(w.ended is not None for w in walks), "", most)


def _count(walks: list[Outcome], what: str) -> int:
    return sum(getattr(walk, what) > 0 for walk in walks)


def _outcomes(model: str, rule: str, seeds: int) -> list[Outcome]:
    outcomes = []
    with Pool() as pool:
        work = [(model, rule, seed) for seed in range(seeds)]
        for outcome in pool.imap(_outcome, work):
            outcomes.append(outcome)
            done = f"\r{model}, {rule}: {len(outcomes)} of {seeds} walks"
            print(done, end="", file=sys.stderr, flush=True)
    print("\r\x1b[K", end="", file=sys.stderr, flush=True)
    return outcomes


def _outcome(work: tuple[str, str, int]) -> Outcome:
    model, rule, seed = work
    walk = Walk(
        course=make_course(seed),
        seed=seed,
        rule="lab" if rule == "lab" else "tracking",
        model=model,
    )
    return walk.run()


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=SEEDS)
    parser.add_argument("--models", nargs="+", default=MODELS)
    given = parser.parse_args()
    missed = 0
    for row in rows(given.seeds, tuple(given.models)):
        print(row, flush=True)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
