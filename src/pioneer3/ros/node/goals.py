"""Goals from topics, told of as move_base does: the wire of :mod:`pioneer3.navigation.goals`."""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from pioneer3.clock import Clock
from pioneer3.geometry import Pose2
from pioneer3.navigation.goals import GoalServer, GoalStatus, NavigationGoal
from pioneer3.ros.messages.goals import (
    FeedbackUpdate,
    GoalState,
    GoalsUpdate,
    ResultUpdate,
    SentGoal,
)
from pioneer3.ros.messages.update import NANO, nanoseconds
from pioneer3.ros.node.goal_list import GoalList
from pioneer3.ros.node.middleware import Middleware, Outlet
from pioneer3.ros.node.publishing import Publishing
from pioneer3.tasks import next_tick

if TYPE_CHECKING:
    from pioneer3.nav.places import Destination

STATUS_EVERY: Final = 0.2
"""Between two lists of goals [s], as in actionlib."""
STATES: Final = {
    GoalStatus.ACCEPTED: GoalState.ACTIVE,
    GoalStatus.EXECUTING: GoalState.ACTIVE,
    GoalStatus.SUCCEEDED: GoalState.SUCCEEDED,
    GoalStatus.ABORTED: GoalState.ABORTED,
    GoalStatus.CANCELED: GoalState.PREEMPTED,
}
"""The words of actionlib."""


class GoalTopics:
    """Tells of goals on move_base's topics; `current` is carried out. The clock is in seconds."""

    def __init__(self, publishing: Publishing, outlet: Outlet, clock: Clock) -> None:
        self._publishing, self._outlet, self._clock = publishing, outlet, clock
        self.goals = GoalList()
        self.current: SentGoal | None = None
        self._count = 0

    def take(self, id_: str, stamp: Any = None) -> SentGoal | None:
        """Take a goal, and return it unless it is known; without an id it gets one.

        Without a stamp, or with a stamp of 0, it was sent now.
        """
        now = self._outlet.stamp(0.0)
        if not id_:
            self._count += 1
            seconds, rest = divmod(nanoseconds(now), NANO)
            id_, stamp = f"{self._outlet.name}-{self._count}-{seconds}.{rest:09d}", now
        sent = stamp if stamp is not None and nanoseconds(stamp) else now
        goal = self.goals.take(id_, sent, self._clock())
        if goal is not None and goal.state.is_over:
            self._publish_result(goal)
        return goal

    def change(self, goal: SentGoal, status: GoalStatus, text: str) -> None:
        """Note the status of a goal, and publish it."""
        if not status.is_over:
            self.current, goal.state, goal.text = goal, STATES[status], text or "on its way"
            self.tell()
            return
        self.current = None
        self.goals.end(goal, STATES[status], text, self._clock())
        self._publish_result(goal)

    def tell(self) -> None:
        """Publish the list of goals."""
        self._publishing.publish(
            GoalsUpdate(
                goals=self.goals.listed(self._clock()),
                stamp=self._outlet.stamp(0.0),
                make=self._outlet.make,
            )
        )

    def feed_back(self, robot_in_map: Pose2, frame: str, stamp: Any) -> None:
        """Publish where the robot is on its way to a goal, if it has one."""
        if (goal := self.current) is not None:
            self._publishing.publish(
                FeedbackUpdate(goal=goal, robot_in_map=robot_in_map, frame=frame, stamp=stamp)
            )

    def _publish_result(self, goal: SentGoal) -> None:
        self._publishing.publish(ResultUpdate(goal=goal, stamp=self._outlet.stamp(0.0)))
        self.tell()


class Goals:
    """Passes goals on to an action server, in the event loop."""

    def __init__(
        self, server: GoalServer, speed: float, publishing: Publishing, middleware: Middleware
    ) -> None:
        self._server, self._speed, self._middleware = server, speed, middleware
        self._clock = asyncio.get_running_loop().time
        self.topics = GoalTopics(publishing, middleware, self._clock)

    async def run(self) -> None:
        """Tell of the goals until cancelled; then the last one ends."""
        try:
            while True:
                self.topics.tell()
                await next_tick(STATUS_EVERY)
        finally:
            self._server.end(GoalStatus.ABORTED, "the node ends")

    def take(self, where: "Callable[[], Destination]", id_: str = "", stamp: Any = None) -> None:
        """Take a goal in place of the one before, unless it is known already.

        Id and stamp as of :meth:`GoalTopics.take`. `where` returns the place. It raises a
        MotionError until the robot knows where it is, and any other PioneerError where the goal is
        wrong.
        """
        goal = self.topics.take(id_, stamp)
        if goal is None or goal.state.is_over:
            return
        self._server.accept(
            NavigationGoal(
                places=lambda: (where(),),
                speed=self._speed,
                told=partial(self._take_status, goal),
                by="ROS",
            )
        )

    def cancel(self, id_: str, stamp: Any) -> None:
        """Cancel the goals that are meant; see :meth:`GoalList.cancel`."""
        if self.topics.current in self.topics.goals.cancel(id_, stamp, self._clock()):
            self._server.end(GoalStatus.CANCELED, "cancelled")

    def _take_status(self, goal: SentGoal, carried_out: NavigationGoal) -> None:
        if carried_out.status is GoalStatus.ABORTED:
            self._middleware.warn(f"the goal is given up: {carried_out.text}")
        self.topics.change(goal, carried_out.status, carried_out.text)
