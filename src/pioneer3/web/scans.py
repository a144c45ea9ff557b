"""What the robots' lasers see, for the pages that want to know; on only while one does."""

import asyncio
from collections.abc import Callable
from math import isfinite
from typing import Any

from pioneer3.geometry import Pose2
from pioneer3.state import Scan
from pioneer3.tasks import running
from pioneer3.units import MM
from pioneer3.web.messages import encode
from pioneer3.web.snapshots import Snapshots
from pioneer3.web.station import Station

PERIOD = 0.095
"""Least time between two sweeps of a laser that pages are told [s]."""
START = '{"type":"scans","scans":['


class Scans(Snapshots):
    """The newest sweep of each laser, as :class:`Snapshots` has the robots' snapshots."""

    def __init__(self, flushed: Callable[[], None]) -> None:
        super().__init__(flushed, START)
        self._wanted_by: set[int] = set()
        self._wanted, self._unwanted = asyncio.Event(), asyncio.Event()
        self._unwanted.set()

    def want(self, guest: int, *, wanted: bool) -> None:
        """Note whether a guest wants to know."""
        (self._wanted_by.add if wanted else self._wanted_by.discard)(guest)
        on, off = (
            (self._wanted, self._unwanted) if self._wanted_by else (self._unwanted, self._wanted)
        )
        on.set()
        off.clear()

    def wanted_by(self, guest: int) -> bool:
        """Whether a guest wants to know."""
        return guest in self._wanted_by

    async def follow(self, station: Station) -> None:
        """Keep the laser of a robot on while anybody wants it; ends by cancellation."""
        while True:
            await self._wanted.wait()
            async with running(self._read(station)):
                await self._unwanted.wait()
            self.forget(station.number)

    async def _read(self, station: Station) -> None:
        laser, clock = station.robot.devices.laser, asyncio.get_running_loop().time
        if not laser.presence.there:
            return
        due = clock()
        async for scan in laser.values():
            if clock() >= due:
                due = clock() + PERIOD
                self.put(
                    station.number, encode(sweep(station.number, scan, station.seen_from(scan)))
                )


def sweep(robot: int, scan: Scan, sensor: Pose2) -> dict[str, Any]:
    """Say what a laser at `sensor` of the map saw.

    `pose` is in whole millimetres and milliradians, `ranges` are in millimetres, 0 where nothing
    answered, from angle `first` on in steps of `step` [rad].
    """
    angles = scan.angles
    return {
        "robot": robot,
        "pose": (round(sensor.x / MM), round(sensor.y / MM), round(sensor.theta * 1000)),
        "first": round(angles[0], 6) if angles else 0.0,
        "step": round((angles[-1] - angles[0]) / (len(angles) - 1), 7) if len(angles) > 1 else 0.0,
        "ranges": [round(metres / MM) if isfinite(metres) else 0 for metres in scan.ranges],
    }
