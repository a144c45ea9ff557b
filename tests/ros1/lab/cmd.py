"""Behaves like the lab's test_cmd: the same command once a second."""

from __future__ import annotations

import rospy
from geometry_msgs.msg import Twist

rospy.init_node("test_cmd")
publisher = rospy.Publisher("/RosAria/cmd_vel", Twist, queue_size=1)
twist = Twist()
twist.linear.x, twist.angular.z = 0.5, 0.2
print("ready", flush=True)  # noqa: T201
rate = rospy.Rate(1)
while not rospy.is_shutdown():
    publisher.publish(twist)
    rate.sleep()
