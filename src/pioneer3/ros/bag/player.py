"""Publishes what the node of a robot would have published, with the topics of its table."""

from collections.abc import Callable
from dataclasses import replace

from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.ros.bag.bags import OpenBag
from pioneer3.ros.bag.navigation import NavigationPlayer
from pioneer3.ros.bag.outlet import BagOutlet
from pioneer3.ros.bag.robots import LoggedRobot, laser_number
from pioneer3.ros.messages.motion import fill_twist
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameter_reading import read_parameters
from pioneer3.ros.node.publishing import Publishing
from pioneer3.ros.node.topics import COMMANDS, published
from pioneer3.ros.node.updates import Updates
from pioneer3.runtime.recording import EMERGENCY_STOP, CommandGiven
from pioneer3.state import Scan, Snapshot


class Player:
    """The node of a robot of a log, whose messages go to a bag.

    Args:
        wall: Returns the time since 1970 [ns] of a moment [s, monotonic] of the program that wrote
            the log.

    Attributes:
        navigation: The part that has a map.
    """

    def __init__(
        self, robot: LoggedRobot, bag: OpenBag, profile: Profile, wall: Callable[[float], int]
    ) -> None:
        prefix = f"{robot.namespace[1:]}/" if robot.namespace else ""
        parameters = read_parameters({"frame_prefix": prefix} if prefix else {}, profile)
        options = replace(parameters.options, map_tf=parameters.tf_broadcast)
        self._robot = robot
        self._outlet = outlet = BagOutlet(bag, robot.namespace)

        def stamp(moment: float) -> object:
            return outlet.stamp_of(wall(moment))

        self._updates = Updates(
            robot.model,
            options,
            lasers=lambda: _mounted(robot),
            stamp=stamp,
            make=outlet.make,
        )
        self.navigation = NavigationPlayer(outlet, options, profile, stamp)
        topics = published(robot.model, options, profile, sorted(robot.lasers))
        self._publishing = Publishing(topics, profile, outlet)
        self._publishing.advertise(lambda topic: True)
        self._commands = [
            outlet.advertise(name, COMMANDS.type_name) for name in COMMANDS.names(profile)
        ]
        self._described = not options.description
        self._latch = _Latch()

    def snapshot(self, time: int, snapshot: Snapshot) -> None:
        """Publish the state of the robot, at a time [ns since 1970] as all others."""
        self._outlet.now = time
        if not self._described:
            self._described = True
            laser = bool(self._robot.lasers)
            self._publishing.publish(self._updates.description(snapshot.bumpers, laser=laser))
        self._publishing.publish(
            self._updates.state(
                snapshot,
                self._robot.model,
                emergency=self._latch.holds(snapshot),
                odom_in_map=self.navigation.odom_in_map(snapshot),
            )
        )
        self.navigation.publish(snapshot)

    def scan(self, laser: str, time: int, scan: Scan) -> None:
        """Publish a scan of a laser."""
        self._outlet.now = time
        number = laser_number(laser)
        assert number is not None
        self._publishing.publish(self._updates.scan(number, scan), laser)

    def command(self, time: int, given: CommandGiven) -> None:
        """Publish the speeds of a command that was carried out, whoever gave it."""
        if given.command == EMERGENCY_STOP:
            self._latch.press()
        if given.refused or not given.seconds:
            return
        self._outlet.now = time
        for publisher in self._commands:
            message = self._outlet.make(COMMANDS.type_name)
            fill_twist(message, given.twist)
            publisher.publish(message)


class _Latch:
    """The emergency stop, from the command until the motors have power again."""

    def __init__(self) -> None:
        self._pressed = self._off = False

    def press(self) -> None:
        """Take the command."""
        self._pressed, self._off = True, False

    def holds(self, snapshot: Snapshot) -> bool:
        """Return whether the robot is held at the next snapshot."""
        on = snapshot.motors.enabled
        self._pressed = self._pressed and not (on and self._off)
        self._off = self._off or not on
        return self._pressed


def _mounted(robot: LoggedRobot) -> list[Pose2] | None:
    """Return where the lasers sit, by their numbers; `None` leaves the model's.

    One that sent nothing sits where the model has its laser.
    """
    if not robot.lasers:
        return None
    usual = robot.model.laser
    elsewhere = Pose2(usual.x, usual.y, usual.theta) if usual else ORIGIN
    by_number = {laser_number(name): pose for name, pose in robot.lasers.items()}
    count = 1 + max(number for number in by_number if number is not None)
    return [by_number.get(number, elsewhere) for number in range(count)]
