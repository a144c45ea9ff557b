"""Publishes what the node of a robot would have published, with the topics of its table."""

from collections.abc import Callable
from dataclasses import replace
from math import inf

from pioneer3.behaviors.engine import Decision
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.links.tap import ROBOT
from pioneer3.log.topics import LogEvent
from pioneer3.models import RobotModel
from pioneer3.robot.explain import Reason
from pioneer3.robot.reports import ArrivalRate
from pioneer3.robot.supervisor import Connection, ConnectionStatus
from pioneer3.ros.bag.bags import OpenBag
from pioneer3.ros.bag.navigation import NavigationPlayer
from pioneer3.ros.bag.outlet import BagOutlet
from pioneer3.ros.bag.robots import LoggedRobot, laser_number
from pioneer3.ros.messages.diagnostics import (
    DiagnosticStatus,
    DiagnosticsUpdate,
    Health,
    ScanCounts,
    diagnose,
    hardware_id,
    scans_status,
)
from pioneer3.ros.messages.motion import fill_twist
from pioneer3.ros.messages.update import NANO
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.ros.node.publishing import Publishing
from pioneer3.ros.node.topics import COMMANDS, SLOWLY, published
from pioneer3.ros.node.updates import Updates
from pioneer3.runtime.recording import (
    RENEWED,
    CommandGiven,
    DecisionMade,
    StandsBecause,
    link_status,
)
from pioneer3.state import Scan, Snapshot

MOST_SILENT = 600 * NANO
"""While a log says nothing for longer than this [ns], nothing is diagnosed."""


class Player:
    """The node of a robot of a log, whose messages go to a bag.

    Args:
        wall: Returns the time since 1970 [ns] of a moment [s, monotonic] of the program that wrote
            the log.

    Attributes:
        navigation: The part that has a map.
        outlet: Has the time.
        due: Time of the next diagnosis [ns since 1970]; `inf` before the first snapshot.
    """

    def __init__(
        self, robot: LoggedRobot, bag: OpenBag, profile: Profile, wall: Callable[[float], int]
    ) -> None:
        prefix = f"{robot.namespace[1:]}/" if robot.namespace else ""
        parameters = read_parameters({"frame_prefix": prefix} if prefix else {}, profile)
        options = replace(parameters.options, map_tf=parameters.tf_broadcast)
        self._robot = robot
        self.outlet = outlet = BagOutlet(bag, robot.namespace)

        def stamp(moment: float) -> object:
            return outlet.stamp_of(wall(moment))

        self._updates = Updates(
            robot.info.model, options, lasers=lambda: _mounted(robot), stamp=stamp, make=outlet.make
        )
        self.navigation = NavigationPlayer(outlet, options, profile, stamp)
        topics = published(robot.info.model, options, profile, sorted(robot.lasers))
        self._publishing = Publishing(topics, profile, outlet)
        self._publishing.advertise(lambda topic: True)
        self._commands = [
            outlet.advertise(name, COMMANDS.type_name) for name in COMMANDS.names(profile)
        ]
        self._described = not options.description
        self.due: float = inf
        self._lasers = {name: _LaserPlayer(name) for name in sorted(robot.lasers)}
        self._snapshot: Snapshot | None = None
        self._decision = Decision()
        self._stands: Reason | None = None
        self._link: ConnectionStatus | None = None
        self._emergency = False

    def snapshot(self, snapshot: Snapshot) -> None:
        """Publish the state of the robot."""
        if not self._described:
            self._described = True
            laser = bool(self._robot.lasers)
            self._publishing.publish(self._updates.description(snapshot.bumpers, laser=laser))
        if self._snapshot is None:
            self.due = self.outlet.now
        self._snapshot = snapshot
        self._publishing.publish(
            self._updates.state(
                snapshot,
                self._robot.info.model,
                emergency=self._emergency,
                odom_in_map=self.navigation.odom_in_map(snapshot),
            )
        )
        self.navigation.publish(snapshot)

    def use_model(self, model: RobotModel) -> None:
        """Take the model of the robot that sends from now on."""
        self._robot = replace(self._robot, info=replace(self._robot.info, model=model))

    def scan(self, laser: str, scan: Scan) -> None:
        """Publish a scan of a laser."""
        number = laser_number(laser)
        assert number is not None
        self._lasers[laser].scan(scan, self.outlet.now / NANO)
        self._publishing.publish(self._updates.scan(number, scan), laser)

    def command(self, given: CommandGiven) -> None:
        """Publish the speeds of a command that was carried out, whoever gave it."""
        if (latches := given.latches) is not None:
            self._emergency = latches
        if given.refused or not given.seconds:
            return
        for publisher in self._commands:
            message = self.outlet.make(COMMANDS.type_name)
            fill_twist(message, given.twist)
            publisher.publish(message)

    def decision(self, made: DecisionMade) -> None:
        """Take a decision, for the next diagnosis."""
        self._decision = made.decision

    def standing(self, told: StandsBecause) -> None:
        """Take the reason to stand likewise."""
        self._stands = told.reason

    def event(self, event: LogEvent) -> None:
        """Take a change of a link likewise; latched messages do not outlive the robot."""
        before = self._robot.prefix
        for name, laser in self._lasers.items():
            if (status := link_status(event, f"{before}{name}")) is not None:
                laser.follow(status)
        if (status := link_status(event, f"{before}{ROBOT}")) is not None:
            self._link = status
            self._lose()

    def diagnose(self, time: int) -> None:
        """Publish the diagnosis that is due, not later than a time [ns since 1970]."""
        self.outlet.now = now = int(self.due)
        self.due = max(now + round(SLOWLY * NANO), time - MOST_SILENT)
        lost, info, decision = self._lose(), self._robot.info, self._decision
        snapshot = None if lost else self._snapshot
        drives = snapshot is not None and snapshot.stamp < decision.until + RENEWED
        health = Health(
            info=info,
            snapshot=snapshot,
            lost=lost,
            emergency=self._emergency,
            driver=(decision.v_by or decision.w_by) if drives else None,
            why_not_moving=self._stands,
            lasers=tuple(laser.status(now / NANO) for laser in self._lasers.values()),
            navigation=self.navigation.diagnose(),
        )
        self._publishing.publish(
            DiagnosticsUpdate(
                found=diagnose(health),
                node=self.outlet.name,
                hardware=hardware_id(info),
                stamp=self.outlet.stamp(0.0),
                make=self.outlet.make,
            )
        )

    def _lose(self) -> str:
        """Return the reason that the robot is lost, and publish that; empty if it is there."""
        if self._link is None or self._link.connection is Connection.CONNECTED:
            return ""
        if self._snapshot is not None:
            self._publishing.lose_robot()
        return self._link.message or self._link.connection


