"""The input of every conversion to ROS messages, and the options that shape the messages.

Conversions fill messages and do not make them, because each middleware has its own classes with the
same fields. They need no ROS. Distances [m] and angles [rad] are ROS's units too (REP 103).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, Final

from pioneer3.geometry import Pose2
from pioneer3.models import RobotModel
from pioneer3.models.description.tree import Frames, FrameTree, Quaternion
from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.robot.devices.pictures import Image
from pioneer3.state import Scan, Snapshot

UNMEASURED: Final = 1e6
"""Variance of z, roll and pitch, which a robot on wheels does not measure."""
DRIVING: Final = (1e-3, 1e-3, UNMEASURED, UNMEASURED, UNMEASURED, 0.03)
"""Variances x, y, z [m^2], roll, pitch, yaw [rad^2] while the wheels turn."""
STANDING: Final = (1e-9, 1e-9, UNMEASURED, UNMEASURED, UNMEASURED, 1e-9)
"""Covariance while the wheels stand still: nothing is added to the error."""


class NoEcho(StrEnum):
    """The range in a sensor_msgs/Range without an echo."""

    MAX_RANGE = "max_range"
    INF = "inf"


@dataclass(frozen=True, slots=True, kw_only=True)
class Beam:
    """The beam of a sonar transducer: the width of its cone [rad], shortest and longest range [m].

    `no_echo` is the range without an echo: ROS's range layers drop infinity, REP 117 wants it.
    """

    field_of_view: float = 0.5236
    nearest: float = 0.15
    farthest: float = SONAR_MAX
    no_echo: NoEcho = NoEcho.MAX_RANGE


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageOptions:
    """The options of messages that ROS leaves open.

    A prefix such as `robot1/` is before every name in `frames`, but not before that of the map,
    which robots may share. `/tf` has the robot's pose with `odometry_tf`, turning wheels with
    `wheels_tf`, else `/tf_static` has them, and the odom frame in the map with `map_tf`, stamped
    `tolerance` [s] into the future, as AMCL does: it holds until the next one. With `ranges` each
    transducer has a topic, with `cloud` all echoes have one; the height of the sonars [m] is `None`
    for the model's. With `description` the robot has `/tf_static` and `robot_description`.
    Variances are those while the wheels turn: x, y, z [m^2], roll, pitch, yaw [rad^2]. Wheel joints
    are left before right, front before rear; none for the default.
    """

    frames: Frames = field(default_factory=Frames)
    prefix: str = ""
    odometry_tf: bool = True
    ranges: bool = True
    cloud: bool = True
    description: bool = True
    wheels_tf: bool = False
    pose_variances: tuple[float, ...] = DRIVING
    twist_variances: tuple[float, ...] = DRIVING
    beam: Beam = field(default_factory=Beam)
    sonar_height: float | None = None
    wheel_joints: tuple[str, ...] = ()
    map_frame: str = "map"
    map_tf: bool = False
    tolerance: float = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class StateUpdate:
    """A new snapshot of the robot, and all that its conversion needs.

    Names in `frames` have the prefix, those in `tree` have none. Left wheels and right ones have
    `turned` so far [rad]; `emergency`: the stop is latched. The pose of the odom frame in the map
    comes with its stamp; `None` where it is not known, or not wanted. The snapshot arrived at
    `stamp`, as the middleware writes times, and `make` returns an empty message of the type named,
    such as `geometry_msgs/Point32`; so in all updates.
    """

    snapshot: Snapshot
    model: RobotModel
    tree: FrameTree
    frames: Frames
    options: MessageOptions
    turned: tuple[float, float] = (0.0, 0.0)
    emergency: bool = False
    odom_in_map: tuple[Any, Pose2] | None = None
    stamp: Any
    make: Callable[[str], Any]

    @property
    def moment(self) -> float:
        """When the snapshot arrived [s, monotonic]."""
        return self.snapshot.stamp

    @property
    def stopped(self) -> bool:
        """Whether the emergency stop is latched, or the robot's own button pressed."""
        return self.emergency or self.snapshot.motors.stop_button


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanUpdate:
    """A new scan of the laser range finder; `period` is the time since the last one [s], or 0.

    The frame of odometry is `odom`, with the prefix.
    """

    scan: Scan
    frame: str
    odom: str = Frames().odom
    stamp: Any
    period: float = 0.0
    make: Callable[[str], Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorUpdate:
    """A new reading of one of :attr:`Devices.sensors`."""

    reading: Any
    frames: Frames
    stamp: Any


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureUpdate:
    """A new picture of the camera, in a `frame` with z forward, x to the right and y down.

    `view` is the angle from its left edge to its right one [rad], `None` where nobody tells it.
    """

    image: Image
    view: float | None
    frame: str
    stamp: Any


@dataclass(frozen=True, slots=True, kw_only=True)
class DescriptionUpdate:
    """The description of the robot that is connected; `urdf` is XML."""

    urdf: str


def fill_header(message: Any, stamp: Any, frame: str) -> None:
    """Fill the std_msgs/Header of a message."""
    message.header.stamp, message.header.frame_id = stamp, frame


def resized(parts: Sequence[Any], count: int, kind: str, make: Callable[[str], Any]) -> list[Any]:
    """Return so many messages of a `kind`: the `parts` first, then empty ones."""
    return [*parts, *(make(kind) for _ in range(len(parts), count))][:count]


def fill_pose(position: Any, orientation: Any, pose: Pose2) -> None:
    """Fill a position and a quaternion, which are empty."""
    position.x, position.y = pose.x, pose.y
    turn = Quaternion.about_z(pose.theta)
    orientation.z, orientation.w = turn.z, turn.w


NANO: Final = 1_000_000_000
"""Nanoseconds of a second."""


def nanoseconds(stamp: Any) -> int:
    """Return a time [ns]: of builtin_interfaces (ROS 2: `sec`, `nanosec`) or genpy (ROS 1)."""
    if hasattr(stamp, "nanosec"):
        return int(stamp.sec) * NANO + int(stamp.nanosec)
    return int(stamp.to_nsec())
