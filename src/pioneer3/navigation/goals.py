"""Goals of a robot on a map, from the request to the end: the action server of all who send it.

=========  ===================================================  =================================
status     the robot                                            next
=========  ===================================================  =================================
ACCEPTED   waits for navigation, for its place and for a way    EXECUTING or an end
EXECUTING  drives                                               an end
SUCCEEDED  is there, or knows where it is after looking around
ABORTED    was stopped or lost, or there is no way
CANCELED   was called back, or got another goal
=========  ===================================================  =================================

Rules:

1. A robot has one goal at a time. A new one cancels the one before.
2. Any stop after the request aborts the goal, also before the robot sets out.
3. A robot that is not sure where it is gets :data:`FIND_PATIENCE` to find out.
4. A robot sets out on a way that is closed now, and waits where it is closed.
5. At a dock the goal ends when the charger answers; a dock without one is no error.
6. Canceling ends the motion at once: there is no status between the request and the end.
"""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Protocol

from pioneer3.behaviors.action import Stack
from pioneer3.errors import LinkError, MotionError, PioneerError, Refusal
from pioneer3.nav.places import Destination
from pioneer3.robot.supervisor import Feed
from pioneer3.runtime.driven import LOST_AFTER, Driven
from pioneer3.runtime.motions import await_mode
from pioneer3.state import Charging
from pioneer3.tasks import running

if TYPE_CHECKING:
    from pioneer3.nav.estimate import Estimate
    from pioneer3.nav.planner import NoWay, Way

log = logging.getLogger(__name__)

FIND_PATIENCE = 3.0
"""Longest wait for a robot that knows where it is [s]."""
CHARGER = 5.0
"""A charger answers within this [s]."""
STOP_CHECK_PERIOD = 0.1
"""Pause between two looks for a stop while a goal waits [s]."""
GONE = "the robot has gone"
"""The reason to end a goal with the work on it."""


class GoalStatus(Enum):
    """Status of a goal, by the words of ROS 2's action servers."""

    ACCEPTED = "accepted"
    EXECUTING = "executing"
    SUCCEEDED = "succeeded"
    ABORTED = "aborted"
    CANCELED = "canceled"

    @property
    def is_over(self) -> bool:
        """Whether a goal keeps this status."""
        return self not in (GoalStatus.ACCEPTED, GoalStatus.EXECUTING)


@dataclass(slots=True, kw_only=True, eq=False)
class NavigationGoal:
    """A request to drive to places of the map, or to look around.

    Attributes:
        places: Returns the places, in their order; `None` looks around. Raises a MotionError where
            the robot must be sure of its place first.
        speed: At most [m/s]; `None` for the robot's highest.
        rounds: How often it drives to all places, if there are several.
        begin: Starts the mode for who asked, or returns a refusal; `None` for a program, which may
            always drive.
        told: Called after each change.
        text: The reason of its end, or of a wait on the way.
        by: Who gave it, for the log: the name of a user of the page, `program` or `ROS`.
        progress: Published with each status.
        found: The way, or the reason that it is closed; `None` while it is not known.
        after: Number of the last stop before the request.
    """

    places: Callable[[], Sequence[Destination]] | None
    speed: float | None = None
    rounds: float = 1
    begin: Callable[[Stack], Refusal | None] | None = None
    told: Callable[["NavigationGoal"], None] = lambda goal: None
    status: GoalStatus = GoalStatus.ACCEPTED
    text: str = ""
    by: str = "program"
    progress: Feed[GoalStatus] = field(default_factory=Feed)
    found: "Way | NoWay | None" = None
    after: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class GoalChanged:
    """A change of a goal: who gave it, where it leads, and its status with the reason.

    Attributes:
        number: Of the goal, which all its changes have.
        by: Name of a user of the page, `program` or `ROS`.
        places: To drive to, in their order; empty to look around, or while nobody can tell.
        status: `accepted`, `executing`, `succeeded`, `aborted` or `canceled`.
        reason: Of its end, or of a wait on the way.
        speed: At most [m/s]; `None` for the robot's highest.
        rounds: How often it drives to all places.
    """

    number: int
    by: str
    places: tuple[Destination, ...]
    status: str
    reason: str
    speed: float | None
    rounds: float


