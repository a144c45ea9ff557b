"""Goals of an action server to messages of actionlib_msgs and move_base_msgs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from pioneer3.geometry import Pose2
from pioneer3.ros.messages.update import fill_header, fill_pose


class GoalState(IntEnum):
    """Numbers of actionlib_msgs/GoalStatus."""

    PENDING = 0
    ACTIVE = 1
    PREEMPTED = 2
    SUCCEEDED = 3
    ABORTED = 4
    REJECTED = 5
    PREEMPTING = 6
    RECALLING = 7
    RECALLED = 8

    @property
    def is_over(self) -> bool:
        """Whether a goal in this state never leaves it."""
        return self in _OVER


_OVER = {
    GoalState.PREEMPTED,
    GoalState.SUCCEEDED,
    GoalState.ABORTED,
    GoalState.REJECTED,
    GoalState.RECALLED,
}


@dataclass(slots=True, kw_only=True, eq=False)
class SentGoal:
    """A goal that somebody has sent, with the id that its sender has for it, and its progress.

    `ended` is when it was over [s, monotonic], or its cancel came before itself; `None` until then.
    """

    id: str
    stamp: Any
    state: GoalState = GoalState.PENDING
    text: str = ""
    ended: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class GoalsUpdate:
    """All goals that are listed, the oldest first.

    `stamp` is as the middleware writes times, as in all updates; `make` returns an empty message of
    the type named.
    """

    goals: Sequence[SentGoal]
    stamp: Any
    make: Callable[[str], Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class ResultUpdate:
    """A goal is over."""

    goal: SentGoal
    stamp: Any


@dataclass(frozen=True, slots=True, kw_only=True)
class FeedbackUpdate:
    """Where the robot is on the way to a goal: its pose in the map's `frame`."""

    goal: SentGoal
    robot_in_map: Pose2
    frame: str
    stamp: Any


def fill_goal(message: Any, goal: SentGoal, robot_in_map: Pose2, frame: str) -> None:
    """Fill a move_base_msgs/MoveBaseActionGoal, or a geometry_msgs/PoseStamped."""
    if hasattr(message, "goal_id"):
        message.header.stamp = goal.stamp
        message.goal_id.id, message.goal_id.stamp = goal.id, goal.stamp
        message = message.goal.target_pose
    fill_header(message, goal.stamp, frame)
    fill_pose(message.pose.position, message.pose.orientation, robot_in_map)


def statuses(message: Any, update: GoalsUpdate) -> None:
    """Fill an actionlib_msgs/GoalStatusArray."""
    message.header.stamp = update.stamp
    message.status_list = []
    for each in update.goals:
        status = update.make("actionlib_msgs/GoalStatus")
        _fill_status(status, each)
        message.status_list.append(status)


def result(message: Any, update: ResultUpdate) -> None:
    """Fill a move_base_msgs/MoveBaseActionResult."""
    message.header.stamp = update.stamp
    _fill_status(message.status, update.goal)


def feedback(message: Any, update: FeedbackUpdate) -> None:
    """Fill a move_base_msgs/MoveBaseActionFeedback."""
    message.header.stamp = update.stamp
    _fill_status(message.status, update.goal)
    stamped = message.feedback.base_position
    fill_header(stamped, update.stamp, update.frame)
    fill_pose(stamped.pose.position, stamped.pose.orientation, update.robot_in_map)


def _fill_status(status: Any, goal: SentGoal) -> None:
    status.goal_id.id, status.goal_id.stamp = goal.id, goal.stamp
    status.status, status.text = int(goal.state), goal.text
