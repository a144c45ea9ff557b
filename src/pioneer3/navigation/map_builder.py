"""Makes a map while a robot is driven, or while it explores by itself.

Scans are matched on the event loop, a few milliseconds each. Loops, poses and the drawing of the
map are made in a thread, again and again.
"""

import asyncio
import gc
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import hypot, inf

from pioneer3.behaviors.action import Action, Desire, Goal, Situation, Stack
from pioneer3.errors import MotionError
from pioneer3.geometry import Pose2
from pioneer3.maps import LineMap, MapObject, OccupancyGrid
from pioneer3.maps.grid import samples
from pioneer3.maps.line_map import FREE
from pioneer3.nav.changes import DaysRenderer, drawn
from pioneer3.nav.clearance import Walls
from pioneer3.nav.costs import COST_CELL, CostMap
from pioneer3.nav.exploring import Exploration, GivenUp, Outlook
from pioneer3.nav.follower import Follower
from pioneer3.nav.frames import Survey
from pioneer3.nav.mapper import Mapper
from pioneer3.nav.places import home
from pioneer3.nav.planner import Way
from pioneer3.nav.rendering import line_map_of, trodden
from pioneer3.nav.sightings import Sightings
from pioneer3.navigation.follow_way import FollowWay, follow_way, stand_unsure
from pioneer3.navigation.keep_clear import LimiterOutline
from pioneer3.navigation.localization import InThread, Localizable
from pioneer3.navigation.navigator import Navigator
from pioneer3.navigation.recording import NavigationLog
from pioneer3.robot.supervisor import Feed
from pioneer3.runtime.motions import run_mode
from pioneer3.state import Snapshot
from pioneer3.tasks import running


@dataclass(slots=True, kw_only=True)
class ExploreMap(Action):
    """Drives one way after the other; between them the robot stands, until no edge is left.

    Attributes:
        unsure: Returns the reason that nobody knows where the robot is, or `None`.
        leg: The present way, or `None` while the next one is looked for.
    """

    unsure: Callable[[], str | None]
    leg: FollowWay | None = None
    name: str = "explore"
    wants_scans: bool = True
    done: bool = False

    @property
    def goal(self) -> Goal | None:
        """Where it goes, in odometry's frame."""
        return self.leg.goal if self.leg else None

    def decide(self, situation: Situation) -> Desire | None:
        """Return the next velocity, or `None` at the end."""
        if self.done:
            return None
        leg = self.leg
        if leg is None or leg.done or leg.failed:
            if unsure := self.unsure():
                return stand_unsure(unsure)
            return Desire(v=0.0, w=0.0, reason="looks where the map ends")
        desire = leg.decide(situation)
        return desire or Desire(v=0.0, w=0.0, reason="has seen the edge of the map")


