"""A robot as a ROS node; `ros1` and `ros2` run it over their middleware."""

import asyncio
from collections.abc import AsyncGenerator, Callable, Iterable, Mapping, Sequence
from contextlib import aclosing, suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from pioneer3.arcos.commands import Command
from pioneer3.arcos.reports import Report, Sip
from pioneer3.errors import CommandError, DeviceError
from pioneer3.geometry import Pose2
from pioneer3.robot.devices.pictures import Image, decode
from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.supervisor import Connection
from pioneer3.ros.messages.diagnostics import (
    DiagnosticStatus,
    Health,
    diagnose,
    hardware_id,
    laser_status,
)
from pioneer3.ros.messages.update import PictureUpdate, ScanUpdate, SensorUpdate, StateUpdate
from pioneer3.ros.node.commands import Commands
from pioneer3.ros.node.driving_parameters import DrivingParameters, Values, changed, to_send
from pioneer3.ros.node.middleware import Middleware
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.parameters import NodeParameters
from pioneer3.ros.node.publishing import Publishing
from pioneer3.ros.node.services import Services
from pioneer3.ros.node.topic import Topic
from pioneer3.ros.node.topics import SLOWLY, aria_laser, command_topics, published
from pioneer3.ros.node.updates import Updates
from pioneer3.runtime.robot import Robot
from pioneer3.state import Bumpers, Snapshot
from pioneer3.tasks import hand_over, next_tick, running

if TYPE_CHECKING:
    from pioneer3.ros.node.navigation import NodeNavigation

REPEAT: Final = 0.1
"""Between two messages that say that the robot is lost [s]: as snapshots would come."""


