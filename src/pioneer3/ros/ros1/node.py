"""A robot as a ROS 1 node, in RosAria's place. rospy's threads end at one hand-over to the loop."""

import asyncio
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import partial
from math import inf
from typing import Any

from pioneer3.arcos.commands import Command
from pioneer3.errors import CommandError
from pioneer3.models import RobotModel
from pioneer3.robot.supervisor import Connection
from pioneer3.ros.description.tree import Tree, tree_of
from pioneer3.ros.description.urdf import describe
from pioneer3.ros.interface.parameters import Parameters
from pioneer3.ros.interface.settings import changed, to_send
from pioneer3.ros.interface.topics import Profile, Topic, command_topics, topics_of
from pioneer3.ros.messages.convert import Reading
from pioneer3.ros.messages.joints import WheelAngles
from pioneer3.ros.ros1.commands import Commands
from pioneer3.ros.ros1.description import Description
from pioneer3.ros.ros1.devices import Devices
from pioneer3.ros.ros1.diagnostics import Diagnostics
from pioneer3.ros.ros1.messages import make
from pioneer3.ros.ros1.publishers import Publishers
from pioneer3.ros.ros1.reconfigure import Reconfigure
from pioneer3.ros.ros1.services import Services
from pioneer3.runtime.robot import Robot
from pioneer3.state import Bumpers, Snapshot
from pioneer3.tasks import running


