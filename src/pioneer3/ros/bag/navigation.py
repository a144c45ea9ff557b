"""Publishes the map of a log, the robot's place on it and its way, as a node with a map does."""

from collections.abc import Callable
from math import isinf, isnan
from typing import Any, Final

from pioneer3.geometry import Pose2
from pioneer3.maps.occupancy import occupancy_of
from pioneer3.navigation.recording import EstimateMade, MapUsed, WayPlanned
from pioneer3.ros.bag.outlet import BagOutlet
from pioneer3.ros.messages.navigation import MapUpdate, NavigationUpdate
from pioneer3.ros.messages.update import MessageOptions
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.navigation_topics import NAVIGATION_TOPICS
from pioneer3.ros.node.publishing import Publishing
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
        self._estimate: EstimateMade | None = None
        self._way: WayPlanned | None = None

    def estimate(self, time: int, estimate: EstimateMade) -> None:
        """Take an estimate, which counts from the next snapshot on."""
        self._estimate = estimate

    def way(self, time: int, way: WayPlanned) -> None:
        """Take a way likewise."""
        self._way = way

    def use_map(self, time: int, used: MapUsed) -> None:
        """Publish a map; ConfigError if its text is none."""
        self._outlet.now = time
        self._publishing.publish(
            MapUpdate(
                grid=occupancy_of(used.line_map),
                frame=self._options.map_frame,
                stamp=self._outlet.stamp_of(time),
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
        self._publishing.publish(
            NavigationUpdate(
                robot_in_map=pose @ snapshot.odometry.robot_in_odom,
                odom_in_map=pose,
                covariance=_covariance(estimate),
                sure=estimate.sure,
                way=way.points if way else (),
                heading=way.place.heading if way and way.place else None,
                frame=self._options.map_frame,
                moment=snapshot.stamp,
                stamp=self._stamp(snapshot.stamp),
                make=self._outlet.make,
            )
        )

    def _known(self) -> Pose2 | None:
        """Return the pose of odometry's frame in the map."""
        estimate = self._estimate
        return None if estimate is None or isinf(estimate.spread) else estimate.odom_in_map


def _covariance(estimate: EstimateMade) -> list[list[float]]:
    """Return the covariance of x, y and heading, as far as the log tells of it."""
    spread, turn = (
        EXACT if isnan(each) else each for each in (estimate.spread, estimate.turn_spread)
    )
    return [[spread**2, 0.0, 0.0], [0.0, spread**2, 0.0], [0.0, 0.0, turn**2]]
