"""The other end of a node's topics, in ROS's own Python; prints JSON.

Usage: /usr/bin/python3 ros1_client.py drive COUNT: when each command was published [s, monotonic].
       /usr/bin/python3 ros1_client.py listen SECONDS: when each pose came [s, monotonic], while
       everything else is subscribed to, too.
       /usr/bin/python3 ros1_client.py follow: listens to three topics until it is ended;
       `circle` also drives.
"""

from __future__ import annotations

import json
import sys
import time
from random import Random

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry

PAUSES = (0.03, 0.2)
"""Between two commands, drawn at random [s]: the repetition of one must not delay the next."""
OTHERS = ("/tf", "sonar", "bumper_state", "battery_voltage", "/diagnostics")


def drive(count: int) -> list[float]:
    """Publish commands at random times, each another one than before."""
    random = Random(0)
    publisher = rospy.Publisher("/RosAria/cmd_vel", Twist, queue_size=1, tcp_nodelay=True)
    while not publisher.get_num_connections():
        rospy.sleep(0.02)
    rospy.sleep(0.5)
    published = []
    for number in range(count):
        twist = Twist()
        twist.linear.x = 0.1 + number % 100 / 1000
        published.append(time.monotonic())
        publisher.publish(twist)
        rospy.sleep(random.uniform(*PAUSES))
    return published


def listen(seconds: float) -> list[float]:
    """Subscribe to what people usually do."""
    came: list[float] = []
    rospy.Subscriber(
        "/RosAria/pose", Odometry, lambda _: came.append(time.monotonic()), tcp_nodelay=True
    )
    for name in OTHERS:
        full = name if name.startswith("/") else f"/RosAria/{name}"
        rospy.Subscriber(full, rospy.AnyMsg, lambda _: None)
    rospy.sleep(seconds)
    return came


def follow(*, driving: bool) -> None:
    """Subscribe to pose, transforms and sonar; send a command ten times a second if `driving`."""
    for name in ("/RosAria/pose", "/tf", "/RosAria/sonar"):
        rospy.Subscriber(name, rospy.AnyMsg, lambda _: None)
    publisher = rospy.Publisher("/RosAria/cmd_vel", Twist, queue_size=1, tcp_nodelay=True)
    twist = Twist()
    twist.linear.x, twist.angular.z = 0.15, 0.5
    print("listens", flush=True)
    while not rospy.is_shutdown():
        if driving:
            publisher.publish(twist)
        rospy.sleep(0.1)


rospy.init_node("bench", anonymous=True)
what, *amount = sys.argv[1:]
if amount:
    (number,) = amount
    found = drive(int(number)) if what == "drive" else listen(float(number))
    sys.stdout.write(json.dumps(found))
else:
    follow(driving=what == "circle")
