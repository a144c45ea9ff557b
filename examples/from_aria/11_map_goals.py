"""List the goals of a map, and drive to the nearest one; needs the extra nav, and a laser.

ARIA: ArMap.readFile, findMapObject, getMapObjects, ArMapObject.getPose; ARNL's
ArPathPlanningTask.pathPlanToGoal and ArLocalizationTask are connect(line_map=...) and goto.
"""

import sys
from math import hypot

from pioneer3 import connect
from pioneer3.nav.places import places

with connect(
    sys.argv[1] if len(sys.argv) > 1 else "tcp://localhost:8101",
    line_map="simulator",  # the simulator's own map; of a robot its file: Path("lab.map")
) as robot:
    known = robot.navigator.line_map
    goals = [place for place in places(known) if place.role == "goal"]
    for goal in goals:
        print(f"{goal.name}: {goal.pose.x:.1f}, {goal.pose.y:.1f} m")

    home = known.homes[0]  # RobotHome, where the robot begins
    nearest = min(goals, key=lambda goal: hypot(goal.pose.x - home.x, goal.pose.y - home.y))
    robot.goto(nearest.name)
    print("at", nearest.name)