AT_HOME = 3.0
"""Longest wait for a robot that stands at the map's home to find that [s]."""
SHARE = 2.0
"""A drawing that took long is followed by a pause so many times as long."""
BENT_BY = 0.1
"""Distance by which a map was bent above which the robot waits until that is drawn [m]."""
SAME_GOAL = 0.3
"""A place to look from that has moved by less than this is driven to without a break [m]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MapState:
    """The state of a map that is being made.

    Attributes:
        line_map: As drawn last; `None` before the first scan.
        driven: Way since the beginning of the map [m].
        area: Of the free ground [m^2].
        edges: Number of edges that are left to look behind; `None` before they are known.
        way: To the next edge, or `None`.
        remarks: Sentences about the map for whoever makes it.
    """

    line_map: LineMap | None
    robot_in_map: Pose2
    odom_in_map: Pose2
    driven: float = 0.0
    area: float = 0.0
    loops: int = 0
    exploring: bool = False
    edges: int | None = None
    way: Way | None = None
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class _Drawing:
    """A map at one instant."""

    line_map: LineMap
    grid: OccupancyGrid
    area: float


@dataclass(slots=True)
class _Trip:
    """An exploration that goes on."""

    mode: Stack
    action: ExploreMap
    top_speed: float
    exploration: Exploration
    outlook: Outlook | None = None


class MapBuilder:
    """Makes a map with one robot. :meth:`run` does the work.

    Without a `mapper`, of a map that is continued, a new one begins where the robot is. The `state`
    is published with each snapshot.
    """

    def __init__(
        self,
        robot: Localizable,
        mapper: Mapper | None = None,
        *,
        name: str = "map",
        objects: Sequence[MapObject] = (),
        in_thread: InThread = asyncio.to_thread,
    ) -> None:
        self.mapper = mapper or Mapper(settings=robot.settings.mapper)
        self.state: Feed[MapState] = Feed()
        self._robot, self._in_thread = robot, in_thread
        self._name, self._objects = name, tuple(objects)
        self._named: list[tuple[str, int, Pose2]] = []
        self._renderer = DaysRenderer(robot.settings.mapper.cell)
        self._drawing: _Drawing | None = None
        self._sightings: Sightings | None = None
        self._trip: _Trip | None = None
        self._limiter = LimiterOutline(
            margin=robot.settings.planner.contact_margin,
            odom_in_map=lambda: self.mapper.odom_in_map,
            unsure=lambda: robot.laser.lost,
        )
        self._sequence = -1
        known = robot.arbiter.log
        self._log = NavigationLog(known, name) if known is not None else None
        self._clock = asyncio.get_running_loop().time

    async def run(self) -> None:
        """Take scans and draw the map, until cancelled or the robot's readings end."""
        gc.freeze()  # else all that was imported is searched for garbage, 60 ms, between two scans
        with self._robot.laser.wanted(), self._robot.arbiter.checking(self._limiter):
            async with running(self._work()):
                async for snapshot in self._robot.supervisor.snapshots.values():
                    self._take(snapshot)

    async def explore(self, speed: float | None = None) -> tuple[GivenUp, ...]:
        """Drive until the map has no edges; return those that the robot did not get to.

        It drives at `speed` [m/s] at most.

        Raises:
            MotionError: A stop or another mode ended it, or the link was lost; see the message.
        """
        mode = self.mode(speed)
        trip = self._trip
        assert trip is not None
        await run_mode(mode, self._robot.arbiter, self._robot.snapshots(), until=inf)
        return trip.exploration.unreachable

    def mode(self, speed: float | None = None) -> Stack:
        """Return the mode that explores, at `speed` [m/s] at most."""
        action = ExploreMap(unsure=lambda: self._robot.laser.lost)
        top = self._robot.info.limits.max_speed
        mode = follow_way(action, "explore", "drives where the map ends")
        exploration = Exploration(self._robot.settings.mapper)
        self._trip = _Trip(mode, action, min(speed or top, top), exploration)
        return mode

    def name_place(self, name: str) -> None:
        """Make the place where the robot is a goal of the map; it moves as loops bend the map.

        Raises:
            MotionError: No scan has come yet, so the robot is nowhere.
        """
        survey = self.mapper.survey
        if not survey.frames:
            raise MotionError("no scan has come yet: there is no map to name places of")
        here = survey.poses[-1].inverse() @ self.mapper.robot_in_map
        self._named.append((name, len(survey.frames) - 1, here))

    @property
    def objects(self) -> tuple[MapObject, ...]:
        """The objects of the map."""
        poses = self.mapper.survey.poses
        named = (
            MapObject(kind="GoalWithHeading", name=name, pose=poses[number] @ here)
            for name, number, here in self._named
        )
        return (*self._objects, *named)

    @property
    def exploring(self) -> bool:
        """Whether the robot drives by itself."""
        return self._trip is not None and self._robot.arbiter.mode is self._trip.mode

    def finished(self) -> LineMap:
        """Close the last loops and return the map. This takes a while."""
        self.mapper.improve()
        room = self._robot.info.model.corner
        cell = self._robot.settings.mapper.cell
        return drawn(self.mapper.survey, room, cell, name=self._name, objects=self.objects)

    def _take(self, snapshot: Snapshot) -> None:
        """Look at the newest scan."""
        scan, mapper = self._robot.laser.latest, self.mapper
        if scan is not None and scan.sequence != self._sequence:
            self._sequence = scan.sequence
            beams = self._limiter.beams.of(scan)
            robot_in_map = mapper.add(beams)
            if self._sightings is not None:
                self._sightings.take(beams, robot_in_map)
        drawing, trip, survey = self._drawing, self._trip, mapper.survey
        outlook = trip.outlook if trip else None
        state = MapState(
            line_map=drawing.line_map if drawing else None,
            robot_in_map=mapper.odom_in_map @ snapshot.odometry.robot_in_odom,
            odom_in_map=mapper.odom_in_map,
            driven=survey.frames[-1].way if survey.frames else 0.0,
            area=drawing.area if drawing else 0.0,
            loops=sum(edge.loop for edge in survey.edges),
            exploring=self.exploring,
            edges=outlook.left if outlook else None,
            way=outlook.target.way if outlook and outlook.target else None,
            remarks=mapper.remarks(scan.sensor_in_robot if scan else None),
        )
        self.state.publish(state)
        if self._log is not None:
            self._log.on_growing_map(
                state.robot_in_map, state.odom_in_map, self._robot.laser.lost or None
            )
            self._log.way(None, state.way if self.exploring else None)

    async def _work(self) -> None:
        """Look for loops, draw the map, and choose where to go, again and again."""
        while True:
            began = self._clock()
            if self.mapper.survey.frames:
                await self._improve()
                self._drawing = await self._in_thread(self._draw, self.mapper.survey)
                await self._choose()
            await asyncio.sleep(
                max(self._robot.settings.mapper.period, SHARE * (self._clock() - began))
            )

    async def _improve(self) -> None:
        before = self.mapper.odom_in_map
        count = len(self.mapper.survey.frames)
        while self.mapper.snapshot.progress.looked < count:
            self.mapper.apply(await self._in_thread(self.mapper.snapshot.improve))
        here = self.mapper.robot_in_map
        was = before @ (self.mapper.odom_in_map.inverse() @ here)
        if self._trip is not None and hypot(was.x - here.x, was.y - here.y) > BENT_BY:
            self._trip.action.leg = None

    def _draw(self, survey: Survey) -> _Drawing:
        grid = trodden(self._renderer.update(survey), survey.poses, self._robot.info.model.corner)
        line_map = line_map_of(grid, self._name, self.objects)
        return _Drawing(line_map, grid, float((grid.states == FREE).sum()) * grid.resolution**2)

    async def _choose(self) -> None:
        """Let an exploring robot drive to an edge of the map as it is drawn now."""
        trip, drawing = self._trip, self._drawing
        if trip is None or drawing is None or not self.exploring:
            return
        now, leg, arbiter = self._clock(), trip.action.leg, self._robot.arbiter
        if leg is not None and leg.done:
            trip.exploration.give_up("")
        elif leg is not None and leg.failed:
            trip.exploration.give_up(leg.failed)
        elif arbiter.driving_action not in {None, trip.action.name}:
            trip.exploration.wait(now)
        seen = self._sightings.points(now) if self._sightings is not None else None
        costs: CostMap = await self._in_thread(
            CostMap.of, drawing.line_map, self._robot.info.model, self._robot.settings.planner
        )
        around = costs if seen is None else costs.with_obstacles(seen)
        outlook: Outlook = await self._in_thread(
            trip.exploration.choose, drawing.grid, around, self.mapper.robot_in_map, now
        )
        trip.outlook, self._sightings = outlook, Sightings(costs)
        self._limiter.walls = Walls.of(drawing.line_map.walls)
        self._limiter.sightings = self._sightings
        if outlook.target is not None:
            self._head_for(trip, outlook.target.way, drawing, self._sightings)
        elif not outlook.left:
            trip.action.done = True
        else:
            trip.action.leg = None

    def _head_for(self, trip: _Trip, way: Way, drawing: _Drawing, sightings: Sightings) -> None:
        """Drive along a way from now on."""
        assert trip.outlook is not None
        assert trip.outlook.target is not None
        view, leg = trip.outlook.target.frontier.view, trip.action.leg
        goal = view.x, view.y, view.theta
        walls = samples(drawing.line_map.walls, COST_CELL)
        if leg is not None and not leg.done and not leg.failed:
            x, y, _ = leg.follower.goal
            if hypot(view.x - x, view.y - y) < SAME_GOAL:
                leg.follower.cost_to_go, leg.follower.goal = way.cost_to_go, goal
                leg.renew(walls, sightings)
                return
        info = self._robot.info
        follower = Follower(info.model, info.limits, goal, way.cost_to_go)
        trip.action.leg = FollowWay(
            follower=follower,
            odom_in_map=lambda: self.mapper.odom_in_map,
            unsure=trip.action.unsure,
            sightings=sightings,
            walls=walls,
            top_speed=trip.top_speed,
        )


async def whereabouts(
    robot: Localizable,
    line_map: LineMap,
    patience: float,
    in_thread: InThread = asyncio.to_thread,
) -> Pose2:
    """Return where a robot is on a map: at its home, or else where it is found.

    To be found it has to be driven a metre meanwhile.

    Raises:
        MotionError: It is not at the map's home, and was not found within `patience` [s].
    """
    navigator = await Navigator.on(robot, line_map, start=home(line_map), in_thread=in_thread)
    async with running(navigator.run()):
        if not await navigator.find(AT_HOME):
            navigator.lose()
            await navigator.find(patience)
        estimate = navigator.estimate
        if not estimate.sure or estimate.robot_in_map is None:
            raise MotionError(
                "the robot is not at the map's home: say with --start where it is, or drive it by"
                " the keys until it is found"
            )
        return estimate.robot_in_map
