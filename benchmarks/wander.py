"""How well robots wander: run as `python -m benchmarks.wander`.

Each run is a whole robot: driver, link, firmware, world with all errors, in virtual time. Prints a
line per run, then what counts beside its bar.
"""

import argparse
import asyncio
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import inf, radians
from pathlib import Path

from benchmarks.table import Row
from pioneer3.behaviors.modes import wander
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile import load_map
from tests.conftest import VirtualTimeLoop
from tests.wandering import Log, cells_of, drive_by_itself, start_in

SHARED = Path(__file__).resolve().parents[2] / "shared" / "maps"
MAPS = {
    "shipped": "office",
    "office": str(SHARED / "office.map"),
    "columbia": str(SHARED / "columbia.map"),
}
COVERED_IN = "office"
"""The map of which 60 % are to be visited within 30 minutes."""
IMPACT, MOVED, COVERED = 0.05, 2.0, 0.6


@dataclass(frozen=True, slots=True)
class Course:
    """A map, a seed, a preset."""

    where: str
    seed: int
    preset: str
    minutes: float
    speed: float | None
    edges: bool

    def run(self) -> Log:
        """Let a robot wander."""
        line_map = load_map(MAPS.get(self.where, self.where))
        realism = Realism()
        if self.edges:
            realism = replace(realism, sonar=replace(realism.sonar, critical=radians(90)))
        drive = drive_by_itself(
            wander(preset=self.preset, speed=self.speed),  # type: ignore[arg-type]
            line_map,
            start_in(line_map, self.seed),
            60 * self.minutes,
            seed=self.seed,
            kernels=Kernels(),
            realism=realism,
        )
        with asyncio.Runner(loop_factory=partial(VirtualTimeLoop, inf)) as runner:
            return runner.run(drive)


def rows(logs: dict[Course, Log]) -> Iterator[Row]:
    """Say what counts."""
    runs = len(logs)
    hit = sum(log.hardest > IMPACT for log in logs.values())
    hits = sum(impact.speed > IMPACT for log in logs.values() for impact in log.impacts)
    stuck = sum(min(log.ways, default=inf) < MOVED for log in logs.values())
    yield Row(f"runs with an impact over {IMPACT} m/s, of {runs}", hit, "", 0)
    yield Row("impacts over that in all", hits, "", 0)
    yield Row(f"runs stuck (a minute under {MOVED:g} m), of {runs}", stuck, "", 0)
    yield Row("ended before their time", sum(log.ended is not None for log in logs.values()), "", 0)
    covered = [
        share(course, log)
        for course, log in logs.items()
        if course.where == COVERED_IN and course.minutes >= 30
    ]
    if covered:
        yield Row("least share of cells visited", min(covered), "", COVERED, more_is_better=True)
        mean = sum(covered) / len(covered)
        yield Row("mean share of cells visited", mean, "", COVERED, more_is_better=True)


def share(course: Course, log: Log) -> float:
    """Return the share of the cells in reach that were visited."""
    reachable = cells_of(load_map(MAPS.get(course.where, course.where)))
    return len(log.cells & reachable) / len(reachable)


def main() -> int:
    """Run all; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--map", action="append", help=f"{', '.join(MAPS)} or a file")
    parser.add_argument("--preset", default="lab", choices=("lab", "aria", "explore"))
    parser.add_argument("--speed", type=float)
    parser.add_argument("--edges", action="store_true", help="sonars hear walls at any angle")
    given = parser.parse_args()
    courses = [
        Course(where, seed, given.preset, given.minutes, given.speed, given.edges)
        for where in given.map or MAPS
        for seed in range(given.first_seed, given.first_seed + given.seeds)
    ]
    logs = {}
    for number, course in enumerate(courses, 1):
        print(f"\r{number}/{len(courses)}", end="", file=sys.stderr, flush=True)
        began = time.perf_counter()
        log = logs[course] = course.run()
        factor = 60 * course.minutes / (time.perf_counter() - began)
        print(
            f"\r{course.where:<9}{course.seed:>3}  x{factor:<4.0f}"
            f" impacts {len(log.impacts):>4}, hardest {log.hardest:.2f} m/s;"
            f" least minute {min(log.ways, default=0):5.1f} m;"
            f" visited {share(course, log):4.0%}{f'; ended: {log.ended}' if log.ended else ''}",
            flush=True,
        )
    missed = 0
    for row in rows(logs):
        print(row)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
