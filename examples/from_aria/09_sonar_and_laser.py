"""Print what sonars and laser measure: ARIA's rangeDeviceExample.

ARIA: getNumSonar, getSonarRange, ArSonarReading; ArLaserConnector.connectLasers, findLaser,
ArLaser.getRawReadings, currentReadingPolar, checkRangeDevicesCurrentPolar, cumulativeReadingPolar.
"""

import sys
from math import degrees, radians

from pioneer3 import connect

with connect(
    sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101"
) as robot:  # lasers=["/dev/ttyUSB1"]: connectLasers
    for snapshot in robot.snapshots(seconds=0.6):
        print("sonar:", *(f"{metres:.2f}" for metres in snapshot.sonar.ranges))

    scan = robot.laser.reading()  # DeviceError where there is none
    print(f"laser: {len(scan.ranges)} readings,", end=" ")
    print(f"{degrees(scan.angles[0]):.0f} to {degrees(scan.angles[-1]):.0f} deg,", end=" ")
    print(f"nearest {min(scan.ranges):.2f} m")

    with robot.laser.wanted():  # as long as it scans, nearest looks through it too
        for _ in robot.snapshots(seconds=1):
            pass
        left, right = (robot.nearest(radians(a), radians(a + 90)) for a in (0, -90))
    print(f"left {left.distance:.2f} m at {degrees(left.bearing):.0f} deg", end=", ")
    print(f"right {right.distance:.2f} m at {degrees(right.bearing):.0f} deg")
