"""The surroundings of a robot: the map, and the robot's pose in it.

They come from a simulation in this program, from a simulator at the other end of the link, or from
a map that the user gave.
"""

import asyncio
from collections.abc import Callable, Hashable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Self

from pioneer3.arcos.commands import SimCtrl, SimOperation
from pioneer3.arcos.reports import MapChanged, Report
from pioneer3.errors import CommandError, ConfigError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.navigation.simulator import TruePose, known_map
from pioneer3.navigation.traffic import SharedPlace, frame_of
from pioneer3.robot.supervisor import is_simulator
from pioneer3.runtime.robot import Robot
from pioneer3.sim.relief import FLAT, Relief
from pioneer3.sim.server.running import RunningSimulation, SimulatedRobot
from pioneer3.state import Snapshot
from pioneer3.tasks import running

NOT_LOOKED_FOR = "nothing tells where it is; with --map, a robot with a laser is found"


class RemoteWorld:
    """The world of a simulator in another program; empty for a real robot.

    A simulator names its map; it is drawn if a map of that name ships, or lies in this program's
    folder, else `tell` is called with a sentence. No other files are read for it. A `line_map` that
    is given counts whatever the simulator says.
    """

    def __init__(self, robot: Robot, line_map: LineMap | None, tell: Callable[[str], None]) -> None:
        self.map, self.relief = line_map, FLAT
        self._robot, self._true = robot, TruePose(robot)
        self._given = line_map is not None
        self._tell = tell
        self._names: asyncio.Queue[str] = asyncio.Queue()

    @property
    def pose(self) -> Pose2 | None:
        """The robot's true pose in the map [m, rad], `None` while none is told."""
        return self._true.pose

    @property
    def frame(self) -> Hashable:
        """Identity of the simulated world: robots of one simulator on one map are in the same."""
        return "simulator", self._true.world, self.map.name if self.map else ""

    def adopt(self, line_map: LineMap, relief: Relief = FLAT) -> None:
        """Show this map from now on, whatever the simulator says."""
        self.map, self.relief, self._given = line_map, relief, True

    async def follow(self) -> None:
        """Ask at every connection, and read the answers; ends by cancellation."""
        forget = self._robot.supervisor.reports.hand_to(self._take, MapChanged)
        try:
            self._ask()
            async with running(self._load(), self._true.follow()):
                async for _ in self._robot.supervisor.status.values():
                    self._ask()
        finally:
            forget()

    def _ask(self) -> None:
        info = self._robot.supervisor.info
        if info is not None and is_simulator(info):
            with suppress(CommandError):  # no session is open
                self._robot.send(SimCtrl(SimOperation.REQUEST_INFO))

    def _take(self, report: Report, stamp: float) -> None:
        if isinstance(report, MapChanged) and (report.by_user or report.reloaded):
            self._names.put_nowait(report.file_name)

    async def _load(self) -> None:
        while True:
            name = await self._names.get()
            if self._given:
                continue
            try:
                self.map, self.relief = await asyncio.to_thread(known_map, name)
            except ConfigError as error:
                self.map, self.relief = None, FLAT
                self._tell(f"The simulator's map is not shown: {error}; give it with --map")


@dataclass(slots=True)
class Located:
    """A robot's place on the map, found by navigation: the pose of odometry's frame [m, rad].

    It is `None` while it is not known; `unsure` returns the reason not to act upon it, or nothing.
    """

    odom_in_map: Callable[[], Pose2 | None] = lambda: None
    unsure: Callable[[], str] = lambda: NOT_LOOKED_FOR


@dataclass(frozen=True, slots=True)
class RobotScene:
    """The surroundings of a robot: a map, and the odometry's origin in it [m, rad].

    A robot is `simulated` in this program, where `truth` returns its true pose in the map, or in
    `remote`, the world of a simulator in another; it is `located` as far as navigation knows.
    """

    map: LineMap | None = None
    odom_in_map: Pose2 = ORIGIN
    truth: Callable[[], Pose2] | None = None
    simulated: tuple[RunningSimulation, SimulatedRobot] | None = None
    remote: RemoteWorld | None = None
    located: Located = field(default_factory=Located)

    @property
    def tells_truth(self) -> bool:
        """Whether a simulator tells where the robot is."""
        return self.truth is not None or bool(self.remote and self.remote.pose)

    @classmethod
    def of(cls, running: RunningSimulation, robot: SimulatedRobot) -> Self:
        """Return the map and the true pose of a robot of a simulation in this program."""
        body = robot.body
        return cls(
            running.world.map,
            body.home,
            truth=lambda: body.robot_in_world,
            simulated=(running, robot),
        )

    @property
    def true_pose(self) -> Pose2 | None:
        """The robot's true pose in the map [m, rad]; `None` where no simulator tells it."""
        reported = self.remote.pose if self.remote else None
        return reported or (self.truth() if self.truth else None)

    def robot_in_map(self, robot_in_odom: Pose2) -> Pose2:
        """Return the pose to draw [m, rad]: the true one if it is known, else the one found."""
        return self.true_pose or (self.located.odom_in_map() or self.odom_in_map) @ robot_in_odom

    def place(self, snapshot: Snapshot) -> SharedPlace | str:
        """Return the place of odometry in a frame that is shared by robots of the same world.

        Where no simulator tells it and the robot is not sure, return the reason.
        """
        frame: Hashable = "no map" if self.map_now is None else frame_of(self.map_now)
        remote = self.remote is not None and self.remote.pose is not None
        if self.remote is not None and remote:
            frame = self.remote.frame
        elif self.truth is None and (unsure := self.located.unsure()):
            return unsure
        return SharedPlace(
            frame, self.odom_in_map_now(snapshot.odometry.robot_in_odom), true=remote
        )

    @property
    def map_now(self) -> LineMap | None:
        """The present map; clients of a simulator may have loaded another one."""
        if self.simulated:
            return self.simulated[0].world.map
        return self.remote.map if self.remote else self.map

    @property
    def relief_now(self) -> Relief:
        """The heights of the present map."""
        if self.simulated:
            return self.simulated[0].world.relief
        return self.remote.relief if self.remote else FLAT

    def adopt(self, line_map: LineMap) -> None:
        """Use another map of the same place from now on; a simulated world becomes it."""
        if self.simulated:
            world = self.simulated[0].world
            world.change_map(line_map, world.relief.carried(world.map, line_map))
        elif self.remote is not None:
            before = self.remote.map or line_map
            self.remote.adopt(line_map, self.remote.relief.carried(before, line_map))

    def odom_in_map_now(self, robot_in_odom: Pose2) -> Pose2:
        """Return the apparent pose of the odometry's origin [m, rad], from its present snapshot.

        It wanders where the true pose is known and odometry drifts.
        """
        return self.robot_in_map(robot_in_odom) @ robot_in_odom.inverse()
