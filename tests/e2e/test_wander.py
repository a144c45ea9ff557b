"""Wandering through the whole driver, in an office, with all errors of wheels and sensors.

Simulated sonars hear edges from a metre off, and walls that they do not look at too steeply.
`python -m benchmarks.wander` says how often robots hit something in more and longer runs.
"""

from pathlib import Path

import pytest

from pioneer3.behaviors.modes import Preset, wander
from pioneer3.sim.worldfile import load_map
from tests.wandering import drive_by_itself, start_in

COLUMBIA = Path(__file__).parents[3] / "shared" / "maps" / "columbia.map"
SECONDS = 121.0
"""Two whole minutes, and a little."""


@pytest.mark.parametrize(
    ("preset", "seed"),
    [("lab", 1), pytest.param("explore", 2, marks=pytest.mark.thorough)],
)
async def test_it_meets_nothing(preset: Preset, seed: int) -> None:
    office = load_map("office")
    home = start_in(office, seed)
    log = await drive_by_itself(wander(preset=preset), office, home, SECONDS, seed=seed)
    assert log.ended is None
    assert log.hardest <= 0.05
    assert len(log.ways) == 2
    assert min(log.ways) >= 2.0


@pytest.mark.parametrize(("preset", "seed"), [("lab", 3), ("aria", 3), ("explore", 5)])
async def test_it_never_gets_stuck(preset: Preset, seed: int) -> None:
    office = load_map("office")
    log = await drive_by_itself(
        wander(preset=preset), office, start_in(office, seed), SECONDS, seed=seed
    )
    assert log.ended is None
    assert len(log.ways) == 2
    assert min(log.ways) >= 2.0


@pytest.mark.skipif(not COLUMBIA.exists(), reason="the map is not here")
async def test_it_finds_a_way_out_where_avoiders_turn_for_ever() -> None:
    narrow = load_map(COLUMBIA)
    log = await drive_by_itself(wander(), narrow, start_in(narrow, 4), SECONDS, seed=4)
    assert log.ended is None
    assert min(log.ways) >= 2.0
