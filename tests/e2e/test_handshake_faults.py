"""The driver against the firmware, over a cable that spoils the handshake. Virtual time."""

import asyncio
from collections.abc import Callable

import pytest

from pioneer3.arcos import commands
from pioneer3.links.memory import bytewise
from pioneer3.runtime.robot import connect_async
from tests.support import First, SimulatedRobot, corrupted, doubled, frame, hold, lost

SYNCS = [bytes.fromhex(sync) for sync in ("fafb03000000", "fafb03010001", "fafb03020002")]


@pytest.mark.parametrize("sync", SYNCS, ids=["SYNC0", "SYNC1", "SYNC2"])
@pytest.mark.parametrize("becomes", [lost, corrupted])
async def test_a_spoilt_sync_costs_one_retry(sync: bytes, becomes: Callable[[bytes], bytes]) -> None:
    fault = First(sync, becomes)
    async with SimulatedRobot(to_robot=fault) as robot:
        async with connect_async(robot.open) as driver:
            assert asyncio.get_running_loop().time() == pytest.approx(0.4, abs=0.06)
            await hold(driver, 0.2)
            assert robot.speed > 0.1
    assert fault.times == 0
