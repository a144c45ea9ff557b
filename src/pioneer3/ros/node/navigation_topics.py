"""The table of topics of a node that has a map: those of map_server, AMCL and move_base."""

from typing import Any, Final

from pioneer3.ros.messages import goals, navigation
from pioneer3.ros.messages.goals import FeedbackUpdate, GoalsUpdate, ResultUpdate
from pioneer3.ros.messages.navigation import MapUpdate, NavigationUpdate
from pioneer3.ros.node.topic import Topic


def _named(name: str, type_name: str, **parts: Any) -> Topic:
    """Return a row; RosAria has none of them, and the names are the same in its profiles."""
    return Topic(compatibility=name, standard=name, type_name=type_name, optional="a map", **parts)


INITIAL_POSE: Final = _named(
    "initialpose",
    "geometry_msgs/PoseWithCovarianceStamped",
    parse=navigation.start,
    note="where the robot is, in `map`; a covariance of 0 is 0.3 m and 0.15 rad",
)
SIMPLE_GOAL: Final = _named(
    "move_base_simple/goal",
    "geometry_msgs/PoseStamped",
    ros2="goal_pose",
    parse=navigation.placed,
    note="RViz's 2D Nav Goal, in RViz 2 2D Goal Pose; in `map`, `odom` or `base_link`",
)
GOAL_NAME: Final = _named(
    "goal_name",
    "std_msgs/String",
    parse=lambda message: str(message.data),
    note="a place of the map, such as `Kitchen`",
)
ACTION_GOAL: Final = _named(
    "move_base/goal",
    "move_base_msgs/MoveBaseActionGoal",
    ros2=None,
    parse=lambda message: navigation.placed(message.goal.target_pose),
    note="a new goal takes the place of the one before",
)
ACTION_CANCEL: Final = _named(
    "move_base/cancel",
    "actionlib_msgs/GoalID",
    ros2=None,
    parse=lambda message: (str(message.id), message.stamp),
    note="without id and stamp all goals",
)
NAVIGATION_TOPICS: Final = (
    _named(
        "map",
        "nav_msgs/OccupancyGrid",
        source=MapUpdate,
        fill=navigation.occupancy_grid,
        latched=True,
        note="walls in cells of 5 cm; a map that is one grid as it is",
    ),
    _named(
        "map_metadata",
        "nav_msgs/MapMetaData",
        source=MapUpdate,
        fill=navigation.map_metadata,
        latched=True,
        note="its size and place",
    ),
    INITIAL_POSE,
    _named(
        "amcl_pose",
        "geometry_msgs/PoseWithCovarianceStamped",
        source=NavigationUpdate,
        fill=navigation.place,
        changes=lambda update: update.odom_in_map,
        latched=True,
        has_data=lambda update: update.sure,
        note="each 10 cm or 0.1 rad, while the robot is sure",
    ),
    SIMPLE_GOAL,
    GOAL_NAME,
    ACTION_GOAL,
    ACTION_CANCEL,
    _named(
        "move_base/status",
        "actionlib_msgs/GoalStatusArray",
        ros2=None,
        source=GoalsUpdate,
        fill=goals.statuses,
        latched=True,
        note="with the reason of each end as text; goals that are over for 5 s more",
    ),
    _named(
        "move_base/feedback",
        "move_base_msgs/MoveBaseActionFeedback",
        ros2=None,
        source=FeedbackUpdate,
        fill=goals.feedback,
        note="the robot's pose in `map`",
    ),
    _named(
        "move_base/result",
        "move_base_msgs/MoveBaseActionResult",
        ros2=None,
        source=ResultUpdate,
        fill=goals.result,
        note="SUCCEEDED, ABORTED or PREEMPTED, and the reason",
    ),
    _named(
        "move_base/current_goal",
        "geometry_msgs/PoseStamped",
        ros2="current_goal",
        source=NavigationUpdate,
        fill=navigation.goal,
        changes=lambda update: (update.way[-1:], update.heading),
        has_data=lambda update: bool(update.way),
        latched=True,
        note="in `map`",
    ),
    _named(
        "move_base/NavfnROS/plan",
        "nav_msgs/Path",
        ros2="plan",
        source=NavigationUpdate,
        fill=navigation.way,
        changes=lambda update: update.way,
        note="a point each 10 cm, again each second; empty at the end",
    ),
)
"""All of them; a node has them beside its others."""
