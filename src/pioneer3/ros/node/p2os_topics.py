"""Topics that only p2os has, with types of p2os_msgs: names of the profile `p2os` of ROS 1."""

from typing import Final

from pioneer3.ros.messages import p2os
from pioneer3.ros.node.topic import Topic

P2OS_TOPICS: Final = (
    Topic(
        p2os="battery_state",
        type_name="p2os_msgs/BatteryState",
        fill=p2os.battery,
        has_data=lambda update: update.snapshot.battery.voltage > 0,  # 0 V comes while it boots
        note="[V]",
    ),
    Topic(
        p2os="motor_state",
        type_name="p2os_msgs/MotorState",
        fill=p2os.motors,
        note="1 while the motors have power, else 0",
    ),
    Topic(
        p2os="sonar",
        type_name="p2os_msgs/SonarArray",
        fill=p2os.sonar,
        has_data=lambda update: bool(update.snapshot.sonar.fresh),
        note="of every transducer [m], 5 without an echo",
    ),
    Topic(
        p2os="dio",
        type_name="p2os_msgs/DIO",
        fill=p2os.digital,
        note="the eight digital inputs",
    ),
    Topic(
        p2os="aio",
        type_name="p2os_msgs/AIO",
        fill=p2os.analog,
        note="voltage of the selected port",
    ),
)
