"""Ticks of several tasks fall together."""

import asyncio
from math import nextafter

import pytest

from pioneer3.tasks import FastTimeLoop, next_tick, running


@pytest.mark.parametrize("begin", [0.0, 0.3, 7.13, nextafter(1e6, 0.0)])
def test_tasks_of_several_periods_wake_up_together(begin: float) -> None:
    ticks: dict[float, list[float]] = {0.1: [], 0.2: [], 0.5: []}

    async def tick(period: float) -> None:
        while True:
            await next_tick(period)
            ticks[period].append(asyncio.get_running_loop().time())

    async def run() -> None:
        async with running(*map(tick, ticks)):
            await asyncio.sleep(2.05)

    loop = FastTimeLoop(begin)
    try:
        loop.run_until_complete(run())
    finally:
        loop.close()
    for period, times in ticks.items():
        assert len(times) in {int(2.05 / period), int(2.05 / period) + 1}
    for times in ticks.values():
        for time in times:
            assert min(abs(time - other) for other in ticks[0.1]) < 1e-6
