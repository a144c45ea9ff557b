"""Drives the legs of a step within free space, and keeps what wheels, sonars and laser say."""

import asyncio
from collections.abc import Sequence
from contextlib import AsyncExitStack, suppress
from dataclasses import dataclass, field
from math import degrees, inf, isfinite, nan, radians
from typing import Protocol

import numpy as np

from pioneer3.arrays import Float
from pioneer3.behaviors.action import MODE, Action, Desire, Ranked, Situation, Stack
from pioneer3.behaviors.actions import Move, Turn
from pioneer3.behaviors.actions.limiters import (
    LimiterBackwards,
    LimiterForwards,
    LimiterSweep,
    LimiterTableSensor,
)
from pioneer3.behaviors.surroundings import Buffer
from pioneer3.calibration.track import RawTrack
from pioneer3.errors import DeviceError, MotionError
from pioneer3.geometry import ORIGIN, Extent, Pose2, wrap
from pioneer3.models import RobotModel
from pioneer3.robot.devices import Devices
from pioneer3.robot.devices.gyro import GyroReading
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.runtime.driven import Driven
from pioneer3.runtime.motions import lost_as_motion_error
from pioneer3.state import Scan, Snapshot
from pioneer3.tasks import running

SPEED = 0.25
"""Speed of legs: wheels that are driven slowly do not slip [m/s]."""
TURN_RATE = radians(30)
"""Turn rate of legs [rad/s]."""
CLEARANCE = 0.12
"""Room that is kept around a robot [m]."""
STILL_TIME = 0.7
"""Time until a robot that has stopped stands still [s]."""
BLOCKED_PATIENCE = 4.0
"""A robot that has stood for so long on its way is held up [s]."""
MOVED = 0.005
"""Way or turn above which a robot is not held up [m, rad]."""
SCAN_PATIENCE = 3.0
"""Longest wait for a scan of a robot that stands [s]."""
SCANS_KEPT = 400
"""Scans of a robot that moves which are kept at most."""


@dataclass(frozen=True, slots=True)
class CourseLeg:
    """A way ahead [m] or a turn on the spot [rad], counter-clockwise."""

    way: float = 0.0
    turn: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class StepDrive:
    """All that was counted and seen on a step.

    Attributes:
        track: Raw odometry, without corrections.
        marks: Its poses at which the robot stood: at the beginning and after each leg.
        stands: A scan at each of these; empty without a laser.
        scans: Scans in motion.
        echoes: Raw heading, which goes on beyond a full turn [rad], number of the transducer, and
            range [m] of what sonars heard, shape (M, 3).
        gyro_turn: Turn from the first to the last of the marks by the gyro [rad]; NaN without one.
    """

    track: RawTrack
    marks: Sequence[int]
    stands: Sequence[Scan]
    scans: Sequence[Scan]
    echoes: Float
    gyro_turn: float = nan


class Measurable(Driven, Protocol):
    """A robot whose laser can be looked through, and whose gyro read."""

    @property
    def devices(self) -> Devices:
        """Devices that it carries."""

    @property
    def laser(self) -> LaserSource:
        """The laser that it looks through, if it is there."""


@dataclass(slots=True, kw_only=True)
class Advancing(Action):
    """Lets a motion drive, and gives up where that is held up.

    Attributes:
        last_stop: Number of the last stop before its end.
    """

    motion: Move | Turn
    name: str = "calibration"
    failed: str | None = None
    last_stop: int = 0
    _since: float = inf
    _place: Pose2 = ORIGIN

    @property
    def done(self) -> bool:
        """Whether it has reached its aim."""
        return self.motion.done

    def decide(self, situation: Situation) -> Desire | None:
        """Return the motion's desire."""
        self.last_stop = situation.last_stop.number
        here, was = situation.pose, self._place
        moved = max(abs(here.x - was.x), abs(here.y - was.y), abs(wrap(here.theta - was.theta)))
        if moved > MOVED or self._since == inf:
            self._since, self._place = situation.now, here
        elif situation.now - self._since > BLOCKED_PATIENCE and not self.done:
            self.failed = "something near holds the robot up: make room, and repeat this step"
        return self.motion.decide(situation)


def _leg(robot: Driven, leg: CourseLeg) -> tuple[Stack, Advancing]:
    """Return the mode that drives a leg and stops for whatever is near, and what advances it."""
    limits = robot.info.limits
    motion: Move | Turn
    if leg.turn:
        rate = min(TURN_RATE, limits.max_turn_rate)
        motion = Turn(angle=leg.turn, rate=rate, deceleration=limits.turn_deceleration)
    else:
        speed = min(SPEED, limits.max_speed)
        motion = Move(distance=leg.way, speed=speed, deceleration=limits.deceleration)
    advancing = Advancing(motion=motion)
    actions = [
        Ranked(100, LimiterTableSensor()),
        Ranked(90, LimiterForwards(CLEARANCE, 0.5, SPEED)),
        Ranked(85, LimiterSweep()),
        Ranked(80, LimiterBackwards()),
        Ranked(50, advancing),
    ]
    return Stack.of("calibration", MODE, actions, "drives to be measured"), advancing


def ground_of(model: RobotModel, length: float) -> Extent:
    """Return the ground that a robot takes that turns at both ends of a line of `length` [m]."""
    reach = model.corner + CLEARANCE
    return Extent(-reach, -reach, length + reach, reach)


