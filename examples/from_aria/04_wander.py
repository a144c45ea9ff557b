"""Wander with a stack of actions: ARIA's wander.

ARIA: ArSonarDevice, addRangeDevice, addAction with ArActionStallRecover, ArActionLimiterForwards,
ArActionLimiterBackwards, ArActionAvoidFront, ArActionAvoidSide, ArActionConstantVelocity;
ArActionGroup, deactivateExclusive, waitForRunExit.
"""

import sys

from pioneer3 import connect
from pioneer3.behaviors import Ranked, Stack
from pioneer3.behaviors.actions import (
    AvoidFront,
    AvoidSide,
    ConstantVelocity,
    LimiterBackwards,
    LimiterForwards,
    StallRecover,
)

stack = Stack.of(  # addAction: the higher priority decides first, as in ARIA
    "wander",
    20,
    [
        Ranked(100, StallRecover()),
        Ranked(95, LimiterForwards(0.3, 0.6, 0.25, name="near limiter")),
        Ranked(90, LimiterForwards(0.3, 1.1, 0.4, name="far limiter")),
        Ranked(85, LimiterBackwards()),
        Ranked(50, AvoidFront(0.45, 0.2)),
        Ranked(49, AvoidSide()),
        Ranked(25, ConstantVelocity(0.3)),
    ],
)
with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    robot.run(stack, seconds=4)  # without seconds: waitForRunExit
    print("wandered to", robot.snapshot.odometry.robot_in_odom if robot.snapshot else "nowhere")
