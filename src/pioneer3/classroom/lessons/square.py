"""Lesson 1: drive a square, and print where the wheels say that the robot is at each corner.

Run: python square.py [ADDRESS] [SIDE [LAPS]]
"""

import sys
from math import degrees, hypot, pi

from pioneer3 import connect

words = sys.argv[1:]
url = words.pop(0) if words and "://" in words[0] else "tcp://localhost:8101"
side = float(words[0]) if words else 0.5  # m
laps = int(words[1]) if len(words) > 1 else 1

with connect(url) as robot:
    assert robot.snapshot is not None
    start = robot.snapshot.odometry.robot_in_odom
    for corner in range(1, 4 * laps + 1):
        robot.move(side, speed=0.3)  # m, m/s
        robot.turn(pi / 2, rate=0.8)  # rad, rad/s
        here = start.inverse() @ robot.snapshot.odometry.robot_in_odom
        print(f"corner {corner}: x {here.x:.2f} m, y {here.y:.2f} m, {degrees(here.theta):.0f} deg")
    print(f"The wheels say: {hypot(here.x, here.y):.2f} m from the start.")
