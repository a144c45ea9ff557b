"""Lesson 3: send the robot from place to place of a map, and print how each drive went.

START is where the robot is now: a place of the map, or X,Y,HEADING in metres and degrees.

Run: python patrol.py [ADDRESS] office START PLACE...
"""

import sys
import time
from math import radians

from pioneer3 import MotionError, connect
from pioneer3.geometry import Pose2

words = sys.argv[1:]
url = words.pop(0) if words and "://" in words[0] else "tcp://localhost:8101"
if len(words) < 3:
    sys.exit(__doc__)
line_map, begin, *places = words
x, *rest = begin.split(",")
start = Pose2(float(x), float(rest[0]), radians(float(rest[1]))) if rest else begin

with connect(url, line_map=line_map, start=start) as robot:
    for place in places:
        began = time.monotonic()
        try:
            robot.goto(place, speed=0.5)
        except MotionError as error:
            print(f"{place}: not there: {error}", flush=True)
        else:
            print(f"{place}: there after {time.monotonic() - began:.0f} s", flush=True)
