"""Follow the wall on the left by sonar.

ARIA: ArSonarDevice, checkRangeDevicesCurrentPolar or sonar.currentReadingPolar, setVel, setRotVel.
"""

import sys
from math import radians

from pioneer3 import connect

KEEP = 0.7
"""Distance of the robot's centre from the wall [m]."""
FAR = 1.5
"""What is farther is no wall to follow [m]."""

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    for _ in robot.snapshots(seconds=4):
        wall = robot.nearest(radians(40), radians(140))
        ahead = robot.nearest(radians(-30), radians(40))
        if ahead.distance < KEEP:
            robot.drive(0.0, radians(-30))  # a corner: away from the wall
        elif wall.distance > FAR:
            robot.drive(0.15, radians(10))  # look for the wall
        else:
            off = wall.distance - KEEP  # and a robot along the wall sees it at 90 degrees
            robot.drive(0.2, 0.8 * off + 0.8 * (wall.bearing - radians(90)))
    print(f"the wall is at {robot.nearest(radians(40), radians(140)).distance:.2f} m")
