"""Sends goals to move_base by actionlib, one after the other, as a program of ROS does.

Usage: /usr/bin/python3 goals.py GOAL ... Each GOAL is `FRAME X Y QZ QW SECONDS`: the goal is
cancelled after SECONDS, or the next one is sent without waiting if that is `next`. Prints JSON: for
each goal its `state`, its `text`, and the number of feedbacks.
"""

from __future__ import annotations

import json
import sys

import actionlib
import rospy
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal

rospy.init_node("goals", anonymous=True)
client = actionlib.ActionClient("move_base", MoveBaseAction)
if not client.wait_for_server(rospy.Duration(20)):
    sys.exit("there is no move_base")
found = []
for line in sys.argv[1:]:
    frame, x, y, qz, qw, seconds = line.split()
    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = frame
    goal.target_pose.header.stamp = rospy.Time.now()
    goal.target_pose.pose.position.x = float(x)
    goal.target_pose.pose.position.y = float(y)
    goal.target_pose.pose.orientation.z = float(qz)
    goal.target_pose.pose.orientation.w = float(qw)
    heard: list[object] = []
    handle = client.send_goal(goal, feedback_cb=lambda _, each, heard=heard: heard.append(each))
    found.append((handle, heard))
    if seconds == "next":
        while handle.get_goal_status() == actionlib.GoalStatus.PENDING:
            rospy.sleep(0.05)
        rospy.sleep(1.0)
        continue
    until = rospy.Time.now() + rospy.Duration(float(seconds))
    while handle.get_comm_state() != actionlib.CommState.DONE and rospy.Time.now() < until:
        rospy.sleep(0.05)
    if handle.get_comm_state() != actionlib.CommState.DONE:
        handle.cancel()
        while handle.get_comm_state() != actionlib.CommState.DONE:
            rospy.sleep(0.05)
sys.stdout.write(
    json.dumps(
        [
            {
                "state": actionlib.GoalStatus.to_string(handle.get_terminal_state()),
                "text": handle.get_goal_status_text(),
                "feedbacks": len(heard),
            }
            for handle, heard in found
        ]
    )
)
