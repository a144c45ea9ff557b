"""Texts for all clients, each made once. A slow client gets the newest only."""

import asyncio
from collections.abc import Callable, Sequence
from math import isfinite
from typing import Protocol

from pioneer3.geometry import Pose2
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.state import Scan
from pioneer3.tasks import running
from pioneer3.units import MM
from pioneer3.web.messages import ClassRobots, LaserSweep, Robots, Scans, encode

PERIOD = 0.04
"""Least time between two frames [s]."""
GATHER = 0.003
"""The first snapshot after a pause waits so long for those of other robots [s]."""
SWEEP_PERIOD = 0.095
"""Least time between two sweeps of a laser that are sent [s]."""
NO_SNAPSHOTS = Robots(())
END = "]}"


class Subscriber(Protocol):
    """A client that takes texts from channels."""

    def wake(self) -> None:
        """Look for new texts."""


class Channel(Protocol):
    """Something that changes, as texts for pages."""

    @property
    def version(self) -> int:
        """Counts the changes."""

    def since(self, seen: int) -> list[str]:
        """Return the texts newer than version `seen`; 0 for all."""


class RetainedChannel:
    """Keeps a text for each key; clients are sent it when it changes."""

    def __init__(self) -> None:
        self.version = 0
        self._texts: dict[str, tuple[int, str]] = {}

    def put(self, key: str, text: str) -> bool:
        """Make `text` the newest of `key`; return whether it differs from the one before."""
        if key in self._texts and self._texts[key][1] == text:
            return False
        self.version += 1
        self._texts[key] = self.version, text
        return True

    def forget(self, key: str) -> None:
        """Drop the text of `key`."""
        self._texts.pop(key, None)

    def since(self, seen: int) -> list[str]:
        """Return the texts that are newer, by the age of their keys: robots, then their states."""
        return [text for version, text in self._texts.values() if version > seen]


class FrameChannel:
    """The newest part of each robot, in one frame for all clients that are equally up to date.

    `flushed` is called when there is a new frame, at least a `period` after the last [s]. The last
    field of the `empty` message is the list of parts.
    """

    def __init__(
        self,
        flushed: Callable[[], None],
        empty: Robots | Scans | ClassRobots = NO_SNAPSHOTS,
        period: float = PERIOD,
    ) -> None:
        self.version = 0
        self._period = period
        self._start = encode(empty).removesuffix(END)
        self._flushed = flushed
        self._parts: dict[tuple[int, int], tuple[int, str]] = {}
        self._frames: dict[int, list[str]] = {}
        self._loop = asyncio.get_running_loop()
        self._flushed_at = float("-inf")
        self._due: asyncio.TimerHandle | None = None

    def put(self, robot: int, text: str, part: int = 0) -> None:
        """Take a robot's newest part, or one of several; it goes out within the period."""
        self._parts[robot, part] = self.version + 1, text
        self._frames.clear()
        if self._due is None:
            at = max(self._loop.time() + GATHER, self._flushed_at + self._period)
            self._due = self._loop.call_at(at, self._flush)

    def forget(self, robot: int) -> None:
        """Drop the parts of a robot that is gone."""
        self._parts = {key: part for key, part in self._parts.items() if key[0] != robot}
        self._frames.clear()

    def since(self, seen: int) -> list[str]:
        """Return a frame with the parts that are newer than version `seen`; nothing without any."""
        frame = self._frames.get(seen)
        if frame is None:
            newer = [text for version, text in self._parts.values() if version > seen]
            frame = [f"{self._start}{','.join(newer)}{END}"] if newer else []
            self._frames[seen] = frame
        return frame

    def _flush(self) -> None:
        self._due = None
        self._flushed_at = self._loop.time()
        self.version += 1
        self._flushed()


class ScanChannel(FrameChannel):
    """The newest sweep of each laser; lasers are on while a client subscribes."""

    def __init__(self, flushed: Callable[[], None]) -> None:
        super().__init__(flushed, Scans(()))
        self._subscribers: set[int] = set()
        self._wanted, self._unwanted = asyncio.Event(), asyncio.Event()
        self._unwanted.set()

    def subscribe(self, client: int, *, on: bool) -> None:
        """Add a client by its number, or take it out."""
        (self._subscribers.add if on else self._subscribers.discard)(client)
        to_set, to_clear = self._wanted, self._unwanted
        if not self._subscribers:
            to_set, to_clear = to_clear, to_set
        to_set.set()
        to_clear.clear()

    @property
    def is_wanted(self) -> bool:
        """Whether any client subscribes."""
        return bool(self._subscribers)

    def has(self, client: int) -> bool:
        """Whether a client subscribes."""
        return client in self._subscribers

    async def follow(
        self, robot: int, lasers: Sequence[LaserSource], sensor_in_map: Callable[[Scan], Pose2]
    ) -> None:
        """Keep the lasers of a robot on while a client subscribes; ends by cancellation."""
        while True:
            await self._wanted.wait()
            async with running(
                *(self._read(robot, n, laser, sensor_in_map) for n, laser in enumerate(lasers))
            ):
                await self._unwanted.wait()
            self.forget(robot)

    async def _read(
        self, robot: int, number: int, laser: LaserSource, sensor_in_map: Callable[[Scan], Pose2]
    ) -> None:
        clock = asyncio.get_running_loop().time
        if not laser.presence.there:
            return
        due = clock()
        async for scan in laser.values():
            if clock() >= due:
                due = clock() + SWEEP_PERIOD
                part = sweep(robot, scan, sensor_in_map(scan), number)
                self.put(robot, encode(part), number)


def sweep(robot: int, scan: Scan, sensor: Pose2, laser: int = 0) -> LaserSweep:
    """Return the message part for a sweep of a robot's laser, which is at `sensor` of the map."""
    angles, several = scan.angles, len(scan.angles) > 1
    return LaserSweep(
        robot,
        laser,
        (round(sensor.x / MM), round(sensor.y / MM), round(sensor.theta * 1000)),
        round(angles[0], 6) if angles else 0.0,
        round((angles[-1] - angles[0]) / (len(angles) - 1), 7) if several else 0.0,
        tuple(round(metres / MM) if isfinite(metres) else 0 for metres in scan.ranges),
    )
