"""Starts the ROS 1 node of a laser range finder without a robot."""

from collections.abc import Awaitable, Callable, Sequence
from typing import Final

from pioneer3.robot.lasers.driver import LaserDriver
from pioneer3.robot.lasers.spec import LaserSpec
from pioneer3.ros.node.laser_node import FRAME, LaserNode
from pioneer3.ros.node.laser_parameters import (
    read_laser_parameters,
    unused_laser_parameters,
)
from pioneer3.ros.ros1.middleware import RospyMiddleware
from pioneer3.ros.ros1.start import announce, on_ros

NODE: Final = "laser"


async def serve_laser(
    arguments: Sequence[str],
    find: Callable[[Sequence[str]], Awaitable[Sequence[LaserSpec]]],
    tell: Callable[[str], None],
) -> int:
    """Run the node until it is shut down or cancelled.

    Args:
        arguments: ROS's own.
        find: Looks for the laser, given its port if the parameters have one.
        tell: Takes a line for a person.

    Raises:
        PioneerError: something could not be started; the message says what to do.
    """
    async with on_ros(NODE, arguments, tell) as watch:
        import rospy

        raw = rospy.get_param("~", {})
        parameters = read_laser_parameters(raw)
        for sentence in unused_laser_parameters(raw):
            rospy.logwarn(sentence)
        watch.start()
        spec = parameters.applied_to(await find(parameters.ports))[0]
        tell(f"laser at {spec.url}")
        driver = LaserDriver(spec.config(), mounting=lambda: spec.mounting_on(None))
        middleware = RospyMiddleware()
        node = LaserNode(driver, parameters.frame_id.lstrip("/") or FRAME, middleware)
        await node.run(lambda: announce(middleware, tell))
    return 0
