"""Print what the sonar sees while turning; commands expire, so they are renewed."""

import sys

from pioneer3 import connect

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    for snapshot in robot.snapshots(seconds=3):
        robot.drive(0.0, 0.5)
        print(f"nearest echo {snapshot.sonar.nearest:.2f} m, {snapshot.battery.voltage:.1f} V")