class RobotNode:
    """Publishes the state of a robot and drives it by `cmd_vel`, and by goals if it has a map.

    The robot is connected, and the node has its name in the middleware already.
    """

    def __init__(self, robot: Robot, parameters: NodeParameters, middleware: Middleware) -> None:
        self._robot = robot
        self._parameters = parameters
        self._middleware = middleware
        self._loop = asyncio.get_running_loop()
        self._options = options = replace(
            parameters.options, map_tf=parameters.tf_broadcast and robot.navigator is not None
        )
        self._updates = Updates(
            model := robot.info.model,
            options,
            lasers=self._mounted,
            camera=lambda: bool(robot.devices.camera.presence.there),
            stamp=self._stamp,
            make=middleware.make,
        )
        self._sensors = {each.kind.name: each for each in robot.devices.sensors}
        self._sent: list[Command] = []
        self._commands = Commands(
            robot, parameters.timeout, resumes=parameters.resume_cmd_vel, warn=middleware.warn
        )
        names = [laser.name for laser in robot.lasers]
        aria = self._aria_lasers() if parameters.publish_aria_lasers else {}
        topics = published(model, options, parameters.profile, names, aria)
        self._publishing = Publishing(topics, parameters.profile, middleware)
        self._navigation = self._navigation_of(robot)
        self._services = Services(
            robot,
            navigation=self._navigation,
            sonar=parameters.use_sonar,
            diagnose=self._diagnose,
            moved=self._updates.jumped,
            warn=middleware.warn,
        )
        self._told: object = None
        self._publishes_soon = False
        self._unheard: tuple[str, ...] = ()
        self._ended = asyncio.Event()

    async def run(self, ready: Callable[[], None]) -> None:
        """Serve until somebody shuts the node down, or until cancelled; then the robot stands.

        `ready` is called when everything is advertised.
        """
        self._middleware.on_shutdown(partial(hand_over, self._loop, self._ended.set))
        self._robot.arbiter.remembers = self._navigation is not None
        self._commands.begin()
        await asyncio.to_thread(self._advertise)
        self._services.session_began()
        ready()
        end_reports = self._robot.supervisor.reports.hand_to(self._take_report, Sip)
        try:
            async with running(
                self._publishing.publish_diagnostics(
                    self._diagnose, lambda: hardware_id(self._robot.info)
                ),
                *([self._navigation.run()] if self._navigation else []),
                *(
                    self._publishing.publish_device(
                        ScanUpdate, laser.values, partial(self._updates.scan, number), laser.name
                    )
                    for number, laser in enumerate(self._robot.lasers)
                ),
                *(
                    self._publishing.publish_device(
                        SensorUpdate, sensor.values, self._updates.reading, sensor.kind.name
                    )
                    for sensor in self._sensors.values()
                ),
                self._publishing.publish_device(PictureUpdate, self._images, self._picture_update),
                self._follow_link(),
                self._repeat_loss(),
                *([self._watch_others(look)] if (look := self._middleware.mismatches) else []),
            ):
                await self._ended.wait()
        finally:
            end_reports()
            self._commands.end()
            self._robot.stop()
            await asyncio.to_thread(self._middleware.forget)

    def describe_robot(self) -> None:
        """Publish its description, in a thread: with bumpers and laser if the robot has them."""
        if not self._options.description:
            return
        latest = self._robot.supervisor.snapshots.latest
        touch = latest.bumpers if latest else Bumpers()
        update = self._updates.description(touch, laser=bool(self._robot.laser.presence.there))
        self._middleware.describe(update.urdf)
        self._publishing.publish(update)

    def _advertise(self) -> None:
        """Tell the others, in a thread: that may take its time, and the robot must not wait."""
        profile, info = self._parameters.profile, self._robot.info
        self._publishing.advertise(self._is_available)
        if self._navigation is not None:
            self._navigation.advertise()
        self._services.advertise(profile, self._middleware)
        self.describe_robot()
        topics = command_topics(
            profile,
            self._parameters.lab_name,
            stamped=bool(self._parameters.enable_stamped_cmd_vel),
        )
        self._commands.subscribe(topics, self._middleware)
        driving = DrivingParameters(
            info.limits,
            info.config,
            self._parameters.driving,
            partial(hand_over, self._loop, self._set),
        )
        self._middleware.reconfigure(self._parameters, driving)

    def _aria_lasers(self) -> Mapping[str, str]:
        """Return the names of lasers in RosAria's topics, by their own; warn of none."""
        if not self._robot.laser.presence.there:
            self._middleware.warn(
                f"~publish_aria_lasers: no laser: {self._robot.laser.presence}; give its port with"
                " --laser or ~laser/serial_port"
            )
        mount = self._robot.info.model.laser
        kind = mount.kind if mount else ""
        return {
            laser.name: aria_laser(
                number,
                kind,
                laser.protocol if isinstance(laser, LaserDriver) else None,
                simulated=laser is self._robot.devices.laser,
            )
            for number, laser in enumerate(self._robot.lasers, start=1)
        }

    def _is_available(self, topic: Topic) -> bool:
        """Return whether the robot has the device that a topic is published from."""
        if topic.source is ScanUpdate:
            plain = self._parameters.profile is Profile.COMPATIBILITY  # RosAria has no such topic
            asked = self._robot.laser is not self._robot.devices.laser or topic.standard is None
            return bool(self._robot.laser.presence.there) and (asked or not plain)
        if topic.source is PictureUpdate:
            return bool(self._robot.devices.camera.presence.there)
        return not topic.sensor or bool(self._sensors[topic.sensor].presence.there)

    def _take_report(self, report: Report, now: float) -> None:
        """Publish the newest snapshot soon: what it makes the robot do comes first."""
        if not self._publishes_soon:
            self._publishes_soon = True
            self._loop.call_soon(self._publish_state)

    def _publish_state(self) -> None:
        """Publish a snapshot that somebody subscribes to, or that latched topics tell of."""
        self._publishes_soon = False
        supervisor = self._robot.supervisor
        snapshot = supervisor.snapshots.latest
        assert snapshot is not None
        model, charging = self._robot.info.model, snapshot.battery.charging
        emergency, sessions = supervisor.pilot.emergency, snapshot.link.sessions
        latched = model, sessions, snapshot.motors, charging, emergency
        if latched != self._told or self._publishing.has_subscribers(StateUpdate):
            self._told = latched
            self._publishing.publish(self._state_update(snapshot))
        else:
            self._updates.pass_over(snapshot, model)
        self._publishing.look()
        if self._navigation is not None:
            self._navigation.publish(snapshot)

    def _state_update(self, snapshot: Snapshot) -> StateUpdate:
        return self._updates.state(
            snapshot,
            self._robot.info.model,
            emergency=self._robot.supervisor.pilot.emergency,
            odom_in_map=self._navigation.odom_in_map(snapshot) if self._navigation else None,
        )

    async def _images(self) -> AsyncGenerator[Image, None]:
        """Yield the camera's pictures, without those that are broken."""
        warned = False
        async with aclosing(self._robot.devices.camera.pictures()) as pictures:
            async for picture in pictures:
                try:
                    image = await asyncio.to_thread(decode, picture)
                except DeviceError as error:
                    if not warned:
                        self._middleware.warn(str(error))
                    warned = True
                else:
                    warned = False
                    yield image

    def _picture_update(self, image: Image) -> PictureUpdate:
        return PictureUpdate(
            image=image,
            view=image.view or self._parameters.camera_view,
            frame=self._updates.frames.camera_optical,
            stamp=self._stamp(image.stamp),
        )

    async def _watch_others(self, look: Callable[[], Sequence[str]]) -> None:
        """Log endpoints of other nodes that cannot talk to this one, once each."""
        told: set[str] = set()
        while True:
            self._unheard = tuple(await asyncio.to_thread(look))
            for sentence in self._unheard:
                if sentence not in told:
                    told.add(sentence)
                    self._middleware.warn(sentence)
            await next_tick(SLOWLY)

    def _diagnose(self) -> tuple[DiagnosticStatus, ...]:
        """Return the state of each part of the robot now."""
        robot, status = self._robot, self._robot.supervisor.status.latest
        lost = status is not None and status.connection is not Connection.CONNECTED
        return diagnose(
            Health(
                info=robot.info,
                snapshot=robot.snapshot,
                lost=status.message if status is not None and lost else "",
                emergency=robot.supervisor.pilot.emergency,
                auto_enable=robot.supervisor.pilot.auto_enable,
                driver=robot.arbiter.driving_action,
                why_not_moving=robot.why_not_moving(),
                refused=robot.supervisor.pilot.blocked,
                lasers=tuple(
                    laser_status(laser) for laser in robot.lasers if isinstance(laser, LaserDriver)
                ),
                navigation=self._navigation.diagnose() if self._navigation else (),
                unheard=self._unheard,
            )
        )

    async def _follow_link(self) -> None:
        """Log losses of the link; latched messages must not outlive the robot."""
        logged, warn = None, self._middleware.warn
        async for status in self._robot.supervisor.status.values():
            if status.connection is Connection.LOST:
                self._publishing.lose_robot()
                if status != logged:
                    warn(f"LOST THE ROBOT: {status.message}; nothing is published meanwhile")
                logged = status
            elif status.connection is Connection.CONNECTED:
                warn(f"connected again: {status.message}")
                self._send(self._sent)  # it may have been switched off and on
                self._services.session_began()

    async def _repeat_loss(self) -> None:
        """Say again and again that the robot is lost, for subscribers that get nothing latched."""
        statuses = self._robot.supervisor.status
        async for status in statuses.values(latest_first=True):
            while status.connection is Connection.LOST and status is statuses.latest:
                self._publishing.lose_robot()
                self._publishing.look()
                await asyncio.sleep(REPEAT)

    def _set(self, values: Values) -> None:
        """Drive by `values` from now on, and tell the robot those that are new to it."""
        new = [command for command in to_send(values) if command not in self._sent]
        self._sent = to_send(values)
        self._robot.supervisor.change_limits(partial(changed, values=values))
        self._send(new)

    def _send(self, several: Iterable[Command]) -> None:
        """Tell the robot; one that is away is told when it is back."""
        with suppress(CommandError):
            for command in several:
                self._robot.send(command)

    def _stamp(self, moment: float) -> object:
        """Return the ROS time of `moment` [s, monotonic]."""
        return self._middleware.stamp(self._loop.time() - moment)

    def _navigation_of(self, robot: Robot) -> "NodeNavigation | None":
        """Return the navigation of a robot that has a map."""
        if robot.navigator is None:
            return None
        from pioneer3.ros.node.navigation import NodeNavigation  # and with it numpy

        return NodeNavigation(
            robot,
            robot.navigator,
            speed=self._parameters.goal_speed,
            options=self._options,
            profile=self._parameters.profile,
            middleware=self._middleware,
        )

    def _mounted(self) -> list[Pose2] | None:
        """Return where lasers that somebody named sit; `None` leaves the model's."""
        asked = self._robot.laser is not self._robot.devices.laser
        return [laser.sensor_in_robot for laser in self._robot.lasers] if asked else None
