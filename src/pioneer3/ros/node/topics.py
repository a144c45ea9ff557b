"""The table of topics, from which a node publishes and subscribes and the docs are made."""

import re
from collections.abc import Mapping, Sequence
from typing import Final

from pioneer3.models import RobotModel
from pioneer3.models.lasers import LASERS, LaserProtocol
from pioneer3.ros.messages import motion, sensors
from pioneer3.ros.messages.diagnostics import DiagnosticsUpdate, diagnostics
from pioneer3.ros.messages.update import (
    DescriptionUpdate,
    MessageOptions,
    PictureUpdate,
    ScanUpdate,
    SensorUpdate,
)
from pioneer3.ros.node.names import CommandName, Profile, lab_commands
from pioneer3.ros.node.p2os_topics import P2OS_TOPICS
from pioneer3.ros.node.topic import Direction, Topic
from pioneer3.state import Charging

SLOWLY: Final = 1.0
"""Between two messages of a topic that hardly changes [s]; of diagnostics too (REP 107)."""
SNAPSHOTS: Final = 10.0
"""Snapshots that a robot sends in a second, unless it is told otherwise [Hz]."""
PINGS: Final = 3.0
"""Readings of one transducer [Hz]: the eight of an array take turns, 40 ms each."""


def transducer_topic(number: int) -> Topic:
    """Return the topic of one sonar transducer."""
    return Topic(
        standard=f"sonar/range_{number}",
        type_name="sensor_msgs/Range",
        fill=sensors.range_of(number),
        has_data=lambda update: number in update.snapshot.sonar.fresh,
        enabled=lambda options: options.ranges,
        rate=PINGS,
        optional="sonars",
        frame=lambda frames: frames.transducer(number),
        note=f"of one transducer, when it was read; its frame `sonar_{number}` looks along x",
    )


def laser_topic(name: str) -> Topic:
    """Return the topic of the laser of this name: `scan` of `laser`, `scan2` of `laser2`."""
    return Topic(
        compatibility=(topic := f"scan{name.removeprefix('laser')}"),
        standard=topic,
        type_name="sensor_msgs/LaserScan",
        source=ScanUpdate,
        sensor=name,
        fill=sensors.scan,
        optional="a laser range finder",
        frame=lambda frames: f"{frames.laser}{name.removeprefix('laser')}",
        note="without `--laser` that of simulators, and in `standard` only; `inf` without an echo"
        " (REP 117); of a second laser `scan2`",
    )


ARIA_SPELLINGS: Final = {"lms5xx": "lms5XX", "s3series": "S3Series"}
"""Names in ARIA of types of lasers that are not in lower case; those of files may be in either."""
ARIA_TYPES: Final = {
    LaserProtocol.LMS2XX: "lms2xx",
    LaserProtocol.COLA: "lms1xx",
    LaserProtocol.SCIP: "urg2.0",
}
"""Types of lasers in ARIA, by their languages; for those that the robot's model does not name."""


def aria_laser(
    number: int, kind: str, protocol: LaserProtocol | None = None, *, simulated: bool
) -> str:
    """Return the name of a laser in RosAria's topics, such as `sim_lms2xx_1`, without points.

    Numbers are from 1; `kind` is that of the first laser in the robot's model, empty for none. It
    is `simulated` if a simulator sends its scans in the robot's own stream.
    """
    spoken = {each.protocol for each in LASERS.values() if kind.lower() in each.kinds}
    if number > 1 or not kind or not (protocol is None or protocol in spoken):
        kind = ARIA_TYPES[protocol or LaserProtocol.LMS2XX]
    name = ARIA_SPELLINGS.get(kind.lower(), kind.lower())
    return re.sub(r"\W", "", f"{'sim_' if simulated else ''}{name}_{number}")


def aria_topics(name: str, aria: str) -> tuple[Topic, Topic]:
    """Return RosAria's topics of the laser of this name, which is `aria` in ARIA."""
    return (
        Topic(
            compatibility=f"~{aria}_laserscan",
            type_name="sensor_msgs/LaserScan",
            source=ScanUpdate,
            sensor=name,
            fill=sensors.scan,
            note="with `~publish_aria_lasers`: as on `scan`",
        ),
        Topic(
            compatibility=f"~{aria}_pointcloud",
            type_name="sensor_msgs/PointCloud",
            source=ScanUpdate,
            sensor=name,
            fill=sensors.scan_cloud,
            note="with `~publish_aria_lasers`: points of the last scan, in the frame of odometry",
        ),
    )


