"""Where the robot is drawn: the map, and the robot's pose in it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.sim.maps import LineMap
from pioneer3.sim.server.running import RunningSimulation, SimulatedRobot
from pioneer3.web.elsewhere import WorldElsewhere


@dataclass(frozen=True, slots=True)
class Scene:
    """What surrounds the robot.

    Attributes:
        map: Walls, or `None` where none are known.
        odom_in_map: Where the odometry's origin lies in the map [m, rad].
        truth: Returns the true pose in the map, where a simulator knows it.
        simulated: The simulation to look at and to change, and the robot in it; `None` for a real
            robot.
        elsewhere: What a simulator in another program tells, if the robot is of one.
    """

    map: LineMap | None = None
    odom_in_map: Pose2 = ORIGIN
    truth: Callable[[], Pose2] | None = None
    simulated: tuple[RunningSimulation, SimulatedRobot] | None = None
    elsewhere: WorldElsewhere | None = None

    @classmethod
    def of(cls, running: RunningSimulation, robot: SimulatedRobot) -> Self:
        """Return map and true pose of a simulated robot, for people to look at and to change."""
        body = robot.body
        return cls(
            running.world.map,
            body.home,
            truth=lambda: body.robot_in_world,
            simulated=(running, robot),
        )

    def robot_in_map(self, robot_in_odom: Pose2) -> Pose2:
        """Return the pose to draw [m, rad]: the true one if it is known."""
        told = self.elsewhere.pose if self.elsewhere else None
        return told or (self.truth() if self.truth else self.odom_in_map @ robot_in_odom)

    @property
    def map_now(self) -> LineMap | None:
        """The map; clients of a simulator may have loaded another since."""
        if self.simulated:
            return self.simulated[0].world.map
        return self.elsewhere.map if self.elsewhere else self.map

    def odom_in_map_now(self, robot_in_odom: Pose2) -> Pose2:
        """Return where the odometry's origin seems to lie [m, rad], given what odometry says now.

        It wanders where the true pose is known and odometry drifts.
        """
        return self.robot_in_map(robot_in_odom) @ robot_in_odom.inverse()
