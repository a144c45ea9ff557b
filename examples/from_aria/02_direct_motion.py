"""Drive by speeds, then by distances and angles: ARIA's directMotionExample.

ARIA: enableMotors, setVel, setRotVel, setVel2, move and isMoveDone, setDeltaHeading, setHeading
and isHeadingDone, stop, ArUtil.sleep.
"""

import sys
import time
from math import radians

from pioneer3 import connect

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    robot.motors(True)  # enableMotors
    for _ in robot.snapshots(seconds=1):
        robot.drive(0.2, radians(20))  # setVel(200), setRotVel(20); expires unless renewed
    for _ in robot.snapshots(seconds=1):
        robot.drive_wheels(0.2, 0.1)  # setVel2(200, 100)

    robot.start_move(-0.2)  # move(-200)
    while not robot.is_move_done():  # isMoveDone
        time.sleep(0.1)  # ArUtil.sleep(100)
    robot.set_delta_heading(radians(45))  # setDeltaHeading(45)
    while not robot.is_move_done():  # isHeadingDone
        time.sleep(0.1)
    robot.set_heading(0.0)  # setHeading(0)
    while not robot.is_move_done():
        time.sleep(0.1)
    robot.stop()
    print(
        "heading", round(robot.snapshot.odometry.robot_in_odom.theta, 2) if robot.snapshot else "?"
    )
