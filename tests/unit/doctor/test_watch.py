"""The line to a robot that is driven, judged as the diagnosis does. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from random import Random

import pytest

from pioneer3 import connect_async
from pioneer3.doctor.facts import Finding, Level
from pioneer3.doctor.watch import LEAST, WINDOW, LineWatch
from tests.faults import Noise
from tests.support import SimulatedRobot


@asynccontextmanager
async def watched(url: str = "memory:host") -> AsyncIterator[tuple[SimulatedRobot, LineWatch]]:
    """Connect, and watch the line."""
    async with SimulatedRobot(url=url) as sim, connect_async(sim.open) as robot:
        yield sim, LineWatch(robot.supervisor)


def judged(watch: LineWatch) -> dict[str, Finding]:
    """Return the findings of this moment by what was looked at."""
    return {finding.check: finding for finding in watch.findings(asyncio.get_running_loop().time())}


async def test_a_good_line_is_fine() -> None:
    async with watched() as (_, watch):
        await asyncio.sleep(WINDOW + 5.0)
        found = judged(watch)
        assert {finding.level for finding in found.values()} == {Level.OK}
        assert found["reports"].found.startswith("10.0 reports/s of 10, longest gap 0.1")
        assert "all good" in found["checksums"].found


async def test_a_moment_is_too_little_to_judge_by() -> None:
    async with watched() as (_, watch):
        await asyncio.sleep(LEAST / 2)
        assert set(judged(watch)) == {"battery"}


@pytest.mark.parametrize(
    ("url", "advice"), [("serial:/dev/ttyUSB0", "screws"), ("tcp://lab:8101", "far end")]
)
async def test_noise_is_found_with_what_to_do_and_forgotten_once_it_is_over(
    url: str, advice: str
) -> None:
    async with watched(url) as (sim, watch):
        sim.to_host = Noise(Random(1), corrupt=0.004)
        await asyncio.sleep(WINDOW)
        found = judged(watch)
        assert found["reports"].level is not Level.OK
        assert found["checksums"].level is Level.FAIL
        assert advice in found["checksums"].advice
        sim.to_host = lambda data: (data,)
        await asyncio.sleep(WINDOW + 1.0)
        assert judged(watch)["checksums"].level is Level.OK


async def test_silence_shows_before_the_link_is_given_up() -> None:
    async with watched() as (sim, watch):
        await asyncio.sleep(LEAST + 1.0)
        sim.silent = True
        await asyncio.sleep(1.5)
        assert judged(watch)["reports"].level is not Level.OK


async def test_a_new_session_is_judged_by_itself() -> None:
    async with watched() as (sim, watch):
        await asyncio.sleep(WINDOW)
        await sim.unplug()
        await asyncio.sleep(5.0)
        assert judged(watch) == {}
        sim.plugged = True
        await asyncio.sleep(WINDOW)
        assert judged(watch)["reports"].level is Level.OK
