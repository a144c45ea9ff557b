"""Goals from topics, told of as move_base does: the wire of :mod:`pioneer3.navigation.goals`."""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from pioneer3.navigation.goals import GoalServer, GoalStatus, NavigationGoal
from pioneer3.ros.messages.goals import GoalState, GoalsUpdate, ResultUpdate, SentGoal
from pioneer3.ros.messages.update import NANO, nanoseconds
from pioneer3.ros.node.goal_list import GoalList
from pioneer3.ros.node.middleware import Middleware
from pioneer3.ros.node.publishing import Publishing

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


class Goals:
    """Passes goals on to an action server, in the event loop; `current` is carried out."""

    def __init__(
        self, server: GoalServer, speed: float, publishing: Publishing, middleware: Middleware
    ) -> None:
        self._server, self._speed = server, speed
        self._publishing, self._middleware = publishing, middleware
        self._goals = GoalList()
        self._count = 0
        self.current: SentGoal | None = None
        self._clock = asyncio.get_running_loop().time

    async def run(self) -> None:
        """Tell of the goals until cancelled; then the last one ends."""
        try:
            while True:
                self._tell()
                await asyncio.sleep(STATUS_EVERY)
        finally:
            self._server.end(GoalStatus.ABORTED, "the node ends")

    def send(self, where: "Callable[[], Destination]") -> None:
        """Take a goal that came without an id; see :meth:`take`."""
        self._count += 1
        now = self._middleware.stamp(0.0)
        seconds, rest = divmod(nanoseconds(now), NANO)
        self.take(f"{self._middleware.name}-{self._count}-{seconds}.{rest:09d}", now, where)

    def take(self, id_: str, stamp: Any, where: "Callable[[], Destination]") -> None:
        """Take a goal in place of the one before, unless it is known already.

        Without an id it gets one; a stamp of 0 is now. `where` returns the place. It raises a
        MotionError until the robot knows where it is, and any other PioneerError where the goal is
        wrong.
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
        if self.current in self._goals.cancel(id_, stamp, self._clock()):
            self._server.end(GoalStatus.CANCELED, "cancelled")

    def _take_status(self, goal: SentGoal, carried_out: NavigationGoal) -> None:
        """Note the status of a goal, and publish it."""
        state, text = STATES[carried_out.status], carried_out.text
        if not carried_out.status.is_over:
            self.current, goal.state, goal.text = goal, state, text or "on its way"
            self._tell()
            return
        self.current = None
        self._goals.end(goal, state, text, self._clock())
        if state is GoalState.ABORTED:
            self._middleware.warn(f"the goal is given up: {text}")
        self._publish_result(goal)

    def _publish_result(self, goal: SentGoal) -> None:
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
