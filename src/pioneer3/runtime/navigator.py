"""Finds a robot on a map, and takes it to places of the map."""

import asyncio
import logging
import sys
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass, field
from math import hypot
from typing import Any, Protocol, Self

import numpy as np

from pioneer3.behaviors.action import Stack
from pioneer3.errors import MotionError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.jit import numba_version
from pioneer3.maps import LineMap
from pioneer3.maps.grid import samples
from pioneer3.nav.beams import beams_of
from pioneer3.nav.costs import CELL, CostMap
from pioneer3.nav.estimate import Estimate
from pioneer3.nav.follower import Follower
from pioneer3.nav.kernels import CACHE
from pioneer3.nav.localizer import Localizer
from pioneer3.nav.places import Destination
from pioneer3.nav.planner import NoWay, Way, plan
from pioneer3.nav.sightings import Sightings
from pioneer3.nav.warm_up import warm_up
from pioneer3.robot.devices.laser import LaserSource
from pioneer3.robot.supervisor import Feed
from pioneer3.runtime.driven import Driven
from pioneer3.runtime.follow_way import FollowWay, follow_way
from pioneer3.runtime.motions import run_mode
from pioneer3.state import Snapshot
from pioneer3.tasks import running

log = logging.getLogger(__name__)

InThread = Callable[..., Awaitable[Any]]
"""Calls a function elsewhere, so that the event loop goes on."""

PATIENCE = 3.0
"""Longest wait for a robot that knows where it is [s]."""
REPLAN_EVERY = 1.0
"""[s]."""
BLOCKED_FOR = 15.0
"""A way that has been closed for so long is given up [s]."""
SPREAD, TURN_SPREAD = 0.3, 0.15
"""Standard deviations of the start [m, rad]."""