class _LaserPlayer:
    """A laser, as a diagnosis sees it."""

    def __init__(self, name: str) -> None:
        self._name, self._lost = name, ""
        self._latest: Scan | None = None
        self._scans = self._losses = 0
        self._rate = ArrivalRate()

    def scan(self, scan: Scan, now: float) -> None:
        """Take a scan of `now` [s]."""
        self._latest, self._scans = scan, self._scans + 1
        self._rate.add(now)

    def follow(self, status: ConnectionStatus) -> None:
        """Take a change of its link."""
        self._losses += status.connection is Connection.LOST and not self._lost
        connected = status.connection is Connection.CONNECTED
        self._lost = "" if connected else status.message or status.connection

    def status(self, now: float) -> DiagnosticStatus:
        """Return its state at `now` [s]."""
        rate = self._rate.at(now)
        scans = ScanCounts(latest=self._latest, scans=self._scans, rate=rate, losses=self._losses)
        return scans_status(self._name, scans, self._lost)


def _mounted(robot: LoggedRobot) -> list[Pose2] | None:
    """Return where the lasers sit, by their numbers; `None` leaves the model's.

    One that sent nothing sits where the model has its laser.
    """
    if not robot.lasers:
        return None
    usual = robot.info.model.laser
    elsewhere = Pose2(usual.x, usual.y, usual.theta) if usual else ORIGIN
    by_number = {laser_number(name): pose for name, pose in robot.lasers.items()}
    count = 1 + max(number for number in by_number if number is not None)
    return [by_number.get(number, elsewhere) for number in range(count)]
