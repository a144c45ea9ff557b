"""Ask the robot why it stands still: before a command, and after it has expired."""

import sys
import time

from pioneer3 import connect

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    print(robot.why_not_moving())
    robot.drive(0.2)
    time.sleep(2)
    print(robot.why_not_moving())