class Ros1Node:
    """Publishes what `robot` says and drives it as `cmd_vel` says.

    `rospy.init_node` comes first.

    Args:
        robot: Connected.
        parameters: Names and patience.
        given: All that is written below the node's name.
    """

    def __init__(
        self, robot: Robot, parameters: Parameters, given: Mapping[str, object] | None = None
    ) -> None:
        self._robot = robot
        self._parameters = parameters
        self._loop = asyncio.get_running_loop()
        topics = command_topics(parameters.profile, parameters.lab_name)
        self._commands = Commands(robot, topics, parameters.timeout, self._warn)
        self._given = dict(given or {})
        self._sent: list[Command] = []
        self._reconfigure: Reconfigure | None = None
        self._publishers = Publishers(_topics(parameters, robot.info.model), parameters.profile)
        self._frames = parameters.conventions.frames.with_prefix(parameters.conventions.prefix)
        self._model, self._tree = robot.info.model, self._tree_of(robot.info.model)
        self._wheels = WheelAngles()
        self._diagnostics = Diagnostics(robot)
        self._services = Services(
            robot,
            parameters.profile,
            sonar=parameters.sonar,
            diagnose=self._diagnostics.conditions,
            moved=self._wheels.jumped,
            warn=self._warn,
        )
        self._devices = Devices(robot, self._frames, self._ros_time)
        self._description = Description()
        self._ended = asyncio.Event()

    async def run(self, ready: Callable[[], None]) -> None:
        """Serve until somebody shuts the node down, or until cancelled; then the robot stands.

        `ready` is called when everything is advertised.
        """
        import rospy  # noqa: PLC0415

        rospy.on_shutdown(lambda: self._hand_over(self._ended.set))
        self._commands.begin()
        await asyncio.to_thread(self._advertise)
        self._services.connected()
        ready()
        try:
            async with running(
                self._publish_all(),
                self._follow_link(),
                self._devices.serve(),
                self._diagnostics.serve(),
            ):
                await self._ended.wait()
        finally:
            self._commands.end()
            self._robot.stop()
            await asyncio.to_thread(self._forget)

    def _advertise(self) -> None:
        """Tell the master, in a thread: it may take its time, and the robot must not wait."""
        self._publishers.advertise()
        self._services.advertise()
        self._diagnostics.advertise()
        if self._parameters.profile is not Profile.COMPATIBILITY:
            self._devices.advertise()
        self.describe_robot()
        self._commands.subscribe()
        info = self._robot.info
        self._reconfigure = Reconfigure(info.limits, info.config, self._given, self._reconfigured)

    def describe_robot(self) -> None:
        """Set `robot_description`, in a thread: with bumpers and laser if the robot has them."""
        if not self._parameters.conventions.description:
            return
        robot, latest = self._robot, self._robot.supervisor.snapshots.latest
        touch = latest.bumpers if latest else Bumpers()
        urdf = describe(
            self._model,
            self._tree,
            self._parameters.conventions.frames,
            bumpers=(len(touch.front), len(touch.rear)),
            laser=bool(robot.devices.laser.presence.there),
        )
        self._description.set(urdf)

    def _forget(self) -> None:
        """Leave the parameter server as it was, in a thread."""
        self._description.forget()
        if self._reconfigure is not None:
            self._reconfigure.forget()

    def _reconfigured(self, settings: dict[str, float]) -> None:
        """Take new settings in rospy's thread."""
        self._hand_over(lambda: self._set(settings))

    def _set(self, settings: dict[str, float]) -> None:
        """Drive by `settings` from now on, and tell the robot what is new to it."""
        new = [command for command in to_send(settings) if command not in self._sent]
        self._sent = to_send(settings)
        self._robot.supervisor.change_limits(partial(changed, settings=settings))
        self._send(new)

    def _send(self, several: Iterable[Command]) -> None:
        """Tell the robot; one that is away is told when it is back."""
        with suppress(CommandError):
            for command in several:
                self._robot.send(command)

    def _hand_over(self, function: Callable[[], object]) -> None:
        """Let the loop call `function`: all that rospy's threads ever do to the robot."""
        with suppress(RuntimeError):  # the loop has ended, and with it the robot's motion
            self._loop.call_soon_threadsafe(function)

    async def _publish_all(self) -> None:
        async for snapshot in self._robot.snapshots(patience=inf):
            self._publishers.publish(self._reading(snapshot))

    def _reading(self, snapshot: Snapshot) -> Reading:
        model = self._robot.info.model
        if model is not self._model:
            self._model, self._tree = model, self._tree_of(model)
        return Reading(
            snapshot=snapshot,
            model=model,
            tree=self._tree,
            frames=self._frames,
            conventions=self._parameters.conventions,
            turned=self._wheels.update(snapshot.odometry, model),
            emergency=self._robot.supervisor.pilot.emergency,
            stamp=self._ros_time(snapshot.stamp),
            make=make,
        )

    def _tree_of(self, model: RobotModel) -> Tree:
        conventions = self._parameters.conventions
        return tree_of(
            model, conventions.frames, conventions.wheel_joints, conventions.sonar_height
        )

    async def _follow_link(self) -> None:
        """Say what becomes of the link; latched messages must not outlive what they tell of."""
        told = None
        async for status in self._robot.supervisor.status.values():
            if status.connection is Connection.LOST:
                self._publishers.unlatch()
                if status != told:
                    self._warn(f"LOST THE ROBOT: {status.message}; nothing is published meanwhile")
                told = status
            elif status.connection is Connection.CONNECTED:
                self._warn(f"connected again: {status.message}")
                self._send(self._sent)  # it may have been switched off and on
                self._services.connected()

    def _ros_time(self, stamp: float) -> Any:
        """Return the ROS time of `stamp` [s, monotonic]."""
        import rospy  # noqa: PLC0415

        age = self._loop.time() - stamp
        now = rospy.get_rostime()
        return rospy.Time.from_sec(max(0.0, now.to_sec() - age))

    def _warn(self, sentence: str) -> None:
        import rospy  # noqa: PLC0415

        rospy.logwarn(sentence)


def _topics(parameters: Parameters, model: RobotModel) -> list[Topic]:
    """Return what is to be published of a robot of this kind."""
    off = set()
    if not parameters.ranges:
        off |= {f"sonar/range_{number}" for number in range(len(model.sonars))}
    if not parameters.cloud:
        off.add("sonar/points")
    return [
        topic
        for topic in topics_of(model)
        if topic.standard not in off and topic.wanted(parameters.conventions)
    ]
