"""Behaves like the lab's p3_sonar: reads points 0 to 7 of each cloud, without a look at how many.

With "follow" as its argument it drives towards the nearest one, 2.5 times a second, as the lab's
p3_sonar_following_moving_object does.
"""

from __future__ import annotations

import math
import sys

import rospy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import PointCloud

near: list[float] = []


def show(cloud: PointCloud) -> None:
    """Print how far each of the front echoes is, from the robot's centre [mm]."""
    near[:] = [math.hypot(cloud.points[i].x, cloud.points[i].y) for i in range(8)]
    print(*(round(1000 * metres) for metres in near), flush=True)  # noqa: T201


rospy.init_node("p3_sonar")
rospy.Subscriber("/RosAria_p3at_1_113/sonar", PointCloud, show, queue_size=1)
publisher = rospy.Publisher("/RosAria/cmd_vel", Twist, queue_size=1)
rate = rospy.Rate(2.5)
while not rospy.is_shutdown():
    if near and sys.argv[1:] == ["follow"]:
        twist = Twist()
        twist.linear.x = max(-0.3, min(0.5, (min(near) - 0.24 - 0.3) / 1.2))
        publisher.publish(twist)
    rate.sleep()
