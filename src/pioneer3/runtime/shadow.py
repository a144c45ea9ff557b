"""A digital shadow: a simulated twin that is told what a robot is told, and where the two part.

The twin gets the very bytes that the robot gets, so that ramps, limits and the watchdog are those
of the robot. Only the ways of the last seconds are compared: errors of older ones do not add up.
What the wheels did is compared with what they were told, and where the robot is known on a map,
the way over the ground with that of the wheels.
"""

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from math import hypot, inf, pi, radians

from pioneer3.arcos.device import Commanded, Device, SessionClosed, WatchdogExpired, WatchdogFed
from pioneer3.geometry import ORIGIN, Pose2, arc, arc_to, wrap
from pioneer3.links.tap import FROM_HOST, OPEN
from pioneer3.models import RobotModel
from pioneer3.robot.pilot import stands
from pioneer3.robot.supervisor import Supervisor
from pioneer3.sim.body import Body
from pioneer3.sim.firmware.steering import steer
from pioneer3.sim.world import World
from pioneer3.state import Identity, Snapshot

WINDOW = 5.0
"""Ways of so long are compared [s]."""
LAGS = 6
"""A robot's reports are behind its twin by less than so many reports: by links, loops, reports."""
JITTER = 0.1
"""They come so irregularly [s]."""
LEAST = 0.03
"""Ways of wheels that differ by less agree [m]."""
SHARE = 0.05
"""So do those that differ by less than this share."""
GROUND_LEAST = 0.025
"""Ways over the ground and of the wheels that differ by less agree [m]."""
GROUND_SHARE = 0.02
"""So do those that differ by less than this share: odometry that was never calibrated is so wrong,
and a place on a map is known to a centimetre or two."""
PIECE = 1.0
"""Ways are compared in pieces of so long: within them, a turn that slips bends nothing [s]."""
SKID = 0.02
"""Share of the way of its sides around each other that a skid-steered robot may lose besides."""
STANDS = 0.15
"""Wheels that went less than this share of the way that they should have gone stand."""
ALIKE = 0.5
"""Both sides are slow if the better one lacks at least this share of what the other lacks."""
LASTS = 1.0
"""A difference that lasts for so long is believed [s]: on hard turns wheels lag behind for less."""
SLIP_LASTS = 0.3
"""Time for which a difference over the ground lasts that is believed [s]: no ramp is behind it."""
STALL = 1.0
"""A robot that stands within this time of a stall was stopped by it [s]."""
PUSHES = 0.35
"""A side is stalled after it has pushed for about so long [s]."""
READ = 2.0
"""Shortest time for which it is told [s]."""
NEAR = 0.3
"""An echo so near ahead of a sonar is of something in the way [m]."""
AHEAD = radians(60)
"""Directions that count as ahead, to both sides [rad]."""
MOST = 1 << 16
"""Bytes from before the robot said what it is that are kept for its twin."""


class Cause(StrEnum):
    """The reason that fits best where a robot does not do what its twin does."""

    IN_THE_WAY = "something is in the way"
    HELD = "its wheels do not turn: it is held, braked, or stands against something low"
    BATTERY = "it is slow, and its battery is low"
    SLOW = "both sides are slow: a load, a slope, or weak motors"
    LEFT_DRAGS = "its left side drags"
    RIGHT_DRAGS = "its right side drags"
    PUSHED = "it is pushed, or rolls"
    SLIPS = "its wheels slip"
    SPINS = "its wheels turn, and it does not move: it is held, lifted, or stuck"


@dataclass(frozen=True, slots=True)
class Parting:
    """The difference between a robot and its twin, and the reason for it that fits best.

    `lacks` is the share of the way that the robot did not go, negative for too much; `twin_in_odom`
    is where a twin is now that was beside the robot when the compared time began [m, rad].
    """

    cause: Cause
    lacks: float
    twin_in_odom: Pose2

    @property
    def text(self) -> str:
        """The sentence for people."""
        if self.cause in {Cause.PUSHED, Cause.HELD, Cause.IN_THE_WAY}:
            return self.cause
        return f"{self.cause} ({100 * self.lacks:.0f} % of the way are missing)"


