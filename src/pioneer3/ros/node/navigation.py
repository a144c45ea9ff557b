"""The navigation of a node: publishes map, place and way; takes starts and goals."""

import asyncio
from collections.abc import Callable
from functools import partial
from math import inf
from typing import TYPE_CHECKING, Any, Final

from pioneer3.errors import CommandError, MotionError, PioneerError
from pioneer3.geometry import Pose2
from pioneer3.maps.line_map import OccupancyGrid
from pioneer3.maps.occupancy import occupancy_of
from pioneer3.ros.messages.diagnostics import DiagnosticStatus
from pioneer3.ros.messages.navigation import (
    MapUpdate,
    NavigationUpdate,
    PlanUpdate,
    SentPose,
    SentStart,
    navigation_status,
    occupancy_grid,
    plan_request,
    way,
)
from pioneer3.ros.messages.update import MessageOptions
from pioneer3.ros.node.goals import Goals
from pioneer3.ros.node.middleware import QUEUE, Middleware, Sender
from pioneer3.ros.node.names import Profile
from pioneer3.ros.node.navigation_topics import (
    ACTION_CANCEL,
    ACTION_GOAL,
    GOAL_NAME,
    INITIAL_POSE,
    NAVIGATION_TOPICS,
    SIMPLE_GOAL,
)
from pioneer3.ros.node.publishing import Publishing
from pioneer3.ros.node.topic import Direction, Topic
from pioneer3.runtime.robot import Robot
from pioneer3.state import Snapshot
from pioneer3.tasks import hand_over

if TYPE_CHECKING:
    from pioneer3.nav.places import Destination
    from pioneer3.nav.planner import Way
    from pioneer3.navigation.navigator import Navigator

GOALS: Final = (SIMPLE_GOAL, GOAL_NAME, ACTION_GOAL)
SETTLED: Final = 3.0
"""A node has all connections to publishers that were there before it after so long [s]."""
SPARSE: Final = 4
"""Step between published points of a way: points are half a cell apart."""


