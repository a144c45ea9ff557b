"""Lesson 2: turn step by step before a wall, and print what one sonar in front hears.

Put the robot 1 m from a plain wall, with its front towards it.

Run: python echoes.py [ADDRESS]
"""

import sys
from math import degrees, isfinite, radians

from pioneer3 import connect

TRANSDUCER = 3  # in front, looks 10 degrees to the left
STEP, STEPS = radians(5), 14
LISTEN = 1.0  # s at each angle: all transducers have fired several times

words = sys.argv[1:]
url = words.pop(0) if words and "://" in words[0] else "tcp://localhost:8101"

with connect(url) as robot:
    looks = robot.info.model.sonars[TRANSDUCER].theta  # rad, to the left of the front
    for number in range(STEPS):
        heard = [shot.sonar.ranges[TRANSDUCER] for shot in robot.snapshots(seconds=LISTEN)]
        angle = degrees(looks + number * STEP)
        echoes = sorted(distance for distance in heard if isfinite(distance))
        middle = f"{echoes[len(echoes) // 2]:.2f} m" if echoes else "no echo"
        print(f"{angle:3.0f} deg from the wall's normal: {middle}", flush=True)
        robot.turn(STEP, rate=0.5)
