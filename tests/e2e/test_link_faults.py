"""Our driver at a simulated robot with a faulty cable. Virtual time."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from pioneer3 import connect_async
from pioneer3.links.memory import MemoryLink, null_modem
from pioneer3.models import load_model
from pioneer3.sim.body import Body
from pioneer3.sim.firmware import Firmware
from pioneer3.sim.server import Simulation
from pioneer3.sim.server.faults import LinkFaults
from pioneer3.sim.world import World
from tests.support import hold, until


class Lab:
    """A robot whose cable can be spoiled."""

    def __init__(self) -> None:
        self.body = Body(load_model("p3dx-sh"))
        self.world = World(None, [self.body])
        self.simulation = Simulation(self.world, [Firmware(self.world, self.body)])
        (self.port,) = self.simulation.ports
        self.tasks = [asyncio.ensure_future(self.simulation.run())]

    async def open(self) -> MemoryLink:
        ours, theirs = null_modem()
        self.tasks.append(asyncio.ensure_future(self.port.serve(theirs)))
        return ours


@pytest.fixture
async def lab() -> AsyncIterator[Lab]:
    here = Lab()
    yield here
    for task in here.tasks:
        task.cancel()
    await asyncio.gather(*here.tasks, return_exceptions=True)


async def test_a_noisy_cable_slows_nobody_down(lab: Lab) -> None:
    lab.port.faults = LinkFaults.parse("drop=0.03,corrupt=0.002,delay=0.06,seed=3")
    async with connect_async(lab.open) as driver:
        await hold(driver, 0.3, seconds=20)
        assert driver.snapshot is not None
        assert driver.snapshot.link.bad_checksums > 10
        assert driver.snapshot.link.sessions == 1
        assert lab.body.robot_in_world.x > 0.8 * 0.3 * 20


async def test_the_same_seed_spoils_as_much_again(lab: Lab) -> None:
    rejected = []
    for _ in range(2):
        lab.port.faults = LinkFaults(corrupt=0.01, seed=5)
        async with connect_async(lab.open) as driver:
            await asyncio.sleep(10)
            assert driver.snapshot is not None
            rejected.append(driver.snapshot.link.bad_checksums)
        await until(lambda: not lab.port.connected)
    assert rejected[0] > 20
    assert rejected[0] == pytest.approx(rejected[1], abs=8)  # it may begin in another tick


async def test_a_frozen_cable_stops_the_robot_and_a_thawed_one_lets_it_go_on(lab: Lab) -> None:
    async with connect_async(lab.open) as driver:
        assert await hold(driver, 0.3) == 0
        lab.port.faults.frozen = True
        await asyncio.sleep(2.5)
        assert lab.body.speeds[0] == 0
        assert lab.port.connected
        lab.port.faults.frozen = False
        await until(lambda: driver.snapshot is not None)
        await asyncio.sleep(1)
        assert await hold(driver, 0.3) == 0
        assert lab.body.speeds[0] == pytest.approx(0.3, abs=0.01)


async def test_a_cable_pulled_out_and_put_back_is_found_again(lab: Lab) -> None:
    async with connect_async(lab.open) as driver:
        assert await hold(driver, 0.3) == 0
        lab.port.faults.unplug()
        await until(lambda: driver.snapshot is None)
        await asyncio.sleep(5)
        assert lab.body.speeds[0] == 0
        assert not lab.simulation.ports[0].is_open
        lab.port.faults.plug_in()
        await until(lambda: driver.snapshot is not None)
        await asyncio.sleep(1)
        assert await hold(driver, 0.3) == 0
