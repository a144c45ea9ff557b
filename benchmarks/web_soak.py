"""Viewers who come and go for hours, in virtual time: does anything stay behind?"""

import asyncio
import gc
import tracemalloc
from collections.abc import Iterator
from functools import partial
from math import inf
from random import Random

from benchmarks.table import Row
from tests.conftest import VirtualTimeLoop
from tests.unit.web.browser import Browser, Product, product

HOURS = 0.5
WARM_UP = 900.0
"""Until caches and trails are as large as they get [s]."""
PAUSE = 20.0
"""Between two comings or goings, on average [s]."""
MOST = 8


class Forgetful(Browser):
    """A browser that keeps the last few messages only."""

    def forget(self) -> None:
        """Keep ten messages."""
        del self.heard[:-10]


async def endure(the: Product, seconds: float, random: Random) -> tuple[int, int]:
    """Let viewers come, drive, and go; return how many came and how many snapshots they got."""
    loop = asyncio.get_running_loop()
    here: list[Forgetful] = []
    came, end = 0, loop.time() + seconds
    first = the.robot.snapshot.sequence if the.robot.snapshot else 0
    while loop.time() < end:
        if here and (len(here) == MOST or random.random() < 0.5):
            await here.pop(random.randrange(len(here))).leave()
        else:
            here.append(await Forgetful(the.app).__aenter__())
            came += 1
            here[-1].drive(random.uniform(-0.1, 0.1), random.uniform(-1, 1))
        for viewer in here:
            viewer.say("ping", t=0)
        until = loop.time() + random.uniform(0, 2 * PAUSE)
        while loop.time() < until:
            await asyncio.sleep(5.0)
            for viewer in here:
                viewer.forget()
    for viewer in here:
        await viewer.leave()
    last = the.robot.snapshot.sequence if the.robot.snapshot else 0
    return came, last - first


async def soak(hours: float) -> tuple[int, int, int, int]:
    """Return visits, snapshots, and by how much memory [bytes] and tasks have grown."""
    random = Random(1)
    async with product() as the:
        await endure(the, WARM_UP, random)
        gc.collect()
        tracemalloc.start()
        await endure(the, WARM_UP, random)
        _forget_wires(the)
        gc.collect()
        before, tasks = tracemalloc.get_traced_memory()[0], len(asyncio.all_tasks())
        came, snapshots = await endure(the, hours * 3600, random)
        _forget_wires(the)
        gc.collect()
        grown = tracemalloc.get_traced_memory()[0] - before
        tracemalloc.stop()
        return came, snapshots, grown, len(asyncio.all_tasks()) - tasks


def _forget_wires(the: Product) -> None:
    """Drop what the test's cable has kept."""
    for wire in the.sim.wires:
        wire.chunks.clear()


def rows_of_soak(hours: float = HOURS) -> Iterator[Row]:
    """Yield the figures."""
    with asyncio.Runner(loop_factory=partial(VirtualTimeLoop, inf)) as runner:
        came, snapshots, grown, tasks = runner.run(soak(hours))
    what = f"{hours:g} h of viewers who come and go"
    yield Row(f"{what}: visits", came, "", 80 * hours, more_is_better=True)
    yield Row(f"{what}: snapshots", snapshots, "", 35_000 * hours, more_is_better=True)
    yield Row(f"{what}: memory more", grown / 1024, "KiB", 64)
    yield Row(f"{what}: tasks more", tasks, "", 0)
