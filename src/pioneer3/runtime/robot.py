"""The robot as a program sees it, asynchronously."""

from collections.abc import Sequence
from math import inf
from typing import TYPE_CHECKING

from pioneer3.arcos.commands import Command
from pioneer3.behaviors.action import Stack
from pioneer3.behaviors.actions import Hold, Move, Turn
from pioneer3.behaviors.modes import goto
from pioneer3.errors import CommandError, MotionError
from pioneer3.geometry import Pose2, wrap
from pioneer3.nav.settings import AS_SHIPPED
from pioneer3.robot.devices import Devices, PictureSource
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.robot.explain import advised
from pioneer3.robot.limits import checked, finite, wheels_as_twist
from pioneer3.robot.supervisor import Supervisor
from pioneer3.runtime.arbiter import PROGRAM, Arbiter
from pioneer3.runtime.driven import Driven
from pioneer3.runtime.motions import StartedMotion, carry_out, lost_as_motion_error, run_mode

if TYPE_CHECKING:
    from pioneer3.navigation.navigator import Navigator
    from pioneer3.runtime.shadow import Shadow

MOTOR_PATIENCE = 4.0
"""Longest wait for the motors to come on [s]."""


class Robot(Driven):
    """A connected robot. All angles counter-clockwise, all units SI.

    Made by :func:`pioneer3.connect_async`. Velocities expire after :attr:`Limits.expiry` (0.5 s);
    every way out stops the robot. Gripper, compass and the like are in :attr:`devices`.

    Attributes:
        lasers: The laser range finders at the computer, each on a link of its own; without any,
            that of a simulator, in the robot's own stream.
        started: The motion that goes on while the program does something else.
        shadow: Its simulated twin, where one was asked for.
        navigator: Knows where it is on a map; `None` without a map, and where a page makes its own.
    """

    def __init__(
        self,
        supervisor: Supervisor,
        arbiter: Arbiter,
        lasers: Sequence[LaserSource] = (),
        pictures: PictureSource | None = None,
    ) -> None:
        self._supervisor = supervisor
        self.arbiter = arbiter
        self.devices = Devices(supervisor, pictures)
        self.lasers: tuple[LaserSource, ...] = (*lasers,) or (self.devices.laser,)
        self.shadow: Shadow | None = None
        self.navigator: Navigator | None = None
        self.settings = AS_SHIPPED
        self.started = StartedMotion(arbiter, supervisor)
        self._hold = Hold("program")
        arbiter.add(self._hold, PROGRAM)
        arbiter.lasers = self.lasers

    @property
    def supervisor(self) -> Supervisor:
        """Keeps the robot connected."""
        return self._supervisor

    @property
    def odom_in_map(self) -> Pose2 | None:
        """Pose of odometry's frame on the map; `None` where it is not surely known."""
        return self.navigator.sure_odom_in_map if self.navigator else None

    @property
    def laser(self) -> LaserSource:
        """The first of :attr:`lasers`."""
        return self.lasers[0]

    def drive(self, speed: float, turn_rate: float = 0.0) -> None:
        """Drive at `speed` [m/s] and `turn_rate` [rad/s] until that expires.

        Raises:
            CommandError: not finite numbers.
            MotionError: the robot will not move; the message gives the reason.
        """
        self.started.end()
        refused = self.arbiter.hold(self._hold, checked(speed, turn_rate), self.info.limits.expiry)
        if refused:
            raise MotionError(str(refused))

    def drive_wheels(self, left: float, right: float) -> None:
        """Drive the wheels of each side at a speed [m/s] until that expires, as :meth:`drive` does.

        Raises:
            CommandError: not finite numbers.
            MotionError: the robot will not move; the message gives the reason.
        """
        twist = wheels_as_twist(left, right, self.info.model)
        self.drive(twist.v, twist.w)

    def stop(self) -> None:
        """Stop the robot, also when others drive."""
        self.started.end()
        self.arbiter.stop(by=self._hold)

    def reset_emergency_stop(self) -> None:
        """Release the latch of the emergency stop. The motors stay off."""
        self.arbiter.reset_emergency_stop()

    async def motors(self, on: bool) -> None:
        """Switch the motors' power; return when the robot confirms it.

        Raises:
            MotionError: the robot did not follow, or the link was lost.
        """
        self.stop()
        refused = self.supervisor.set_motors(on=on)
        if refused:
            raise MotionError(str(refused))
        with lost_as_motion_error("motors"):
            async for snapshot in self.snapshots(MOTOR_PATIENCE):
                if snapshot.motors.enabled == on:
                    return
        failure = f"the motors did not switch {'on' if on else 'off'}"
        raise MotionError(advised(self.why_not_moving()) or failure)

    async def move(self, distance: float, speed: float | None = None) -> None:
        """Drive `distance` [m] straight ahead, negative backwards, at `speed` [m/s] at most.

        Raises:
            CommandError: not finite numbers.
            MotionError: it did not get there, or the link was lost; see the message.
        """
        await self._carry_out(self._move(distance, speed))

    async def turn(self, angle: float, rate: float | None = None) -> None:
        """Turn on the spot by `angle` [rad], at `rate` [rad/s] at most.

        Raises:
            CommandError: not finite numbers.
            MotionError: it did not get there, or the link was lost; see the message.
        """
        await self._carry_out(self._turn(angle, rate))

    def start_move(self, distance: float, speed: float | None = None) -> None:
        """Begin a :meth:`move` and return at once.

        The next command of this program ends it. :meth:`is_move_done` tells of its end.

        Raises:
            CommandError: not finite numbers.
            MotionError: the robot will not move; the message gives the reason.
        """
        self._start(self._move(distance, speed))

    def set_delta_heading(self, angle: float, rate: float | None = None) -> None:
        """Begin a :meth:`turn` by `angle` [rad] and return at once, as :meth:`start_move` does."""
        self._start(self._turn(angle, rate))

    def set_heading(self, heading: float, rate: float | None = None) -> None:
        """Begin to turn to a heading of odometry's frame [rad], by the shorter way.

        It returns at once, as :meth:`start_move` does.
        """
        snapshot = self.snapshot
        if snapshot is None:
            raise MotionError(advised(self.why_not_moving()))
        here = snapshot.odometry.robot_in_odom.theta
        self.set_delta_heading(wrap(finite("heading", heading) - here), rate)

    def is_move_done(self) -> bool:
        """Return whether the motion that was started last has reached its aim.

        It is true as well where none was started, or a later command of this program ended it.

        Raises:
            MotionError: something else ended it, or the link was lost; see the message.
        """
        return self.started.done

    async def goto(
        self,
        x: float | str,
        y: float | None = None,
        heading: float | None = None,
        *,
        speed: float | None = None,
    ) -> None:
        """Drive to a point of odometry's frame [m], or to a place of the map by its name.

        At `speed` [m/s] at most. To a point it drives straight, slower near obstacles and around
        those that are small, and turns to `heading` [rad] if that is given. To a place it drives
        along a planned way.

        Raises:
            CommandError: not finite numbers, or a name without a map.
            ConfigError: the map has no such place.
            MotionError: it did not get there, or the link was lost; see the message.
        """
        top = _top("speed", speed, self.info.limits.max_speed)
        if isinstance(x, str):
            if self.navigator is None:
                raise CommandError(f"goto {x}: there is no map: connect with line_map=...")
            self.started.end()
            await self.navigator.goto(x, top)
            return
        if y is None:
            raise CommandError("goto: give x and y, or the name of a place of the map")
        end = None if heading is None else finite("heading", heading)
        mode = goto(finite("x", x), finite("y", y), end, speed=top)
        self.started.end()
        await run_mode(mode, self.arbiter, self.snapshots(), until=inf)

    async def run(self, mode: Stack, seconds: float = inf) -> None:
        """Let `mode` drive as :meth:`Driven.run` tells, in place of a motion that was started."""
        self.started.end()
        await super().run(mode, seconds)

    def send(self, command: Command) -> None:
        """Send any ARCOS command that is not about motion.

        Raises:
            CommandError: no session is open, the command does not fit the protocol, or it moves
                the robot.
        """
        self.supervisor.send(command)

    def send_unsafe(self, command: Command) -> None:
        """Send any ARCOS command at all; see :meth:`Supervisor.send_unsafe` for the consequences.

        Raises:
            CommandError: no session is open, or the command does not fit the protocol.
        """
        self.supervisor.send_unsafe(command)

    def _move(self, distance: float, speed: float | None) -> Move:
        limits = self.info.limits
        return Move(
            distance=finite("distance", distance),
            speed=_top("speed", speed, limits.max_speed),
            deceleration=limits.deceleration,
        )

    def _turn(self, angle: float, rate: float | None) -> Turn:
        limits = self.info.limits
        return Turn(
            angle=finite("angle", angle),
            rate=_top("rate", rate, limits.max_turn_rate),
            deceleration=limits.turn_deceleration,
        )

    async def _carry_out(self, action: Move | Turn) -> None:
        self.started.end()
        self._hold.release()
        await carry_out(action, self.arbiter, self.supervisor, self.snapshots())

    def _start(self, action: Move | Turn) -> None:
        self._hold.release()
        self.started.start(action, self.snapshots())


def _top(name: str, wanted: float | None, most: float) -> float:
    """Return the `wanted` top speed or rate, `most` at most."""
    number = most if wanted is None else finite(name, wanted)
    if number <= 0:
        raise CommandError(f"{name} must be positive, not {number:g}")
    return min(number, most)
