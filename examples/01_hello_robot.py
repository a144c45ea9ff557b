"""Connect, say hello, drive a little. Start a simulator first, with `pioneer3 sim`."""

import sys

from pioneer3 import connect

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    print(f"Hello, {robot.info.identity.name}, a {robot.info.model.title}")
    robot.move(0.5)
    robot.turn(1.57)
    print("Now at", robot.snapshot.odometry.robot_in_odom if robot.snapshot else "nowhere")