@dataclass(frozen=True, slots=True)
class _Moment:
    """The state at a report: ways of the wheels since the beginning [m], left, then right.

    `wheels` are by the counters, `spun` by the speeds that the robot reports. `robot_in_map` is
    `None` while its place is not sure.
    """

    stamp: float
    wheels: tuple[float, float]
    spun: tuple[float, float]
    twin: tuple[float, float]
    twin_speeds: tuple[float, float]
    robot_in_odom: Pose2
    robot_in_map: Pose2 | None


class Twin:
    """A robot of a model without errors on an empty plane, which obeys the bytes of a host."""

    def __init__(self, model: RobotModel, now: float) -> None:
        self.body = Body(model)
        self._world = World(robots=[self.body])
        self._device = Device(Identity(name="", family=model.family, model=model.name))
        self._now = now

    def receive(self, data: bytes, now: float) -> None:
        """Obey what the host sends at `now` [s]."""
        self.go_on(now)
        for event in self._device.receive(data, now):
            self._obey(event)
        self._device.outgoing()

    def go_on(self, now: float) -> None:
        """Move until `now` [s]."""
        if now <= self._now:
            return
        for event in self._device.tick(now):
            self._obey(event)
        self._world.step(now - self._now)
        self._now = now

    def _obey(self, event: object) -> None:
        match event:
            case Commanded(command):
                steer(self.body, command)
            case WatchdogExpired():
                self.body.drive.held = True
            case WatchdogFed():
                self.body.drive.held = False
            case SessionClosed():
                self.body.session_ended()