class Planning(Protocol):
    """A navigator, as goals use it; see :class:`~pioneer3.navigation.navigator.Navigator`."""

    @property
    def estimate(self) -> "Estimate":
        """The place of the robot."""

    async def find(self) -> bool:
        """Wait until it is sure where the robot is; return whether."""

    async def plan(self, place: Destination) -> "Way | NoWay":
        """Return a way from where the robot is."""

    def begin_drive(
        self,
        place: Destination,
        way: "Way",
        speed: float | None = None,
        *,
        after: Sequence[Destination] = (),
        rounds: float = 1,
    ) -> Stack:
        """Begin a drive along a way; return its mode, to start at once."""

    def looking_around(self) -> Stack:
        """Return the mode that finds out where the robot is."""


class GoalServer:
    """Carries out the goals of one robot. :meth:`run` does the work.

    Its `navigator` may take a while to be ready; `patience` is the longest wait for news of a robot
    on its way [s]; `current` is the goal that is not over, or `None`.
    """

    def __init__(
        self,
        robot: Driven,
        navigator: Callable[[], Awaitable[Planning]],
        patience: float = LOST_AFTER,
    ) -> None:
        self.current: NavigationGoal | None = None
        self._robot, self._navigator, self._patience = robot, navigator, patience
        self._mode: Stack | None = None
        self._news = asyncio.Event()
        self._gone = False
        self._accepted = 0

    async def run(self) -> None:
        """Carry out goals until cancelled; then the last one ends."""
        try:
            while True:
                await self._news.wait()
                self._news.clear()
                if (goal := self.current) is not None:
                    async with running(self._carry_out(goal), self._watch_stops(goal)):
                        await self._news.wait()
        finally:
            self._gone = True
            self.end(GoalStatus.ABORTED, GONE)

    def accept(self, goal: NavigationGoal) -> None:
        """Carry out `goal` in place of the one before."""
        self.end(GoalStatus.CANCELED, "another goal came")
        self.current, goal.after = goal, self._robot.arbiter.last_stop.number
        self._accepted += 1
        self._change(goal, GoalStatus.ACCEPTED, "")
        self._news.set()
        if self._gone:
            self.end(GoalStatus.ABORTED, GONE)

    def end(self, status: GoalStatus, why: str) -> None:
        """End the current goal, if there is one; a robot that was on its way stops."""
        goal, self.current = self.current, None
        mode, self._mode = self._mode, None
        if goal is None:
            return
        if mode is not None and self._robot.arbiter.mode is mode:
            self._robot.arbiter.end_mode(why)
        self._news.set()
        self._change(goal, status, why)

    async def set_out(self, goal: NavigationGoal) -> None:
        """Accept `goal`, and wait until the robot is on its way.

        Raises:
            MotionError: It does not set out; see the message.
        """
        self.accept(goal)
        await self._wait(goal, lambda status: status is not GoalStatus.ACCEPTED)

    async def carry_out(self, goal: NavigationGoal) -> None:
        """Accept `goal`, and wait for its end; cancelled, it cancels the goal.

        Raises:
            MotionError: It did not succeed; see the message.
        """
        self.accept(goal)
        try:
            await self._wait(goal, lambda status: status.is_over)
        finally:
            if self.current is goal:
                self.end(GoalStatus.CANCELED, "its sender called it back")

    async def _wait(self, goal: NavigationGoal, enough: Callable[[GoalStatus], bool]) -> None:
        async for status in goal.progress.values(latest_first=True):
            if enough(status):
                break
        if goal.status in (GoalStatus.ABORTED, GoalStatus.CANCELED):
            raise MotionError(goal.text)

    def _change(self, goal: NavigationGoal, status: GoalStatus, text: str) -> None:
        goal.status, goal.text = status, text
        if (robot_log := self._robot.arbiter.log) is not None:
            changed = _changed(self._accepted, goal)
            robot_log.put(robot_log.topic("goal", GoalChanged), changed)
        goal.progress.publish(status)
        goal.told(goal)

    async def _watch_stops(self, goal: NavigationGoal) -> None:
        """End a goal that waits, as soon as somebody stops the robot."""
        while goal.status is GoalStatus.ACCEPTED:
            await asyncio.sleep(STOP_CHECK_PERIOD)
            stop = self._robot.arbiter.last_stop
            if goal.status is GoalStatus.ACCEPTED and stop.outdates(goal.after):
                self.end(GoalStatus.ABORTED, stop.why)

    async def _carry_out(self, goal: NavigationGoal) -> None:
        status, text = GoalStatus.ABORTED, "it failed; the log has the details"
        try:
            text = await self._drive(goal, await self._navigator())
            status = GoalStatus.SUCCEEDED
        except PioneerError as error:
            text = str(error)
        except Exception:
            log.exception("a goal failed")
        if self.current is goal:
            self.end(status, text)

    async def _drive(self, goal: NavigationGoal, navigator: Planning) -> str:
        """Carry out a goal; return how it succeeded.

        Raises:
            PioneerError: It did not.
        """
        places = await self._places(goal, navigator)
        if places is None:
            if navigator.estimate.sure:
                return "it is sure where it is"
            await self._run(goal, navigator.looking_around(), "")
            return "it knows where it is"
        mode, closed = await self._way(goal, places, navigator)
        await self._run(goal, mode, closed)
        if places[-1].charges:
            await self._await_charger(places[-1])
        return "arrived"

    async def _places(
        self, goal: NavigationGoal, navigator: Planning
    ) -> Sequence[Destination] | None:
        """Return the places once the robot is sure of its own, or has waited long enough."""
        if goal.places is None:
            await navigator.find()
            return None
        places = None
        with suppress(MotionError):  # only a robot that knows where it is can tell
            places = goal.places()  # at once: a wrong one fails, one in its frame moves with it
        await navigator.find()  # planning gives the reason if it is not sure
        return places or goal.places()

    async def _way(
        self, goal: NavigationGoal, places: Sequence[Destination], navigator: Planning
    ) -> tuple[Stack, str]:
        """Return the mode that drives to places, and the reason to wait on the way, or nothing."""
        from pioneer3.nav.planner import NoWay
        from pioneer3.navigation.ways import to_drive

        first, *rest = places
        goal.found = found = await navigator.plan(first)
        way = to_drive(found)
        mode = navigator.begin_drive(first, way, goal.speed, after=rest, rounds=goal.rounds)
        return mode, f"{found.why}; it waits before it" if isinstance(found, NoWay) else ""

    async def _run(self, goal: NavigationGoal, mode: Stack, text: str) -> None:
        """Let a mode drive until it has reached its aim, unless the robot was stopped meanwhile."""
        arbiter = self._robot.arbiter
        if arbiter.last_stop.outdates(goal.after):
            raise MotionError(arbiter.last_stop.why)
        refused = (goal.begin or arbiter.start)(mode)
        if arbiter.mode is not mode:
            raise MotionError(refused.text if refused else "another mode was started")
        self._mode = mode
        self._change(goal, GoalStatus.EXECUTING, text)
        await await_mode(mode, arbiter, self._robot.snapshots(patience=self._patience))

    async def _await_charger(self, dock: Destination) -> None:
        try:
            async for snapshot in self._robot.snapshots(CHARGER):
                if snapshot.battery.charging not in (Charging.NONE, Charging.UNKNOWN):
                    log.info("stands in %s: %s", dock, snapshot.battery.charging)
                    return
        except LinkError as error:
            raise MotionError(str(error)) from error
        log.warning("stands in %s, but the robot does not say that it is charged", dock)


def _changed(number: int, goal: NavigationGoal) -> GoalChanged:
    """Return the message for a log."""
    there: tuple[Destination, ...] = ()
    if goal.places is not None:
        with suppress(PioneerError):  # only a robot that knows where it is can tell
            there = tuple(goal.places())
    return GoalChanged(
        number=number,
        by=goal.by,
        places=there,
        status=goal.status.value,
        reason=goal.text,
        speed=goal.speed,
        rounds=goal.rounds,
    )
