"""Topics that only p2os has, with types of p2os_msgs: names of the profile `p2os` of ROS 1."""

from math import isfinite
from typing import Any, Final

from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.ros.messages.update import StateUpdate, fill_header
from pioneer3.ros.node.topic import Topic

DIGITAL_LINES: Final = 8
"""Digital inputs of the controller, which p2os sends alone."""


def _battery(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/BatteryState [V]."""
    fill_header(message, update.stamp, update.frames.base)
    message.voltage = update.snapshot.battery.voltage


def _motors(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/MotorState: 1 while the motors have power, else 0."""
    message.state = int(update.snapshot.motors.enabled)


def _sonar(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/SonarArray: the range of every transducer, the longest without an echo."""
    fill_header(message, update.stamp, update.frames.base)
    heard = update.snapshot.sonar.ranges[: len(update.model.sonars)]
    message.ranges = [metres if isfinite(metres) else SONAR_MAX for metres in heard]
    message.ranges_count = len(message.ranges)


def _digital(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/DIO with the digital inputs."""
    message.count = DIGITAL_LINES
    message.bits = update.snapshot.inputs.digital_in & 0xFF


def _analog(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/AIO with the voltage of the selected port [V]."""
    message.voltages = [update.snapshot.inputs.analog]
    message.voltages_count = 1


P2OS_TOPICS: Final = (
    Topic(
        p2os="battery_state",
        type_name="p2os_msgs/BatteryState",
        fill=_battery,
        has_data=lambda update: update.snapshot.battery.voltage > 0,  # 0 V comes while it boots
        note="[V]",
    ),
    Topic(
        p2os="motor_state",
        type_name="p2os_msgs/MotorState",
        fill=_motors,
        note="1 while the motors have power, else 0",
    ),
    Topic(
        p2os="sonar",
        type_name="p2os_msgs/SonarArray",
        fill=_sonar,
        has_data=lambda update: bool(update.snapshot.sonar.fresh),
        note="of every transducer [m], 5 without an echo",
    ),
    Topic(p2os="dio", type_name="p2os_msgs/DIO", fill=_digital, note="the eight digital inputs"),
    Topic(p2os="aio", type_name="p2os_msgs/AIO", fill=_analog, note="voltage of the selected port"),
)
