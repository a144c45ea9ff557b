"""Publishes the map of a log, the robot's place on it and its way, as a node with a map does."""

from collections.abc import Callable
from math import inf, isinf, isnan
from typing import Any, Final

import numpy as np

from pioneer3.geometry import Pose2
from pioneer3.maps.occupancy import occupancy_of
from pioneer3.nav.estimate import Estimate
from pioneer3.nav.places import Destination
from pioneer3.navigation.goals import GoalChanged, GoalStatus
from pioneer3.navigation.navigator import NavigatorState
from pioneer3.navigation.recording import EstimateMade, MapUsed, WayPlanned
from pioneer3.ros.bag.outlet import BagOutlet
from pioneer3.ros.messages.diagnostics import DiagnosticStatus
from pioneer3.ros.messages.goals import SentGoal, fill_goal
from pioneer3.ros.messages.navigation import MapUpdate, NavigationUpdate, navigation_status
from pioneer3.ros.messages.update import NANO, MessageOptions
from pioneer3.ros.node.goals import STATUS_EVERY, GoalTopics
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.navigation_topics import ACTION_GOAL, NAVIGATION_TOPICS, SIMPLE_GOAL
from pioneer3.ros.node.publishing import EARLY, Publishing
from pioneer3.ros.node.topic import Direction
from pioneer3.state import Snapshot

EXACT: Final = 0.0
"""Spread of a place that nobody doubts, as on a map that grows."""


class NavigationPlayer:
    """The navigation of a node.

    Args:
        stamp: Returns a moment [s, monotonic] as ROS time.
    """

    def __init__(
        self,
        outlet: BagOutlet,
        options: MessageOptions,
        profile: Profile,
        stamp: Callable[[float], Any],
    ) -> None:
        self._outlet, self._options, self._stamp = outlet, options, stamp
        published = [topic for topic in NAVIGATION_TOPICS if topic.direction is Direction.PUBLISHED]
        self._publishing = Publishing(published, profile, outlet)
        self._publishing.advertise(lambda topic: True)
        asked = next(each for each in (ACTION_GOAL, SIMPLE_GOAL) if each.names(profile))
        self._asked = asked.type_name
        self._senders = [outlet.advertise(name, self._asked) for name in asked.names(profile)]
        self._goals = GoalTopics(self._publishing, outlet, lambda: outlet.now / NANO)
        self._goal: tuple[int, SentGoal | None] = (0, None)
        self._told_at = -inf
        self._map = ""
        self._estimate: Estimate | None = None
        self._way: WayPlanned | None = None

    def estimate(self, told: EstimateMade) -> None:
        """Take an estimate, which counts from the next snapshot on."""
        anywhere = told.odom_in_map is None or isinf(told.spread)
        self._map = told.map
        self._estimate = Estimate(
            robot_in_map=told.robot_in_map,
            odom_in_map=told.odom_in_map,
            covariance=_covariance(told),
            sure=told.sure,
            agreement=told.agreement,
            stage="lost" if anywhere else "sure" if told.sure else "looking",
            reason=told.reason,
        )

    def way(self, way: WayPlanned) -> None:
        """Take a way likewise."""
        self._way = way

    def goal(self, told: GoalChanged) -> None:
        """Publish the change of a goal, and the goal itself when it is new."""
        number, goal = self._goal
        if goal is None or number != told.number:
            goal = self._goals.take("")
            self._goal = told.number, goal
            if goal is not None and told.places:
                self._send(goal, told.places[-1])
        if goal is not None:
            self._goals.change(goal, GoalStatus(told.status), told.reason)

    def _send(self, goal: SentGoal, place: Destination) -> None:
        """Publish a goal as its sender would have."""
        for sender in self._senders:
            message = self._outlet.make(self._asked)
            pose = Pose2(place.x, place.y, place.heading or 0.0)
            fill_goal(message, goal, pose, self._options.map_frame)
            sender.publish(message)

    def use_map(self, used: MapUsed) -> None:
        """Publish a map; ConfigError if its text is none."""
        self._publishing.publish(
            MapUpdate(
                grid=occupancy_of(used.line_map),
                frame=self._options.map_frame,
                stamp=self._outlet.stamp(0.0),
            )
        )

    def odom_in_map(self, snapshot: Snapshot) -> tuple[Any, Pose2] | None:
        """Return the transform to publish and its stamp; `None` where the robot may be anywhere."""
        pose = self._known()
        if pose is None or not self._options.map_tf:
            return None
        return self._stamp(snapshot.stamp + self._options.tolerance), pose

    def publish(self, snapshot: Snapshot) -> None:
        """Publish where the robot is at a snapshot, and its way."""
        pose, estimate, way = self._known(), self._estimate, self._way
        if pose is None or estimate is None:
            return
        robot_in_map, frame = pose @ snapshot.odometry.robot_in_odom, self._options.map_frame
        stamp = self._stamp(snapshot.stamp)
        self._publishing.publish(
            NavigationUpdate(
                robot_in_map=robot_in_map,
                odom_in_map=pose,
                covariance=estimate.covariance,
                sure=estimate.sure,
                way=way.points if way else (),
                heading=way.place.heading if way and way.place else None,
                frame=frame,
                moment=snapshot.stamp,
                stamp=stamp,
                make=self._outlet.make,
            )
        )
        self._goals.feed_back(robot_in_map, frame, stamp)
        if not 0 <= snapshot.stamp - self._told_at < STATUS_EVERY - EARLY:
            self._told_at = snapshot.stamp
            self._goals.tell()

    def diagnose(self) -> tuple[DiagnosticStatus, ...]:
        """Return the state of localization and of the goal; nothing of a robot without a map."""
        estimate, place = self._estimate, self._way.place if self._way else None
        if estimate is None:
            return ()
        return navigation_status(self._map, estimate, NavigatorState(estimate=estimate, goal=place))

    def _known(self) -> Pose2 | None:
        """Return the pose of odometry's frame in the map."""
        estimate = self._estimate
        return None if estimate is None or estimate.stage == "lost" else estimate.odom_in_map


def _covariance(told: EstimateMade) -> Any:
    """Return the covariance of x, y and heading, as far as the log tells of it."""
    spread, turn = (EXACT if isnan(each) else each for each in (told.spread, told.turn_spread))
    return np.diag([spread**2, spread**2, turn**2])
