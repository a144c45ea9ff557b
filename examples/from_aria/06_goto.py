"""Drive from point to point, around small things: ARIA's gotoActionExample.

ARIA: ArPose, ArActionGoto, setGoal, haveAchievedGoal, cancelGoal, beside limiters and avoiders.
"""

import sys

from pioneer3 import MotionError, Pose2, connect

GOALS = (Pose2(0.4, 0.0), Pose2(0.4, 0.3), Pose2(0.0, 0.0))
"""In odometry's frame [m]: the robot begins at (0, 0)."""

with connect(sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101") as robot:
    for goal in GOALS:
        try:
            robot.goto(goal.x, goal.y, speed=0.3)  # setGoal; returns at haveAchievedGoal
        except MotionError as error:  # a goal behind a wall, a stop: cancelGoal, with the reason
            print("did not get there:", error)
            break
        print(f"at {goal.x:.1f}, {goal.y:.1f}")
