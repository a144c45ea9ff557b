"""One robot of the page: its control, and the messages that describe it."""

from collections.abc import Iterable
from typing import Protocol

from msgspec.structs import replace

from pioneer3.behaviors.action import Goal
from pioneer3.errors import Refusal
from pioneer3.geometry import Pose2, Twist2
from pioneer3.limits import Limits
from pioneer3.models import RobotModel
from pioneer3.navigation.goals import GoalStatus
from pioneer3.robot.explain import Reason, ReasonKind
from pioneer3.robot.supervisor import SIMULATOR_NAMES, RobotInfo, kind
from pioneer3.runtime.robot import Robot
from pioneer3.state import Scan, Snapshot
from pioneer3.web import messages
from pioneer3.web.audience import Audience
from pioneer3.web.calibration import RobotCalibration
from pioneer3.web.control import Control, Operator
from pioneer3.web.details import RobotDetails
from pioneer3.web.mapping import RobotMapping
from pioneer3.web.navigation import RobotNavigation
from pioneer3.web.scene import RobotScene

SONAR_MAX = 5.0
DEFAULT_SPEED, DEFAULT_TURN_RATE = 0.3, 0.6
NO_MODE = messages.ModeState()


class ConnectedClients(Protocol):
    """The clients of a page, as far as a robot's messages name them."""

    def number_of(self, operator: object) -> int | None:
        """Return the number of a client, or `None` for a script."""


class RobotView:
    """A robot of the page, with a number and a name of its own; numbers are never used again.

    People see the label: its name, or that of the student who has it.
    """

    def __init__(
        self,
        number: int,
        name: str,
        robot: Robot,
        *,
        scene: RobotScene,
        control: Control,
        navigation: RobotNavigation,
        mapping: RobotMapping,
        calibration: RobotCalibration,
    ) -> None:
        self.number = number
        self.name = self.label = name
        self.robot = robot
        self.control = control
        self.navigation = navigation
        self.mapping = mapping
        self.calibration = calibration
        self.scene = scene
        self.details = RobotDetails(number, robot, scene)

    def sensor_in_map(self, scan: Scan) -> Pose2:
        """Return the pose of the laser in the map at the time of a sweep [m, rad]."""
        return self.scene.robot_in_map(scan.robot_in_odom) @ scan.sensor_in_robot

    def describe(self) -> messages.ListedRobot:
        """Return the part of the hello for this robot."""
        laser = self.robot.laser
        return replace(
            robot_part(self.number, self.label, self.robot.supervisor.info),
            laser=bool(laser.presence.there),
            scans=laser is not self.robot.devices.laser,
            plans=self.navigation.possible,
            forbids=self.navigation.forbids,
            camera=bool(self.robot.devices.camera.presence.there),
        )

    def status(self) -> messages.Status:
        """Return the state of the connection."""
        status = self.robot.supervisor.status.latest
        assert status is not None
        return messages.Status(self.number, status.connection, status.message)

    async def publish_snapshots(
        self, audiences: Iterable[Audience], clients: ConnectedClients
    ) -> None:
        """Send each snapshot, encoded once for all, to the `audiences` that want it."""
        async for snapshot in self.robot.supervisor.snapshots.values():
            wanting = [audience for audience in audiences if audience.wants(self.number)]
            if wanting:
                text = messages.encode(self.snapshot(snapshot, clients))
                for audience in wanting:
                    audience.snapshots.put(self.number, text)

    def end_mode(self, operator: Operator) -> Refusal | None:
        """End the mode for an operator, and the goal, which may still wait for its way."""
        if refused := self.control.end_mode(operator):
            return refused
        self.navigation.goals.end(GoalStatus.CANCELED, f"{operator.name} ended it")
        return None

    def release(self, operator: Operator) -> None:
        """End the control of an operator, and the goal that the operator sent."""
        self.control.release(operator)
        self.navigation.release(operator)

    def mode(self) -> messages.ModeState:
        """Return the running mode, and how the last one ended."""
        arbiter = self.robot.arbiter
        running, ended = arbiter.mode, arbiter.ended
        return messages.ModeState(
            running.name if running else None,
            arbiter.told if running else (),
            messages.ModeEnd(ended.mode.name, ended.done, ended.why, ended.place)
            if ended
            else None,
        )

    def snapshot(self, snapshot: Snapshot, clients: ConnectedClients) -> messages.SnapshotMessage:
        """Return the message part for a snapshot."""
        arbiter, odom = self.robot.arbiter, snapshot.odometry.robot_in_odom
        pilot = self.robot.supervisor.pilot
        return snapshot_part(
            self.number,
            snapshot,
            robot_in_map=self.scene.robot_in_map(odom),
            why=self.robot.why_not_moving(),
            mode=self.mode(),
            stop=pilot.last_stop.why,
            commanded=pilot.sent,
            emergency_stop=pilot.emergency,
            driver=_driver(self.control.who_drives(), clients),
            target=self._target(arbiter.mode.goal, odom) if arbiter.mode else None,
            parting=self._parting(odom),
        )

    def _parting(self, odom: Pose2) -> messages.PartingState | None:
        shadow = self.robot.shadow
        if shadow is None or (found := shadow.parting) is None:
            return None
        return messages.PartingState(
            found.text, self.scene.odom_in_map_now(odom) @ found.twin_in_odom
        )

    def _target(self, goal: Goal | None, odom: Pose2) -> messages.Target | None:
        if goal is None:
            return None
        place = self.scene.odom_in_map_now(odom) @ Pose2(goal.x, goal.y, goal.heading or 0.0)
        return messages.Target(
            round(place.x, 3),
            round(place.y, 3),
            round(place.theta, 3) if goal.heading is not None else None,
            goal.person,
        )