class Navigable(Driven, Protocol):
    """A robot with a laser that can be driven."""

    @property
    def laser(self) -> LaserSource:
        """The laser that it looks through."""


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
    """A way that is being driven."""

    goal: Destination
    action: FollowWay
    mode: Stack
    way: Way
    closed_since: float | None = field(default=None)


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
        localizer: On the map.
        in_thread: Runs what takes long.

    Attributes:
        line_map: The map.
        state: Published with each snapshot.
        costs: The same.
    """

    def __init__(
        self, robot: Navigable, costs: CostMap, localizer: Localizer, *, in_thread: InThread
    ) -> None:
        self.line_map = localizer.line_map
        self.state: Feed[Navigation] = Feed()
        self.costs = costs
        self._robot, self._in_thread = robot, in_thread
        self._localizer = localizer
        self._sightings = Sightings(costs)
        self._walls = samples(self.line_map.walls, CELL)
        self._clock = asyncio.get_running_loop().time
        self._sequence = -1
        self._drive: _Drive | None = None

    @classmethod
    async def on(
        cls,
        robot: Navigable,
        line_map: LineMap,
        *,
        start: Pose2 | None = None,
        rng: np.random.Generator | None = None,
        in_thread: InThread = asyncio.to_thread,
    ) -> Self:
        """Return the navigator of a robot on a map.

        Args:
            robot: The robot.
            line_map: The map.
            start: Where the robot is, if anybody knows; `None` has it found.
            rng: Draws all that is random.
            in_thread: Runs what takes long.
        """
        await in_thread(warm_up)
        model = robot.info.model
        localizer = Localizer(line_map, model, rng or np.random.default_rng())
        costs = await in_thread(CostMap.of, line_map, model)
        await in_thread(localizer.prepare)
        navigator = cls(robot, costs, localizer, in_thread=in_thread)
        if start is None:
            navigator.lose()
        else:
            navigator.place(start)
        return navigator

    @property
    def estimate(self) -> Estimate:
        """Where the robot is."""
        return self._localizer.estimate

    @property
    def odom_in_map(self) -> Pose2:
        """The pose of odometry's frame on the map [m, rad]; the origin while it is not known."""
        return self.estimate.odom_in_map or ORIGIN

    def place(
        self, robot_in_map: Pose2, spread: float = SPREAD, turn_spread: float = TURN_SPREAD
    ) -> None:
        """Tell where the robot is, with the standard deviations of that [m, rad]."""
        self._localizer.start(robot_in_map, spread, turn_spread)
        self._sightings.forget()

    def lose(self) -> None:
        """Forget where the robot is: it has been carried away."""
        self._localizer.start_unknown()
        self._sightings.forget()

    async def run(self) -> None:
        """Keep track of the robot and of its way, until cancelled."""
        with self._robot.laser.wanted():
            async with running(self._search(), self._replan()):
                async for snapshot in self._robot.supervisor.snapshots.values():
                    self._take(snapshot)

    def _take(self, snapshot: Snapshot) -> None:
        """Look at the newest scan."""
        scan = self._robot.laser.latest
        if scan is not None and scan.sequence != self._sequence:
            self._sequence = scan.sequence
            beams = beams_of(scan)
            self._localizer.take(beams)
            estimate = self.estimate
            if estimate.sure and estimate.odom_in_map is not None:
                self._sightings.take(beams, estimate.odom_in_map @ beams.robot_in_odom)
        drive = self._drive
        if drive is not None and self._robot.arbiter.mode is not drive.mode:
            self._drive = drive = None
        self.state.publish(
            Navigation(
                estimate=self.estimate,
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
        return "something is in the way" if drive.action.blocked or drive.closed_since else ""

    async def _search(self) -> None:
        """Search for the robot wherever that is wanted."""
        async for _ in self.state.values():
            if self._localizer.wants_search and (search := self._localizer.search()) is not None:
                self._localizer.adopt(await self._in_thread(search.run))

    async def _replan(self) -> None:
        """Look for a better way, again and again."""
        while True:
            await asyncio.sleep(REPLAN_EVERY)
            drive = self._drive
            if drive is None or not self.estimate.sure:
                continue
            way = await self.plan(drive.goal)
            now = self._clock()
            if isinstance(way, Way):
                drive.action.follower.cost_to_go, drive.way = way.cost_to_go, way
                drive.closed_since = None
            elif drive.closed_since is None:
                drive.closed_since = now
            elif now - drive.closed_since > BLOCKED_FOR:
                drive.action.failed = way.why

    async def plan(self, goal: Destination) -> Way | NoWay:
        """Return a way from where the robot is, around all that it has seen."""
        estimate = self.estimate
        if not estimate.sure or estimate.robot_in_map is None:
            return NoWay(f"it is not sure where the robot is: {estimate.reason}")
        here, there = estimate.robot_in_map, (goal.x, goal.y)
        seen = self._sightings.points(self._clock())
        start = here.x, here.y
        way: Way | NoWay
        way = await self._in_thread(plan, self.costs.with_obstacles(seen), start, there)
        if isinstance(way, Way) or not len(seen):
            return way
        free = await self._in_thread(plan, self.costs, start, there)
        return self._closed(free, goal) if isinstance(free, Way) else free

    def _closed(self, way: Way, goal: Destination) -> NoWay:
        """Return the reason that a way of the map cannot be driven: where, and when it was seen."""
        now, needed = self._clock(), self.costs.needed
        for x, y in way.points.tolist():
            seen = self._sightings.seen_at(x, y, needed)
            if seen is not None:
                left = hypot(goal.x - x, goal.y - y)
                words = f"the way to {goal} is closed {left:.1f} m from it, at ({x:.1f}, {y:.1f})"
                return NoWay(f"{words}: seen {max(0.0, now - seen):.0f} s ago", (x, y))
        return NoWay(f"things in the way leave none to {goal}")

    async def find(self, patience: float) -> bool:
        """Wait for up to `patience` [s] until it is sure where the robot is; return whether."""
        with suppress(TimeoutError):
            async with asyncio.timeout(patience):
                async for state in self.state.values(latest_first=True):
                    if state.estimate.sure:
                        return True
        return self.estimate.sure

    def mode(self, goal: Destination, way: Way, speed: float | None = None) -> Stack:
        """Return the mode that drives along `way`, at `speed` [m/s] at most."""
        limits = self._robot.info.limits
        follower = Follower(
            self._robot.info.model, limits, (goal.x, goal.y, goal.heading), way.cost_to_go
        )
        action = FollowWay(
            follower=follower,
            odom_in_map=lambda: self.odom_in_map,
            unsure=lambda: None if self.estimate.sure else self.estimate.reason,
            sightings=self._sightings,
            walls=self._walls,
            top_speed=min(speed or limits.max_speed, limits.max_speed),
        )
        mode = follow_way(action)
        self._drive = _Drive(goal, action, mode, way)
        return mode

    async def goto(self, goal: Destination, speed: float | None = None) -> None:
        """Drive to a place.

        Raises:
            MotionError: There is no way, or the robot did not get there; see the message.
        """
        await self.find(PATIENCE)
        way = await self.plan(goal)
        if isinstance(way, NoWay):
            raise MotionError(f"goto {goal}: {way.why}")
        mode = self.mode(goal, way, speed)
        await run_mode(mode, self._robot.arbiter, self._robot.snapshots(), until=float("inf"))
