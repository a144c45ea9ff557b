"""The goals of one action server, by the rules of actionlib's protocol."""

from typing import Any, Final

from pioneer3.ros.messages.goals import GoalState, SentGoal
from pioneer3.ros.messages.update import nanoseconds

LISTED: Final = 5.0
"""A goal that is over is listed for so long [s]: its sender may have missed the result."""
MOST: Final = 100
"""Goals that are listed; more are a sender that has gone wrong."""


class GoalList:
    """All goals that have come, and cancels that came before their goals."""

    def __init__(self) -> None:
        self._goals: list[SentGoal] = []
        self._cancelled_to = 0

    def take(self, id_: str, stamp: Any, now: float) -> SentGoal | None:
        """Take a goal; return it, or `None` where it is known.

        One that was cancelled before it came is over already.
        """
        known = self._by_id(id_)
        if known is not None and known.state is not GoalState.RECALLING:
            return None
        if known is not None:
            self.end(known, GoalState.RECALLED, "cancelled before it came", now)
            return known
        goal = SentGoal(id=id_, stamp=stamp)
        self._add(goal, now)
        if 0 < nanoseconds(stamp) <= self._cancelled_to:
            self.end(goal, GoalState.RECALLED, "older than the last cancel", now)
        return goal

    def cancel(self, id_: str, stamp: Any, now: float) -> list[SentGoal]:
        """Take a cancel; return the goals that are to end.

        Without id and stamp it means all goals, with a stamp those up to then, with an id that one.
        """
        moment = nanoseconds(stamp)
        everything = not id_ and not moment
        meant = [
            goal
            for goal in self._goals
            if everything or goal.id == id_ or (moment and nanoseconds(goal.stamp) <= moment)
        ]
        if id_ and self._by_id(id_) is None:
            self._add(SentGoal(id=id_, stamp=stamp, state=GoalState.RECALLING, ended=now), now)
        self._cancelled_to = max(self._cancelled_to, moment)
        ending = [goal for goal in meant if goal.state in (GoalState.PENDING, GoalState.ACTIVE)]
        for goal in ending:
            began = goal.state is GoalState.ACTIVE
            goal.state = GoalState.PREEMPTING if began else GoalState.RECALLING
        return ending

    def end(self, goal: SentGoal, state: GoalState, text: str, now: float) -> None:
        """End a goal."""
        goal.state, goal.text, goal.ended = state, text, now

    def listed(self, now: float) -> list[SentGoal]:
        """Return the goals to tell of."""
        self._goals = [
            goal for goal in self._goals if goal.ended is None or now - goal.ended < LISTED
        ]
        return list(self._goals)

    def _by_id(self, id_: str) -> SentGoal | None:
        return next((goal for goal in self._goals if goal.id == id_), None)

    def _add(self, goal: SentGoal, now: float) -> None:
        over = [each for each in self.listed(now) if each.ended is not None]
        if len(self._goals) >= MOST and over:
            self._goals.remove(over[0])
        self._goals.append(goal)
