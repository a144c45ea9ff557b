"""The one table of topics: their names in both profiles, types, and what fills them."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Final

from pioneer3.models import RobotModel
from pioneer3.ros.interface.lab import CommandTopic, lab_commands
from pioneer3.ros.messages import clouds, convert, joints, ranges, transforms
from pioneer3.ros.messages.conventions import Conventions
from pioneer3.ros.messages.convert import RECHARGE_STATES, Reading
from pioneer3.state import Charging

SLOWLY: Final = 1.0
"""Between two messages of what hardly changes [s]."""


class Profile(StrEnum):
    """Which names are used: those of RosAria, those of today's ROS packages, or both at once."""

    COMPATIBILITY = "compatibility"
    STANDARD = "standard"
    BOTH = "both"


@dataclass(frozen=True, slots=True, kw_only=True)
class Topic:
    """Something a node publishes.

    Attributes:
        compatibility: Name in RosAria, `~` for below the node's own; `None` if it has none.
        standard: Name after the conventions of ROS packages, relative; `None` if it has none.
        kind: Message type.
        fill: Puts a reading into an empty message.
        told: What the message depends on, where it is sent when that changes; `None` for what is
            sent with every reading.
        latched: Whether who subscribes late gets the last message.
        period: Longest pause between two messages [s]; `None` where only changes are sent.
        unknown: What a latched one says while there is no robot; `None` if it stays true.
        known: Whether a reading tells anything about it.
        wanted: Whether it is published at all.
    """

    compatibility: str | None = None
    standard: str | None = None
    kind: str
    fill: Callable[[Any, Reading], None]
    told: Callable[[Reading], object] | None = None
    latched: bool = False
    period: float | None = None
    unknown: object = None
    known: Callable[[Reading], bool] = lambda reading: True
    wanted: Callable[[Conventions], bool] = lambda conventions: True

    def names(self, profile: Profile) -> tuple[str, ...]:
        """Return its names in `profile`."""
        by_profile = {
            Profile.COMPATIBILITY: [self.compatibility],
            Profile.STANDARD: [self.standard],
            Profile.BOTH: [self.compatibility, self.standard],
        }
        return tuple(dict.fromkeys(name for name in by_profile[profile] if name is not None))


def _tells_of_transducer(number: int) -> Callable[[Reading], bool]:
    return lambda reading: number in reading.snapshot.sonar.fresh


def topics_of(model: RobotModel) -> tuple[Topic, ...]:
    """Return the table for a robot of this kind: a Range of each of its transducers is in it."""
    return (
        *TOPICS,
        *(
            Topic(
                standard=f"sonar/range_{number}",
                kind="sensor_msgs/Range",
                fill=ranges.range_of(number),
                known=_tells_of_transducer(number),
            )
            for number in range(len(model.sonars))
        ),
    )


TOPICS: Final = (
    Topic(
        compatibility="~pose",
        standard="odom",
        kind="nav_msgs/Odometry",
        fill=convert.odometry,
    ),
    Topic(
        compatibility="/tf",
        standard="/tf",
        kind="tf2_msgs/TFMessage",
        fill=transforms.moving,
        wanted=lambda conventions: conventions.odometry_in_tree or conventions.wheels_in_tree,
    ),
    Topic(
        compatibility="/tf_static",
        standard="/tf_static",
        kind="tf2_msgs/TFMessage",
        fill=transforms.fixed,
        told=lambda reading: reading.tree,
        latched=True,
        wanted=lambda conventions: conventions.description,
    ),
    Topic(
        standard="joint_states",
        kind="sensor_msgs/JointState",
        fill=joints.joint_states,
    ),
    Topic(
        compatibility="~bumper_state",
        kind="rosaria/BumperState",
        fill=convert.rosarias_bumpers,
    ),
    Topic(
        standard="bumper_state",
        kind="rosaria/BumperState",
        fill=convert.bumpers,
    ),
    Topic(
        standard="bumpers/points",
        kind="sensor_msgs/PointCloud2",
        fill=clouds.touches,
        known=lambda reading: bool(reading.snapshot.bumpers.front or reading.snapshot.bumpers.rear),
    ),
    Topic(
        compatibility="~battery_voltage",
        kind="std_msgs/Float64",
        fill=convert.voltage,
    ),
    Topic(
        compatibility="~sonar",
        kind="sensor_msgs/PointCloud",
        fill=clouds.sonar_cloud,
    ),
    Topic(
        compatibility="~sonar_pointcloud2",
        kind="sensor_msgs/PointCloud2",
        fill=clouds.sonar_cloud2,
    ),
    Topic(
        standard="sonar/points",
        kind="sensor_msgs/PointCloud2",
        fill=clouds.echoes,
        known=lambda reading: bool(reading.snapshot.sonar.fresh),
    ),
    Topic(
        compatibility="~battery_recharge_state",
        kind="std_msgs/Int8",
        fill=convert.recharge_state,
        told=lambda reading: reading.snapshot.battery.charging,
        latched=True,
        unknown=RECHARGE_STATES[Charging.UNKNOWN],
    ),
    Topic(
        compatibility="~battery_state_of_charge",
        kind="std_msgs/Float32",
        fill=convert.charge,
        known=lambda reading: reading.snapshot.battery.charge is not None,
    ),
    Topic(
        standard="battery_state",
        kind="sensor_msgs/BatteryState",
        fill=convert.battery,
        told=lambda reading: (reading.snapshot.battery.charge, reading.snapshot.battery.charging),
        period=SLOWLY,
        known=lambda reading: reading.snapshot.battery.voltage > 0,  # 0 V comes while it boots
    ),
    Topic(
        compatibility="~motors_state",
        standard="motors_state",
        kind="std_msgs/Bool",
        fill=convert.motors,
        told=lambda reading: reading.snapshot.motors.enabled,
        latched=True,
        unknown=False,
    ),
    Topic(
        standard="emergency_stop",
        kind="std_msgs/Bool",
        fill=convert.emergency_stop,
        latched=True,
        unknown=True,  # who asks whether it is safe to drive must not hear yes
    ),
    Topic(
        standard="compass",
        kind="std_msgs/Float32",
        fill=convert.compass,
        known=lambda reading: reading.snapshot.inputs.compass is not None,
    ),
    Topic(standard="dio", kind="std_msgs/UInt16", fill=convert.digital),
    Topic(standard="aio", kind="std_msgs/Float32MultiArray", fill=convert.analog),
)


def command_names(profile: Profile, name: str) -> tuple[str, ...]:
    """Return the full names of a command topic or service, such as `cmd_vel`."""
    return {
        Profile.COMPATIBILITY: (f"~{name}",),
        Profile.STANDARD: (name,),
        Profile.BOTH: (f"~{name}", name),
    }[profile]


def command_topics(profile: Profile, lab_name: str | None = None) -> tuple[CommandTopic, ...]:
    """Return the topics to take commands from."""
    own = tuple(CommandTopic(name) for name in command_names(profile, "cmd_vel"))
    return own if lab_name is None else (*lab_commands(lab_name), *own)
