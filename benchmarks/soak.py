"""An hour of twenty robots as fast as they can, and a thousand visits: `python -m benchmarks.soak`.

Prints what came of it beside what must come of it. The tests run both in short.
"""

import argparse
import asyncio
import time
from collections.abc import Iterator

from benchmarks.table import Row
from tests.e2e.soak_hour import endure, the_map
from tests.e2e.soak_visits import visit

ROBOTS = 20


def rows(hours: float = 1.0, visits: int = 1000) -> Iterator[Row]:
    """Yield the figures."""
    yield from rows_of_hours(hours)
    yield from rows_of_visits(visits)


def rows_of_hours(hours: float) -> Iterator[Row]:
    """Run robots in simulated time."""
    began = time.perf_counter()
    endured = endure(the_map(), hours * 3600, robots=ROBOTS)
    took = time.perf_counter() - began
    what = f"{ROBOTS} robots, {hours:g} h"
    yield Row(f"{what}: real-time factor", endured.seconds / took, "x", 10, more_is_better=True)
    yield Row(f"{what}: sessions", endured.sessions, "", 1, more_is_better=True)
    yield Row(f"{what}: commands", endured.commands, "", 1, more_is_better=True)
    yield Row(f"{what}: standard reports", endured.reports, "", endured.owed, more_is_better=True)
    yield Row(f"{what}: more than were owed", endured.reports - endured.owed, "", 0)
    yield Row(f"{what}: error of the world's clock", abs(endured.time_error) * 1e6, "us", 1)
    yield Row(f"{what}: not finite, outside, in a wall", len(endured.troubles), "", 0)
    yield Row(f"{what}: bytes spoilt", endured.spoilt, "", 0)
    yield Row(f"{what}: pieces of memory more", endured.grown_blocks, "", 2000)


def rows_of_visits(visits: int) -> Iterator[Row]:
    """Let clients come and go over TCP."""
    visited = asyncio.run(visit(the_map(), visits, robots=ROBOTS))
    what = f"{visits} visits over TCP"
    served = visited.visits.total()
    yield Row(
        f"{what}: served, then {ROBOTS} more", served, "", visits + ROBOTS, more_is_better=True
    )
    yield Row(f"{what}: ports stuck", len(visited.stuck_ports), "", 0)
    yield Row(f"{what}: not finite, outside", len(visited.troubles), "", 0)
    yield Row(f"{what}: files more", visited.grown_files, "", 0)
    yield Row(f"{what}: tasks more", visited.grown_tasks, "", 0)
    yield Row(f"{what}: objects more", visited.grown_objects, "", visits / 2)


def main() -> int:
    """Print the table; return 1 if something is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hours", type=float, default=1.0)
    parser.add_argument("--visits", type=int, default=1000)
    options = parser.parse_args()
    missed = 0
    for row in rows(options.hours, options.visits):
        print(row, flush=True)
        missed += not row.met
    return int(missed > 0)


if __name__ == "__main__":
    raise SystemExit(main())
