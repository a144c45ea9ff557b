"""Behaves like the lab's rob_key: one Twist for each key press, no more.

Usage: /usr/bin/python3 rob_key.py < KEYS; f b l r drive, a space stops.
"""

from __future__ import annotations

import sys

import rospy
from geometry_msgs.msg import Twist

MOVES = {"f": (0.5, 0.0), "b": (-0.5, 0.0), "l": (0.0, 0.5), "r": (0.0, -0.5), " ": (0.0, 0.0)}

rospy.init_node("rob_key")
publisher = rospy.Publisher("/RosAria/cmd_vel", Twist, queue_size=1)
while not publisher.get_num_connections():
    rospy.sleep(0.02)
print("ready", flush=True)  # noqa: T201
while key := sys.stdin.read(1):
    if key in MOVES:
        twist = Twist()
        twist.linear.x, twist.angular.z = MOVES[key]
        publisher.publish(twist)