DIAGNOSTICS: Final = Topic(
    compatibility="/diagnostics",
    standard="/diagnostics",
    type_name="diagnostic_msgs/DiagnosticArray",
    source=DiagnosticsUpdate,
    fill=diagnostics,
    period=SLOWLY,
    note="link, motors, battery, sonar, odometry, command, and why it does not move",
)
COMMANDS: Final = Topic(
    compatibility="~cmd_vel",
    standard="cmd_vel",
    type_name="geometry_msgs/Twist",
    parse=motion.wanted_twist,
    note="numbers that are not finite are refused, and the log says so",
)
STAMPED_COMMANDS: Final = Topic(
    ros2="cmd_vel_stamped",
    type_name="geometry_msgs/TwistStamped",
    parse=lambda message: motion.wanted_twist(message.twist),
    optional="commands of both types",
    note="with `enable_stamped_cmd_vel`, as since Kilted, it is `cmd_vel`, and Twist is"
    " `cmd_vel_unstamped`; refused if older than `cmd_vel_timeout`; a stamp of 0 is now",
)
UNSTAMPED_NAME: Final = "cmd_vel_unstamped"
"""Name of the topic of Twist where `cmd_vel` is of TwistStamped."""
TOPICS: Final = (
    COMMANDS,
    STAMPED_COMMANDS,
    Topic(
        compatibility="~pose",
        standard="odom",
        p2os="pose",
        type_name="nav_msgs/Odometry",
        fill=motion.odometry,
        rate=SNAPSHOTS,
        frame=lambda frames: frames.odom,
        note="10 Hz; stamped when the snapshot arrived",
    ),
    Topic(
        compatibility="/tf",
        standard="/tf",
        ros2="tf",
        type_name="tf2_msgs/TFMessage",
        fill=motion.moving_transforms,
        has_data=lambda update: (
            update.options.odometry_tf or update.options.wheels_tf or bool(update.odom_in_map)
        ),
        enabled=lambda options: options.odometry_tf or options.wheels_tf or options.map_tf,
        rate=SNAPSHOTS,
        note="`odom` to `base_footprint`, in `compatibility` and `p2os` to `base_link`, same stamp"
        " as the pose; in `standard` the turning wheels too; with a map `map` to `odom`",
    ),
    Topic(
        compatibility="/tf_static",
        standard="/tf_static",
        ros2="tf_static",
        type_name="tf2_msgs/TFMessage",
        fill=motion.fixed_transforms,
        changes=lambda update: update.tree,
        latched=True,
        enabled=lambda options: options.description,
        note="where sonars, bumpers, laser and all else sit on the robot",
    ),
    Topic(
        ros2="robot_description",
        type_name="std_msgs/String",
        source=DescriptionUpdate,
        fill=motion.description,
        latched=True,
        enabled=lambda options: options.description,
        note="URDF of the robot that is connected",
    ),
    Topic(
        standard="joint_states",
        type_name="sensor_msgs/JointState",
        fill=motion.joint_states,
        rate=SNAPSHOTS,
        note="wheels, from odometry: Pioneers report no more by themselves",
    ),
    Topic(
        compatibility="~sonar",
        type_name="sensor_msgs/PointCloud",
        fill=sensors.sonar_cloud,
        note="a point of every transducer, at 5 m without an echo",
    ),
    Topic(
        compatibility="~sonar_pointcloud2",
        type_name="sensor_msgs/PointCloud2",
        fill=sensors.sonar_cloud2,
        note="the same",
    ),
    Topic(
        standard="sonar/points",
        type_name="sensor_msgs/PointCloud2",
        fill=sensors.echoes,
        has_data=lambda update: bool(update.snapshot.sonar.fresh),
        enabled=lambda options: options.cloud,
        rate=SNAPSHOTS,
        optional="sonars",
        frame=lambda frames: frames.base,
        note="echoes since the last snapshot, in `base_link`",
    ),
    Topic(
        compatibility="~bumper_state",
        type_name="rosaria/BumperState",
        fill=sensors.rosarias_bumpers,
        note="from left to right; five and five that nothing touches where the robot has none,"
        " as RosAria has it",
    ),
    Topic(
        standard="bumper_state",
        ros2=None,
        type_name="rosaria/BumperState",
        fill=sensors.bumpers,
        note="from left to right; empty where the robot has none",
    ),
    Topic(
        ros2="bumper_state",
        type_name="std_msgs/UInt8MultiArray",
        fill=sensors.bumper_array,
        rate=SNAPSHOTS,
        optional="bumpers",
        note="two rows, front and rear, from left to right; 1 for each pressed segment",
    ),
    Topic(
        standard="bumpers/points",
        type_name="sensor_msgs/PointCloud2",
        fill=sensors.touches,
        has_data=lambda update: bool(update.snapshot.bumpers.front or update.snapshot.bumpers.rear),
        optional="bumpers",
        frame=lambda frames: frames.base,
        note="a point for each pressed segment; only from robots with bumpers",
    ),
    Topic(
        compatibility="~battery_voltage",
        type_name="std_msgs/Float64",
        fill=sensors.voltage,
        note="[V]",
    ),
    Topic(
        compatibility="~battery_recharge_state",
        type_name="std_msgs/Int8",
        fill=sensors.recharge_state,
        changes=lambda update: update.snapshot.battery.charging,
        latched=True,
        when_lost=sensors.RECHARGE_STATES[Charging.UNKNOWN],
        note="-1 while it is not known",
    ),
    Topic(
        compatibility="~battery_state_of_charge",
        type_name="std_msgs/Float32",
        fill=sensors.charge,
        has_data=lambda update: update.snapshot.battery.charge is not None,
        note="0 to 1; only from robots that know it",
    ),
    Topic(
        standard="battery_state",
        p2os=None,
        type_name="sensor_msgs/BatteryState",
        fill=sensors.battery,
        changes=lambda update: (update.snapshot.battery.charge, update.snapshot.battery.charging),
        period=SLOWLY,
        has_data=lambda update: update.snapshot.battery.voltage > 0,  # 0 V comes while it boots
        note="NaN for all that the robot does not measure",
    ),
    Topic(
        compatibility="~motors_state",
        standard="motors_state",
        type_name="std_msgs/Bool",
        fill=sensors.motors,
        changes=lambda update: update.snapshot.motors.enabled,
        latched=True,
        when_lost=False,
        note="false while no robot is connected",
    ),
    Topic(
        standard="emergency_stop",
        type_name="std_msgs/Bool",
        fill=sensors.emergency_stop,
        changes=lambda update: update.stopped,
        period=0.0,
        latched=True,
        when_lost=True,  # a program that asks whether it is safe to drive must not hear yes
        rate=SNAPSHOTS,
        note="true while the latch or the robot's own button holds it, or no robot is connected:"
        " 10 Hz then, too",
    ),
    Topic(
        standard="imu/data_raw",
        type_name="sensor_msgs/Imu",
        source=SensorUpdate,
        sensor="gyro",
        fill=sensors.imu,
        optional="a gyro",
        frame=lambda frames: frames.imu,
        note="turn rate, where the robot sends its gyro's samples (GyroType 1)",
    ),
    Topic(
        standard="compass",
        type_name="std_msgs/Float32",
        fill=sensors.compass,
        has_data=lambda update: update.snapshot.inputs.compass is not None,
        optional="a compass",
        note="heading as the robot states it [rad]",
    ),
    Topic(
        standard="dio",
        p2os=None,
        type_name="std_msgs/UInt16",
        fill=sensors.digital,
        rate=SNAPSHOTS,
        optional="digital lines",
        note="inputs in the low byte, outputs in the high one",
    ),
    Topic(
        standard="aio",
        p2os=None,
        type_name="std_msgs/Float32MultiArray",
        fill=sensors.analog,
        rate=SNAPSHOTS,
        optional="an analog line",
        note="selected port and its voltage",
    ),
    Topic(
        compatibility="camera/image_raw",
        standard="camera/image_raw",
        type_name="sensor_msgs/Image",
        source=PictureUpdate,
        fill=sensors.image,
        optional="a camera",
        frame=lambda frames: frames.camera_optical,
        note="`rgb8`, with `--camera` or `~camera_url`; its frame is `camera_optical_frame`",
    ),
    Topic(
        compatibility="camera/camera_info",
        standard="camera/camera_info",
        type_name="sensor_msgs/CameraInfo",
        source=PictureUpdate,
        fill=sensors.camera_info,
        optional="a camera",
        frame=lambda frames: frames.camera_optical,
        note="matrices of 0 unless the camera tells its field of view, as"
        " simulated ones do, or `~camera_view_deg` does",
    ),
    DIAGNOSTICS,
    *P2OS_TOPICS,
)
"""All topics but those of single lasers and transducers, whose number depends on the robot."""


