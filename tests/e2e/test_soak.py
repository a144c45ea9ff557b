"""Many robots, many hosts, for long: nothing leaks, drifts or gets stuck.

At full length, an hour and a thousand visits: `python -m benchmarks.soak`.
"""

from dataclasses import replace
from importlib.util import find_spec

import pytest

from tests.e2e.soak_hour import endure, the_map
from tests.e2e.soak_visits import VISITS, visit

SECONDS = 60.0 if find_spec("numba") else 5.0


def test_twenty_robots_run_without_a_leak_or_a_drift() -> None:
    endured = endure(the_map(), SECONDS)
    assert endured.reports == endured.owed > 9 * 20 * SECONDS
    assert endured.time_error == pytest.approx(0, abs=1e-9)
    assert endured.troubles == ()
    assert endured.spoilt == 0
    assert endured.commands > 100 * SECONDS
    assert endured.grown_blocks < 2000  # one leaked with every command would make 9000


def test_the_same_seed_gives_the_same_bytes_and_another_one_others() -> None:
    first, second = (endure(the_map(), 3.0, robots=5, seed=1) for _ in range(2))
    assert replace(first, grown_blocks=0) == replace(second, grown_blocks=0)
    assert endure(the_map(), 3.0, robots=5, seed=2).digest != first.digest


@pytest.mark.realtime
async def test_a_hundred_visits_leave_nothing_behind() -> None:
    visited = await visit(the_map(), 100)
    assert visited.visits.total() == 120  # the last twenty look whether every port still serves
    assert len(visited.visits) == len(VISITS)
    assert visited.stuck_ports == ()
    assert visited.troubles == ()
    assert (visited.grown_files, visited.grown_tasks) == (0, 0)
    assert visited.grown_objects < 500  # a connection that is kept has dozens, and its tasks
