"""Drive on until something is near in front, then stop.

ARIA: ArActionLimiterForwards over ArActionConstantVelocity, or checkRangeDevicesCurrentPolar in a
loop with setVel; getRobotRadius.
"""

import sys
from math import radians

from pioneer3 import connect

STOP = 0.5
"""So much room must be left in front of the robot [m]."""

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    radius = robot.info.model.radius
    for _ in robot.snapshots(seconds=10):
        ahead = robot.nearest(radians(-45), radians(45))
        room = ahead.distance - radius
        if room < STOP:
            robot.stop()
            print(f"stopped: {room:.2f} m of room")
            break
        robot.drive(min(0.4, room - STOP + 0.1))
    else:
        print(f"nothing was in the way; {room:.2f} m of room")
