"""Takes a robot to places of a map, and around what is not on the map."""

import asyncio
import logging
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import hypot, inf
from typing import Self

import numpy as np
from numpy.typing import NDArray

from pioneer3.behaviors.action import Stack
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.jit import numba_version
from pioneer3.maps import LineMap
from pioneer3.maps.grid import samples
from pioneer3.nav.costs import CELL, CostMap
from pioneer3.nav.estimate import Estimate
from pioneer3.nav.follower import Follower
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.places import Destination
from pioneer3.nav.planner import CostToGo, NoWay, Way, plan
from pioneer3.nav.sightings import Sightings
from pioneer3.nav.traffic import Traveller, meeting, passing_place, without_robots
from pioneer3.nav.warm_up import warm_up
from pioneer3.robot.supervisor import Feed
from pioneer3.runtime.driven import snapshots_of
from pioneer3.runtime.follow_way import FollowWay, follow_way
from pioneer3.runtime.localization import (
    SPREAD,
    TURN_SPREAD,
    InThread,
    Localizable,
    Localization,
)
from pioneer3.runtime.look_around import look_around
from pioneer3.runtime.motions import lost_as_motion_error, run_mode
from pioneer3.runtime.traffic import Traffic
from pioneer3.state import Charging, Snapshot
from pioneer3.tasks import running

log = logging.getLogger(__name__)

PATIENCE = 3.0
"""Longest wait for a robot that knows where it is [s]."""
REPLAN_EVERY = 1.0
"""[s]."""
BLOCKED_FOR, BY_PEOPLE = 15.0, 90.0
"""A way that has been closed for so long is given up, the latter while people are about [s]."""
PAUSE = 3.0
"""A robot on patrol stands so long at each place [s]."""
HELD_UP = 6.0
"""A robot that has come no nearer for so long takes another way, if there is one [s]."""
AHEAD = 1.0
"""The place that holds a robot up is so near on its way [m]."""
AVOIDED = 120.0
"""It is kept out of for so long [s]."""
APART_EVERY, BEFORE = 0.3, 0.4
"""Whether others come near is looked at so often [s]; a robot waits so far before them [m]."""
CHARGER = 5.0
"""A charger answers within this [s]."""

PATROL = "patrol", "drives from place to place of the map"
"""Name of the mode, and what it does."""

