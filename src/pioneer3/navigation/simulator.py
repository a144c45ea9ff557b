"""The map and the true pose of a simulated robot, as its simulator tells them over its link."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

from pioneer3.arcos.commands import RequestMode, RequestSimStat, SimCtrl, SimOperation
from pioneer3.arcos.reports import MapChanged, Report, SimStat
from pioneer3.errors import CommandError, ConfigError
from pioneer3.geometry import Pose2, wrap
from pioneer3.links.urls import split_host
from pioneer3.robot.supervisor import is_simulator
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import running
from pioneer3.units import MM

if TYPE_CHECKING:  # most programs ask for the pose alone
    from pioneer3.maps import LineMap
    from pioneer3.sim.relief import Relief

LOCAL = "localhost"


class TruePose:
    """Asks the simulator of a robot for its pose, at every connection.

    Between two questions passes the `period` [s]; `None` asks for a pose with each report. Each
    pose is `told`.

    Attributes:
        pose: In the simulated world [m, rad]; `None` while none is told, as by a real robot.
        odom_in_world: Pose of odometry's origin when that was told, or `None`.
    """

    def __init__(
        self,
        robot: Robot,
        period: float | None = None,
        told: Callable[[Pose2], None] = lambda robot_in_world: None,
    ) -> None:
        self.pose: Pose2 | None = None
        self.odom_in_world: Pose2 | None = None
        self._robot, self._period, self._told = robot, period, told

    @property
    def world(self) -> str:
        """The computer of the simulator: robots of one computer are taken to be in one world."""
        return _computer(self._robot.info.url)

    async def follow(self) -> None:
        """Ask, and read the answers; ends by cancellation."""
        forget = self._robot.supervisor.reports.hand_to(self._take, SimStat)
        try:
            self._ask()
            async with running(self._repeat()):
                async for _ in self._robot.supervisor.status.values():
                    # until the simulator tells it: the robot may have been moved
                    self.pose = self.odom_in_world = None
                    self._ask()
        finally:
            forget()

    async def _repeat(self) -> None:
        while self._period is not None:
            await asyncio.sleep(self._period)
            self._ask()

    def _ask(self) -> None:
        info = self._robot.supervisor.info
        if info is not None and is_simulator(info):
            mode = RequestMode.STREAM if self._period is None else RequestMode.ONCE
            with suppress(CommandError):  # no session is open
                self._robot.send(RequestSimStat(mode))

    def _take(self, report: Report, stamp: float) -> None:
        if isinstance(report, SimStat):
            heading = wrap(radians(report.heading_deg))
            self.pose = Pose2(report.x_mm * MM, report.y_mm * MM, heading)
            self._told(self.pose)
            if (now := self._robot.snapshot) is not None:
                self.odom_in_world = self.pose @ now.odometry.robot_in_odom.inverse()


@lru_cache
def _computer(url: str) -> str:
    """Return the computer at the other end of a link."""
    host = split_host(url)[0] if url.startswith("tcp:") else LOCAL
    return LOCAL if host.startswith("127.") or host == "::1" else host


OF_SIMULATOR = "simulator"
"""In place of a map: the one that the simulator names."""
ENDINGS = (".map", ".toml", ".yaml")
MAP_PATIENCE = 2.0
"""Time within which a simulator names its map [s]."""
REMEDY = "give the map with --map (in Python: line_map=)"


async def map_of_simulator(robot: Robot) -> "LineMap":
    """Return the map that the simulator at the other end of the link names.

    Raises:
        ConfigError: It is a robot, or names no map, or one that is not known here.
    """
    url = robot.info.url
    if not is_simulator(robot.info):
        raise ConfigError(f"{url}: a robot names no map: {REMEDY}")
    with robot.supervisor.reports.subscribe(MapChanged) as told:
        robot.send(SimCtrl(SimOperation.REQUEST_INFO))
        try:
            async with asyncio.timeout(MAP_PATIENCE):
                name = (await anext(aiter(told))).file_name
        except (TimeoutError, StopAsyncIteration):
            raise ConfigError(f"{url}: this simulator names no map: {REMEDY}") from None
    try:
        return (await asyncio.to_thread(known_map, name))[0]
    except ConfigError as error:
        raise ConfigError(f"the map of the simulator: {error}; {REMEDY}") from None


def known_map(name: str) -> "tuple[LineMap, Relief]":
    """Return the map that ships under `name`, or lies in the working folder, and its heights.

    Raises:
        ConfigError: There is none, or it cannot be read.
    """
    from pioneer3.maps import shipped_maps
    from pioneer3.sim.worldfile import file_in, load_world, shipped_worlds

    stem = name.removesuffix(".map")
    if stem in {"empty", *shipped_maps(), *shipped_worlds()}:
        world = load_world(stem)
    elif path := next((p for e in ENDINGS if (p := file_in(Path(), stem + e))), None):
        world = load_world(path)
    else:
        raise ConfigError(f"there is no map {stem[:40]!r} here")
    line_map = world.line_map()
    return line_map, world.relief(line_map)
