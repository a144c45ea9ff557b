"""Behaves like the lab's rob_key_multi_robot_con_separately.

At each press it tells all robots to stop, and at once one of them to move, on another topic.

Usage: /usr/bin/python3 rob_key_multi.py ROBOTS < KEYS; f b l r drive, a space stops, q goes on to
the next robot, s N y to robot N. It waits until ROBOTS robots listen.
"""

from __future__ import annotations

import sys

import rospy
from geometry_msgs.msg import Twist

NAMES = ("p0_119", "p1_113", "p2_246", "p3_191", "p4_254", "p5_160")
MOVES = {"f": (0.1, 0.0), "b": (-0.1, 0.0), "l": (0.0, 0.1), "r": (0.0, -0.1), " ": (0.0, 0.0)}

rospy.init_node("rob_key")
everybody = rospy.Publisher("/RosAria/cmd_vel", Twist, queue_size=10)
each = [rospy.Publisher(f"/RosAria/cmd_vel_{name}", Twist, queue_size=10) for name in NAMES]
robots, chosen, wanted = int(sys.argv[1]), 0, 0
while (
    everybody.get_num_connections() < robots
    or sum(publisher.get_num_connections() for publisher in each) < robots
):
    rospy.sleep(0.02)
print("ready", flush=True)  # noqa: T201
while key := sys.stdin.read(1):
    if key == "q":
        chosen = (chosen + 1) % len(NAMES)
    elif key.isdigit():
        wanted = int(key)
    elif key == "y":
        chosen = wanted
    elif key in MOVES:
        twist = Twist()
        twist.linear.x, twist.angular.z = MOVES[key]
        everybody.publish(Twist())
        each[chosen].publish(twist)