class Shadow:
    """The twin of one robot: give it the robot's link and its snapshots; read `parting`.

    Attributes:
        parting: Where the robot differs now; `None` while it does what it should.
        odom_in_map: Returns the pose of odometry's frame on the map [m, rad], `None` while that is
            not sure.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self.parting: Parting | None = None
        self.odom_in_map: Callable[[], Pose2 | None] = lambda: None
        self._clock = clock
        self._twin: Twin | None = None
        self._unheard: list[tuple[float, bytes]] = []
        self._moments: deque[_Moment] = deque()
        self._encoder = ORIGIN
        self._since, self._until = inf, -inf
        self._stall: Snapshot | None = None

    def now(self) -> float:
        """Return the time [s]."""
        return self._clock()

    def remark(self, words: str) -> None:
        """Begin anew with each connection."""
        if words.startswith(OPEN):
            self._twin, self.parting, self._stall = None, None, None
            self._unheard.clear()
            self._moments.clear()

    def note(self, way: str, data: bytes, now: float) -> None:
        """Take bytes that pass `now` [s]; the twin gets those from the host."""
        if way != FROM_HOST:
            return
        if self._twin is not None:
            self._twin.receive(data, now)
        elif sum(len(each) for _, each in self._unheard) < MOST:
            self._unheard.append((now, data))

    async def follow(self, supervisor: Supervisor, tell: Callable[[str], None]) -> None:
        """Take the snapshots of a robot until cancelled; tell in words what changes."""
        told: Cause | None = None
        async for snapshot in supervisor.snapshots.values():
            assert supervisor.info is not None
            parting = self.take(snapshot, supervisor.info.model)
            cause = parting.cause if parting else None
            if cause is not told:
                tell(parting.text if parting else "it does again what its twin does")
                told = cause

    def take(self, snapshot: Snapshot, model: RobotModel) -> Parting | None:
        """Take the next snapshot; return where the robot differs now."""
        twin = self._twin_of(model, snapshot.stamp)
        twin.go_on(snapshot.stamp)
        self._add(snapshot, twin.body)
        here = snapshot.odometry.robot_in_encoder
        twin.body.reset_odometry(here)  # both mean the same by a heading
        self._encoder = here
        if not snapshot.motors.enabled or snapshot.motors.stop_button:
            self._moments.clear()  # it stands, whatever it was told before
        if snapshot.motors.stalled:
            self._stall = snapshot
        if len(self._moments) > 1 and self._is_blocked(snapshot):
            cause = self._cause_of_stall(snapshot, model)
            if cause is not None:
                self._tell(self._parting(cause, 1.0), snapshot)
            self._moments.clear()  # the driver stops what stalls
            self._stall = None
            return self.parting
        self._decide(self._judge(snapshot, model) if len(self._moments) > 1 else None, snapshot)
        return self.parting

    def _is_blocked(self, snapshot: Snapshot) -> bool:
        """Whether the motors push, or did just now, and nothing turns any more.

        On hard turns they may push hard, too.
        """
        stall = self._stall
        return stall is not None and snapshot.stamp - stall.stamp < STALL and stands(snapshot)

    def _cause_of_stall(self, snapshot: Snapshot, model: RobotModel) -> Cause | None:
        """Return the cause of a stall: a side that drags stalls alone, while the other one goes.

        A robot that brakes hard on a turn pushes as hard, and goes as it should: `None`.
        """
        assert self._stall is not None
        motors, at = self._stall.motors, self._stall.stamp
        pushing = [each for each in self._moments if -PUSHES < each.stamp - at <= 0]
        first, last = (pushing or self._moments)[0], (pushing or self._moments)[-1]
        if motors.left_stalled != motors.right_stalled:
            stalled, other = (0, 1) if motors.left_stalled else (1, 0)
            told = [b - a or inf for a, b in zip(first.twin, last.twin, strict=True)]
            if (last.wheels[stalled] - first.wheels[stalled]) / told[stalled] > ALIKE:
                return None
            if self._went(first, last)[other] / told[other] > ALIKE:
                return Cause.LEFT_DRAGS if motors.left_stalled else Cause.RIGHT_DRAGS
        return _held(snapshot, model, back=sum(last.twin) < sum(first.twin))

    def _went(self, first: _Moment, last: _Moment) -> tuple[float, float]:
        """Return the ways of both sides [m], over the ground where that is known."""
        if first.robot_in_map is None or last.robot_in_map is None:
            left, right = (b - a for a, b in zip(first.wheels, last.wheels, strict=True))
            return left, right
        assert self._twin is not None
        moved, _ = arc_to(first.robot_in_map.inverse() @ last.robot_in_map)
        aside = moved.w * self._twin.body.track / 2
        return moved.v - aside, moved.v + aside

    def _decide(self, found: Parting | None, snapshot: Snapshot) -> None:
        """Believe what lasts, and keep it for as long as people need to read it."""
        now = snapshot.stamp
        if found is None:
            self._since = inf
            if now - self._until > 0:
                self.parting = None
            return
        self._since = min(self._since, now)
        lasts = SLIP_LASTS if found.cause in {Cause.SLIPS, Cause.SPINS} else LASTS
        if now - self._since >= lasts:
            self._tell(found, snapshot)

    def _tell(self, parting: Parting, snapshot: Snapshot) -> None:
        self.parting, self._until = parting, snapshot.stamp + READ

    def _twin_of(self, model: RobotModel, now: float) -> Twin:
        if self._twin is None:
            self._twin = Twin(model, self._unheard[0][0] if self._unheard else now)
            for at, data in self._unheard:
                self._twin.receive(data, at)
            self._unheard.clear()
        return self._twin

    def _add(self, snapshot: Snapshot, body: Body) -> None:
        odometry, odom_in_map = snapshot.odometry, self.odom_in_map()
        wheels = spun = (0.0, 0.0)
        if self._moments:
            before = self._moments[-1]
            passed = snapshot.stamp - before.stamp
            spun = (
                before.spun[0] + odometry.left_speed * passed,
                before.spun[1] + odometry.right_speed * passed,
            )
            step, _ = arc_to(self._encoder.inverse() @ odometry.robot_in_encoder)
            aside = step.w * body.track / 2
            wheels = before.wheels[0] + step.v - aside, before.wheels[1] + step.v + aside
        v, w = body.speeds
        aside = w * body.track / 2
        moment = _Moment(
            stamp=snapshot.stamp,
            wheels=wheels,
            spun=spun,
            twin=body.wheel_travel,
            twin_speeds=(v - aside, v + aside),
            robot_in_odom=odometry.robot_in_odom,
            robot_in_map=odom_in_map and odom_in_map @ odometry.robot_in_odom,
        )
        self._moments.append(moment)
        while self._moments[0].stamp < snapshot.stamp - WINDOW:
            self._moments.popleft()

    def _judge(self, snapshot: Snapshot, model: RobotModel) -> Parting | None:
        lags = range(min(LAGS, len(self._moments) - 1))
        lacks = min(map(self._lacks, lags), key=lambda both: max(each.excess for each in both))
        if any(each.excess > 0 for each in lacks):
            cause = _cause(lacks, snapshot, model)
            return self._parting(cause, max(each.share for each in lacks))
        return self._judge_ground(model)

    def _lacks(self, lag: int) -> "list[_Lack]":
        """Compare with the twin of so many reports before."""
        moments = list(self._moments)
        real, twin = moments[lag:], moments[: len(moments) - lag]
        lacks = []
        for side in (0, 1):
            told = twin[-1].twin[side] - twin[0].twin[side]
            went = min(
                real[-1].wheels[side] - real[0].wheels[side],
                real[-1].spun[side] - real[0].spun[side],  # counters of a simulator may come late
                key=lambda way: abs(told - way),
            )
            speeds = [each.twin_speeds[side] for each in twin]
            allowed = LEAST + SHARE * abs(told) + JITTER * (max(speeds) - min(speeds))
            lacks.append(_Lack(told, told - went, allowed))
        return lacks

    def _judge_ground(self, model: RobotModel) -> Parting | None:
        """Compare the way over the ground with that of the wheels."""
        known = [each for each in self._moments if each.robot_in_map is not None]
        if not known:
            return None
        marks = known[:1]
        for each in known:
            if each.stamp - marks[-1].stamp >= PIECE:
                marks.append(each)
        rolled = _way([each.robot_in_odom for each in marks])
        went = _way([each.robot_in_map for each in marks if each.robot_in_map is not None])
        allowed = GROUND_LEAST + GROUND_SHARE * rolled
        if model.drive == "skid":
            aside = [each.wheels[1] - each.wheels[0] for each in known]
            allowed += SKID / 2 * sum(abs(b - a) for a, b in pairwise(aside))
        if rolled - went <= allowed:
            return None
        cause = Cause.SPINS if went < STANDS * rolled else Cause.SLIPS
        return self._parting(cause, 1 - went / rolled)

    def _parting(self, cause: Cause, lacks: float) -> Parting:
        """Return the difference, with the twin that began beside the robot."""
        assert self._twin is not None
        pose = self._moments[0].robot_in_odom
        for before, after in pairwise(self._moments):
            left, right = (b - a for a, b in zip(before.twin, after.twin, strict=True))
            pose @= arc((left + right) / 2, (right - left) / self._twin.body.track, 1.0)
        return Parting(cause, lacks, pose)


@dataclass(frozen=True, slots=True)
class _Lack:
    """The way that a side was told to go, what it lacks of it, and how much may be lacking [m]."""

    told: float
    missing: float
    allowed: float

    @property
    def share(self) -> float:
        """The missing share of the way; 0 where there was none to go."""
        return self.missing / self.told if abs(self.told) > LEAST else 0.0

    @property
    def excess(self) -> float:
        """How much more than allowed is missing, or too much [m]; positive if that is wrong."""
        return abs(self.missing) - self.allowed

    @property
    def slow(self) -> bool:
        """Whether too much is missing."""
        return self.excess > 0 and self.share > 0


def _cause(lacks: Sequence[_Lack], snapshot: Snapshot, model: RobotModel) -> Cause:
    """Return why the wheels differ from what they were told."""
    shares = [each.share for each in lacks]
    if min(shares) > 1 - STANDS:
        return _held(snapshot, model, back=sum(each.told for each in lacks) < 0)
    if not any(each.slow for each in lacks):
        return Cause.PUSHED
    if min(shares) < ALIKE * max(shares):
        return Cause.LEFT_DRAGS if shares[0] > shares[1] else Cause.RIGHT_DRAGS
    return Cause.BATTERY if snapshot.battery.low else Cause.SLOW


def _held(snapshot: Snapshot, model: RobotModel, *, back: bool) -> Cause:
    """Return the cause for which no wheel turns."""
    is_met = any((*snapshot.bumpers.front, *snapshot.bumpers.rear))
    return Cause.IN_THE_WAY if is_met or _is_near(snapshot, model, back=back) else Cause.HELD


def _is_near(snapshot: Snapshot, model: RobotModel, *, back: bool) -> bool:
    """Whether something echoes close ahead, or behind."""
    pairs = zip(model.sonars, snapshot.sonar.ranges, strict=False)
    return any(
        heard < NEAR and abs(wrap(mount.theta + (pi if back else 0.0))) < AHEAD
        for mount, heard in pairs
    )


def _way(poses: Sequence[Pose2]) -> float:
    """Return how far a way leads by poses on it, which are close together [m]."""
    return sum(hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(poses))
