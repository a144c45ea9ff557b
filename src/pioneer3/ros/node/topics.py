"""The table of topics, from which a node publishes and subscribes and the docs are made."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Final

from pioneer3.models import RobotModel
from pioneer3.ros.messages import camera, motion, sensors
from pioneer3.ros.messages.diagnostics import DiagnosticsUpdate, diagnostics
from pioneer3.ros.messages.goals import FeedbackUpdate, GoalsUpdate, ResultUpdate
from pioneer3.ros.messages.navigation import MapUpdate, NavigationUpdate
from pioneer3.ros.messages.update import (
    MessageOptions,
    PictureUpdate,
    ScanUpdate,
    SensorUpdate,
    StateUpdate,
)
from pioneer3.ros.node.names import CommandName, Profile, lab_commands
from pioneer3.state import Charging

SLOWLY: Final = 1.0
"""Between two messages of a topic that hardly changes [s]; of diagnostics too (REP 107)."""
Update = (
    StateUpdate
    | ScanUpdate
    | SensorUpdate
    | PictureUpdate
    | DiagnosticsUpdate
    | MapUpdate
    | NavigationUpdate
    | GoalsUpdate
    | FeedbackUpdate
    | ResultUpdate
)
"""Anything that topics are published from."""


class Direction(StrEnum):
    """Whether the node sends the messages of a topic or receives them."""

    PUBLISHED = "published"
    SUBSCRIBED = "subscribed"


@dataclass(frozen=True, slots=True, kw_only=True)
class Topic:
    """One row of the table: a topic that a node publishes or subscribes to.

    A topic that is not latched is published only while it has subscribers.

    Attributes:
        compatibility: Name in RosAria, `~` for below the node's own; `None` if it has none.
        standard: Name after the conventions of ROS packages, relative; `None` if it has none.
        type_name: Type of its messages.
        source: Kind of update that it is published from.
        sensor: Name of the sensor whose readings are published; empty for all other topics.
        fill: Puts such an update into an empty message; `None` for a topic that is subscribed to.
        parse: Returns the content of a message that is received, or raises a CommandError; `None`
            for a topic that is published.
        changes: Returns the content that matters, where a message is sent only when that is new;
            `None` for a topic that is sent with every update. Updates then have a `moment`.
        latched: Whether a late subscriber gets the last message.
        period: Longest pause between two messages [s]; `None` where only changes are sent.
        when_lost: Content of a latched topic while there is no robot; `None` if it stays true.
        has_data: Whether an update has data for it.
        enabled: Whether the options want it.
        note: For the docs.
    """

    compatibility: str | None = None
    standard: str | None = None
    type_name: str
    source: type[Update] = StateUpdate
    sensor: str = ""
    fill: Callable[[Any, Any], None] | None = None
    parse: Callable[[Any], Any] | None = None
    changes: Callable[[Any], object] | None = None
    latched: bool = False
    period: float | None = None
    when_lost: object = None
    has_data: Callable[[Any], bool] = lambda update: True
    enabled: Callable[[MessageOptions], bool] = lambda options: True
    note: str = ""

    @property
    def direction(self) -> Direction:
        """Whether the node publishes it or subscribes to it."""
        return Direction.PUBLISHED if self.fill else Direction.SUBSCRIBED

    def names(self, profile: Profile) -> tuple[str, ...]:
        """Return its names in `profile`."""
        return profile.choose(self.compatibility, self.standard)


def transducer_topic(number: int) -> Topic:
    """Return the topic of one sonar transducer."""
    return Topic(
        standard=f"sonar/range_{number}",
        type_name="sensor_msgs/Range",
        fill=sensors.range_of(number),
        has_data=lambda update: number in update.snapshot.sonar.fresh,
        enabled=lambda options: options.ranges,
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
        note="without `--laser` that of simulators, and in `standard` only; `inf` without an echo"
        " (REP 117); of a second laser `scan2`",
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
TOPICS: Final = (
    COMMANDS,
    Topic(
        compatibility="~pose",
        standard="odom",
        type_name="nav_msgs/Odometry",
        fill=motion.odometry,
        note="10 Hz; stamped when the snapshot arrived",
    ),
    Topic(
        compatibility="/tf",
        standard="/tf",
        type_name="tf2_msgs/TFMessage",
        fill=motion.moving_transforms,
        has_data=lambda update: (
            update.options.odometry_tf or update.options.wheels_tf or bool(update.odom_in_map)
        ),
        enabled=lambda options: options.odometry_tf or options.wheels_tf or options.map_tf,
        note="`odom` to `base_link`, same stamp as the pose; in `standard` the turning wheels too;"
        " with a map `map` to `odom`",
    ),
    Topic(
        compatibility="/tf_static",
        standard="/tf_static",
        type_name="tf2_msgs/TFMessage",
        fill=motion.fixed_transforms,
        changes=lambda update: update.tree,
        latched=True,
        enabled=lambda options: options.description,
        note="where sonars, bumpers, laser and all else sit on the robot",
    ),
    Topic(
        standard="joint_states",
        type_name="sensor_msgs/JointState",
        fill=motion.joint_states,
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
        type_name="rosaria/BumperState",
        fill=sensors.bumpers,
        note="from left to right; empty where the robot has none",
    ),
    Topic(
        standard="bumpers/points",
        type_name="sensor_msgs/PointCloud2",
        fill=sensors.touches,
        has_data=lambda update: bool(update.snapshot.bumpers.front or update.snapshot.bumpers.rear),
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
        latched=True,
        when_lost=True,  # a program that asks whether it is safe to drive must not hear yes
        note="true while the latch or the robot's own button holds it, or no robot is connected",
    ),
    Topic(
        standard="imu/data_raw",
        type_name="sensor_msgs/Imu",
        source=SensorUpdate,
        sensor="gyro",
        fill=sensors.imu,
        note="turn rate, where the robot sends its gyro's samples (GyroType 1)",
    ),
    Topic(
        standard="compass",
        type_name="std_msgs/Float32",
        fill=sensors.compass,
        has_data=lambda update: update.snapshot.inputs.compass is not None,
        note="heading as the robot states it [rad]",
    ),
    Topic(
        standard="dio",
        type_name="std_msgs/UInt16",
        fill=sensors.digital,
        note="inputs in the low byte, outputs in the high one",
    ),
    Topic(
        standard="aio",
        type_name="std_msgs/Float32MultiArray",
        fill=sensors.analog,
        note="selected port and its voltage",
    ),
    Topic(
        compatibility="camera/image_raw",
        standard="camera/image_raw",
        type_name="sensor_msgs/Image",
        source=PictureUpdate,
        fill=camera.image,
        note="`rgb8`, with `--camera` or `~camera_url`; its frame is `camera_optical_frame`",
    ),
    Topic(
        compatibility="camera/camera_info",
        standard="camera/camera_info",
        type_name="sensor_msgs/CameraInfo",
        source=PictureUpdate,
        fill=camera.camera_info,
        note="matrices of 0 unless the camera tells its field of view, as"
        " simulated ones do, or `~camera_view_deg` does",
    ),
    DIAGNOSTICS,
)
"""All topics but those of single lasers and transducers, whose number depends on the robot."""


def topics_of(model: RobotModel, lasers: Sequence[str] = ("laser",)) -> tuple[Topic, ...]:
    """Return the table for a robot of this kind, with its transducers and `lasers` by name."""
    transducers = (transducer_topic(number) for number in range(len(model.sonars)))
    return (*TOPICS, *map(laser_topic, lasers), *transducers)


def published(
    model: RobotModel,
    options: MessageOptions,
    profile: Profile,
    lasers: Sequence[str] = ("laser",),
) -> list[Topic]:
    """Return the topics that a node with these options publishes."""
    return [
        topic
        for topic in topics_of(model, lasers)
        if topic.direction is Direction.PUBLISHED
        and topic.names(profile)
        and topic.enabled(options)
    ]


def command_topics(profile: Profile, lab_name: str | None = None) -> tuple[CommandName, ...]:
    """Return the topics to take commands from."""
    own = tuple(CommandName(name) for name in COMMANDS.names(profile))
    return own if lab_name is None else (*lab_commands(lab_name), *own)
