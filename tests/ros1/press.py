"""Publishes one Twist as the lab's rob_key does at a key press, and says how the robot moved.

Usage: /usr/bin/python3 press.py SPEED SECONDS; SPEED may be nan. Prints JSON: for every pose that
came within SECONDS after the press its x [m], speed [m/s], stamp and when it came [s].
"""

from __future__ import annotations

import json
import sys
import time

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

seen: list[tuple[float, ...]] = []
pressed = None


def note(pose: Odometry) -> None:
    """Keep a pose that came after the press."""
    if pressed is not None:
        seen.append(
            (
                pose.pose.pose.position.x,
                pose.twist.twist.linear.x,
                pose.header.stamp.to_sec(),
                rospy.get_time(),
            )
        )


rospy.init_node("press", anonymous=True)
rospy.Subscriber("/RosAria/pose", Odometry, note, queue_size=10)
publisher = rospy.Publisher("/RosAria/cmd_vel", Twist, queue_size=1)
while not publisher.get_num_connections():
    rospy.sleep(0.02)
twist = Twist()
twist.linear.x = float(sys.argv[1])
pressed = rospy.get_time()
publisher.publish(twist)
while not rospy.is_shutdown() and rospy.get_time() < pressed + float(sys.argv[2]):
    time.sleep(0.02)  # signals do not end a long rospy.sleep
sys.stdout.write(json.dumps(seen))
