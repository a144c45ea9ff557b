"""Drives to places of a map: planned anew as more is seen, and apart from those of other robots."""

import asyncio
import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from pioneer3.behaviors.action import Stack
from pioneer3.geometry import Pose2
from pioneer3.maps.grid import samples
from pioneer3.nav.costs import COST_CELL, CostMap
from pioneer3.nav.follower import Follower
from pioneer3.nav.places import Destination
from pioneer3.nav.planner import CostToGo, NoWay, Way
from pioneer3.nav.sightings import Sightings
from pioneer3.nav.traffic import Traveller, meeting, passing_place
from pioneer3.navigation.follow_way import FollowWay, follow_way
from pioneer3.navigation.localization import InThread, Localizable, Localization
from pioneer3.navigation.traffic import Traffic
from pioneer3.navigation.ways import NOWHERE, Ways

log = logging.getLogger(__name__)

APART_EVERY = 0.3
"""Time between two looks whether others come near [s]."""
WAITING_GAP = 0.4
"""Distance before the ways of others at which a robot waits [m]."""
PATROL = "patrol", "drives from place to place of the map"
"""Name of the mode, and what it does."""


@dataclass(slots=True)
class Drive:
    """A drive to one place after the other.

    Attributes:
        legs: Ways that are left to drive, the present one among them; `inf` without an end.
        closed_since: When its way was first found closed [s].
        closed: The reason, as it is now.
        arrived: When the robot came to the present place [s], if there are more.
        skipped: Places in turn that no way leads to.
        aside: Whether it lets others pass, at a place beside their ways.
    """

    places: tuple[Destination, ...]
    legs: float
    action: FollowWay
    mode: Stack
    way: Way
    since: float
    at: int = 0
    closed_since: float | None = None
    closed: str = ""
    arrived: float | None = None
    skipped: int = 0
    aside: bool = False

    @property
    def place(self) -> Destination:
        """The present place."""
        return self.places[self.at]

    @property
    def is_last(self) -> bool:
        """Whether no other place comes after it."""
        return self.legs <= 1

    def go_on(self) -> None:
        """Take the next place."""
        self.at, self.legs = (self.at + 1) % len(self.places), self.legs - 1
        self.closed_since = self.arrived = None


