"""Lesson 2: a wander program of one's own: ahead while there is room, else turn away.

Run: python keep_clear.py [ADDRESS] [SECONDS]
"""

import sys

from pioneer3 import MotionError, connect

SPEED, TURN_RATE = 0.25, 0.6  # m/s, rad/s
NEAR, FAR = 0.6, 0.9  # m: turn from nearer than this, until nothing is nearer than that

words = sys.argv[1:]
url = words.pop(0) if words and "://" in words[0] else "tcp://localhost:8101"
seconds = float(words[0]) if words else 20.0
turning = 0.0  # rad/s

with connect(url) as robot:
    for snapshot in robot.snapshots(seconds=seconds):
        left = min(snapshot.sonar.ranges[0:4])  # m; from 90 degrees left to the front
        right = min(snapshot.sonar.ranges[4:8])
        nearest = min(left, right)
        if not turning and nearest < NEAR:
            turning = TURN_RATE if right < left else -TURN_RATE  # and on, the same way
            print(f"{nearest:.2f} m {'right' if right < left else 'left'}: I turn away", flush=True)
        elif turning and nearest > FAR:
            turning = 0.0
        try:
            robot.drive(0.0 if turning else SPEED, turning)
        except MotionError as error:  # it touched something that it did not hear
            print(error, flush=True)
            turning = turning or TURN_RATE
            robot.drive(0.0, turning)
