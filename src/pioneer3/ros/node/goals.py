"""Carries out goals from topics, one at a time, and tells of them as move_base does."""

import asyncio
import logging
from collections.abc import Callable
from contextlib import suppress
from math import inf
from typing import TYPE_CHECKING, Any, Final

from pioneer3.behaviors.action import Stack
from pioneer3.errors import MotionError, PioneerError
from pioneer3.ros.messages.goals import Goal, GoalState, GoalsUpdate, ResultUpdate
from pioneer3.ros.messages.update import NANO, nanoseconds
from pioneer3.ros.node.goal_list import GoalList
from pioneer3.ros.node.middleware import Middleware
from pioneer3.ros.node.publishing import Publishing
from pioneer3.runtime.motions import run_mode
from pioneer3.runtime.robot import Robot

if TYPE_CHECKING:
    from pioneer3.nav.places import Destination
    from pioneer3.navigation.navigator import Navigator

log = logging.getLogger(__name__)

STATUS_EVERY: Final = 0.2
"""Between two lists of goals [s], as in actionlib."""
PATIENCE: Final = 3.0
"""Longest wait for a robot that knows where it is [s]."""


class Goals:
    """Has a navigator carry out goals. A new one takes the place of the one before.

    All calls are made in the event loop.

    Args:
        robot: Connected.
        navigator: Its own.
        speed: On the way at most [m/s].
        publishing: Of the topics of actionlib.
        middleware: Of the node.
    """

    def __init__(
        self,
        robot: Robot,
        navigator: "Navigator",
        speed: float,
        publishing: Publishing,
        middleware: Middleware,
    ) -> None:
        self._robot, self._navigator, self._speed = robot, navigator, speed
        self._publishing, self._middleware = publishing, middleware
        self._goals = GoalList()
        self._count = 0
        self._current: Goal | None = None
        self._mode: Stack | None = None
        self._task: asyncio.Task[None] | None = None
        self._clock = asyncio.get_running_loop().time

    @property
    def current(self) -> Goal | None:
        """The goal that is being carried out."""
        return self._current

    async def run(self) -> None:
        """Tell of the goals until cancelled; then the last one ends."""
        try:
            while True:
                self._tell()
                await asyncio.sleep(STATUS_EVERY)
        finally:
            self._end(GoalState.ABORTED, "the node ends")

    def send(self, where: "Callable[[], Destination]") -> None:
        """Take a goal that came without an id; see :meth:`take`."""
        self._count += 1
        now = self._middleware.stamp(0.0)
        seconds, rest = divmod(nanoseconds(now), NANO)
        self.take(f"{self._middleware.name}-{self._count}-{seconds}.{rest:09d}", now, where)

    def take(self, id_: str, stamp: Any, where: "Callable[[], Destination]") -> None:
        """Take a goal in place of the one before, unless it is known already.

        Args:
            id_: Of the goal; if empty, it gets one.
            stamp: When it was sent; if zero, now.
            where: Returns the place. Raises a MotionError until the robot knows where it is, and
                any other PioneerError where the goal is wrong.
        """
        if not id_:
            self.send(where)
            return
        sent = stamp if nanoseconds(stamp) else self._middleware.stamp(0.0)
        goal = self._goals.take(id_, sent, self._clock())
        if goal is None:
            return
        if goal.state.is_over:
            self._publish_result(goal)
            return
        self._end(GoalState.PREEMPTED, "another goal came")
        self._current, goal.state, goal.text = goal, GoalState.ACTIVE, "on its way"
        self._tell()
        self._task = asyncio.ensure_future(self._carry_out(goal, where))

    def cancel(self, id_: str, stamp: Any) -> None:
        """Cancel the goals that are meant; see :meth:`GoalList.cancel`."""
        if self._current in self._goals.cancel(id_, stamp, self._clock()):
            self._end(GoalState.PREEMPTED, "cancelled")

    async def _carry_out(self, goal: Goal, where: "Callable[[], Destination]") -> None:
        try:
            await self._drive(where)
        except PioneerError as error:
            state, text = GoalState.ABORTED, str(error).removeprefix("goto: ")
        except Exception:
            log.exception("a goal failed")
            state, text = GoalState.ABORTED, "it failed; the log of the node has the details"
        else:
            state, text = GoalState.SUCCEEDED, "arrived"
        if self._current is goal:
            self._end(state, text)

    async def _drive(self, where: "Callable[[], Destination]") -> None:
        from pioneer3.navigation.ways import to_drive

        arbiter, after = self._robot.arbiter, self._robot.arbiter.last_stop.number
        place = None
        with suppress(MotionError):  # only a robot that knows where it is can tell
            place = where()
        await self._navigator.find(PATIENCE)
        place = place or where()
        way = to_drive(await self._navigator.plan(place))
        if arbiter.last_stop.number != after:
            raise MotionError(arbiter.last_stop.why)
        self._mode = self._navigator.mode(place, way, self._speed)
        await run_mode(self._mode, arbiter, self._robot.snapshots(), until=inf)
        await self._navigator.await_charger(place)

    def _end(self, state: GoalState, text: str) -> None:
        """End the current goal, if there is one; the robot stops if it was on its way."""
        goal, self._current = self._current, None
        mode, self._mode = self._mode, None
        task, self._task = self._task, None
        if goal is None:
            return
        if mode is not None and self._robot.arbiter.mode is mode:
            self._robot.arbiter.end_mode(text)
        if task is not None and task is not asyncio.current_task():
            task.cancel()
        self._goals.end(goal, state, text, self._clock())
        if state is GoalState.ABORTED:
            self._middleware.warn(f"the goal is given up: {text}")
        self._publish_result(goal)

    def _publish_result(self, goal: Goal) -> None:
        self._publishing.publish(ResultUpdate(goal=goal, stamp=self._middleware.stamp(0.0)))
        self._tell()

    def _tell(self) -> None:
        self._publishing.publish(
            GoalsUpdate(
                goals=self._goals.listed(self._clock()),
                stamp=self._middleware.stamp(0.0),
                make=self._middleware.make,
            )
        )