def called(info: RobotInfo) -> str:
    """Return what people call a robot: the name that its owner gave it, else that of its type.

    By the names of simulators programs know these, and all robots in them have the same.
    """
    told = info.identity.name
    nameless = told.lower() in SIMULATOR_NAMES or told == info.model.name
    return info.model.title if nameless else told


def robot_part(number: int, name: str, info: RobotInfo | None) -> messages.ListedRobot:
    """Return the part of the hello for a robot that has nothing to see or to plan with.

    `info` is `None` before the first connection.
    """
    return messages.ListedRobot(
        id=number,
        name=name,
        kind=kind(info) if info else "ROBOT",
        url=info.url if info else "",
        shape=_shape(info.identity.name, info.model) if info else None,
        limits=_limits(info.limits) if info else None,
    )


def snapshot_part(
    number: int,
    now: Snapshot,
    *,
    robot_in_map: Pose2,
    why: Reason | None,
    emergency_stop: bool,
    driver: messages.Driver | None,
    mode: messages.ModeState = NO_MODE,
    stop: str | None = None,
    commanded: Twist2 | None = None,
    target: messages.Target | None = None,
    parting: messages.PartingState | None = None,
) -> messages.SnapshotMessage:
    """Return the message part for a snapshot; the last `stop` may be what keeps it standing."""
    motors = now.motors
    return messages.SnapshotMessage(
        robot=number,
        sequence=now.sequence,
        robot_in_map=robot_in_map,
        robot_in_odom=now.odometry.robot_in_odom,
        twist=now.odometry.twist,
        sonar=messages.SonarRanges(now.sonar.ranges, now.sonar.enabled),
        bumpers=now.bumpers,
        battery=now.battery,
        motors=messages.DriveState(
            motors.enabled, motors.stalled, motors.moving, motors.stop_button
        ),
        link=now.link,
        faults=now.faults,
        why=why and why.text,
        standing=why and why.kind,
        symptom=why and why.symptom,
        stop=stop if why and why.kind is ReasonKind.STOPPED else None,
        emergency_stop=emergency_stop,
        driver=driver,
        mode=mode.mode,
        decided=mode.decided,
        ended=mode.ended,
        commanded=commanded,
        target=target,
        parting=parting,
    )


def _shape(name: str, model: RobotModel) -> messages.Shape:
    return messages.Shape(
        name=name,
        model=model.name,
        title=model.title,
        length_front=model.length_front,
        length_rear=model.length_rear,
        width=model.width,
        sonars=model.sonars,
        front_bumpers=model.front_bumpers,
        rear_bumpers=model.rear_bumpers,
        sonar_max=SONAR_MAX,
    )


def _limits(limits: Limits) -> messages.SpeedLimits:
    return messages.SpeedLimits(
        speed=limits.max_speed,
        turn_rate=limits.max_turn_rate,
        default_speed=min(DEFAULT_SPEED, limits.max_speed),
        default_turn_rate=min(DEFAULT_TURN_RATE, limits.max_turn_rate),
    )


def _driver(driver: Operator | str | None, clients: ConnectedClients) -> messages.Driver | None:
    """Return the client, or the name of the program, that drives."""
    if driver is None or isinstance(driver, str):
        return messages.Driver(None, driver) if driver else None
    return messages.Driver(clients.number_of(driver), driver.name)
