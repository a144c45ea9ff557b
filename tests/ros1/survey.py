"""A subscriber to topics of any type that looks at every message for a while. Needs rospy only.

Usage: /usr/bin/python3 survey.py SECONDS TOPIC ... Prints JSON: for each topic that was heard its
type, md5sum and latching; how many messages came, with which frames, how old their stamps were on
arrival at most [s], and whether each stamp was later than the one before.
"""

from __future__ import annotations

import json
import sys
import threading
from typing import Any

import rospy
from genpy.dynamic import generate_dynamic
from roslib.message import get_message_class

heard: dict[str, dict[str, Any]] = {}
stamps: dict[str, float] = {}
classes: dict[str, Any] = {}
lock = threading.Lock()


def note(raw: rospy.AnyMsg, topic: str) -> None:
    """Take in a message, in a thread of its connection."""
    now, header = rospy.get_time(), raw._connection_header
    with lock:
        if topic not in classes:
            kind = header["type"]
            definition = header["message_definition"]
            classes[topic] = get_message_class(kind) or generate_dynamic(kind, definition)[kind]
        message = classes[topic]().deserialize(raw._buff)
        row = heard.setdefault(
            topic,
            {
                "type": header["type"],
                "md5sum": header["md5sum"],
                "latching": header.get("latching", "0"),
                "count": 0,
                "frames": [],
                "age": 0.0,
                "ordered": True,
                "first": now,
            },
        )
        row["count"] += 1
        row["last"] = now
        for stamped in getattr(message, "transforms", [message]):
            if hasattr(stamped, "header"):
                look_at(row, topic, stamped.header, now)


def look_at(row: dict[str, Any], topic: str, header: Any, now: float) -> None:
    """Take in a header."""
    if header.frame_id not in row["frames"]:
        row["frames"].append(header.frame_id)
    stamp = header.stamp.to_sec()
    row["age"] = max(row["age"], now - stamp)
    row["ordered"] = row["ordered"] and stamp >= stamps.get(topic, stamp)
    stamps[topic] = stamp


rospy.init_node("survey", anonymous=True)
for name in sys.argv[2:]:
    rospy.Subscriber(name, rospy.AnyMsg, note, callback_args=name, queue_size=100)
rospy.sleep(float(sys.argv[1]))
with lock:
    sys.stdout.write(json.dumps(heard))
