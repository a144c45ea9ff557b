"""Maps, the place on them, ways and goals to ROS messages; starts and goals from them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import atan2, hypot, isfinite, sqrt
from typing import TYPE_CHECKING, Any, Final

from pioneer3.errors import CommandError
from pioneer3.geometry import Pose2
from pioneer3.ros.messages.diagnostics import DiagnosticLevel, DiagnosticStatus
from pioneer3.ros.messages.update import fill_header, fill_pose

if TYPE_CHECKING:
    from pioneer3.maps.line_map import OccupancyGrid
    from pioneer3.nav.estimate import Estimate
    from pioneer3.navigation.navigator import NavigatorState

PLANE: Final = (0, 1, 5)
"""Rows of x, y and yaw in a covariance of six."""
NO_ROTATION: Final = 1e-6
"""A quaternion whose square is less turns nothing, as in move_base."""
UPRIGHT: Final = 1e-3
"""The z axis of a goal may be off by so much [1 - cosine], as in move_base."""
FARTHEST: Final = 1e5
"""Farthest place from the origin [m]."""
WIDEST: Final = 100.0
"""Standard deviation of a start [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MapUpdate:
    """The map in its frame, when a node begins."""

    grid: "OccupancyGrid"
    frame: str
    stamp: Any


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class NavigationUpdate:
    """Where the robot is on the map and goes, at one snapshot.

    Its most likely pose, and that of odometry's frame, which each update of the filter changes, may
    be acted upon if it is `sure`; the covariance is of x, y and heading [m, rad], shape (3, 3).
    Without a goal its `way` has no points [m]; a goal may have a `heading` [rad]. The snapshot was
    taken at the moment [s, monotonic], the same as the middleware writes times.
    """

    robot_in_map: Pose2
    odom_in_map: Pose2
    covariance: Any
    sure: bool
    way: tuple[tuple[float, float], ...]
    heading: float | None
    frame: str
    moment: float
    stamp: Any
    make: Callable[[str], Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanUpdate:
    """A way that somebody asked for, as in a NavigationUpdate; no points if there is none."""

    way: tuple[tuple[float, float], ...]
    heading: float | None
    frame: str
    stamp: Any
    make: Callable[[str], Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class SentPose:
    """A pose [m, rad] that somebody has sent, in a frame, whose name has no leading slash."""

    frame: str
    pose: Pose2


@dataclass(frozen=True, slots=True, kw_only=True)
class SentStart(SentPose):
    """A start that somebody has sent, with the standard deviations of its place and its heading.

    `spread` is in each direction [m], 0 where it is not told, and `turn_spread` [rad] likewise.
    """

    spread: float
    turn_spread: float


def occupancy_grid(message: Any, update: MapUpdate) -> None:
    """Fill a nav_msgs/OccupancyGrid: 0 is free, 100 occupied, -1 unknown."""
    import numpy as np  # nodes without a map stay small

    from pioneer3.maps.line_map import FREE, OCCUPIED

    fill_header(message, update.stamp, update.frame)
    map_metadata(message.info, update)
    states = update.grid.states
    cells = np.full(states.shape, -1, dtype=np.int8)
    cells[states == FREE], cells[states == OCCUPIED] = 0, 100
    message.data = cells.ravel().tolist()


def map_metadata(message: Any, update: MapUpdate) -> None:
    """Fill a nav_msgs/MapMetaData."""
    message.map_load_time = update.stamp
    message.resolution = update.grid.resolution
    message.height, message.width = update.grid.states.shape
    fill_pose(message.origin.position, message.origin.orientation, update.grid.origin)


def place(message: Any, update: NavigationUpdate) -> None:
    """Fill a geometry_msgs/PoseWithCovarianceStamped."""
    fill_header(message, update.stamp, update.frame)
    pose = message.pose.pose
    fill_pose(pose.position, pose.orientation, update.robot_in_map)
    matrix = [0.0] * 36
    for i, row in enumerate(PLANE):
        for j, column in enumerate(PLANE):
            matrix[6 * row + column] = float(update.covariance[i][j])
    message.pose.covariance = matrix


def way(message: Any, update: "NavigationUpdate | PlanUpdate") -> None:
    """Fill a nav_msgs/Path; each pose looks along the way, the last one as the goal."""
    fill_header(message, update.stamp, update.frame)
    message.poses = []
    for pose in _headed(update.way, update.heading):
        stamped = update.make("geometry_msgs/PoseStamped")
        fill_header(stamped, update.stamp, update.frame)
        fill_pose(stamped.pose.position, stamped.pose.orientation, pose)
        message.poses.append(stamped)


def goal(message: Any, update: NavigationUpdate) -> None:
    """Fill a geometry_msgs/PoseStamped with the goal."""
    fill_header(message, update.stamp, update.frame)
    fill_pose(
        message.pose.position, message.pose.orientation, _headed(update.way, update.heading)[-1]
    )


def placed(message: Any) -> SentPose:
    """Return the pose of a geometry_msgs/PoseStamped; CommandError if it has no frame, or tilts."""
    return SentPose(frame=_frame(message), pose=flat_pose(message.pose))


def plan_request(message: Any) -> tuple[SentPose | None, SentPose]:
    """Return start and goal of a nav_msgs/GetPlan; CommandError as of :func:`placed`.

    As in move_base, a start without a frame, here `None`, is where the robot is.
    """
    known = str(message.start.header.frame_id).lstrip("/")
    return (placed(message.start) if known else None), placed(message.goal)


def start(message: Any) -> SentStart:
    """Return the start of a geometry_msgs/PoseWithCovarianceStamped.

    Raises:
        CommandError: It is none in the plane, or has no frame or a wrong covariance.
    """
    variances = [float(message.pose.covariance[index]) for index in (0, 7, 35)]
    if not all(0 <= variance < WIDEST**2 for variance in variances):
        raise CommandError(f"the covariance has {variances} on its diagonal")
    x, y, heading = variances
    return SentStart(
        frame=_frame(message),
        pose=flat_pose(message.pose.pose),
        spread=sqrt(max(x, y)),
        turn_spread=sqrt(heading),
    )


def flat_pose(pose: Any) -> Pose2:
    """Return a geometry_msgs/Pose as one on the floor; its height does not count.

    Raises:
        CommandError: A number is not finite, the quaternion is no rotation or tilts.
    """
    at, turned = pose.position, pose.orientation
    x, y = float(at.x), float(at.y)
    if not (abs(x) < FARTHEST and abs(y) < FARTHEST):
        raise CommandError(f"there is no place ({x:g}, {y:g})")
    qx, qy, qz, qw = (float(each) for each in (turned.x, turned.y, turned.z, turned.w))
    squared = qx * qx + qy * qy + qz * qz + qw * qw
    numbers = ", ".join(f"{number:g}" for number in (qx, qy, qz, qw))
    if not isfinite(squared) or squared < NO_ROTATION:
        raise CommandError(f"the orientation {numbers} is no rotation: w: 1.0 looks along x")
    if 2 * (qx * qx + qy * qy) > UPRIGHT * squared:
        raise CommandError(f"the orientation {numbers} tilts: robots turn about z only")
    return Pose2(x, y, atan2(2 * (qw * qz + qx * qy), squared - 2 * (qy * qy + qz * qz)))


def _frame(message: Any) -> str:
    frame = str(message.header.frame_id).lstrip("/")
    if not frame:
        raise CommandError("the header names no frame: frame_id: map")
    return frame


def _headed(points: Sequence[tuple[float, float]], heading: float | None) -> list[Pose2]:
    """Return poses that look along the way; a robot that may end as it likes ends along it."""
    if len(points) < 2:
        return [Pose2(*point, heading or 0.0) for point in points]
    poses: list[Pose2] = []
    for (x, y), (ahead_x, ahead_y) in pairwise(points):
        dx, dy = ahead_x - x, ahead_y - y
        along = atan2(dy, dx) if hypot(dx, dy) or not poses else poses[-1].theta
        poses.append(Pose2(x, y, along))
    poses.append(Pose2(*points[-1], poses[-1].theta if heading is None else heading))
    return poses


def navigation_status(
    map_name: str, estimate: "Estimate", state: "NavigatorState | None"
) -> tuple[DiagnosticStatus, DiagnosticStatus]:
    """Return the states of localization and of navigation; before the first, `state` is `None`."""
    return _localization(map_name, estimate), _goal(state)


def _localization(map_name: str, estimate: "Estimate") -> DiagnosticStatus:
    pose, deviation = estimate.robot_in_map, estimate.deviation
    known = pose if estimate.stage != "lost" else None
    values = (
        ("map", map_name),
        ("sure", "yes" if estimate.sure else "no"),
        ("stage", estimate.stage),
        ("agreement", f"{estimate.agreement:.2f}"),
        ("deviation", f"{deviation:.3f}" if isfinite(deviation) else ""),
        ("x", f"{known.x:.3f}" if known else ""),
        ("y", f"{known.y:.3f}" if known else ""),
        ("heading", f"{known.theta:.3f}" if known else ""),
    )
    if estimate.sure and estimate.remark:
        return DiagnosticStatus("Localization", DiagnosticLevel.WARN, estimate.remark, values)
    if estimate.sure:
        return DiagnosticStatus("Localization", DiagnosticLevel.OK, estimate.reason, values)
    message = f"not sure: {estimate.reason}"
    return DiagnosticStatus("Localization", DiagnosticLevel.WARN, message, values)


def _goal(state: "NavigatorState | None") -> DiagnosticStatus:
    goal, problem, left = state and state.goal, state.problem if state else "", ""
    if state is not None and state.way is not None and state.estimate.robot_in_map is not None:
        here = state.estimate.robot_in_map
        left = f"{state.way.rest_from(here.x, here.y).length:.1f}"
    message = f"on the way to {goal}" if goal else "no goal"
    values = (("goal", str(goal or "")), ("left", left), ("problem", problem))
    if problem:
        message = f"{message}: {problem}"
        return DiagnosticStatus("Navigation", DiagnosticLevel.WARN, message, values)
    return DiagnosticStatus("Navigation", DiagnosticLevel.OK, message, values)
