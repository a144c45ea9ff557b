"""Takes a robot to places of a map, and around what is not on the map."""

import asyncio
import gc
import logging
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Self

import numpy as np

from pioneer3.behaviors.action import Stack
from pioneer3.errors import MotionError
from pioneer3.geometry import ORIGIN, Pose2
from pioneer3.maps import LineMap
from pioneer3.nav.clearance import Walls
from pioneer3.nav.costs import CostMap
from pioneer3.nav.estimate import Estimate
from pioneer3.nav.places import Destination, find_place
from pioneer3.nav.planner import NoWay, Way
from pioneer3.nav.sightings import Sightings
from pioneer3.nav.traffic import without_robots
from pioneer3.nav.warm_up import warm_up
from pioneer3.navigation.drives import Drives
from pioneer3.navigation.goals import FIND_PATIENCE, GoalServer, NavigationGoal
from pioneer3.navigation.keep_clear import LimiterOutline
from pioneer3.navigation.last_place import (
    LastPlace,
    last_place_file,
    read_last_place,
    write_last_place,
)
from pioneer3.navigation.localization import (
    SPREAD,
    TURN_SPREAD,
    InThread,
    Localizable,
    Localization,
    look_around,
)
from pioneer3.navigation.recording import NavigationLog, use_map
from pioneer3.navigation.traffic import Traffic
from pioneer3.robot.supervisor import Feed
from pioneer3.state import Snapshot
from pioneer3.tasks import running

log = logging.getLogger(__name__)

