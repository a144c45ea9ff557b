"""State of the robot to the messages of p2os_msgs."""

from math import isfinite
from typing import Any, Final

from pioneer3.robot.assemble import SONAR_MAX
from pioneer3.ros.messages.update import StateUpdate, fill_header

DIGITAL_LINES: Final = 8
"""Digital inputs of the controller, which p2os sends alone."""


def battery(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/BatteryState [V]."""
    fill_header(message, update.stamp, update.frames.base)
    message.voltage = update.snapshot.battery.voltage


def motors(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/MotorState: 1 while the motors have power, else 0."""
    message.state = int(update.snapshot.motors.enabled)


def sonar(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/SonarArray: the range of every transducer, the longest without an echo."""
    fill_header(message, update.stamp, update.frames.base)
    heard = update.snapshot.sonar.ranges[: len(update.model.sonars)]
    message.ranges = [metres if isfinite(metres) else SONAR_MAX for metres in heard]
    message.ranges_count = len(message.ranges)


def digital(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/DIO with the digital inputs."""
    message.count = DIGITAL_LINES
    message.bits = update.snapshot.inputs.digital_in & 0xFF


def analog(message: Any, update: StateUpdate) -> None:
    """Fill a p2os_msgs/AIO with the voltage of the selected port [V]."""
    message.voltages = [update.snapshot.inputs.analog]
    message.voltages_count = 1
