"""What tf2 makes of /tf and /tf_static: the way from odom to each frame. Needs rospy and tf2_py.

Usage: /usr/bin/python3 look_up.py SECONDS FIXED FRAME ... Prints JSON: `parents`, the parent of
every frame as tf2 has it, how many `roots` the frames have, and `at`, for each FRAME its x, y and
z [m] and its quaternion in FIXED.
"""

from __future__ import annotations

import json
import sys

import rospy
import tf2_py
from tf2_msgs.msg import TFMessage

core = tf2_py.BufferCore(rospy.Duration(30))
parents: dict[str, set[str]] = {}


def take(message: TFMessage, static: bool) -> None:
    """Hand all transforms on to tf2."""
    for each in message.transforms:
        parents.setdefault(each.child_frame_id, set()).add(each.header.frame_id)
        if static:
            core.set_transform_static(each, "look_up")
        else:
            core.set_transform(each, "look_up")


rospy.init_node("look_up", anonymous=True)
rospy.Subscriber("/tf", TFMessage, take, callback_args=False, queue_size=100)
rospy.Subscriber("/tf_static", TFMessage, take, callback_args=True, queue_size=100)
rospy.sleep(float(sys.argv[1]))
at = {}
for frame in sys.argv[3:]:
    found = core.lookup_transform_core(sys.argv[2], frame, rospy.Time(0)).transform
    t, q = found.translation, found.rotation
    at[frame] = [t.x, t.y, t.z, q.x, q.y, q.z, q.w]
roots = {above for several in parents.values() for above in several} - set(parents)
sys.stdout.write(
    json.dumps(
        {"parents": {k: sorted(v) for k, v in parents.items()}, "roots": sorted(roots), "at": at}
    )
)