class NodeNavigation:
    """Navigation on topics: of a connected robot, on the way to goals at `speed` [m/s] at most."""

    def __init__(
        self,
        robot: Robot,
        navigator: "Navigator",
        *,
        speed: float,
        options: MessageOptions,
        profile: Profile,
        middleware: Middleware,
    ) -> None:
        self._robot, self.navigator = robot, navigator
        self._options, self._profile, self._middleware = options, profile, middleware
        self._frames = options.frames.with_prefix(options.prefix)
        published = [topic for topic in NAVIGATION_TOPICS if topic.direction is Direction.PUBLISHED]
        self._publishing = Publishing(published, profile, middleware)
        self._goals = Goals(navigator.goals, speed, self._publishing, middleware)
        self._grid: OccupancyGrid | None = None
        self._way: tuple[Way | None, tuple[tuple[float, float], ...]] = (None, ())
        self._loop = asyncio.get_running_loop()
        self._clock = self._loop.time
        self._began = inf

    def advertise(self) -> None:
        """Publish the map, and subscribe to starts and goals; in a thread."""
        self._grid = occupancy_of(self.navigator.line_map)
        self._publishing.advertise(lambda topic: True)
        self._publishing.publish(self._map())
        self._began = self._clock()
        for topic, take in (
            (INITIAL_POSE, self._take_start),
            (SIMPLE_GOAL, lambda sent: self._goals.take(self._place_in(SIMPLE_GOAL, sent))),
            (GOAL_NAME, self._take_name),
            (ACTION_GOAL, self._take_action_goal),
            (ACTION_CANCEL, lambda sent: self._goals.cancel(*ACTION_CANCEL.content(sent))),
        ):
            for name in topic.names(self._profile):
                receive = partial(self._receive, topic, take)
                self._middleware.subscribe(name, topic.type_name, receive, queue=QUEUE)

    async def run(self) -> None:
        """Carry out goals until cancelled."""
        await self._goals.run()

    def odom_in_map(self, snapshot: Snapshot) -> tuple[Any, Pose2] | None:
        """Return the transform to publish and its stamp, or `None`.

        As in AMCL it is the most likely one, sure or not, so that people see it; and none where the
        robot may be anywhere.
        """
        estimate = self.navigator.estimate
        if not self._options.map_tf or estimate.odom_in_map is None or estimate.stage == "lost":
            return None
        age = self._clock() - snapshot.stamp - self._options.tolerance
        return self._middleware.stamp(age), estimate.odom_in_map

    def publish(self, snapshot: Snapshot) -> None:
        """Publish where the robot is at `snapshot`, and its way."""
        estimate, navigation = self.navigator.estimate, self.navigator.state.latest
        if estimate.odom_in_map is None or navigation is None:
            return
        robot_in_map = estimate.odom_in_map @ snapshot.odometry.robot_in_odom
        stamp = self._middleware.stamp(self._clock() - snapshot.stamp)
        self._publishing.publish(
            NavigationUpdate(
                robot_in_map=robot_in_map,
                odom_in_map=estimate.odom_in_map,
                covariance=estimate.covariance,
                sure=estimate.sure,
                way=self._points(navigation.way),
                heading=navigation.goal.heading if navigation.goal else None,
                frame=self._options.map_frame,
                moment=snapshot.stamp,
                stamp=stamp,
                make=self._middleware.make,
            )
        )
        self._goals.topics.feed_back(robot_in_map, self._options.map_frame, stamp)

    def diagnose(self) -> tuple[DiagnosticStatus, ...]:
        """Return the state of localization and of the goal."""
        state = self.navigator.state.latest
        return navigation_status(self.navigator.line_map.name, self.navigator.estimate, state)

    def make_map(self) -> Any:
        """Return a message with the map."""
        message = self._middleware.make("nav_msgs/OccupancyGrid")
        occupancy_grid(message, self._map())
        return message

    async def make_plan(self, request: Any) -> Any:
        """Return a message with the way that a request asks for; without points if there is none.

        The robot sets out on that way; the reason that there is none, and that one is closed now,
        is logged.
        """
        from pioneer3.nav.planner import NoWay
        from pioneer3.navigation.ways import to_drive

        points: tuple[tuple[float, float], ...] = ()
        heading = None
        try:
            begin, end = plan_request(request)
            start = self._in_map(begin.frame) @ begin.pose if begin else None
            place = self._place_of(end)
            heading = place.heading
            found = await self.navigator.plan(place, start)
            points = _sparse(to_drive(found))
            if isinstance(found, NoWay):
                self._middleware.warn(f"make_plan: {found.why}")
        except PioneerError as error:
            self._middleware.warn(f"make_plan: {error}")
        message, stamp = self._middleware.make("nav_msgs/Path"), self._middleware.stamp(0.0)
        make, frame = self._middleware.make, self._options.map_frame
        way(message, PlanUpdate(way=points, heading=heading, frame=frame, stamp=stamp, make=make))
        return message

    def no_plan(self) -> Any:
        """Return an empty message of a way."""
        return self._middleware.make("nav_msgs/Path")

    def _map(self) -> MapUpdate:
        assert self._grid is not None
        stamp = self._middleware.stamp(0.0)
        return MapUpdate(grid=self._grid, frame=self._options.map_frame, stamp=stamp)

    def _points(self, way: "Way | None") -> tuple[tuple[float, float], ...]:
        """Return some of the points of a way, the last one among them."""
        if way is not self._way[0]:
            self._way = way, _sparse(way) if way else ()
        return self._way[1]

    def _receive(
        self, topic: Topic, take: Callable[[Any], None], message: Any, sender: Sender
    ) -> None:
        """Take a message, in any thread."""
        if sender.latched and topic in GOALS and self._clock() - self._began < SETTLED:
            self._middleware.warn(
                f"a goal of {sender.node} is ignored: it is latched, and may be older than this"
                " node; send it again"
            )
            return
        hand_over(self._loop, take, message)

    def _take_start(self, message: Any) -> None:
        refused, map_frame = "", self._options.map_frame
        try:
            start: SentStart = INITIAL_POSE.content(message)
        except CommandError as error:
            refused = str(error)
        else:
            if start.frame != map_frame:
                refused = f"it is in the frame {start.frame}, not in {map_frame}"
        if refused:
            self._middleware.warn(f"initialpose is ignored: {refused}")
            return
        if start.spread or start.turn_spread:
            self.navigator.place(start.pose, start.spread, start.turn_spread)
        else:
            self.navigator.place(start.pose)

    def _take_action_goal(self, message: Any) -> None:
        where = self._place_in(ACTION_GOAL, message)
        self._goals.take(where, str(message.goal_id.id), message.goal_id.stamp)

    def _take_name(self, message: Any) -> None:
        from pioneer3.nav.places import find_place

        name = GOAL_NAME.content(message)
        self._goals.take(lambda: find_place(self.navigator.line_map, name))

    def _place_in(self, topic: Topic, message: Any) -> "Callable[[], Destination]":
        """Return a function that returns the place of a goal, and raises if it is wrong."""
        return lambda: self._place_of(topic.content(message))

    def _place_of(self, goal: SentPose) -> "Destination":
        """Return the place of a goal on the map.

        Raises:
            CommandError: Nothing is known of its frame.
            MotionError: The robot does not know where it is, and the frame is not the map's.
        """
        from pioneer3.nav.places import Destination

        pose = self._in_map(goal.frame) @ goal.pose
        return Destination(x=pose.x, y=pose.y, heading=pose.theta)

    def _in_map(self, frame: str) -> Pose2:
        """Return the pose of a frame in the map."""
        frames, map_frame = self._frames, self._options.map_frame
        if frame == map_frame:
            return Pose2()
        if frame not in (frames.odom, frames.base, frames.root):
            raise CommandError(
                f"the goal is in the frame {frame}: give it in {map_frame}, {frames.odom} or"
                f" {frames.base}"
            )
        estimate, snapshot = self.navigator.estimate, self._robot.snapshot
        if not estimate.sure or estimate.odom_in_map is None or snapshot is None:
            raise MotionError(f"it is not sure where the robot is: {estimate.reason}")
        if frame == frames.odom:
            return estimate.odom_in_map
        return estimate.odom_in_map @ snapshot.odometry.robot_in_odom


def _sparse(way: "Way") -> tuple[tuple[float, float], ...]:
    """Return some of the points of a way [m], the last one among them."""
    points = [*way.points[:-1:SPARSE], way.points[-1]]
    return tuple((float(x), float(y)) for x, y in points)
