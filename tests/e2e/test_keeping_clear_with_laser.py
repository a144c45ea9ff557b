"""Modes with a laser among glass, thin legs, a black counter and people. Virtual time.

`python -m benchmarks.wander --laser in-band` does the same in more and longer runs.
"""

from collections.abc import Callable
from functools import cache

import pytest

from pioneer3 import Robot
from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.modes import Preset, wander
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap
from pioneer3.sim.worldfile import load_world
from tests.wandering import (
    IN_BAND,
    Guide,
    Log,
    RandomGoals,
    RandomStick,
    Thing,
    drive_by_itself,
    start_in,
)

IMPACT = 0.05
SECONDS = 61.0


@cache
def place(name: str) -> tuple[LineMap, tuple[Thing, ...]]:
    """Return the walls of a world, and its crates and people."""
    world = load_world(name)
    return world.line_map(), (*world.movable, *world.people)


async def drive(
    mode: Callable[[LineMap, Pose2], Stack | Guide],
    model: str,
    seed: int,
    laser: str = IN_BAND,
    *,
    where: str = "cafe",
    seconds: float = SECONDS,
    lossy: bool = False,
) -> Log:
    """Let a mode drive for a while."""
    line_map, things = place(where)
    home = start_in(line_map, seed, model, things)
    return await drive_by_itself(
        mode(line_map, home),
        line_map,
        home,
        seconds,
        seed=seed,
        model=model,
        things=things,
        laser=laser,
        lossy=lossy,
    )


@pytest.mark.parametrize(
    ("preset", "model", "seed"),
    [("lab", "p3at-sh", 1), ("aria", "p3dx-sh", 2), ("explore", "p3at-sh", 3)],
)
async def test_wandering_among_tables_hits_nothing(preset: Preset, model: str, seed: int) -> None:
    log = await drive(lambda line_map, home: wander(preset=preset), model, seed)
    assert log.ended is None
    assert log.hardest <= IMPACT
    assert sum(log.ways) > 1.0


async def test_a_laser_that_is_lost_for_a_while_leaves_the_sonars() -> None:
    lost: list[bool] = []

    def wandering(line_map: LineMap, home: Pose2) -> Guide:
        started: list[Stack] = []

        def guide(robot: Robot) -> Stack | None:
            lost.append(robot.laser.lost is not None)
            if not started:
                started.append(wander(preset="aria"))
                return started[0]
            return None

        return guide

    log = await drive(wandering, "p3dx-sh", 4, "lms-200", where="lab", seconds=48.0, lossy=True)
    assert any(lost)
    assert not lost[0]
    assert not lost[-1]
    assert log.hardest <= IMPACT


async def test_going_from_place_to_place_hits_nothing() -> None:
    log = await drive(
        lambda line_map, home: RandomGoals(line_map, home, 6, "p3dx-sh"), "p3dx-sh", 6
    )
    assert log.hardest <= IMPACT
    assert sum(log.ways) > 1.0


@pytest.mark.parametrize(
    ("model", "seed"), [("p3at-sh", 0), pytest.param("p3dx-sh", 1, marks=pytest.mark.thorough)]
)
async def test_a_stick_that_is_pushed_about_hits_nothing(model: str, seed: int) -> None:
    log = await drive(lambda line_map, home: RandomStick(seed), model, seed)
    assert log.hardest <= IMPACT
