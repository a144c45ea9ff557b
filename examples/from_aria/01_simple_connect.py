"""Connect and print the robot's state: ARIA's simpleConnect.

ARIA: ArArgumentParser, ArSimpleConnector or ArRobotConnector.connectRobot, ArRobot.runAsync,
getPose, getVel, getRotVel, getRealBatteryVoltage, Aria.exit.
"""

import sys
from math import degrees

from pioneer3 import connect

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    print(f"{robot.info.identity.name}, a {robot.info.model.title}")
    for snapshot in robot.snapshots(seconds=1):
        here, twist = snapshot.odometry.robot_in_odom, snapshot.odometry.twist
        print(
            f"x {here.x:.2f} m, y {here.y:.2f} m, th {degrees(here.theta):.0f} deg,"
            f" vel {twist.v:.2f} m/s, rotVel {degrees(twist.w):.0f} deg/s,"
            f" {snapshot.battery.voltage:.1f} V"
        )
