"""A robot has confirmed a stop once its reports say for a while that it stands. Virtual time."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from pioneer3.fleet.spec import FleetRobot
from pioneer3.fleet.stop import HELD, stop_all
from pioneer3.geometry import Twist2
from pioneer3.state import Snapshot
from tests.fleets import robot
from tests.unit.ros.support import seen

EVERY = 0.1
"""The time from one report to the next [s]."""


class Reporting:
    """A robot that reports these speeds once it is told to stop [m/s], and then that it stands."""

    snapshot = None

    def __init__(self, *speeds: float, held: bool = True) -> None:
        self._speeds = list(speeds)
        self.supervisor = SimpleNamespace(taken=False, without_power=held)
        self.told: set[str] = set()

    def stop(self) -> None:
        self.told.add("stop")

    def emergency_stop(self) -> None:
        self.told.add("emergency stop")

    def why_not_moving(self) -> None:
        return None

    async def snapshots(self, patience: float) -> AsyncIterator[Snapshot]:
        while True:
            await asyncio.sleep(EVERY)
            speed = self._speeds.pop(0) if self._speeds else 0.0
            now = asyncio.get_running_loop().time()
            yield replace(seen(twist=Twist2(speed)), stamp=now)

    @asynccontextmanager
    async def connect(self, _: FleetRobot) -> AsyncIterator[Any]:
        yield self


@pytest.mark.parametrize(
    "speeds",
    [(), (0.3,), (0.0, 0.3), (0.0, 0.0, -0.3), (0.0, 0.3, 0.0, 0.3)],
    ids=["it stands", "it brakes", "it moves again", "later", "twice"],
)
async def test_a_robot_that_stands_for_a_moment_only_has_not_confirmed(
    speeds: tuple[float, ...],
) -> None:
    (answer,) = await stop_all([robot(1)], Reporting(*speeds).connect)
    assert answer.ok
    stood_since = (len(speeds) + 1) * EVERY
    assert stood_since + HELD <= answer.seconds + 1e-9 <= stood_since + HELD + EVERY + 1e-9


@pytest.mark.parametrize("emergency", [False, True])
async def test_each_kind_of_stop_is_the_one_that_is_sent(*, emergency: bool) -> None:
    one = Reporting()
    (answer,) = await stop_all([robot(1)], one.connect, emergency=emergency)
    assert answer.ok
    assert one.told == {"emergency stop" if emergency else "stop"}


async def test_an_emergency_stop_that_does_not_latch_is_not_confirmed() -> None:
    (answer,) = await stop_all([robot(1)], Reporting(held=False).connect, emergency=True)
    assert (answer.ok, answer.reached) == (False, True)
