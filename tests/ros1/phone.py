"""A phone that tells how it turns on /android/imu, fifty times a second, once somebody listens.

Usage: /usr/bin/python3 phone.py < FLICKS, a line each: turns about x, y, z [rad/s], which
lasts 0.2 s.
"""

from __future__ import annotations

import sys
import threading

import rospy
from sensor_msgs.msg import Imu

FLICK = 10
turns: list[tuple[float, ...]] = []


def read() -> None:
    """Take flicks as they come."""
    for line in sys.stdin:
        turns.extend([tuple(map(float, line.split()))] * FLICK)


rospy.init_node("phone")
publisher = rospy.Publisher("/android/imu", Imu, queue_size=10)
while not publisher.get_num_connections():
    rospy.sleep(0.02)
threading.Thread(target=read, daemon=True).start()
rate = rospy.Rate(50)
while not rospy.is_shutdown():
    imu = Imu()
    imu.header.stamp = rospy.Time.now()
    turn = imu.angular_velocity
    turn.x, turn.y, turn.z = turns.pop(0) if turns else (0.0, 0.0, 0.0)
    publisher.publish(imu)
    rate.sleep()
