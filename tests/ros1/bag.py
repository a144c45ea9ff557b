"""Reads poses from a recording. Needs rosbag only.

Usage: /usr/bin/python3 bag.py FILE TOPIC ... Prints JSON: for each topic of nav_msgs/Odometry the
stamp [s] and x [m] of every message.
"""

from __future__ import annotations

import json
import sys

import rosbag

with rosbag.Bag(sys.argv[1]) as bag:
    found = {
        topic: [
            [message.header.stamp.to_sec(), message.pose.pose.position.x]
            for _, message, _ in bag.read_messages(topics=[topic])
        ]
        for topic in sys.argv[2:]
    }
sys.stdout.write(json.dumps(found))
