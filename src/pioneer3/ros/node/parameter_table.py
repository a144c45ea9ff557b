"""The table of a node's own parameters, from which they are checked, described and documented."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import pi
from typing import Final

from pioneer3.models.description.tree import Frames
from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.ros.messages.update import DRIVING, Beam, MessageOptions
from pioneer3.ros.node.laser_parameters import BELOW
from pioneer3.ros.node.names import Profile

ROS1: Final = frozenset({Profile.COMPATIBILITY, Profile.STANDARD, Profile.BOTH})
ROS2: Final = frozenset({Profile.ROS2})
EVERYWHERE: Final = ROS1 | ROS2
SHORTEST: Final = 0.1
"""No publisher keeps pace with a shorter timeout [s]."""
LONGEST: Final = 3600.0
GOAL_SPEED: Final = 0.3
"""On the way to goals [m/s], as on the page and in the API."""
TOP_SPEED: Final = 10.0
"""No limit may be above it [m/s, rad/s]."""


class ParameterKind(StrEnum):
    """Kinds of values; the names are those of ROS 2."""

    BOOL = "bool"
    INTEGER = "integer"
    DOUBLE = "double"
    STRING = "string"
    DOUBLES = "double_array"
    STRINGS = "string_array"


Value = bool | int | float | str | tuple[float, ...] | tuple[str, ...] | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """A parameter of the node.

    Attributes:
        name: Without `~`.
        kind: Of its values.
        default: Its value unless given; `None` where the robot, the model or a search tells.
        low: Least number.
        high: Greatest number.
        choices: All values that it may have, if they can be listed.
        otherwise: The default in words, where it is not `default`.
        note: Its meaning, for people, with its unit.
        profiles: Where it is known.
    """

    name: str
    kind: ParameterKind
    default: Value = None
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()
    otherwise: str = ""
    note: str
    profiles: frozenset[Profile] = EVERYWHERE


BOOL, INTEGER, DOUBLE, STRING, DOUBLES, STRINGS = ParameterKind
PARAMETERS: Final = (
    Parameter(
        name="port",
        kind=STRING,
        default="auto",
        note="URL of the robot; `auto` looks for it, `host:8101` is TCP; `--port` comes first",
    ),
    Parameter(
        name="model",
        kind=STRING,
        default="",
        note="what the robot really is, such as `p3dx-sh`, or the path of a `.toml` or ARIA `.p`"
        " file; empty for what it says; `--model` comes first",
    ),
    Parameter(
        name="baud",
        kind=INTEGER,
        low=0,
        high=1_000_000,
        otherwise="any",
        note="speed of the serial port to try first; `--baud` comes first",
    ),
    Parameter(
        name="profile",
        kind=STRING,
        default="compatibility",
        choices=("compatibility", "standard", "both"),
        profiles=ROS1,
        note="which names count",
    ),
    Parameter(
        name="lab_name",
        kind=STRING,
        default="",
        profiles=ROS1,
        note="the robot's name in the lab, such as `p3at_1_113`; see above",
    ),
    Parameter(
        name="enable_stamped_cmd_vel",
        kind=BOOL,
        otherwise="true since Kilted",
        profiles=ROS2,
        note="`cmd_vel` is of TwistStamped, and `cmd_vel_unstamped` of Twist; else `cmd_vel` is"
        " of Twist, and `cmd_vel_stamped` of TwistStamped",
    ),
    Parameter(
        name="cmd_vel_timeout",
        kind=DOUBLE,
        low=0.0,
        high=LONGEST,
        otherwise="0.5 s; 0.6 s in `compatibility` and `both`",
        note="silence after which the robot stops [s]. **0 is unsafe**: it goes on as the last"
        " message said for as long as its publisher is there; 0.1 s is the shortest. The lab's"
        " `rob_key`, which sends one message for each key press, needs it",
    ),
    Parameter(
        name="resume_cmd_vel",
        kind=BOOL,
        default=True,
        note="whether a stream that fell silent drives again when it has come steadily for 0.3 s;"
        " else it needs a zero or another direction",
    ),
    Parameter(
        name="auto_enable_motors",
        kind=BOOL,
        default=True,
        note="whether a command brings the motors on",
    ),
    Parameter(
        name="max_linear_velocity",
        kind=DOUBLE,
        low=0.001,
        high=TOP_SPEED,
        otherwise="the robot's own",
        note="[m/s], never above the robot's own",
    ),
    Parameter(
        name="max_angular_velocity",
        kind=DOUBLE,
        low=0.001,
        high=TOP_SPEED,
        otherwise="the robot's own",
        note="[rad/s], never above the robot's own",
    ),
    Parameter(
        name="frame_prefix",
        kind=STRING,
        default="",
        note="before the name of every frame, such as `robot1/`",
    ),
    Parameter(
        name="odom_frame_id",
        kind=STRING,
        default=Frames().odom,
        note="of odometry; `odom_frame` in `compatibility`",
    ),
    Parameter(
        name="base_frame_id",
        kind=STRING,
        default=Frames().base,
        note="of the robot; `base_link_frame` in `compatibility`",
    ),
    Parameter(
        name="footprint_frame_id",
        kind=STRING,
        otherwise="`base_footprint`; none without `publish_description`, and none in"
        " `compatibility` with `publish_tf`, so that `/tf` is RosAria's",
        note="of the robot, too: `odom` to this one to `base_frame_id`; empty for none",
    ),
    Parameter(
        name="bumpers_frame",
        kind=STRING,
        otherwise="`bumpers`; the robot's frame in `standard` and ROS 2",
        note="of bumpers",
    ),
    Parameter(
        name="sonar_frame",
        kind=STRING,
        default=Frames().sonar,
        profiles=ROS1,
        note="of the clouds of RosAria",
    ),
    Parameter(
        name="sonar_frame_prefix",
        kind=STRING,
        default=Frames().sonar_prefix,
        note="before the number in the frame of a transducer",
    ),
    Parameter(
        name="laser_frame_id",
        kind=STRING,
        otherwise="`laser`; `laser_frame` in `compatibility`",
        note="of scans",
    ),
    Parameter(
        name="publish_tf",
        kind=BOOL,
        default=True,
        note="`odom` to `base_footprint`, else to `base_link`, on `/tf`; false where a filter"
        " publishes it: robot_pose_ekf as it is, robot_localization with `base_link_frame:"
        " base_footprint`",
    ),
    Parameter(
        name="publish_description",
        kind=BOOL,
        default=True,
        note="`robot_description`, `/tf_static`, turning wheels on `/tf`",
    ),
    Parameter(
        name="pose_covariance_diagonal",
        kind=DOUBLES,
        default=DRIVING,
        note="variances of x, y, z [m^2], roll, pitch, yaw [rad^2] while it moves; 1e-9 for what"
        " is measured while it stands",
    ),
    Parameter(
        name="twist_covariance_diagonal",
        kind=DOUBLES,
        default=DRIVING,
        note="the same of the velocities",
    ),
    Parameter(name="use_sonar", kind=BOOL, default=True, note="whether the sonars ping"),
    Parameter(
        name="sonar_publish_ranges",
        kind=BOOL,
        default=True,
        note="whether each transducer has a topic",
    ),
    Parameter(
        name="sonar_publish_cloud", kind=BOOL, default=True, note="whether all echoes have one"
    ),
    Parameter(
        name="sonar_fov_rad",
        kind=DOUBLE,
        default=Beam().field_of_view,
        low=0.01,
        high=pi,
        note="width of a Range's beam [rad]",
    ),
    Parameter(
        name="sonar_min_range_m",
        kind=DOUBLE,
        default=Beam().nearest,
        low=0.0,
        high=SONAR_MAX,
        note="shortest Range [m]",
    ),
    Parameter(
        name="sonar_max_range_m",
        kind=DOUBLE,
        default=Beam().farthest,
        low=0.1,
        high=SONAR_MAX,
        note="longest Range [m]",
    ),
    Parameter(
        name="sonar_no_echo",
        kind=STRING,
        default="max_range",
        choices=("max_range", "inf"),
        note="a Range when nothing was heard: costmaps throw `inf` away, which REP 117 wants",
    ),
    Parameter(
        name="sonar_z_offset_m",
        kind=DOUBLE,
        low=-1.0,
        high=3.0,
        otherwise="the model's",
        note="height of the sonars above the floor [m]",
    ),
    Parameter(
        name="wheel_joint_names",
        kind=STRINGS,
        otherwise="`[front_left_wheel_joint, ...]`",
        note="left before right, front before rear",
    ),
    Parameter(
        name="map",
        kind=STRING,
        default="",
        note="to navigate on: a file, or the name of a map that ships; `--map` comes first",
    ),
    Parameter(
        name="start",
        kind=STRING,
        default="",
        otherwise="the map's home",
        note="where the robot is on the map: a name, `x,y,heading` in metres and degrees, or"
        " `unknown`; `--start` comes first",
    ),
    Parameter(
        name="goal_speed",
        kind=DOUBLE,
        default=GOAL_SPEED,
        low=0.01,
        high=5.0,
        note="on the way to goals at most [m/s]",
    ),
    Parameter(
        name="global_frame_id",
        kind=STRING,
        default=MessageOptions().map_frame,
        note="of the map; without `frame_prefix`",
    ),
    Parameter(
        name="transform_tolerance",
        kind=DOUBLE,
        default=MessageOptions().tolerance,
        low=0.0,
        high=10.0,
        note="so far into the future `map` to `odom` is stamped [s]",
    ),
    Parameter(
        name="tf_broadcast", kind=BOOL, default=True, note="whether `/tf` has `map` to `odom`"
    ),
    Parameter(
        name="camera_url",
        kind=STRING,
        default="",
        note="MJPEG stream of a camera, after `--camera`",
    ),
    Parameter(
        name="camera_view_deg",
        kind=DOUBLE,
        low=0.0,
        high=179.0,
        otherwise="not known",
        note="its angle from left to right [degrees], if it does not tell that",
    ),
    Parameter(
        name="use_sim_time",
        kind=BOOL,
        default=False,
        profiles=ROS2,
        note="whether stamps are those of `/clock`",
    ),
    Parameter(
        name="autostart",
        kind=BOOL,
        default=True,
        profiles=ROS2,
        note="whether the node configures and activates itself; else a lifecycle manager does",
    ),
)
"""All but those of lasers, which are below `laser`, and of driving, which change at run time."""
BY_NAME: Final[Mapping[str, Parameter]] = {each.name: each for each in PARAMETERS}


def parameters_in(profile: Profile) -> tuple[Parameter, ...]:
    """Return the parameters that are known in `profile`."""
    return tuple(each for each in PARAMETERS if profile in each.profiles)


def names_in(profile: Profile) -> frozenset[str]:
    """Return their names, with that below which a laser has its own."""
    return frozenset({*(each.name for each in parameters_in(profile)), BELOW})
