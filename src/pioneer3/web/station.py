"""One robot at the page: where it is driven from, and what is told of it."""

from typing import Any

from pioneer3.behaviors.action import Goal
from pioneer3.geometry import Pose2, Twist2
from pioneer3.robot.explain import kind_of
from pioneer3.runtime.robot import Robot
from pioneer3.sim.placement.straight_path import PathCheck, check_path
from pioneer3.state import Scan, Snapshot
from pioneer3.web import messages, requests
from pioneer3.web.details import Details
from pioneer3.web.guest import Somebody
from pioneer3.web.hands import Input
from pioneer3.web.modes import Goto, Mode, make
from pioneer3.web.scene import Scene
from pioneer3.web.wheel import Wheel

GOTO_TIME = 600.0
"""To reach a place of the map [s]."""


class Station:
    """A robot of the page.

    Attributes:
        number: What it goes by in requests and paths; given once.
        name: What people call it; no two at a page have the same.
        robot: What is driven.
        wheel: Who drives it.
        scene: Where it is.
        details: What is told to those only who look closely.
    """

    def __init__(self, number: int, name: str, robot: Robot, scene: Scene, wheel: Wheel) -> None:
        self.number = number
        self.name = name
        self.robot = robot
        self.wheel = wheel
        self.details = Details(number, robot, scene)
        self.scene = scene

    def drive(self, who: Somebody, twist: Twist2, source: Input = "touch") -> str | None:
        """Let `who` hold `twist` with `source`; return why they must let go first, or `None`.

        Why the robot ignores it otherwise is in the snapshots.
        """
        refused = self.wheel.drive(who, twist, source)
        return refused if self.wheel.ignored or self.wheel.holder is not who else None

    def start_mode(self, who: Somebody, wish: Mode) -> str | None:
        """Let the robot drive by itself for `who`, who must stay; return why not, or `None`."""
        if self.robot.snapshot is None:
            return "the robot is not connected"
        mode = make(wish, self.robot.info.limits)
        return self.wheel.start(who, mode, wish.seconds)

    def goto(self, who: Somebody, wish: requests.Goto) -> PathCheck:
        """Let the robot drive straight to a place of the map, for `who`, who must stay.

        Returns:
            Why it does not, or why it may not get there.
        """
        snapshot = self.robot.snapshot
        if snapshot is None:
            return PathCheck("The robot is not connected.")
        odom = snapshot.odometry.robot_in_odom
        here, line_map = self.scene.robot_in_map(odom), self.scene.map_now
        said = PathCheck()
        if line_map is not None:
            model = self.robot.info.model
            said = check_path(line_map, model, (here.x, here.y), (wish.x, wish.y))
        if said.refusal:
            return said
        place = Pose2(wish.x, wish.y, wish.heading or 0.0)
        goal = self.scene.odom_in_map_now(odom).inverse() @ place
        heading = None if wish.heading is None else goal.theta
        mode = Goto(x=goal.x, y=goal.y, heading=heading, speed=wish.speed, seconds=GOTO_TIME)
        refused = self.start_mode(who, mode)
        return PathCheck(refused) if refused else said

    def seen_from(self, scan: Scan) -> Pose2:
        """Return where the laser was in the map at the time of a sweep [m, rad]."""
        return self.scene.robot_in_map(scan.robot_in_odom) @ scan.sensor_in_robot

    def describe(self) -> dict[str, Any]:
        """Return what a page needs to draw and drive this robot."""
        laser = bool(self.robot.devices.laser.presence.there)
        return messages.robot(self.number, self.name, self.robot.supervisor.info, laser=laser)

    def status(self) -> dict[str, Any]:
        """Return how it stands with the link."""
        status = self.robot.supervisor.status.latest
        assert status is not None
        return messages.status(self.number, status)

    def snapshot(self, snapshot: Snapshot, driver: dict[str, Any] | None) -> dict[str, Any]:
        """Return what pages are told of a reading; `driver` as in :func:`messages.snapshot`."""
        arbiter, odom = self.robot.arbiter, snapshot.odometry.robot_in_odom
        why = self.robot.why_not_moving()
        return messages.snapshot(
            self.number,
            snapshot,
            pose=self.scene.robot_in_map(odom),
            why=why,
            standing=kind_of(why),
            mode=arbiter.mode.name if arbiter.mode else None,
            decided=arbiter.told if arbiter.mode else (),
            ended=arbiter.ended,
            commanded=self.robot.supervisor.pilot.sent,
            emergency_stop=self.robot.supervisor.pilot.emergency,
            driver=driver,
            target=self._target(arbiter.mode.goal, odom) if arbiter.mode else None,
        )

    def _target(self, goal: Goal | None, odom: Pose2) -> dict[str, Any] | None:
        if goal is None:
            return None
        place = self.scene.odom_in_map_now(odom) @ Pose2(goal.x, goal.y, goal.heading or 0.0)
        return messages.goal(place, heads=goal.heading is not None, person=goal.person)
