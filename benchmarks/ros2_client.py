"""The other end of a node's topics in ROS 2, until it is ended: listens to three, and may drive.

python -m benchmarks.ros2_client follow|circle --backend NAME --domain NUMBER [--connect PLACE]
"""

import argparse
import asyncio

from pioneer3.ros.ros2.backend import Qos
from pioneer3.ros.ros2.network import BackendName, Network
from tests.ros2.networks import Ros2

PAUSE = 0.1
"""Between two commands [s]."""
TOPICS = {
    "/odom": "nav_msgs/Odometry",
    "/tf": "tf2_msgs/TFMessage",
    "/sonar/points": "sensor_msgs/PointCloud2",
}


async def main() -> None:
    """Listen, and drive in a circle if it is asked for."""
    parser = argparse.ArgumentParser()
    parser.add_argument("what", choices=("follow", "circle"))
    parser.add_argument("--backend", type=BackendName)
    parser.add_argument("--domain", type=int)
    parser.add_argument("--connect", nargs="*", default=())
    given = parser.parse_args()
    network = Network(backend=given.backend, domain=given.domain, connect=tuple(given.connect))
    async with Ros2(network).peer() as peer:
        for name, type_name in TOPICS.items():
            type_ = peer.types.message_type(type_name)
            peer.backend.subscribe(name, type_, Qos(), lambda cdr, gid: None, lambda gid: None)
        publisher = peer.publisher("/cmd_vel", "geometry_msgs/Twist")
        print("listens", flush=True)
        while True:
            if given.what == "circle":
                publisher.write(peer.twist(0.15, 0.5))
            await asyncio.sleep(PAUSE)


asyncio.run(main())
