"""A subscriber to topics of any type; prints what the connections say as JSON. Needs rospy only.

Usage: /usr/bin/python3 listen.py SECONDS TOPIC ...
"""

from __future__ import annotations

import json
import sys
import threading

import rospy

everything = threading.Event()
heard: dict[str, dict[str, object]] = {}


def note(message: rospy.AnyMsg, topic: str) -> None:
    """Keep the first message of each topic."""
    header = message._connection_header
    heard.setdefault(
        topic,
        {
            "type": header["type"],
            "md5sum": header["md5sum"],
            "latching": header.get("latching", "0"),
            "bytes": len(message._buff),
        },
    )
    if len(heard) == len(sys.argv) - 2:
        everything.set()


rospy.init_node("listen", anonymous=True)
for name in sys.argv[2:]:
    rospy.Subscriber(name, rospy.AnyMsg, note, callback_args=name, queue_size=10)
everything.wait(float(sys.argv[1]))
sys.stdout.write(json.dumps(heard))
