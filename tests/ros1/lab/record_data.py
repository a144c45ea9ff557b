"""Behaves like the lab's test_record_data: prints the poses of the local robot."""

from __future__ import annotations

import rospy
from nav_msgs.msg import Odometry


def record(pose: Odometry) -> None:
    """Print where the robot is [m]."""
    place = pose.pose.pose.position
    print(f"{place.x:.3f} {place.y:.3f}", flush=True)  # noqa: T201


rospy.init_node("test_record_data")
rospy.Subscriber("/RosAria_local/pose", Odometry, record, queue_size=1)
rospy.spin()
