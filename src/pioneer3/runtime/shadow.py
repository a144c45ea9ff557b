"""A digital shadow: a simulated twin that is told what a robot is told, and where the two part.

The twin gets the very bytes that the robot gets, so that ramps, limits and the watchdog are those
of the robot. Only the ways of the last seconds are compared: errors of older ones do not add up.
What the wheels did is compared with what they were told, and where the robot is known on a map,
the way over the ground with that of the wheels.
"""

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import hypot, inf

from pioneer3.geometry import ORIGIN, Pose2, arc, arc_to
from pioneer3.links.tap import FROM_HOST, OPEN
from pioneer3.models import RobotModel
from pioneer3.robot.pilot import stands
from pioneer3.robot.supervisor import Supervisor
from pioneer3.runtime.parting import (
    HOLDS,
    LEAST,
    STANDS,
    Cause,
    Parting,
    SideLack,
    best_of,
    cause_of,
    held_by,
)
from pioneer3.runtime.twin import Twin
from pioneer3.sim.body import Body
from pioneer3.state import Snapshot

WINDOW = 5.0
"""Ways of so long are compared [s]."""
LAGS = 6
"""A robot's reports are behind its twin by less than so many reports: by links, loops, reports."""
JITTER = 0.1
"""They come so irregularly [s]."""
SHARE = 0.05
"""So do those that differ by less than this share."""
ASIDE = 0.035
"""Sides whose ways lack nearly the same agree [m]: what delays a robot delays both."""
ASIDE_SHARE = 0.25
"""So do those that lack less than this share of their way around each other: they skid."""
GROUND_LEAST = 0.04
"""Ways over the ground and of the wheels that differ by less agree [m]: a place on a map is known
to a centimetre."""
GROUND_SHARE = 0.02
"""Odometry that was never calibrated is wrong by about this share, which is learnt."""
LEARNT = 2.0
"""Way after which that is half known [m]."""
PIECE = 1.0
"""Ways are compared in pieces of so long: within them, a turn that slips bends nothing [s]."""
LATELY = 1.2
"""A robot that has hardly moved within this time since it stalled is stuck [s]."""
GIVES = 0.06
"""Way that hands give meanwhile [m]."""
FREE = 0.15
"""A robot that has moved by this is free again [m]: until then one thing holds it."""
LASTS = 1.0
"""A difference that lasts for so long is believed [s]: on hard turns wheels lag behind for less."""
SLIP_LASTS = 0.4
"""Time for which a difference over the ground lasts that is believed [s]: no ramp is behind it."""
TESTS = 0.05
"""Speed that a wheel is to have if it is to tell whether the robot is held [m/s]."""
AS_TOLD = 0.12
"""Share by which the speed of a side differs at most that goes as it should."""
STRAIGHT = 0.06
"""Sides whose speeds differ by less go straight, for which nothing sound has to push [m/s]."""
STALL = 1.0
"""A robot that stands within this time of a stall was stopped by it [s]."""
READ = 2.0
"""Shortest time for which it is told [s]."""
MOST = 1 << 16
"""Bytes from before the robot said what it is that are kept for its twin."""


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
        self._stood = ORIGIN
        self._drags: Cause | None = None
        self._both = False
        self._mark: _Moment | None = None
        self._rolled = self._lost = 0.0

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
        drags = self._feel(snapshot) if snapshot.motors.stalled else None
        if drags is not None and held_by(snapshot, model, back=False) is Cause.HELD:
            self.parting = None  # whatever was told before
            self._tell(self._parting(drags, 0.0), snapshot)
        if len(self._moments) > 1 and self._is_blocked(snapshot):
            cause = self._why_stuck(best_of(self._compared(self._moments)), snapshot, model)
            self._tell(self._parting(cause, 1.0), snapshot)
            self._moments.clear()  # the driver stops what stalls
            return self.parting
        self._decide(self._judge(snapshot, model) if len(self._moments) > 1 else None, snapshot)
        return self.parting

    def _is_blocked(self, snapshot: Snapshot) -> bool:
        """Whether the motors push, or did just now, and nothing turns any more.

        On hard turns they may push hard, too.
        """
        stall = self._stall
        return stall is not None and snapshot.stamp - stall.stamp < STALL and stands(snapshot)

    def _why_stuck(self, lacks: Sequence[SideLack], snapshot: Snapshot, model: RobotModel) -> Cause:
        """Return the side that drags by the last stalls, or what else holds the robot."""
        if self._drags is not None:
            return self._drags
        return held_by(snapshot, model, back=sum(each.told for each in lacks) < 0)

    def _feel(self, snapshot: Snapshot) -> Cause | None:
        """Note a stall, and which side drags by the last ones; return the one that surely does.

        A side drags that pushes alone while the other one goes as it should: surely where both are
        to go straight, as nothing sound pushes there. One that only brakes hard tells nothing.
        """
        motors, odometry = snapshot.motors, snapshot.odometry
        before, speeds = list(self._moments)[-LAGS:], (odometry.left_speed, odometry.right_speed)
        other = 1 if motors.left_stalled else 0
        is_alone = motors.left_stalled != motors.right_stalled
        if self._stall is None or snapshot.stamp - self._stall.stamp > WINDOW:
            if is_alone and before and _brakes(speeds, before, 1 - other):
                self._moments.clear()  # its ramp begins anew at the speed of the wheel
                return None
            self._drags, self._both = None, False
        self._stall = snapshot
        self._both |= not is_alone
        told = [each.twin_speeds[other] for each in before if abs(each.twin_speeds[other]) > TESTS]
        if not is_alone or not any(abs(speeds[other] / each - 1) < AS_TOLD for each in told):
            return None
        self._drags = Cause.LEFT_DRAGS if motors.left_stalled else Cause.RIGHT_DRAGS
        apart = max(abs(each.twin_speeds[1] - each.twin_speeds[0]) for each in before)
        return self._drags if apart < STRAIGHT and not self._both else None

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
        here, before = snapshot.odometry.robot_in_odom, self.parting
        if before is None or hypot(here.x - self._stood.x, here.y - self._stood.y) > FREE:
            self._stood = here
        elif before.cause in HOLDS and parting.cause is not Cause.IN_THE_WAY:
            parting = replace(parting, cause=before.cause)
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
            self._learn(self._moments.popleft())

    def _learn(self, moment: _Moment) -> None:
        """Learn which share of its way over the ground the robot usually lacks."""
        mark, now = self._mark, moment.robot_in_map
        if self.parting is not None or now is None:
            self._mark = None
        elif mark is None or moment.stamp - mark.stamp >= PIECE:
            self._mark = moment
            if mark and mark.robot_in_map and moment.stamp - mark.stamp < 2 * PIECE:
                rolled = _way([mark.robot_in_odom, moment.robot_in_odom])
                self._rolled += rolled
                self._lost += rolled - _way([mark.robot_in_map, now])

    def _judge(self, snapshot: Snapshot, model: RobotModel) -> Parting | None:
        both = self._compared(self._moments)
        lacks = best_of(both)
        aside = min(abs(left.missing - right.missing) for left, right in both)
        told = [each.twin[1] - each.twin[0] for each in self._moments]
        allowed = ASIDE + ASIDE_SHARE * sum(abs(b - a) for a, b in pairwise(told))
        drags = aside > allowed and any(each.share * abs(each.told) > LEAST for each in lacks)
        if drags or any(each.excess > 0 for each in lacks):
            cause = self._stuck(snapshot, model) or cause_of(lacks, snapshot, model)
            return self._parting(cause, max(each.share for each in lacks))
        return self._judge_ground()

    def _stuck(self, snapshot: Snapshot, model: RobotModel) -> Cause | None:
        """Return the cause that holds a robot which stalled and has hardly moved lately."""
        lately = [each for each in self._moments if each.stamp > snapshot.stamp - LATELY]
        lacks = best_of(self._compared(lately))
        moves = any(abs(each.told - each.missing) > GIVES for each in lacks)
        if moves or self._stall is None or snapshot.stamp - self._stall.stamp > WINDOW:
            return None
        return self._why_stuck(lacks, snapshot, model)

    def _compared(self, moments: Iterable[_Moment]) -> list[list[SideLack]]:
        """Compare with the twin of each number of reports before."""
        each = list(moments)
        lags = range(max(1, min(LAGS, len(each) - 1)))
        return [self._lacks(each[lag:], each[: len(each) - lag]) for lag in lags]

    def _lacks(self, real: Sequence[_Moment], twin: Sequence[_Moment]) -> list[SideLack]:
        """Compare the ways of a robot with those of its twin."""
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
            lacks.append(SideLack(told, told - went, allowed))
        return lacks

    def _judge_ground(self) -> Parting | None:
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
        known_way = self._rolled + LEARNT
        allowed = hypot(GROUND_LEAST, GROUND_SHARE * rolled * LEARNT / known_way)
        usual = rolled * self._lost / known_way
        if rolled - went - usual <= allowed:
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


def _brakes(speeds: tuple[float, float], before: Sequence[_Moment], side: int) -> bool:
    """Whether a side goes on faster than it is told to, which is less than `before` [m/s]."""
    then, told, speed = before[0].twin_speeds[side], before[-1].twin_speeds[side], speeds[side]
    return abs(told) < abs(then) and (speed - told) * speed > 0


def _way(poses: Sequence[Pose2]) -> float:
    """Return how far a way leads by poses on it, which are close together [m]."""
    return sum(hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(poses))
