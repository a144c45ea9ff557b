"""The true pose of a simulated robot, as its simulator tells it over the robot's own link."""

import asyncio
from contextlib import suppress
from functools import lru_cache
from math import radians

from pioneer3.arcos.commands import RequestMode, RequestSimStat
from pioneer3.arcos.reports import Report, SimStat
from pioneer3.errors import CommandError
from pioneer3.geometry import Pose2, wrap
from pioneer3.links.urls import split_host
from pioneer3.robot.identity import is_simulator
from pioneer3.runtime.robot import Robot
from pioneer3.tasks import running
from pioneer3.units import MM

LOCAL = "localhost"


class TruePose:
    """Asks the simulator of a robot for its pose, at every connection.

    Args:
        robot: The robot.
        period: Pause between two questions [s]; `None` asks for a pose with each report.

    Attributes:
        pose: In the simulated world [m, rad]; `None` while none is told, as by a real robot.
        odom_in_world: Pose of odometry's origin when that was told, or `None`.
    """

    def __init__(self, robot: Robot, period: float | None = None) -> None:
        self.pose: Pose2 | None = None
        self.odom_in_world: Pose2 | None = None
        self._robot, self._period = robot, period

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
            if (now := self._robot.snapshot) is not None:
                self.odom_in_world = self.pose @ now.odometry.robot_in_odom.inverse()


@lru_cache
def _computer(url: str) -> str:
    """Return the computer at the other end of a link."""
    host = split_host(url)[0] if url.startswith("tcp:") else LOCAL
    return LOCAL if host.startswith("127.") or host == "::1" else host
