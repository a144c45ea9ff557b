"""Behaves like the lab's android_teleop: a phone's turns become speeds, ten times a second."""

from __future__ import annotations

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Imu

FLICK = 3.0
wanted = Twist()


def feel(imu: Imu) -> None:
    """Take a flick of the phone for a command."""
    turns = imu.angular_velocity
    if abs(turns.x) > FLICK:
        wanted.linear.x, wanted.angular.z = (0.2 if turns.x > 0 else -0.2), 0.0
    elif abs(turns.z) > FLICK:
        wanted.linear.x, wanted.angular.z = 0.0, (0.5 if turns.z > 0 else -0.5)
    elif abs(turns.y) > FLICK:
        wanted.linear.x = wanted.angular.z = 0.0


rospy.init_node("android_teleop")
rospy.Subscriber("/android/imu", Imu, feel, queue_size=1)
publisher = rospy.Publisher("/RosAria/cmd_vel", Twist, queue_size=1)
print("ready", flush=True)  # noqa: T201
rate = rospy.Rate(10)
while not rospy.is_shutdown():
    publisher.publish(wanted)
    rate.sleep()
