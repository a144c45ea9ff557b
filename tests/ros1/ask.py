"""A program of rospy that asks a node as ROS's tools and graphs do. Needs dynamic_reconfigure too.

Usage: /usr/bin/python3 ask.py NODE. Prints JSON: how many `responses` came over a persistent
connection, and how many of several calls at once came back `together`; what dynamic_reconfigure has
`set` and `described`; the level of a logger before and after it is set; `connections`, process and
codes of refusals by the node's own interface.
"""

from __future__ import annotations

import json
import sys
import threading
from typing import Any
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
from dynamic_reconfigure.client import Client
from roscpp.srv import GetLoggers, SetLoggerLevel
from std_srvs.srv import Empty

node = sys.argv[1]
rospy.init_node("ask", anonymous=True)
rospy.wait_for_service(f"{node}/enable_motors", 10)
persistent = rospy.ServiceProxy(f"{node}/enable_motors", Empty, persistent=True)
responses = sum(persistent() is not None for _ in range(20))
done: list[object] = []
threads = [
    threading.Thread(
        target=lambda: done.append(rospy.ServiceProxy(f"{node}/enable_motors", Empty)())
    )
    for _ in range(8)
]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
client = Client(node, timeout=10)
described = client.get_parameter_descriptions()
config = client.update_configuration({"trans_accel": 0.2, "TicksMM": 130})


def loggers() -> dict[str, str]:
    """Return the level of each logger."""
    return {
        each.name: each.level
        for each in rospy.ServiceProxy(f"{node}/get_loggers", GetLoggers)().loggers
    }


before = loggers()
rospy.ServiceProxy(f"{node}/set_logger_level", SetLoggerLevel)("pioneer3", "error")
uri = rosgraph.Master("/ask").lookupNode(node)
api: Any
with ServerProxy(uri) as api:
    connections = api.getBusInfo("/ask")[2]
    pid = api.getPid("/ask")[2]
    refused = api.paramUpdate("/ask", "/x", 1)[0], api.getUri_of_nobody("/ask")[0]
sys.stdout.write(
    json.dumps(
        {
            "responses": responses,
            "together": len(done),
            "set": {name: config[name] for name in ("trans_accel", "TicksMM")},
            "described": {
                each["name"]: [each["type"], each["min"], each["max"]] for each in described
            },
            "loggers": [before.get("pioneer3"), loggers()["pioneer3"]],
            "connections": [row[1:5] for row in connections],
            "pid": pid,
            "refused": refused,
        }
    )
)
