"""Drive a square, and print where it ends.

ARIA: move, isMoveDone, setDeltaHeading, isHeadingDone, getX, getY, getTh, lock and unlock, which
nothing here needs: a snapshot never changes.
"""

import sys
from math import degrees, radians

from pioneer3 import connect

SIDE = 0.3
"""Length of a side [m]."""

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    for _ in range(4):
        robot.move(SIDE)  # returns when it is there
        robot.turn(radians(90))
    if robot.snapshot is not None:
        here = robot.snapshot.odometry.robot_in_odom
        print(f"back at x {here.x:.2f} m, y {here.y:.2f} m, th {degrees(here.theta):.0f} deg")