Float = NDArray[np.float64]
NOWHERE: Float = np.empty((0, 2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Navigation:
    """The state of a navigator.

    Attributes:
        estimate: Where the robot is.
        goal: Where it goes, or `None`.
        way: Its way as planned last, or `None`.
        top_speed: On the way [m/s].
        problem: The reason that it does not come on, or empty.
    """

    estimate: Estimate
    goal: Destination | None = None
    way: Way | None = None
    top_speed: float = 0.0
    problem: str = ""


@dataclass(slots=True)
class _Drive:
    """A drive to one place after the other.

    Attributes:
        goals: The places, in their order.
        legs: Ways that are left to drive, the present one among them; `inf` without an end.
        action: Drives.
        mode: It and its guards.
        way: The present one.
        at: Number of the present place.
        closed_since: When its way was first found closed [s].
        closed: The reason, as it is now.
        arrived: When the robot came to the present place [s], if there are more.
        skipped: Places in turn that no way leads to.
        since: When it set out [s].
        aside: Whether it lets others pass, at a place beside their ways.
    """

    goals: tuple[Destination, ...]
    legs: float
    action: FollowWay
    mode: Stack
    way: Way
    since: float
    at: int = 0
    closed_since: float | None = field(default=None)
    closed: str = ""
    arrived: float | None = field(default=None)
    skipped: int = 0
    aside: bool = False

    @property
    def goal(self) -> Destination:
        return self.goals[self.at]

    @property
    def is_last(self) -> bool:
        return self.legs <= 1

    def go_on(self) -> None:
        """Take the next place."""
        self.at, self.legs = (self.at + 1) % len(self.goals), self.legs - 1
        self.closed_since = self.arrived = None


def to_drive(found: Way | NoWay) -> Way:
    """Return the way to set out on: doors open, and people go on, before they are met.

    Raises:
        MotionError: There is none; see the message.
    """
    if isinstance(found, Way):
        return found
    if found.free is None:
        raise MotionError(found.why)
    return found.free


async def compile_kernels() -> None:
    """Compile navigation in a process of its own, once after each installation: half a minute.

    Else this program would stand still meanwhile, and its robot stop.
    """
    if numba_version() and not CACHE.is_complete:
        log.warning("compiling navigation, once: half a minute")
        process = await asyncio.create_subprocess_exec(sys.executable, "-m", "pioneer3.nav")
        await process.wait()


class Navigator:
    """Navigates one robot on one map. :meth:`run` does the work.

    Args:
        robot: The robot.
        costs: Of the map for it.
        localization: On the map.
        in_thread: Runs what takes long.
        traffic: The other robots.
        name: Of the robot, for the drivers of the others.

    Attributes:
        line_map: The map.
        state: Published with each snapshot.
        costs: The same.
    """

    def __init__(
        self,
        robot: Localizable,
        costs: CostMap,
        localization: Localization,
        *,
        in_thread: InThread,
        traffic: Traffic | None = None,
        name: str = "another robot",
    ) -> None:
        self.line_map = localization.line_map
        self.state: Feed[Navigation] = Feed()
        self.costs = costs
        self._robot, self._in_thread = robot, in_thread
        self._localization, self._traffic, self._name = localization, traffic or Traffic(), name
        self._sightings = Sightings(costs)
        self._walls = samples(self.line_map.walls, CELL)
        self._clock = asyncio.get_running_loop().time
        self._drive: _Drive | None = None
        self._changing = asyncio.Lock()  # planning takes a while: one task changes drives
        self._avoided: list[tuple[float, float, float]] = []

    @classmethod
    async def on(
        cls,
        robot: Localizable,
        line_map: LineMap,
        *,
        start: Pose2 | None = None,
        rng: np.random.Generator | None = None,
        in_thread: InThread = asyncio.to_thread,
        traffic: Traffic | None = None,
        name: str = "another robot",
    ) -> Self:
        """Return the navigator of a robot on a map.

        A robot without a laser is found by its sonars.

        Args:
            robot: The robot.
            line_map: The map.
            start: Where the robot is, if anybody knows; `None` has it found.
            rng: Draws all that is random.
            in_thread: Runs what takes long.
            traffic: The other robots of this program, for which it makes way.
            name: Of the robot, for the drivers of the others.
        """
        await in_thread(warm_up)
        costs = await in_thread(CostMap.of, line_map, robot.info.model)
        drawn = rng or np.random.default_rng()
        localization = await Localization.on(robot, line_map, drawn, in_thread)
        navigator = cls(robot, costs, localization, in_thread=in_thread, traffic=traffic, name=name)
        if start is not None:
            navigator.place(start)
        return navigator

    @property
    def estimate(self) -> Estimate:
        """Where the robot is."""
        return self._localization.estimate

    @property
    def odom_in_map(self) -> Pose2:
        """The pose of odometry's frame on the map [m, rad]; the origin while it is not known."""
        return self._localization.odom_in_map

    def place(
        self, robot_in_map: Pose2, spread: float = SPREAD, turn_spread: float = TURN_SPREAD
    ) -> None:
        """Tell where the robot is, with the standard deviations of that [m, rad]."""
        self._localization.place(robot_in_map, spread, turn_spread)
        self._sightings.forget()

    def forget_obstacles(self) -> None:
        """Forget all that it has seen and that is not on the map; what is there is seen again."""
        self._sightings.forget()
        self._avoided.clear()

    def lose(self) -> None:
        """Forget where the robot is: it has been carried away."""
        self._localization.lose()
        self._sightings.forget()

    async def run(self) -> None:
        """Keep track of the robot and of its way, until cancelled."""
        with self._localization.sensing(), self._traffic.joined(self):
            async with running(self._localization.search(), self._steer(), self._keep_apart()):
                async for snapshot in self._robot.supervisor.snapshots.values():
                    self._take(snapshot)

    def _take(self, snapshot: Snapshot) -> None:
        """Look at all that is new."""
        beams, estimate = self._localization.take(snapshot), self.estimate
        if beams is not None and estimate.sure and estimate.odom_in_map is not None:
            there = estimate.odom_in_map @ beams.robot_in_odom
            others = self._traffic.others(self)
            self._sightings.take(without_robots(beams, there, others), there)
        drive = self._drive
        if drive is not None and self._robot.arbiter.mode is not drive.mode:
            self._drive = drive = None
        self.state.publish(
            Navigation(
                estimate=estimate,
                goal=drive.goal if drive else None,
                way=drive.way if drive else None,
                top_speed=drive.action.top_speed if drive else 0.0,
                problem=self._problem(drive),
            )
        )

    def _problem(self, drive: _Drive | None) -> str:
        if drive is None:
            return ""
        if not self.estimate.sure:
            return f"not sure where it is: {self.estimate.reason}"
        if drive.aside:
            return "makes room for another robot"
        if drive.action.waits:
            return drive.action.waits
        if drive.closed_since is not None:
            return drive.closed
        return "something is in the way" if drive.action.blocked else ""

    async def _steer(self) -> None:
        """Look for a better way again and again, and send the robot on where it has arrived."""
        while True:
            await asyncio.sleep(REPLAN_EVERY)
            async with self._changing:
                drive = self._drive
                if drive is None or drive.aside or not self.estimate.sure:
                    continue
                if drive.action.arrived:
                    await self._send_on(drive)
                else:
                    await self._replan(drive)

    @property
    def traveller(self) -> Traveller | None:
        """The robot as others see it; `None` while it is not sure where it is."""
        here, drive = self.estimate.robot_in_map, self._drive
        if not self.estimate.sure or here is None:
            return None
        goes = drive is not None and not drive.action.arrived and not drive.aside
        return Traveller(
            name=self._name,
            robot_in_map=here,
            corner=self._robot.info.model.corner,
            way=drive.way.rest_from(here.x, here.y).points if drive and goes else NOWHERE,
            since=drive.since if drive else inf,
        )

    async def _keep_apart(self) -> None:
        """Let the robots pass that set out earlier: wait before their ways, or make room."""
        while True:
            await asyncio.sleep(APART_EVERY)
            async with self._changing:
                drive, mine = self._drive, self.traveller
                if drive is None or mine is None:
                    continue
                if drive.aside or not drive.action.arrived:
                    await self._give_way(drive, mine)

    async def _give_way(self, drive: _Drive, mine: Traveller) -> None:
        here = mine.robot_in_map
        onward = replace(mine, way=drive.way.rest_from(here.x, here.y).points)
        met = {other: meeting(onward, other) for other in self._traffic.ahead_of(self)}
        stop = BEFORE + self._braking_distance()
        near = [other for other, way in met.items() if way is not None and way < stop]
        drive.action.waits = f"lets {near[0].name} pass" if near and not drive.aside else ""
        if not near:
            if drive.aside:
                drive.aside = False
                await self._begin_leg(drive)
        elif drive.action.arrived or not drive.aside:
            stays = replace(mine, way=NOWHERE)
            if any(meeting(stays, other) == 0.0 for other in near):
                await self._make_room(drive, mine, near)

    async def _make_room(self, drive: _Drive, mine: Traveller, others: Sequence[Traveller]) -> None:
        """Go to a place beside the ways of others, if there is one."""
        seen = self.costs.with_obstacles(self._sightings.points(self._clock()))
        place = await self._in_thread(passing_place, seen, mine, others)
        if place is not None:
            drive.aside, drive.action.waits = True, ""
            goal = Destination(x=place.x, y=place.y)
            drive.action.send_on(self._follower(goal, place), last=False)

    def _braking_distance(self) -> float:
        snapshot = self._robot.snapshot
        speed = snapshot.odometry.twist.v if snapshot else 0.0
        return speed * speed / (2 * self._robot.info.limits.deceleration)

    async def _replan(self, drive: _Drive) -> None:
        now = self._clock()
        people = bool(self._sightings.movers.people())
        if drive.action.held_up(now) > HELD_UP and not people:
            self._avoid(drive.way, now)
        way = await self.plan(drive.goal)
        if isinstance(way, Way):
            drive.action.follower.cost_to_go, drive.way = way.cost_to_go, way
            drive.closed_since = None
            return
        drive.closed = way.why
        if drive.closed_since is None:
            drive.closed_since = now
        elif now - drive.closed_since > (BY_PEOPLE if people else BLOCKED_FOR):
            if drive.is_last:
                drive.action.failed = way.why
            else:
                await self._skip(drive, way)

    def _avoid(self, way: Way, now: float) -> None:
        """Keep out of the narrowest place of the next stretch: the robot does not get through.

        A way for a disk may bend too sharply for a robot that is longer than it is wide.
        """
        here = self.estimate.robot_in_map
        if here is None or any(now - when < HELD_UP for *_, when in self._avoided):
            return
        rest = way.rest_from(here.x, here.y)
        near = rest.points[rest.to_go[0] - rest.to_go < AHEAD]
        x, y = near[int(self.costs.clearance_at(near).argmin())].tolist()
        log.info("keeps out of (%.1f, %.1f): it does not get through there", x, y)
        self._avoided.append((x, y, now))

    async def _send_on(self, drive: _Drive) -> None:
        """Plan the way to the next place of a patrol, once the robot has stood long enough."""
        if drive.is_last:
            return
        now = self._clock()
        if drive.arrived is None:
            drive.arrived, drive.skipped = now, 0
        elif now - drive.arrived >= PAUSE:
            drive.go_on()
            await self._begin_leg(drive)

    async def _begin_leg(self, drive: _Drive) -> None:
        way = await self.plan(drive.goal)
        if isinstance(way, Way):
            drive.way = way
            follower = self._follower(drive.goal, way.cost_to_go)
            drive.action.send_on(follower, last=drive.is_last)
        else:
            await self._skip(drive, way)

    async def _skip(self, drive: _Drive, no_way: NoWay) -> None:
        """Leave out a place that no way leads to; give up if there is none to any."""
        log.warning("leaves out %s: %s", drive.goal, no_way.why)
        drive.skipped += 1
        if drive.is_last or drive.skipped >= len(drive.goals):
            drive.action.failed = no_way.why
            return
        drive.go_on()
        await self._begin_leg(drive)

    async def plan(self, goal: Destination, start: Pose2 | None = None) -> Way | NoWay:
        """Return a way from `start`, or where the robot is, around all that it has seen."""
        estimate = self.estimate
        here = start or (estimate.robot_in_map if estimate.sure else None)
        if here is None:
            return NoWay(f"it is not sure where the robot is: {estimate.reason}")
        now = self._clock()
        self._avoided = [each for each in self._avoided if now - each[2] < AVOIDED]
        seen, things = (self._sightings.points(now, people=people) for people in (True, False))
        avoided = np.array(self._avoided).reshape(-1, 3)[:, :2]
        # without another way: where it was held up before, through robots and people, who may go on
        tries = [
            np.concatenate([seen, self._robots(), avoided]),
            np.concatenate([seen, self._robots()]),
            seen,
            things,
        ]
        way: Way | NoWay = NoWay("")
        for number, obstacles in enumerate(tries):
            if number and len(obstacles) == len(tries[number - 1]):
                continue  # the same once more
            around = self.costs.with_obstacles(obstacles)
            way = await self._in_thread(plan, around, (here.x, here.y), (goal.x, goal.y))
            if isinstance(way, Way):
                return way
        if not len(seen):
            return way
        free = await self._in_thread(plan, self.costs, (here.x, here.y), (goal.x, goal.y))
        return self._closed(free, goal) if isinstance(free, Way) else free

    def _robots(self) -> Float:
        """Return the outlines of other robots that stay where they are [m], shape (N, 2)."""
        stay = [other.body for other in self._traffic.others(self) if not len(other.way)]
        return np.concatenate([NOWHERE, *stay])

    def _closed(self, way: Way, goal: Destination) -> NoWay:
        """Return the reason that a way of the map cannot be driven: where, and when it was seen."""
        now, needed = self._clock(), self.costs.needed
        for x, y in way.points.tolist():
            seen = self._sightings.seen_at(x, y, needed)
            if seen is not None:
                left = hypot(goal.x - x, goal.y - y)
                words = f"the way to {goal} is closed {left:.1f} m from it, at ({x:.1f}, {y:.1f})"
                return NoWay(f"{words}: seen {max(0.0, now - seen):.0f} s ago", (x, y), way)
        return NoWay(f"things in the way leave none to {goal}", free=way)

    async def find(self, patience: float = PATIENCE) -> bool:
        """Wait for up to `patience` [s] until it is sure where the robot is; return whether."""
        return await self._localization.find(patience)

    def _follower(self, goal: Destination, cost_to_go: CostToGo) -> Follower:
        info, where = self._robot.info, (goal.x, goal.y, goal.heading)
        return Follower(info.model, info.limits, where, cost_to_go)

    def mode(
        self,
        goal: Destination,
        way: Way,
        speed: float | None = None,
        *,
        after: Sequence[Destination] = (),
        rounds: float = 1,
    ) -> Stack:
        """Return the mode that drives along `way`, at `speed` [m/s] at most.

        If there are places to go to `after` that, it is a patrol: it begins anew after the last
        place, until it has been driven for so many `rounds`.
        """
        limits = self._robot.info.limits
        goals = (goal, *after)
        legs = rounds * len(goals)
        action = FollowWay(
            follower=self._follower(goal, way.cost_to_go),
            odom_in_map=lambda: self.odom_in_map,
            unsure=lambda: None if self.estimate.sure else self.estimate.reason,
            sightings=self._sightings,
            walls=self._walls,
            preferred_speed=self.costs.speed_at,
            top_speed=min(speed or limits.max_speed, limits.max_speed),
            last=legs <= 1,
        )
        mode = follow_way(action, *PATROL) if after else follow_way(action)
        self._drive = _Drive(goals, legs, action, mode, way, self._clock())
        return mode

    def looking_around(self) -> Stack:
        """Return the mode that drives about a little until it is sure where the robot is."""
        return look_around(lambda: self.estimate, self._robot.info.limits)

    async def look_around(self) -> None:
        """Drive about a little until it is sure where the robot is.

        Raises:
            MotionError: It did not find itself; see the message.
        """
        if not await self.find():
            log.info("looks around: %s", self.estimate.reason)
            await self._drive_along(self.looking_around())

    async def goto(self, goal: Destination, speed: float | None = None) -> None:
        """Drive to a place.

        Raises:
            MotionError: There is no way, or the robot did not get there; see the message.
        """
        await self._drive_along(self.mode(goal, await self._way_to(goal), speed))
        await self.await_charger(goal)

    async def patrol(
        self, goals: Sequence[Destination], speed: float | None = None, rounds: float = inf
    ) -> None:
        """Drive from place to place, and begin anew after the last one, for so many `rounds`.

        Places that no way leads to are left out until the next round.

        Raises:
            MotionError: There is no way to any, or the robot was stopped; see the message.
        """
        first, *rest = goals
        mode = self.mode(first, await self._way_to(first), speed, after=rest, rounds=rounds)
        await self._drive_along(mode)

    async def _way_to(self, goal: Destination) -> Way:
        await self.find()
        try:
            return to_drive(await self.plan(goal))
        except MotionError as error:
            raise MotionError(f"goto {goal}: {error}") from None

    async def _drive_along(self, mode: Stack) -> None:
        await run_mode(mode, self._robot.arbiter, self._robot.snapshots(), until=inf)

    async def await_charger(self, goal: Destination) -> None:
        """Wait for the charger where the goal is a dock; a dock without one is no error.

        Raises:
            MotionError: The robot was lost.
        """
        if not goal.charges:
            return
        with lost_as_motion_error("goto"):
            async for snapshot in snapshots_of(self._robot.supervisor, CHARGER):
                if snapshot.battery.charging not in (Charging.NONE, Charging.UNKNOWN):
                    log.info("stands in %s: %s", goal, snapshot.battery.charging)
                    return
        log.warning("stands in %s, but the robot does not say that it is charged", goal)