NOTHING: Final[Mapping[str, str]] = {}


def topics_of(model: RobotModel, lasers: Sequence[str] = ("laser",)) -> tuple[Topic, ...]:
    """Return the table for a robot of this kind, with its transducers and `lasers` by name."""
    transducers = (transducer_topic(number) for number in range(len(model.sonars)))
    return (*TOPICS, *map(laser_topic, lasers), *transducers)


def published(
    model: RobotModel,
    options: MessageOptions,
    profile: Profile,
    lasers: Sequence[str] = ("laser",),
    aria: Mapping[str, str] = NOTHING,
) -> list[Topic]:
    """Return the topics that a node with these options publishes.

    Lasers that are on RosAria's topics, too, have their names there in `aria`.
    """
    several = [topic for names in aria.items() for topic in aria_topics(*names)]
    return [
        topic
        for topic in (*topics_of(model, lasers), *several)
        if topic.direction is Direction.PUBLISHED
        and topic.names(profile)
        and topic.enabled(options)
    ]


def command_topics(
    profile: Profile, lab_name: str = "", *, stamped: bool = False
) -> tuple[CommandName, ...]:
    """Return the topics to take commands from; with `stamped` ROS 2's `cmd_vel` is TwistStamped."""
    (*first,) = COMMANDS.names(profile)
    (*other,) = STAMPED_COMMANDS.names(profile)
    if stamped:
        first, other = [UNSTAMPED_NAME], first
    own = (
        *(CommandName(name) for name in first),
        *(CommandName(name, stamped=True) for name in other),
    )
    if not lab_name or profile is Profile.ROS2:
        return own
    return (*lab_commands(lab_name), *own)
