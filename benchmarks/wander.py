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
from itertools import product
from math import inf, radians
from pathlib import Path

from benchmarks.table import Row
from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.modes import wander
from pioneer3.behaviors.modes.wander import PRESETS
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.models.lasers import LASERS
from pioneer3.sim.kernels import Kernels
from pioneer3.sim.realism import Realism
from pioneer3.sim.worldfile import WorldFile, load_world
from tests.conftest import VirtualTimeLoop
from tests.wandering import (
    IN_BAND,
    MODEL,
    Guide,
    Log,
    RandomGoals,
    RandomStick,
    Thing,
    cells_of,
    drive_by_itself,
    start_in,
)

SHARED = Path(__file__).resolve().parents[2] / "shared" / "maps"
MAPS = {
    "shipped": "office",
    "office": str(SHARED / "office.map"),
    "columbia": str(SHARED / "columbia.map"),
}
COVERED_IN = "office"
"""The map of which 60 % are to be visited within 30 minutes."""
GOTO, BY_HAND = "goto", "by-hand"
"""Modes in place of a preset: to one place after the other, and a stick that is pushed about."""
IMPACT, MOVED, COVERED = 0.05, 2.0, 0.6


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """A world, a seed, a preset, a robot and its laser."""

    where: str
    seed: int
    preset: str
    model: str
    laser: str | None
    lossy: bool
    minutes: float
    speed: float | None
    edges: bool

    def __str__(self) -> str:
        return (
            f"{self.where:<9}{self.model:<8}{self.preset:<8}{self.laser or '-':<11}{self.seed:>3}"
        )

    @property
    def world(self) -> WorldFile:
        """Where it is."""
        return load_world(MAPS.get(self.where, self.where))

    def run(self) -> Log:
        """Let a robot wander."""
        world = self.world
        line_map = world.line_map()
        things: list[Thing] = [*world.movable, *world.people]
        realism = Realism()
        if self.edges:
            realism = replace(realism, sonar=replace(realism.sonar, critical=radians(90)))
        home = start_in(line_map, self.seed, self.model, things)
        drive = drive_by_itself(
            self._mode(line_map, home),
            line_map,
            home,
            60 * self.minutes,
            seed=self.seed,
            kernels=Kernels(),
            realism=realism,
            model=self.model,
            things=things,
            laser=self.laser,
            lossy=self.lossy,
        )
        with asyncio.Runner(loop_factory=partial(VirtualTimeLoop, inf)) as runner:
            return runner.run(drive)

    def _mode(self, line_map: LineMap, home: Pose2) -> Stack | Guide:
        if self.preset == GOTO:
            return RandomGoals(line_map, home, self.seed, self.model, self.speed or 0.4)
        if self.preset == BY_HAND:
            return RandomStick(self.seed)
        return wander(preset=self.preset, speed=self.speed)  # type: ignore[arg-type]


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
    reachable = cells_of(course.world.line_map(), course.model)
    return len(log.cells & reachable) / len(reachable)


def main() -> int:
    """Run all; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--map", action="append", help=f"{', '.join(MAPS)}, a world or a file")
    parser.add_argument("--preset", action="append", choices=(*PRESETS.names, GOTO, BY_HAND))
    parser.add_argument("--model", action="append", help=f"of the robot, by default {MODEL}")
    parser.add_argument("--laser", action="append", choices=(IN_BAND, *LASERS))
    parser.add_argument("--lossy", action="store_true", help="lose the laser 10 s every minute")
    parser.add_argument("--speed", type=float)
    parser.add_argument("--edges", action="store_true", help="sonars hear walls at any angle")
    parser.add_argument("--impacts", action="store_true", help="print where, and how fast")
    given = parser.parse_args()
    lasers = given.laser or [None]
    courses = [
        Course(
            where=where,
            seed=seed,
            preset=preset,
            model=model,
            laser=lasers[(number + seed) % len(lasers)],
            lossy=given.lossy,
            minutes=given.minutes,
            speed=given.speed,
            edges=given.edges,
        )
        for seed in range(given.first_seed, given.first_seed + given.seeds)
        for number, (where, model, preset) in enumerate(
            product(given.map or MAPS, given.model or [MODEL], given.preset or ["lab"])
        )
    ]
    logs = {}
    for number, course in enumerate(courses, 1):
        print(f"\r{number}/{len(courses)}", end="", file=sys.stderr, flush=True)
        began = time.perf_counter()
        log = logs[course] = course.run()
        factor = 60 * course.minutes / (time.perf_counter() - began)
        print(
            f"\r{course}  x{factor:<4.0f}"
            f" impacts {len(log.impacts):>4}, hardest {log.hardest:.2f} m/s;"
            f" least minute {min(log.ways, default=0):5.1f} m;"
            f" visited {share(course, log):4.0%}{f'; ended: {log.ended}' if log.ended else ''}",
            flush=True,
        )
        for impact in log.impacts if given.impacts else ():
            print(f"  {impact}", flush=True)
    missed = 0
    for row in rows(logs):
        print(row)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