def require_room(robot: Driven, room: Extent) -> None:
    """Raise MotionError if a sensor sees something in the `room` around a robot [m], or none looks.

    It is ahead and to the left of the robot's middle.
    """
    situation = robot.arbiter.situation()
    if situation is None:
        raise MotionError("the link is lost")
    if not situation.around.sensing:
        raise MotionError("no sonar and no laser looks out: switch the sonars on")
    echo = situation.around.nearest_in_box(*room, Buffer.CURRENT)
    if isfinite(echo.distance):
        side = "left" if echo.bearing > 0 else "right"
        raise MotionError(
            f"something is {echo.distance:.2f} m away, {abs(degrees(echo.bearing)):.0f} degrees to "
            f"the {side}: this step takes the ground from {room.x_min:.2f} to {room.x_max:.2f} m "
            f"ahead, and from {-room.y_min:.2f} m to the right to {room.y_max:.2f} m to the left; "
            "move it, or the robot, and repeat this step"
        )


@dataclass(slots=True)
class _Recorder:
    """Notes what a robot says while it drives."""

    robot: Measurable
    by_laser: bool
    stamps: list[float] = field(default_factory=list)
    poses: list[Pose2] = field(default_factory=list)
    echoes: list[tuple[float, int, float]] = field(default_factory=list)
    scans: list[Scan] = field(default_factory=list)
    heading: float = 0.0
    sessions: int | None = None
    gyro: GyroReading | None = None
    gyro_heading: float = 0.0

    async def run(self) -> None:
        """Take each snapshot."""
        with lost_as_motion_error("calibration"):
            async for snapshot in self.robot.snapshots():
                self.take(snapshot)

    def take(self, snapshot: Snapshot) -> None:
        """Note one; MotionError if the link was lost before it."""
        if self.sessions not in {None, snapshot.link.sessions}:
            raise MotionError("the link was lost on the way: repeat this step")
        self.sessions = snapshot.link.sessions
        if self.stamps and snapshot.stamp <= self.stamps[-1]:
            return
        here = snapshot.odometry.robot_in_encoder
        if self.poses:
            self.heading += wrap(here.theta - self.poses[-1].theta)
        self.stamps.append(snapshot.stamp)
        self.poses.append(here)
        gyro = self.robot.devices.gyro.latest
        if gyro is not None:
            self.gyro_heading += wrap(gyro.heading - self.gyro.heading) if self.gyro else 0.0
            self.gyro = gyro
        ranges = snapshot.sonar.ranges
        self.echoes += [(self.heading, n, ranges[n]) for n in snapshot.sonar.fresh]
        scan = self.robot.laser.latest if self.by_laser else None
        if scan is not None and (not self.scans or scan.sequence != self.scans[-1].sequence):
            self.scans.append(scan)
            if len(self.scans) > 2 * SCANS_KEPT:
                del self.scans[::2]


async def drive(
    robot: Measurable, legs: Sequence[CourseLeg], room: Extent, *, by_laser: bool = False
) -> StepDrive:
    """Drive legs one after the other; stand still between them, and look `by_laser`.

    Raises:
        MotionError: There is no room, something came in the way, somebody stopped the robot, or
            the link was lost; see the message.
    """
    require_room(robot, room)
    known = robot.arbiter.last_stop.number
    recorder = _Recorder(robot, by_laser)
    marks: list[int] = []
    stands: list[Scan] = []
    turned: list[float] = []

    async def stand() -> None:
        await asyncio.sleep(STILL_TIME)
        if by_laser:
            stands.append(await _standing(robot))
        marks.append(len(recorder.poses) - 1)
        turned.append(recorder.gyro_heading if recorder.gyro else nan)

    gyro = robot.devices.gyro
    async with AsyncExitStack() as stack:
        if by_laser:
            stack.enter_context(robot.laser.wanted())
        await stack.enter_async_context(running(recorder.run()))
        if gyro.presence.there:
            stack.enter_context(gyro.wanted())
            with suppress(DeviceError):
                await gyro.reading()  # it learns its zero
        await stand()
        for leg in legs:
            if (stop := robot.arbiter.last_stop).outdates(known):  # no leg was there to end
                raise MotionError(f"{stop.why}: repeat this step")
            mode, advancing = _leg(robot, leg)
            await robot.run(mode)
            known = advancing.last_stop
            await stand()
    if marks[0] < 0:
        raise MotionError("the robot has told nothing: repeat this step")
    return StepDrive(
        track=RawTrack.of(recorder.stamps, recorder.poses),
        marks=marks,
        stands=stands,
        scans=recorder.scans,
        echoes=np.array(recorder.echoes).reshape(-1, 3),
        gyro_turn=turned[-1] - turned[0],
    )


async def _standing(robot: Measurable) -> Scan:
    """Return a scan that has begun since the robot stands."""
    now = robot.snapshot
    since = now.stamp if now else -inf
    try:
        async with asyncio.timeout(SCAN_PATIENCE):
            async for scan in robot.laser.values():
                if scan.stamp > since:
                    return scan
    except TimeoutError:
        pass
    raise DeviceError(f"no scan for {SCAN_PATIENCE:g} s: {robot.laser.presence}")
