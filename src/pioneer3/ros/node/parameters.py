"""The parameters of a node: what each means, and what follows from their values."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf, pi, radians
from typing import Final

from pioneer3.geometry import Pose2
from pioneer3.models.description.tree import Frames
from pioneer3.nav.place_text import pose_of
from pioneer3.nav.settings import AS_SHIPPED, SETTINGS, NavigationSettings
from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.ros.messages.update import DRIVING, Beam, MessageOptions, NoEcho
from pioneer3.ros.node.driving_parameters import DrivingSettings
from pioneer3.ros.node.laser_parameters import BELOW, LaserParameters
from pioneer3.ros.node.names import SHAPE, Profile
from pioneer3.ros.node.parameter import (
    P2OS,
    ROS1,
    ROS2,
    Parameter,
    ParameterKind,
    Value,
    full_name,
    rows_of,
)

TOP_SPEED: Final = 10.0
"""No limit may be above it [m/s, rad/s]."""
LEAST_VARIANCE: Final = 1e-12
"""A variance is positive [m^2, rad^2]."""
MOST_VARIANCE: Final = 1e12
"""A variance is finite [m^2, rad^2]."""
FRAME: Final = ".*[^/].*"
"""A frame has a name; tf2 has none with a leading slash, which is left out."""
frame = partial(Parameter, pattern=FRAME, form="the name of a frame")
MODEL: Final = "robot_model"
"""Parameter that the node writes itself while it runs: the robot's model."""
SIMULATED: Final = "simulated"
"""Parameter that the node writes itself while it runs: whether the robot is a simulator."""
NAVIGATION: Final = tuple(
    Parameter(
        setting.meaning,
        name=setting.name,
        kind=ParameterKind.INTEGER if setting.is_whole else ParameterKind.DOUBLE,
        default=setting.default,
        low=setting.low,
        high=setting.high,
        unit=setting.unit,
    )
    for setting in SETTINGS.values()
)
"""Settings of navigation; their names have two parts: `~planner/margin`, `planner.margin`."""
BELOW_NAMES: Final = {BELOW, *(row.name.partition(".")[0] for row in NAVIGATION)}
"""Names that parameters lie below."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeParameters:
    """The parameters of a robot's node; :func:`read_parameters` reads and checks them.

    Those of `driving` may change while the node runs.
    """

    port: str = Parameter(
        "URL of the robot; `auto` looks for it, `host:8101` is TCP; `--port` comes first"
    ).field("auto")
    model: str = Parameter(
        "what the robot really is, such as `p3dx-sh`, or the path of a `.toml` or ARIA `.p`"
        " file; empty for what it says; `--model` comes first"
    ).field("")
    use_tcp: bool = Parameter(
        "whether the robot is at `tcp_remote_host` and `tcp_remote_port`; else it is at `port`",
        profiles=P2OS,
    ).field(False)
    tcp_remote_host: str = Parameter("of the robot, with `use_tcp`", profiles=P2OS).field(
        "localhost"
    )
    tcp_remote_port: int = Parameter(
        "of the robot, with `use_tcp`", low=1, high=65535, profiles=P2OS
    ).field(8101)
    baud: int | None = Parameter(
        "speed of the serial port to try first; `--baud` comes first",
        low=0,
        high=1_000_000,
        otherwise="any",
    ).field(None)
    profile: Profile = Parameter(  # noqa: RUF009 - it returns a field
        "which names count", choices=("compatibility", "standard", "both", "p2os"), profiles=ROS1
    ).field(Profile.COMPATIBILITY)
    lab_name: str = Parameter(
        "the robot's name in the lab, such as `p3at_1_113`; see above",
        pattern=f"({SHAPE.pattern})?",
        form="a name such as p3at_1_113",
        profiles=ROS1,
    ).field("")
    enable_stamped_cmd_vel: bool | None = Parameter(
        "`cmd_vel` is of TwistStamped, and `cmd_vel_unstamped` of Twist; else `cmd_vel` is"
        " of Twist, and `cmd_vel_stamped` of TwistStamped",
        otherwise="true since Kilted",
        profiles=ROS2,
    ).field(None)
    cmd_vel_timeout: float | None = Parameter(
        "silence after which the robot stops. **0 is unsafe**: it goes on as the last message"
        " said for as long as its publisher is there; 0.1 s is the shortest. The lab's"
        " `rob_key`, which sends one message for each key press, needs it",
        low=0.0,
        high=3600.0,
        unit="s",
        otherwise="0.5 s; 0.6 s in `compatibility`, `both` and `p2os`",
    ).field(None)
    resume_cmd_vel: bool = Parameter(
        "whether a stream that fell silent drives again when it has come steadily for 0.3 s;"
        " else it needs a zero or another direction"
    ).field(True)
    auto_enable_motors: bool = Parameter("whether a command brings the motors on").field(True)
    max_linear_velocity: float | None = Parameter(
        "greatest speed, never above the robot's own",
        low=0.001,
        high=TOP_SPEED,
        unit="m/s",
        otherwise="the robot's own",
        p2os="max_xspeed",
    ).field(None)
    max_angular_velocity: float | None = Parameter(
        "greatest turn rate, never above the robot's own",
        low=0.001,
        high=TOP_SPEED,
        unit="rad/s",
        otherwise="the robot's own",
        p2os="max_yawspeed",
    ).field(None)
    frame_prefix: str = Parameter(
        "before the name of every frame, such as `robot1/`; tf's `~tf_prefix` is `robot1`, in ROS 1"
        " also in a namespace above",
        aliases=("tf_prefix",),
    ).field("")
    odom_frame_id: str = frame("of odometry", rosaria="odom_frame").field(Frames().odom)
    base_frame_id: str = frame(
        "of the robot", rosaria="base_link_frame", p2os="base_link_frame_id"
    ).field(Frames().base)
    footprint_frame_id: str | None = frame(
        "of the robot, too: `odom` to this one to `base_frame_id`; empty for none",
        pattern=f"({FRAME})?",
        otherwise="`base_footprint`; none without `publish_description`, and none in"
        " `compatibility` and `p2os` with `publish_tf`, so that `/tf` is theirs",
    ).field(None)
    bumpers_frame: str | None = frame(
        "of bumpers", otherwise="`bumpers`; the robot's frame in `standard` and ROS 2"
    ).field(None)
    sonar_frame: str = frame("of the clouds of RosAria", profiles=ROS1).field(Frames().sonar)
    sonar_frame_prefix: str = frame("before the number in the frame of a transducer").field(
        Frames().sonar_prefix
    )
    laser_frame_id: str | None = frame(
        "of scans", otherwise="`laser`; `laser_frame` in `compatibility`"
    ).field(None)
    publish_aria_lasers: bool = Parameter(
        "whether lasers are on RosAria's topics, too, such as `~sim_lms2xx_1_laserscan`",
        profiles=frozenset({Profile.COMPATIBILITY, Profile.BOTH}),
    ).field(False)
    publish_tf: bool = Parameter(
        "`odom` to `base_footprint`, else to `base_link`, on `/tf`; false where a filter"
        " publishes it: robot_pose_ekf as it is, robot_localization with `base_link_frame:"
        " base_footprint`"
    ).field(True)
    publish_description: bool = Parameter(
        "`robot_description`, `/tf_static`, turning wheels on `/tf`"
    ).field(True)
    pose_covariance_diagonal: tuple[float, ...] = Parameter(
        "variances of x, y, z [m^2], roll, pitch, yaw [rad^2] while it moves; 1e-9 for what"
        " is measured while it stands",
        low=LEAST_VARIANCE,
        high=MOST_VARIANCE,
    ).field(DRIVING)
    twist_covariance_diagonal: tuple[float, ...] = Parameter(
        "the same of the velocities", low=LEAST_VARIANCE, high=MOST_VARIANCE
    ).field(DRIVING)
    use_sonar: bool = Parameter("whether the sonars ping").field(True)
    sonar_publish_ranges: bool = Parameter("whether each transducer has a topic").field(True)
    sonar_publish_cloud: bool = Parameter("whether all echoes have one").field(True)
    sonar_fov_rad: float = Parameter(
        "width of a Range's beam", low=0.01, high=pi, unit="rad"
    ).field(Beam().field_of_view)
    sonar_min_range_m: float = Parameter("shortest Range", low=0.0, high=SONAR_MAX, unit="m").field(
        Beam().nearest
    )
    sonar_max_range_m: float = Parameter("longest Range", low=0.1, high=SONAR_MAX, unit="m").field(
        Beam().farthest
    )
    sonar_no_echo: str = Parameter(
        "a Range when nothing was heard: costmaps throw `inf` away, which REP 117 wants",
        choices=tuple(NoEcho),
    ).field("max_range")
    sonar_z_offset_m: float | None = Parameter(
        "height of the sonars above the floor",
        low=-1.0,
        high=3.0,
        unit="m",
        otherwise="the model's",
    ).field(None)
    wheel_joint_names: tuple[str, ...] | None = Parameter(
        "left before right, front before rear",
        pattern=".+",
        otherwise="`[front_left_wheel_joint, ...]`",
    ).field(None)
    map: str = Parameter(
        "to navigate on: a file, or the name of a map that ships; `--map` comes first"
    ).field("")
    start: str = Parameter(
        "where the robot is on the map: a name, `x,y,heading` in metres and degrees, or"
        " `unknown`; `--start` comes first",
        otherwise="as it was last, or home",
    ).field("")
    goal_speed: float = Parameter(
        "on the way to goals at most", low=0.01, high=5.0, unit="m/s"
    ).field(0.3)
    global_frame_id: str = frame("of the map; without `frame_prefix`").field(
        MessageOptions().map_frame
    )
    transform_tolerance: float = Parameter(
        "so far into the future `map` to `odom` is stamped", low=0.0, high=10.0, unit="s"
    ).field(MessageOptions().tolerance)
    tf_broadcast: bool = Parameter("whether `/tf` has `map` to `odom`").field(True)
    camera_url: str = Parameter("MJPEG stream of a camera, after `--camera`").field("")
    camera_view_deg: float | None = Parameter(
        "its angle from left to right, if it does not tell that",
        low=0.0,
        high=179.0,
        unit="degrees",
        otherwise="not known",
    ).field(None)
    use_sim_time: bool = Parameter("whether stamps are those of `/clock`", profiles=ROS2).field(
        False
    )
    autostart: bool = Parameter(
        "whether the node configures and activates itself; else a lifecycle manager does",
        profiles=ROS2,
    ).field(True)
    driving: DrivingSettings = field(default_factory=DrivingSettings)
    laser: LaserParameters = field(default_factory=LaserParameters)
    navigation: NavigationSettings = AS_SHIPPED

    @property
    def url(self) -> str | None:
        """URL of the robot, which RosAria writes as `host:8101`; `None` to look for it."""
        if self.use_tcp:
            return f"tcp://{self.tcp_remote_host}:{self.tcp_remote_port}"
        if self.port in {"", "auto"}:
            return None
        return f"tcp://{self.port}" if re.fullmatch(r"[\w.-]+:\d+", self.port) else self.port

    @property
    def timeout(self) -> float:
        """Silence of cmd_vel after which the robot stops [s]; `inf` for never."""
        return self.cmd_vel_timeout or inf

    @property
    def initial_pose(self) -> Pose2 | str | None:
        """Where the robot is on the map: a pose, or a name; `None` for its last one, or home."""
        return pose_of(self.start, "start") if self.start else None

    @property
    def camera_view(self) -> float | None:
        """Field of view of the camera from left to right [rad]; `None` where it is not known."""
        return radians(self.camera_view_deg or 0.0) or None

    @property
    def frames(self) -> Frames:
        """Names of the frames, without the prefix."""
        return Frames(
            odom=self.odom_frame_id.lstrip("/"),
            base=self.base_frame_id.lstrip("/"),
            footprint=(self.footprint_frame_id or "").lstrip("/"),
            bumpers=(self.bumpers_frame or self.base_frame_id).lstrip("/"),
            sonar=self.sonar_frame.lstrip("/"),
            sonar_prefix=self.sonar_frame_prefix.lstrip("/"),
            laser=(self.laser_frame_id or Frames().laser).lstrip("/"),
        )

    @property
    def options(self) -> MessageOptions:
        """Options of messages."""
        described = self.publish_description
        return MessageOptions(
            frames=self.frames,
            prefix=self.frame_prefix.lstrip("/"),
            odometry_tf=self.publish_tf,
            ranges=self.sonar_publish_ranges,
            cloud=self.sonar_publish_cloud,
            description=described,
            wheels_tf=described and self.profile is not Profile.COMPATIBILITY,
            pose_variances=self.pose_covariance_diagonal,
            twist_variances=self.twist_covariance_diagonal,
            beam=Beam(
                field_of_view=self.sonar_fov_rad,
                nearest=self.sonar_min_range_m,
                farthest=self.sonar_max_range_m,
                no_echo=NoEcho(self.sonar_no_echo),
            ),
            sonar_height=self.sonar_z_offset_m,
            wheel_joints=self.wheel_joint_names or (),
            map_frame=self.global_frame_id.lstrip("/"),
            map_tf=self.tf_broadcast,
            tolerance=self.transform_tolerance,
        )

    @property
    def values(self) -> Mapping[Parameter, Value | None]:
        """The values in ROS 2 by parameters, but for those that act at once."""
        own = {row: getattr(self, row.name) for row in parameters_in(Profile.ROS2)}
        laser = {
            replace(row, name=full_name(row.name, Profile.ROS2, BELOW)): getattr(
                self.laser, row.name
            )
            for row in rows_of(LaserParameters)
        }
        return own | laser | {row: self.navigation.value(row.name) for row in NAVIGATION}


def parameters_in(profile: Profile) -> tuple[Parameter, ...]:
    """Return the robot's parameters that are known in `profile`, and read at the start."""
    return tuple(row for row in rows_of(NodeParameters) if profile in row.profiles)