class Drives:
    """The drives of one robot, one at a time; by its `name` the drivers of others know it."""

    def __init__(
        self,
        robot: Localizable,
        costs: CostMap,
        localization: Localization,
        *,
        sightings: Sightings,
        traffic: Traffic,
        in_thread: InThread,
        name: str,
    ) -> None:
        self.line_map, self.robot = localization.line_map, robot
        self.present: Drive | None = None
        self._costs, self._localization = costs, localization
        self._sightings, self._traffic, self._name = sightings, traffic, name
        self._in_thread = in_thread
        self._walls = samples(self.line_map.walls, COST_CELL)
        self._clock = asyncio.get_running_loop().time
        self.ways = Ways(costs, sightings, self._clock, in_thread)
        self._changing = asyncio.Lock()  # planning takes a while: one task changes drives

    def present_in(self, mode: Stack | None) -> Drive | None:
        """Return the drive of now, which ends once `mode` is another one."""
        if self.present is not None and self.present.mode is not mode:
            self.present = None
        return self.present

    @property
    def problem(self) -> str:
        """The reason that the robot does not come on, or empty."""
        drive = self.present
        if drive is None:
            return ""
        if not self._localization.estimate.sure:
            return f"not sure where it is: {self._localization.estimate.reason}"
        if drive.aside:
            return "makes room for another robot"
        if drive.action.waits:
            return drive.action.waits
        if drive.closed_since is not None:
            return drive.closed
        return "something is in the way" if drive.action.blocked else ""

    async def steer(self) -> None:
        """Look for a better way again and again, and send the robot on where it has arrived."""
        while True:
            await asyncio.sleep(self._costs.settings.period)
            async with self._changing:
                drive = self.present
                if drive is None or drive.aside or not self._localization.estimate.sure:
                    continue
                if drive.action.arrived:
                    await self._send_on(drive)
                else:
                    await self._replan(drive)

    @property
    def traveller(self) -> Traveller | None:
        """The robot as others see it; `None` while it is not sure where it is."""
        here, drive = self._localization.estimate.robot_in_map, self.present
        if not self._localization.estimate.sure or here is None:
            return None
        goes = drive is not None and not drive.action.arrived and not drive.aside
        return Traveller(
            name=self._name,
            robot_in_map=here,
            corner=self.robot.info.model.corner,
            way=drive.way.rest_from(here.x, here.y).points if drive and goes else NOWHERE,
            since=drive.since if drive else inf,
        )

    async def keep_apart(self) -> None:
        """Let the robots pass that set out earlier: wait before their ways, or make room."""
        while True:
            await asyncio.sleep(APART_EVERY)
            async with self._changing:
                drive, mine = self.present, self.traveller
                if drive is None or mine is None:
                    continue
                if drive.aside or not drive.action.arrived:
                    await self._give_way(drive, mine)

    async def _give_way(self, drive: Drive, mine: Traveller) -> None:
        here = mine.robot_in_map
        onward = replace(mine, way=drive.way.rest_from(here.x, here.y).points)
        met = {other: meeting(onward, other) for other in self._traffic.ahead_of(self)}
        snapshot, limits = self.robot.snapshot, self.robot.info.limits
        speed = snapshot.odometry.twist.v if snapshot else 0.0
        stop = WAITING_GAP + speed * speed / (2 * limits.deceleration)
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

    async def _make_room(self, drive: Drive, mine: Traveller, others: Sequence[Traveller]) -> None:
        """Go to a place beside the ways of others, if there is one."""
        seen = self._costs.with_obstacles(self._sightings.points(self._clock()))
        place = await self._in_thread(passing_place, seen, mine, others)
        if place is not None:
            drive.aside, drive.action.waits = True, ""
            beside = Destination(x=place.x, y=place.y)
            drive.action.send_on(self._follower(beside, place), last=False)

    async def _replan(self, drive: Drive) -> None:
        now, settings = self._clock(), self._costs.settings
        people = self._sightings.movers.are_about(now)
        here = self._localization.estimate.robot_in_map
        if drive.action.held_up(now) > settings.held_up and not people and here is not None:
            self.ways.avoid(drive.way, here)
        way = await self.plan(drive.place)
        if isinstance(way, Way):
            drive.action.follower.cost_to_go, drive.way = way.cost_to_go, way
            drive.closed_since = None
            return
        drive.closed = way.why
        if drive.closed_since is None:
            drive.closed_since = now
        elif now - drive.closed_since > (
            settings.blocked_by_people if people else settings.blocked
        ):
            if drive.is_last:
                drive.action.failed = way.why
            else:
                await self._skip(drive, way)

    async def _send_on(self, drive: Drive) -> None:
        """Plan the way to the next place of a patrol, once the robot has stood long enough."""
        if drive.is_last:
            return
        now = self._clock()
        if drive.arrived is None:
            drive.arrived, drive.skipped = now, 0
        elif now - drive.arrived >= self._costs.settings.pause:
            drive.go_on()
            await self._begin_leg(drive)

    async def _begin_leg(self, drive: Drive) -> None:
        way = await self.plan(drive.place)
        if isinstance(way, Way):
            drive.way = way
            follower = self._follower(drive.place, way.cost_to_go)
            drive.action.place = drive.place.name
            drive.action.send_on(follower, last=drive.is_last)
        else:
            await self._skip(drive, way)

    async def _skip(self, drive: Drive, no_way: NoWay) -> None:
        """Leave out a place that no way leads to; give up if there is none to any."""
        log.warning("leaves out %s: %s", drive.place, no_way.why)
        drive.skipped += 1
        if drive.is_last or drive.skipped >= len(drive.places):
            drive.action.failed = no_way.why
            return
        drive.go_on()
        await self._begin_leg(drive)

    async def plan(self, place: Destination, start: Pose2 | None = None) -> Way | NoWay:
        """Return a way from `start`, or where the robot is, around all that it has seen."""
        estimate = self._localization.estimate
        here = start or (estimate.robot_in_map if estimate.sure else None)
        if here is None:
            return NoWay(f"it is not sure where the robot is: {estimate.reason}")
        stay = [other.body for other in self._traffic.others(self) if not len(other.way)]
        return await self.ways.to(place, here, np.concatenate([NOWHERE, *stay]))

    def _follower(self, place: Destination, cost_to_go: CostToGo) -> Follower:
        info, where = self.robot.info, (place.x, place.y, place.heading)
        return Follower(info.model, info.limits, where, cost_to_go)

    def begin(
        self, places: tuple[Destination, ...], way: Way, speed: float | None, rounds: float
    ) -> Stack:
        """Begin a drive along `way`, to one place after the other; return its mode.

        It is as fast as `speed` [m/s] at most, and is driven to all so many `rounds`.
        """
        limits = self.robot.info.limits
        legs = rounds * len(places)
        action = FollowWay(
            follower=self._follower(places[0], way.cost_to_go),
            odom_in_map=lambda: self._localization.odom_in_map,
            unsure=self.unsure,
            sightings=self._sightings,
            walls=self._walls,
            preferred_speed=self._costs.speed_at,
            top_speed=min(speed or limits.max_speed, limits.max_speed),
            place=places[0].name,
            last=legs <= 1,
        )
        mode = follow_way(action, *PATROL) if len(places) > 1 else follow_way(action)
        self.present = Drive(places, legs, action, mode, way, self._clock())
        return mode

    def unsure(self) -> str | None:
        """Return the reason that nobody knows where the robot is, or `None`."""
        estimate = self._localization.estimate
        return None if estimate.sure else estimate.reason