REMEMBERED_EVERY = 10.0
"""Time between two writings of the robot's place [s]: its computer may be switched off."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NavigatorState:
    """Where a robot is and goes, its way as planned last, and its top speed there [m/s].

    The `problem` is the reason that it does not come on, or empty.
    """

    estimate: Estimate
    goal: Destination | None = None
    way: Way | None = None
    top_speed: float = 0.0
    problem: str = ""


class Navigator:
    """Navigates one robot on one map. :meth:`run` does the work.

    Attributes:
        goals: Carries out the goals of programs, of the command line and of ROS; a robot of the
            page has a server that outlives its navigators (:mod:`pioneer3.web.navigation`).
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
        self.state: Feed[NavigatorState] = Feed()
        self.costs = costs
        self._robot, self._localization = robot, localization
        self._traffic, self._sightings = traffic or Traffic(), Sightings(costs)
        self._drives = Drives(
            robot,
            costs,
            localization,
            sightings=self._sightings,
            traffic=self._traffic,
            in_thread=in_thread,
            name=name,
        )
        self.goals = GoalServer(robot, self._itself)
        self._in_thread = in_thread
        self._file = last_place_file(robot.info, self.line_map)
        self._last: LastPlace | None = None
        self._unwritten = self._remarked = False
        known = robot.arbiter.log
        self._log = NavigationLog(known, self.line_map.name) if known is not None else None

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

        Without a `start` the robot is found; without a laser by its sonars. It makes way for the
        other robots of `traffic`, whose drivers know it by its `name`.

        Raises:
            ConfigError: The map is too large.
        """
        await in_thread(warm_up)
        drawn = rng or np.random.default_rng()
        # first what has the finest cells: it refuses a map that is too large before there is work
        localization = await Localization.on(robot, line_map, drawn, in_thread)
        costs = await in_thread(CostMap.of, line_map, robot.info.model, robot.settings.planner)
        navigator = cls(robot, costs, localization, in_thread=in_thread, traffic=traffic, name=name)
        if start is not None:
            navigator.place(start)
        return navigator

    @property
    def sure_odom_in_map(self) -> Pose2 | None:
        """The pose of odometry's frame on the map [m, rad], `None` while that is not sure."""
        return self.estimate.odom_in_map if self.estimate.sure else None

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

    def place_as_remembered(self, otherwise: Pose2 | None) -> None:
        """Look for the robot where it was when a program ended, and at the place `otherwise` [m].

        Its laser decides between the two. Sonars cannot: they are told the last place only if
        odometry has gone on since.
        """
        now, last = self._robot.snapshot, read_last_place(self._file)
        odom = now.odometry.robot_in_odom if now else ORIGIN
        goes_on = last is not None and last.goes_on(odom)
        guesses = last.guesses(odom) if last and (goes_on or self._localization.by_laser) else []
        if otherwise is not None and not goes_on:
            guesses.append(otherwise)
        if guesses:
            self._localization.place(guesses[0], others=guesses[1:])

    def forget_obstacles(self) -> None:
        """Forget all things that it has seen and the map does not show; it sees them again."""
        self._drives.ways.forget()

    def lose(self) -> None:
        """Forget where the robot is: it has been carried away."""
        self._localization.lose()
        self._sightings.forget()

    async def run(self) -> None:
        """Keep track of the robot and of its way, until cancelled."""
        gc.freeze()  # else all that was imported is searched for garbage, 60 ms, between two ticks
        drives = self._drives
        if (robot_log := self._robot.arbiter.log) is not None:
            use_map(robot_log, self.line_map)
        limiter = LimiterOutline(
            margin=self.costs.settings.contact_margin,
            walls=Walls.of(self.line_map.walls),
            sightings=self._sightings,
            odom_in_map=lambda: self.odom_in_map,
            unsure=drives.unsure,
            beams=self._localization.beams,
        )
        sensing, checking = self._localization.sensing(), self._robot.arbiter.checking(limiter)
        with sensing, checking, self._traffic.travelling(drives):
            work = (self._localization.search(), drives.steer(), drives.keep_apart())
            try:
                async with running(*work, self.goals.run(), self._remember()):
                    async for snapshot in self._robot.supervisor.snapshots.values():
                        self._take(snapshot)
            finally:
                if self._unwritten:
                    write_last_place(self._file, self._last)

    def _take(self, snapshot: Snapshot) -> None:
        """Look at all that is new."""
        beams, estimate = self._localization.take(snapshot), self.estimate
        if beams is not None and estimate.sure and estimate.odom_in_map is not None:
            there = estimate.odom_in_map @ beams.robot_in_odom
            others = self._traffic.others(self._drives)
            self._sightings.take(without_robots(beams, there, others), there)
        if estimate.sure and estimate.odom_in_map is not None:
            self._note(LastPlace(estimate.odom_in_map, snapshot.odometry.robot_in_odom))
        elif estimate.stage == "lost":
            self._note(None)
        if estimate.remark and not self._remarked:
            self._remarked = True
            log.warning("%s", estimate.remark)
        drive = self._drives.present_in(self._robot.arbiter.mode)
        state = NavigatorState(
            estimate=estimate,
            goal=drive.place if drive else None,
            way=drive.way if drive else None,
            top_speed=drive.action.top_speed if drive else 0.0,
            problem=self._drives.problem,
        )
        self.state.publish(state)
        if self._log is not None:
            self._log.estimate(estimate)
            self._log.way(state.goal, state.way)
            self._log.problem(state.problem)

    def _note(self, place: LastPlace | None) -> None:
        """Keep a place that the sensors have confirmed, or that there is none."""
        self._unwritten = self._unwritten or place != self._last or place is None
        self._last = place

    async def _remember(self) -> None:
        """Write the place into its file now and then."""
        while True:
            await asyncio.sleep(REMEMBERED_EVERY)
            if self._unwritten:
                self._unwritten = False
                await self._in_thread(write_last_place, self._file, self._last)

    async def plan(self, place: Destination, start: Pose2 | None = None) -> Way | NoWay:
        """Return a way from `start`, or where the robot is, around all that it has seen."""
        return await self._drives.plan(place, start)

    def begin_drive(
        self,
        place: Destination,
        way: Way,
        speed: float | None = None,
        *,
        after: Sequence[Destination] = (),
        rounds: float = 1,
    ) -> Stack:
        """Begin a drive along `way`, at `speed` [m/s] at most; return its mode, to start at once.

        The drive ends with any other mode. If there are places to go to `after` that, it is a
        patrol: it begins anew after the last place, until it has been driven for so many `rounds`.
        """
        return self._drives.begin((place, *after), way, speed, rounds)

    async def find(self, patience: float = FIND_PATIENCE) -> bool:
        """Wait for up to `patience` [s] until it is sure where the robot is; return whether."""
        return await self._localization.find(patience)

    def looking_around(self) -> Stack:
        """Return the mode that drives about a little until it is sure where the robot is."""
        return look_around(lambda: self.estimate, self._robot.info.limits)

    async def look_around(self) -> None:
        """Drive about a little until it is sure where the robot is.

        Raises:
            MotionError: It did not find itself; see the message.
        """
        await self._carry_out("look around", NavigationGoal(places=None))

    async def goto(self, place: Destination | str, speed: float | None = None) -> None:
        """Drive to a place, or to the one of the map with this name.

        Raises:
            ConfigError: The map has no such place.
            MotionError: There is no way, or the robot did not get there; see the message.
        """
        there = find_place(self.line_map, place) if isinstance(place, str) else place
        await self._carry_out(f"goto {there}", NavigationGoal(places=lambda: (there,), speed=speed))

    async def patrol(
        self, places: Sequence[Destination], speed: float | None = None, rounds: float = inf
    ) -> None:
        """Drive from place to place, and begin anew after the last one, for so many `rounds`.

        Places that no way leads to are left out until the next round.

        Raises:
            MotionError: There is no way to any, or the robot was stopped; see the message.
        """
        goal = NavigationGoal(places=lambda: places, speed=speed, rounds=rounds)
        await self._carry_out("patrol", goal)

    async def _carry_out(self, title: str, goal: NavigationGoal) -> None:
        try:
            await self.goals.carry_out(goal)
        except MotionError as error:
            raise MotionError(f"{title}: {error}") from None

    async def _itself(self) -> Self:
        return self
