"""A simulator at the other end of the link: its map, and where the robot truly is."""

import asyncio
import logging
from collections.abc import Callable
from contextlib import suppress
from math import radians
from pathlib import Path

from pioneer3.arcos.commands import Request, RequestSimStat, SimCtrl, SimOperation
from pioneer3.arcos.reports import MapChanged, Report, SimStat
from pioneer3.errors import CommandError, ConfigError
from pioneer3.geometry import Pose2, wrap
from pioneer3.robot.identity import is_simulator
from pioneer3.runtime.robot import Robot
from pioneer3.sim.maps import LineMap, shipped_maps
from pioneer3.sim.worldfile import load_world, shipped_worlds
from pioneer3.tasks import running
from pioneer3.units import MM

log = logging.getLogger(__name__)

ENDINGS = (".map", ".toml", ".yaml")


class WorldElsewhere:
    """What a simulator tells of its world; nothing of a robot that is real, or of others.

    A simulator names its map; it is drawn if a map of that name ships, or lies in this program's
    folder. No other files are read for it.

    Args:
        robot: The driver.
        line_map: The map, whatever the simulator says; `None` takes the simulator's.
        tell: Told in words if there is no map of the simulator's name.

    Attributes:
        map: The map, `None` while none is known.
        pose: The robot's true pose in it, `None` while none is told.
    """

    def __init__(self, robot: Robot, line_map: LineMap | None, tell: Callable[[str], None]) -> None:
        self.map = line_map
        self.pose: Pose2 | None = None
        self._robot = robot
        self._given = line_map is not None
        self._tell = tell
        self._names: asyncio.Queue[str] = asyncio.Queue()

    async def follow(self) -> None:
        """Ask at every connection, and listen; ends by cancellation."""
        forget = self._robot.supervisor.reports.hand_to(self._take, MapChanged, SimStat)
        try:
            self._ask()
            async with running(self._load()):
                async for _ in self._robot.supervisor.status.values():
                    self._ask()
        finally:
            forget()

    def _ask(self) -> None:
        self.pose = None  # until it is told anew: the robot may have been put elsewhere
        info = self._robot.supervisor.info
        if info is not None and is_simulator(info):
            with suppress(CommandError):  # no session is open
                self._robot.send(SimCtrl(SimOperation.REQUEST_INFO))
                self._robot.send(RequestSimStat(Request.STREAM))

    def _take(self, report: Report, stamp: float) -> None:
        if isinstance(report, SimStat):
            heading = wrap(radians(report.heading_deg))
            self.pose = Pose2(report.x_mm * MM, report.y_mm * MM, heading)
        elif isinstance(report, MapChanged) and (report.by_user or report.reloaded):
            self._names.put_nowait(report.file_name)

    async def _load(self) -> None:
        while True:
            name = await self._names.get()
            if self._given:
                continue
            try:
                self.map = await asyncio.to_thread(known_map, name)
            except ConfigError as error:
                self.map = None
                self._tell(f"The simulator's map is not shown: {error}; give it with --map")


def known_map(name: str) -> LineMap:
    """Return the map that ships under `name`, or lies in the working folder.

    Raises:
        ConfigError: There is none, or it cannot be read.
    """
    stem = name.removesuffix(".map")
    if stem in {"empty", *shipped_maps(), *shipped_worlds()}:
        return load_world(stem).line_map()
    plain = stem == Path(stem).name
    path = next((p for e in ENDINGS if plain and (p := Path(stem + e)).is_file()), None)
    if path is None:
        raise ConfigError(f"there is no map {stem[:40]!r} here")
    return load_world(path).line_map()
